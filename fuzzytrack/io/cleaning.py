"""Faults of real recordings: what is dropped, merged or divided, by rules that are counted.

Copies of rows, equal times, clocks that start again, positions that are repeated or beyond any use,
starts without a baseline, long times without a plot. The rules look back only, track by track, so
that pieces of any size and streams decide alike.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io import cleaning_step
from fuzzytrack.io.cleaning_rules import Cleaning, CleaningCounts
from fuzzytrack.io.cleaning_step import OWN, clean_rows
from fuzzytrack.io.equal_times import EqualTimes
from fuzzytrack.io.file_order import recognized_period, turned, turns_in_file
from fuzzytrack.io.piece import Piece, check_finite
from fuzzytrack.io.time_errors import time_error
from fuzzytrack.reprs import summary

__all__ = ["Cleaner", "JudgedRows"]

# Without a limit of the user's, a track ends after so many times the mean of its intervals so far,
# of which there must be some. 2.4 million simulated tracks of 120 plots, with intervals that are
# regular, with jitter, 1:10, in near-duplicate pairs, in bursts of 5 with gaps of 20 or 100, or
# log-uniform over 1:100, were not divided, at detection probabilities from 1 down to 0.3.
_GAP_FACTOR, _GAP_INTERVALS = 100.0, 8
# Compiling, or reading compiled code, takes longer than fewer rows in plain Python.
_COMPILE_ABOVE = 100_000
_PLAIN_BELOW = 2_000


@dataclass(frozen=True, eq=False)
class JudgedRows:
    """Rows of a piece, and what is to happen to them.

    Attributes
    ----------
    judged : Piece
        All rows, with the segments of those that are kept.
    raw : Piece
        The same rows as they came, but for their times, which are counted on where the clock
        starts again at 0.
    kept : ndarray of bool, shape (n_rows,)
        Which rows are neither dropped nor wait.
    """

    judged: Piece
    raw: Piece
    kept: NDArray[np.bool_]

    def __repr__(self) -> str:
        return summary(self, "judged", kept=int(self.kept.sum()))

    @property
    def cleaned(self) -> Piece:
        """Rows that are kept."""
        return self.judged if self.kept.all() else self.judged.take(self.kept)

    @property
    def seen(self) -> Piece:
        """Rows that belong to their tracks now, also if they are dropped; copies do not."""
        assert self.judged.segments is not None
        there = self.judged.segments >= 0
        return self.raw if there.all() else self.raw.take(there)

    @property
    def waiting(self) -> Piece:
        """Rows of tracks that have stopped, from the one on that is out of order.

        The time of that one is counted on where the clock starts again at 0; the others have their
        times as they came.
        """
        assert self.judged.segments is not None
        return self.raw.take(self.judged.segments == cleaning_step.WAITS)


class Cleaner:
    """Applies the rules to a recording, piece by piece.

    Parameters
    ----------
    cleaning : Cleaning
        The rules.
    period : float, optional
        Period of the clock (s), where the form of the times tells it; see `Clock.period`.
    turn : float, optional
        Full circle of positions that are bare angles.
    column : str
        Name of the column of time, for messages.
    show : callable, optional
        Text of a time (s), for messages; see `Clock.as_cell`.

    Notes
    -----
    Holds about 350 bytes for each track so far.
    """

    def __init__(
        self,
        cleaning: Cleaning,
        period: float | None = None,
        *,
        turn: float | None = None,
        column: str = "",
        show: Callable[[float], str] | None = None,
    ) -> None:
        self.cleaning = cleaning
        self._column, self._show = column, show or "{:.15g}".format
        self._equal = None
        if cleaning.duplicates != "error":
            self._equal = EqualTimes(cleaning.duplicates, turn)
        self._rules = _rules(cleaning)
        known = period if cleaning.wrap == "auto" else cleaning.wrap
        self._clock = np.array([float(known or 0), math.nan])
        self._fills = self._sorted_wraps = 0
        self._period = 0.0
        self._slot: dict[str, int] = {}
        self._state = _new_tracks(0, OWN)
        # Places of tracks that were forgotten, and what was counted in them.
        self._free: list[int] = []
        self.past = np.zeros(cleaning_step.STOPPED - cleaning_step.COPIES)
        self._files: list[str] = []
        self._file = 0
        self._rows = 0

    @property
    def counts(self) -> CleaningCounts:
        """What the rules have changed so far."""
        totals = self._state[:, cleaning_step.COPIES : cleaning_step.STOPPED].sum(axis=0)
        copies, stale, delayed, segments, coasted, wraps = map(int, self.past + totals)
        period = float(self._clock[cleaning_step.PERIOD]) or self._period or None
        equal = self._equal
        return CleaningCounts(
            copies=copies + (equal.copies if equal else 0),
            merged=equal.merged if equal else 0,
            fills=self._fills,
            stale=stale,
            delayed=delayed,
            segments=segments,
            coasted=coasted,
            wraps=wraps + self._sorted_wraps,
            period=period,
        )

    def advance(self, piece: Piece) -> Piece:
        """Clean one more piece.

        Parameters
        ----------
        piece : Piece

        Returns
        -------
        Piece
            Without the rows that are dropped, with segments. Where equal times are merged, the last
            rows of each track come with a later piece, or from `finish`.

        Raises
        ------
        DataError
            If a time or a position is infinite, or the times of a track do not increase; names row,
            time and remedies. Make a new cleaner then.
        ValueError
            If the number of axes changes.
        """
        check_finite(piece)
        piece = self._without_fills(piece)
        return self._cleaned(piece if self._equal is None else self._equal.advance(piece))

    def advance_live(self, piece: Piece) -> JudgedRows:
        """Clean rows as they come, where those of a track may be out of order.

        A track stops at such a row. What is done about that row is up to the caller, who gives the
        others that wait once more. Equal times are not merged.

        Parameters
        ----------
        piece : Piece

        Raises
        ------
        DataError
            If a time or a position is infinite.
        ValueError
            If the number of axes changes.
        """
        check_finite(piece)
        piece = self._without_fills(piece)
        return self._judged(piece)[0]

    def replay(self, piece: Piece) -> JudgedRows:
        """Clean rows of tracks that were put back, whose clock has been turned already.

        Parameters
        ----------
        piece : Piece
            Rows of these tracks in order of time, as `JudgedRows.seen` gave them.
        """
        clock, recognizes = self._clock.copy(), self._rules[cleaning_step.RECOGNIZE]
        self._clock[:], self._rules[cleaning_step.RECOGNIZE] = (0.0, math.nan), 0.0
        places = [self._slot[name] for name in piece.ids.names]
        turns = self._state[places, cleaning_step.TURNS]
        self._state[places, cleaning_step.TURNS] = 0.0
        found = self._judged(piece)[0]
        self._state[places, cleaning_step.TURNS] = turns
        self._clock[:], self._rules[cleaning_step.RECOGNIZE] = clock, recognizes
        return found

    # ---------------------------------------------------------------- tracks as numbers

    def __len__(self) -> int:
        """Number of tracks that are known."""
        return len(self._slot)

    @property
    def ids(self) -> tuple[str, ...]:
        """Their identities."""
        return tuple(self._slot)

    @property
    def clock(self) -> tuple[float, float, int]:
        """Period of the clock (s), time of the last row (s), and rows with values beyond use."""
        period, now = self._clock.tolist()
        return period, now, self._fills

    @clock.setter
    def clock(self, value: tuple[float, float, int]) -> None:
        *clock, self._fills = value
        self._clock[:] = clock

    def width(self, n_axes: int) -> int:
        """Numbers of a track."""
        return OWN + 2 * n_axes

    def numbers(self, ids: Sequence[str], n_axes: int) -> Array:
        """All that is known of tracks, shape (n_tracks, `width`); unknown ones are begun."""
        self._make_room(n_axes)
        places = [self._place(id) for id in ids]
        self._make_room(n_axes)
        found: Array = self._state[places]
        return found

    def put(self, ids: Sequence[str], numbers: Array, *, turned: bool = False) -> None:
        """Set tracks back to what `numbers` gave of them.

        Parameters
        ----------
        ids : sequence of str
            The tracks; new ones are made.
        numbers : ndarray, shape (n_tracks, width)
        turned : bool
            Whether to leave alone how often the clock of each has started again.
        """
        now = self.numbers(ids, (numbers.shape[1] - OWN) // 2)
        places = [self._slot[id] for id in ids]
        self._state[places] = numbers
        if turned:
            for column in (cleaning_step.TURNS, cleaning_step.WRAPS):
                self._state[places, column] = now[:, column]

    def forget(self, ids: Sequence[str]) -> None:
        """Forget tracks, but for what has been counted in them."""
        for id in ids:
            place = self._slot.pop(id)
            track = self._state[place]
            self.past += track[cleaning_step.COPIES : cleaning_step.STOPPED]
            self._state[place] = _new_tracks(1, len(track))
            self._free.append(place)

    def _place(self, name: str) -> int:
        place = self._slot.get(name)
        if place is None:
            place = self._slot[name] = self._free.pop() if self._free else len(self._slot)
        return place

    def in_order(self, piece: Piece) -> Piece:
        """Put a recording in order of time, track by track, before it is cleaned as one piece.

        A clock that starts again is recognized in the order of the file, which is nearly that of
        time: midnight is not what is out of order.

        Parameters
        ----------
        piece : Piece
            The whole recording.
        """
        codes, time = piece.ids.codes, piece.time
        period = float(self._clock[cleaning_step.PERIOD])
        if period == 0 and self.cleaning.wrap == "auto":
            period = recognized_period(piece)
        if period > 0 and len(piece):
            turns = turns_in_file(time, period)
            time = time + turns * period
            self._period, self._sorted_wraps = period, turned(codes, turns)
        # The cleaner must not turn the clock once more.
        self._clock[cleaning_step.PERIOD] = self._rules[cleaning_step.RECOGNIZE] = 0.0
        # Stable: the order of the file within a track.
        return replace(piece, time=time).take(np.lexsort((time, codes)))

    def finish(self) -> Piece | None:
        """Take the rows that were held back at the end of the recording, if there are any."""
        held = None if self._equal is None else self._equal.finish()
        return None if held is None or not len(held) else self._cleaned(held)

    def _without_fills(self, piece: Piece) -> Piece:
        with np.errstate(invalid="ignore"):
            filled = np.abs(piece.plots) > self.cleaning.fill_limit
        if not filled.any():
            return piece
        self._fills += int(filled.any(axis=1).sum())
        return replace(piece, plots=np.where(filled, math.nan, piece.plots))

    def _cleaned(self, piece: Piece) -> Piece:
        if not len(piece):
            return replace(piece, segments=np.zeros(0, dtype=np.int64))
        found, wrong, now = self._judged(piece)
        if wrong >= 0:
            track = self._state[self._slot[piece.ids[wrong]]]
            file = self._files[int(track[cleaning_step.FILE])]
            raise time_error(piece, wrong, now, track, file, self._column, self._show)
        return found.cleaned

    def _judged(self, piece: Piece) -> tuple[JudgedRows, int, float]:
        """Rows with what is to happen to them; the first at which a track stops, and its time."""
        if piece.file not in self._files:
            self._files.append(piece.file)
        self._file = self._files.index(piece.file)
        slots = self._slots(piece)
        # Copies in the order of C, which are written to.
        time, plots = (np.array(a, dtype=np.float64, order="C") for a in (piece.time, piece.plots))
        kept, segments = np.ones(len(piece), dtype=bool), np.zeros(len(piece), dtype=np.int64)
        self._rows += len(piece)
        large = self._rows > _COMPILE_ABOVE and len(piece) > _PLAIN_BELOW
        run = self._compiled if large else self._plain
        wrong = run(slots, time, piece.rows, plots, kept, segments)
        # Those that are put back, or told of, go on from here.
        self._state[slots[segments == cleaning_step.WAITS], cleaning_step.STOPPED] = 0.0
        cleaned = replace(piece, time=time, plots=plots, segments=segments)
        found = JudgedRows(cleaned, replace(piece, time=time), kept)
        return found, wrong, float(time[wrong])

    def _slots(self, piece: Piece) -> NDArray[np.int64]:
        """Places of the tracks of the rows; room for the new ones."""
        n_axes, names, codes = piece.plots.shape[1], piece.ids.names, piece.ids.codes
        self._make_room(n_axes)
        present = np.flatnonzero(np.bincount(codes, minlength=len(names)))
        places = np.zeros(len(names), dtype=np.int64)
        places[present] = [self._place(names[k]) for k in present.tolist()]
        self._make_room(n_axes)
        return places[codes]

    def _make_room(self, n_axes: int) -> None:
        """Make room for the tracks that there are."""
        width = self.width(n_axes)
        if not self._slot:
            self._state, self._free = _new_tracks(0, width), []
        elif self._state.shape[1] != width:
            before = (self._state.shape[1] - OWN) // 2
            raise ValueError(f"plots: {n_axes} axes; the pieces before have {before}")
        missing = len(self._slot) + len(self._free) - len(self._state)
        if missing > 0:
            more = max(missing, len(self._state))
            self._state = np.concatenate([self._state, _new_tracks(more, width)])

    # ---------------------------------------------------------------- the rows

    def _plain(
        self,
        slots: NDArray[np.int64],
        time: Array,
        rows: NDArray[np.int64],
        plots: Array,
        kept: NDArray[np.bool_],
        segments: NDArray[np.int64],
    ) -> int:
        """Run over lists, which plain Python reads faster than arrays."""
        # Only the tracks of these rows: there may be many others.
        present, own = np.unique(slots, return_inverse=True)
        lists = [values.ravel().tolist() for values in (time, plots, kept, segments)]
        tracks, clock = self._state[present].ravel().tolist(), self._clock.tolist()
        wrong = clean_rows(
            own.tolist(), lists[0], rows.tolist(), lists[1], plots.shape[1], self._file,
            self._rules.tolist(), clock, tracks, lists[2], lists[3],
        )  # fmt: skip
        for values, found in zip((time, plots, kept, segments), lists, strict=True):
            values.ravel()[:] = found
        self._state[present] = np.reshape(tracks, (len(present), -1))
        self._clock[:] = clock
        return wrong

    def _compiled(
        self,
        slots: NDArray[np.int64],
        time: Array,
        rows: NDArray[np.int64],
        plots: Array,
        kept: NDArray[np.bool_],
        segments: NDArray[np.int64],
    ) -> int:
        return _compiled_rows()(
            slots, time, np.ascontiguousarray(rows, dtype=np.int64), plots.ravel(), plots.shape[1],
            self._file, self._rules, self._clock, self._state.ravel(), kept, segments,
        )  # fmt: skip


@cache
def _compiled_rows() -> Callable[..., int]:
    from fuzzytrack.kernels.compile import compiled

    return compiled(clean_rows, nogil=True)


def _rules(cleaning: Cleaning) -> Array:
    def limit(value: Any, otherwise: float) -> float:
        return otherwise if value is None else float(value)

    gap = -1.0 if cleaning.max_gap == "auto" else limit(cleaning.max_gap, math.inf)
    return np.array([
        limit(cleaning.stale, -1.0),
        limit(cleaning.least_step, 0.0),
        gap,
        limit(cleaning.max_coast, math.inf),
        float(cleaning.wrap == "auto"),
        _GAP_FACTOR,
        _GAP_INTERVALS,
    ])  # fmt: skip


def _new_tracks(count: int, width: int) -> Array:
    state = np.zeros((count, width))
    state[:, cleaning_step.PLOT] = math.nan
    state[:, OWN:] = math.nan
    return state
