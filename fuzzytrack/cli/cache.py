"""The command that shows and clears the folder of compiled code."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, say
from fuzzytrack.kernels.cache import MOST_BYTES, MOST_FILES, KernelFolder
from fuzzytrack.plurals import counted

__all__ = ["cache"]


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove the compiled code.")] = False,
    json: options.Json = False,
) -> None:
    """Show where compiled code is kept and how much of it, or remove it.

    A tracker is compiled for its first large job, and its code is kept for later processes.
    FUZZYTRACK_CACHE_DIR names another folder; empty or off, nothing is kept.
    """
    folder = KernelFolder.of_user()
    removed = folder.clear() if clear else None
    problem = folder.problem()
    files = folder.files()
    size = sum(status.st_size for _, status in files)
    if json:
        found = {
            "folder": folder.path,
            "usable": problem is None,
            "problem": problem,
            "files": len(files),
            "bytes": size,
            "most_files": MOST_FILES,
            "most_bytes": MOST_BYTES,
        }
        if removed is not None:
            found |= {"removed_files": removed[0], "removed_bytes": removed[1]}
        print_json(found)
        return
    if removed is not None:
        say(f"removed: {_amount(*removed)}")
    say(f"folder:  {folder.path or 'none'}")
    say(f"kept:    {_amount(len(files), size)}, of {_amount(MOST_FILES, MOST_BYTES)} at most")
    say(f"usable:  {'yes' if problem is None else f'no, {problem}'}")


def _amount(files: int, size: int) -> str:
    return f"{counted(files, 'file')}, {size / 1e6:.3g} MB"
