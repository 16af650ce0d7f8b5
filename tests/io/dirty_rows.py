"""Rows of recordings with faults, cleaned, and what comes out."""

import math

import numpy as np

from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.cleaning_rules import Cleaning
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.table import Words

NAN = math.nan


def piece(time, plots=None, ids=None, *, cells=None, file="a.csv", first=2):
    """Rows; the first one stands in line `first` of the file."""
    time = np.asarray(time, dtype=float)
    values = np.arange(len(time)) * 10.0 if plots is None else np.asarray(plots, dtype=float)
    values = values[:, None] if values.ndim == 1 else values
    words = [""] * len(time) if ids is None else list(ids)
    names = tuple(dict.fromkeys(words))
    codes = np.array([names.index(word) for word in words], dtype=np.int64)
    rows = np.arange(first, first + len(time))
    return Piece(Words(names, codes), time, values, rows, file, None, cells)


def cleaned(rows, period=None, **rules):
    """All rows as one piece, and the counts."""
    cleaner = Cleaner(Cleaning(**rules), period)
    out = [cleaner.advance(rows), cleaner.finish()]
    return joined([part for part in out if part is not None]), cleaner.counts


def joined(parts):
    """Rows by track and line: id, time, plot and segment of each."""
    rows = [
        (part.ids[k], int(part.rows[k]), float(part.time[k]), tuple(part.plots[k].tolist()),
         int(part.segments[k]))
        for part in parts
        for k in range(len(part))
    ]  # fmt: skip
    return sorted(rows, key=lambda row: row[:2])


def lines(rows):
    return [row[1] for row in rows]


def times(rows):
    return [row[2] for row in rows]


def plots(rows):
    return [row[3][0] for row in rows]


def segments(rows):
    return [row[4] for row in rows]


def same(one, other):
    """Equal to the last bit, NaN being equal to itself."""
    return repr(one) == repr(other)
