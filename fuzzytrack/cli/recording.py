"""Recordings as the options of several commands name them."""

from __future__ import annotations

from fuzzytrack.cli import options
from fuzzytrack.cli.output import progress
from fuzzytrack.io.recording import Recording, read_tracks

__all__ = ["axes_named", "read_recording"]


def axes_named(text: str | None) -> list[str] | None:
    """Columns of position as written after ``--axes``."""
    return None if text is None else options.names(text, "--axes")


def read_recording(
    file: str, time: str | None, id: str | None, axes: str | None, sort: bool
) -> Recording:
    """Read a recording, with a progress bar."""
    with progress("reading") as watch:
        return read_tracks(file, time=time, id=id, axes=axes_named(axes), sort=sort, progress=watch)
