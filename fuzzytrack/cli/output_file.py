"""Where a command writes tracks: a file, or standard output."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, redirect_stdout
from tempfile import TemporaryDirectory
from typing import Any

import typer

__all__ = ["STANDARD_OUTPUT", "output_file", "told_aside"]

#: What stands for standard output in place of a file.
STANDARD_OUTPUT = "-"


@contextmanager
def output_file(output: str | None) -> Iterator[str | None]:
    """File for the tracks; what is meant for standard output is printed when it is whole."""
    if output != STANDARD_OUTPUT:
        yield output
        return
    with TemporaryDirectory() as folder:
        place = os.path.join(folder, "tracks.csv")
        yield place
        with open(place, "rb") as file:
            stream = typer.get_binary_stream("stdout")
            shutil.copyfileobj(file, stream)
            stream.flush()


def told_aside(output: str | None) -> AbstractContextManager[Any]:
    """Print on standard error as long as standard output takes the tracks."""
    return redirect_stdout(sys.stderr) if output == STANDARD_OUTPUT else nullcontext()
