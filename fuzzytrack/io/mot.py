"""Boxes of the MOT challenge (det.txt, gt.txt): rows of numbers without names of columns."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import open_bytes
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.record_source import Losses, RecordSource, Row
from fuzzytrack.plurals import counted

__all__ = ["Mot"]

_FILES = ("det.txt", "gt.txt")
_CELLS = ("frame", "id", "left", "top", "width", "height", "confidence")
# What follows differs between the files of the challenge, and is in none of them a position in the
# picture.
_MORE = ("cell_8", "cell_9", "cell_10")


@dataclass
class Mot(Reader):
    """Reads boxes in the frames of a film; the position is the center of a box (pixels).

    Parameters
    ----------
    rate : float
        Frames a second; with the default 1 times are numbers of frames.
    """

    rate: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.rate < math.inf:
            raise ValueError(f"rate: must be positive, got {self.rate}")

    def reads(self, file: str) -> bool:
        """Whether a file has the name of one of the challenge, and begins with a row of numbers."""
        if os.path.basename(file).lower() not in _FILES:
            return False
        try:
            with open(file, "rb") as stream:
                return _numbers(stream.readline(4096)) is not None
        except OSError:
            return False

    @contextmanager
    def open_source(self, file: str) -> Iterator[RecordSource]:
        """Open a file.

        Raises
        ------
        DataError
            If a row is none of 7 to 10 numbers, also later, while it is read; names the row.
        OSError
            If it cannot be read.
        """
        with open_bytes(file) as stream:
            # Not by iterating, which would hide how much has been read.
            lines = enumerate(iter(io.BufferedReader(stream).readline, b""), 1)
            number, first = _first_row(lines, stream.file)
            width, identified = len(first), first[1] != -1.0
            numbers = (*_CELLS, *_MORE)[:width]
            types = dict.fromkeys((*numbers, "time", "x", "y"), "number") | {"id": "text"}
            # Where it is -1 too: errors about equal times then say so.
            description = PlotDescription(time="time", id="id", axes=("x", "y"), wrap=None)
            remarks = ["the position is the center of the box (pixels)"]
            if self.rate == 1.0:
                remarks.append("times are numbers of frames")
            if not identified:
                remarks.append("id is -1: no identities; all boxes are taken as one track")
            rows = chain(
                [_row(number, first, self.rate)], _rows(lines, stream.file, width, self.rate)
            )
            yield RecordSource(stream, types, description, rows, Losses(), remarks)


def _first_row(lines: Iterator[tuple[int, bytes]], file: str) -> tuple[int, list[float]]:
    """Number of the first row that is not blank, and its cells."""
    for number, line in lines:
        if line.strip():
            cells = _numbers(line)
            if cells is None:
                break
            return number, cells
    raise DataError(f"{file}: row 1: expected 7 to 10 numbers separated by commas")


def _numbers(line: bytes) -> list[float] | None:
    """Numbers of a row; None if these are not 7 to 10 finite numbers."""
    cells = line.split(b",")
    if not len(_CELLS) <= len(cells) <= len(_CELLS) + len(_MORE) or b"_" in line:
        return None
    try:
        found = list(map(float, cells))
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


def _rows(lines: Iterator[tuple[int, bytes]], file: str, width: int, rate: float) -> Iterator[Row]:
    for number, line in lines:
        if not line.strip():
            continue
        cells = _numbers(line)
        if cells is None or len(cells) != width:
            raise DataError(
                f"{file}: row {number}: expected {counted(width, 'number')} separated by commas, "
                "as in the first row"
            )
        yield _row(number, cells, rate)


def _row(number: int, cells: list[float], rate: float) -> Row:
    frame, identity, left, top, wide, high, *_ = cells
    center = (left + wide / 2.0, top + high / 2.0)
    return number, (frame, f"{identity:.15g}", *cells[2:], frame / rate, *center)
