"""Errors about rows whose time is not later than that of the row before in their track."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io import cleaning_step
from fuzzytrack.io.piece import Piece, place_of
from fuzzytrack.io.time_cells import same_time

__all__ = ["time_error"]

# A fall of the time by more mean intervals is no local disorder.
_DISORDER = 20.0


def time_error(
    piece: Piece,
    place: int,
    now: float,
    track: Array,
    file: str,
    column: str,
    show: Callable[[float], str],
) -> DataError:
    """Error about a row whose time is not later than that of the row before.

    Parameters
    ----------
    piece : Piece
    place : int
        Where the row is in the piece.
    now : float
        Its time (s), counted on where the clock starts again.
    track : ndarray
        Numbers of its track, see `fuzzytrack.io.cleaning_step`.
    file : str
        File of the row before.
    column : str
        Name of the column of time.
    show : callable
        Text of a time (s).
    """
    id = piece.ids[place]
    whose = f" (id {id!r})" if id else ""
    before = f"row {int(track[cleaning_step.ROW])}"
    if file != piece.file:
        before += f" of {file}"
    time = float(piece.time[place])
    fall = float(track[cleaning_step.TIME]) - now
    if fall == 0:
        what = _repeats(piece, place, before, id)
    else:
        what = (
            f"is earlier than {show(time + fall)} in {before}; expected increasing times"
            f"{_remedies(fall, track, bool(id))}"
        )
    where = f"{place_of(piece, place)}{column and f', column {column}'}"
    return DataError(f"{where}: time {show(time)}{whose} {what}")


def _remedies(fall: float, track: Array, identified: bool) -> str:
    intervals = track[cleaning_step.INTERVALS]
    # As Python's number, which is infinite without a warning.
    mean = float(track[cleaning_step.SUM] / intervals) if intervals else 0.0
    remedies = "; `sort` puts them in order"
    if not identified:
        remedies += ", and `id` names the column that distinguishes tracks"
    if fall > _DISORDER * mean:
        remedies += f"; if its clock starts again (it falls by {fall:.15g} s), `wrap` is its period"
    return remedies


def _repeats(piece: Piece, place: int, before: str, id: str) -> str:
    """What is wrong with a time that equals the one before, and what to do."""
    cells, codes = piece.time_cells, piece.ids.codes
    earlier = np.flatnonzero(codes[:place] == codes[place])
    if cells is not None and len(earlier):
        one, other = str(cells[earlier[-1]]).strip(), str(cells[place]).strip()
        if not same_time(one, other):
            return (
                f"in the cell {other} and {one} in {before} are too close to tell apart in double "
                "precision; expected times further apart"
            )
    # Several tracks in one file look like this when their identities are not read, or not known.
    mend = ""
    if not id:
        mend = "; if these are several tracks, name the column of their id (`id`)"
    elif id == "-1":
        mend = "; if the id -1 says that there is none, find out first which plot is of which track"
    return (
        f"repeats that of {before}; expected times that differ, or `duplicates` to say which plot "
        f"counts{mend}"
    )
