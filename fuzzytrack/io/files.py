"""Files and folders that appear whole or not at all."""

from __future__ import annotations

import errno
import glob
import os
import secrets
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fuzzytrack.errors import DataError

__all__ = ["PathLike", "check_output", "check_output_folder", "whole_file", "whole_folder"]

PathLike = str | os.PathLike[str]


def check_output(path: PathLike, inputs: tuple[PathLike, ...] = ()) -> Path:
    """Check that a file can be written, before the work is done.

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
    target = _followed(path)
    for source in inputs:
        if target.exists() and os.path.exists(source) and os.path.samefile(source, target):
            raise DataError(f"{path}: is the input; write to another file")
    if target.is_dir():
        raise IsADirectoryError(None, "is a folder, not a file", str(path))
    if target.exists() and not target.is_file():
        raise OSError(None, "is not an ordinary file", str(path))
    _check_parent(path, target)
    return target


def check_output_folder(path: PathLike) -> Path:
    """Check that a folder can be made, before the work is done.

    Parameters
    ----------
    path : str or path
        The folder; it need not exist.

    Returns
    -------
    Path
        The folder, with symbolic links followed.

    Raises
    ------
    DataError
        If it exists and is not empty.
    OSError
        If it cannot be made, or is a file.
    """
    target = _followed(path)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(None, "is not a folder", str(path))
    if target.is_dir() and any(target.iterdir()):
        raise DataError(f"{path}: holds files already; choose another folder")
    _check_parent(path, target)
    return target


def _followed(path: PathLike) -> Path:
    """Absolute path with symbolic links followed."""
    try:
        return Path(path).resolve()
    except RuntimeError:
        # So Python before 3.13 says that links point to one another.
        raise OSError(None, "is a loop of symbolic links; remove it", str(path)) from None


def _check_parent(path: PathLike, target: Path) -> None:
    if not target.parent.is_dir():
        raise FileNotFoundError(None, f"there is no folder {target.parent}", str(path))
    if not os.access(target.parent, os.W_OK):
        raise PermissionError(None, f"folder {target.parent} cannot be written to", str(path))


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
    draft = _draft_of(target, target.stem, target.suffix)
    try:
        with _full_disk_named(path):
            yield draft
        if target.exists():
            shutil.copymode(target, draft)
        os.replace(draft, target)
    finally:
        draft.unlink(missing_ok=True)


# Seconds after the last write to a draft from which on it is taken for one that was left behind.
_STALE = 86_400.0


def _draft_of(target: Path, stem: str, suffix: str = "") -> Path:
    """A new name beside a file or folder; drafts that a killed run has left of it are removed."""
    pattern = f".{glob.escape(stem)}.{'[0-9a-f]' * 8}.part{glob.escape(suffix)}"
    for left in target.parent.glob(pattern):
        with suppress(OSError):
            written = max(os.stat(each).st_mtime for each in (left, *left.rglob("*")))
            if time.time() - written > _STALE:
                shutil.rmtree(left) if left.is_dir() else left.unlink()
    return target.with_name(f".{stem}.{secrets.token_hex(4)}.part{suffix}")


# Of a write where there is no room: on the disk, for the user, in a file of this kind.
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@contextmanager
def _full_disk_named(path: PathLike) -> Iterator[None]:
    """Say of which file it is that there is no room for it: writes to an open file do not."""
    try:
        yield
    except OSError as error:
        if error.errno not in _FULL:
            raise
        reason = f"{os.strerror(error.errno)}; nothing was written"
        raise OSError(error.errno, reason, os.fspath(path)) from error


@contextmanager
def whole_folder(path: PathLike) -> Iterator[Path]:
    """Write a folder whole or not at all.

    Parameters
    ----------
    path : str or path
        The folder; it must not exist, or be empty.

    Yields
    ------
    Path
        A draft beside it, to be filled. When the block ends it takes the place of the folder; if
        the block fails it is removed.

    Raises
    ------
    DataError, OSError
        See `check_output_folder`.
    """
    target = check_output_folder(path)
    draft = _draft_of(target, target.name)
    draft.mkdir()
    try:
        with _full_disk_named(path):
            yield draft
        os.replace(draft, target)
    finally:
        # A task that could not be stopped may still write into it.
        shutil.rmtree(draft, ignore_errors=True)
