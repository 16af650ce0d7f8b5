"""Files written whole or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fuzzytrack.errors import DataError

__all__ = ["check_output", "whole_file"]

PathLike = str | os.PathLike[str]


def check_output(path: PathLike, inputs: tuple[PathLike, ...] = ()) -> Path:
    """Look ahead whether a file can be written, before the work is done.

    Parameters
    ----------
    path : str or path
        The file to be written; it need not exist.
    inputs : tuple of str or path
        Files that must not be overwritten.

    Returns
    -------
    Path
        The file, with symbolic links followed.

    Raises
    ------
    DataError
        If the file is one of the inputs.
    OSError
        If its folder does not exist or cannot be written to, or the path is no ordinary file.
    """
    target = Path(path).resolve()
    for source in inputs:
        if target.exists() and os.path.exists(source) and os.path.samefile(source, target):
            raise DataError(f"{path}: is the input; write to another file")
    if target.is_dir():
        raise IsADirectoryError(None, "is a folder, not a file", str(path))
    if target.exists() and not target.is_file():
        raise OSError(None, "is not an ordinary file", str(path))
    if not target.parent.is_dir():
        raise FileNotFoundError(None, f"there is no folder {target.parent}", str(path))
    if not os.access(target.parent, os.W_OK):
        raise PermissionError(None, f"folder {target.parent} cannot be written to", str(path))
    return target


@contextmanager
def whole_file(path: PathLike, inputs: tuple[PathLike, ...] = ()) -> Iterator[Path]:
    """Write a file whole or not at all.

    Parameters
    ----------
    path : str or path
        The file; replaced if it exists.
    inputs : tuple of str or path
        Files that must not be overwritten.

    Yields
    ------
    Path
        A draft in the same folder, with the same suffix, to be written to. When the block ends it
        takes the place of the file; if the block fails it is removed, and the file is as it was.

    Raises
    ------
    DataError, OSError
        See `check_output`.
    """
    target = check_output(path, inputs)
    draft = target.with_name(f".{target.stem}.{secrets.token_hex(4)}.part{target.suffix}")
    try:
        yield draft
        if target.exists():
            shutil.copymode(target, draft)
        os.replace(draft, target)
    finally:
        draft.unlink(missing_ok=True)
