"""Recordings larger than memory: tracked piece by piece, with the numbers of one run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.pieces import Piece
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.trackers.lane_tracker import LaneTracker, announce
from fuzzytrack.trackers.result import checked_keep
from fuzzytrack.trackers.state import TrackState

__all__ = ["OpenTracks", "TrackedPiece", "run_iter"]

Places = NDArray[np.int64]

_GAINS = ("alpha", "beta", "gamma")


@dataclass(frozen=True, eq=False)
class TrackedPiece:
    """What a tracker made of a piece.

    Attributes
    ----------
    piece : Piece
        The piece.
    outputs : mapping of str to ndarray, shape (n_rows, n_axes)
        What was kept, row by row as the piece: predicted, filtered, velocity, acceleration,
        innovation, and alpha, beta, gamma; see `fuzzytrack.TrackResult`.
    """

    piece: Piece
    outputs: Mapping[str, Array]


def run_iter(
    tracker: LaneTracker,
    pieces: Iterable[Piece],
    *,
    sigma: float | None = None,
    keep: Sequence[str] | None = None,
) -> Iterator[TrackedPiece]:
    """Run a tracker over many tracks, piece by piece.

    Parameters
    ----------
    tracker : LaneTracker
        The tracker: any of this package.
    pieces : iterable of Piece
        Rows of any tracks, irregularly mixed; the rows of a track, which may go on from piece to
        piece, in order of time. See `fuzzytrack.io.read_pieces`.
    sigma : float, optional
        Standard deviation of the plots (m).
    keep : sequence of str, optional
        Which outputs to keep, of predicted, filtered, velocity, acceleration, innovation and gains;
        all unless given.

    Yields
    ------
    TrackedPiece
        One a piece, in their order; equal to the last bit to each track run by itself, at once.

    Raises
    ------
    DataError
        If a plot is infinite, or the times of a track do not increase; names identity and time.
    ValueError
        If `keep` names what there is not, the number of axes changes, or the tracker needs `sigma`.

    Notes
    -----
    Holds one piece, its outputs, and the state of every track that has been seen: ``8·rows.kept``
    bytes a lane (see `fuzzytrack.lanes.layout.Rows`), and about 250 bytes a track for its identity
    and time.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> from fuzzytrack.io.pieces import Piece
    >>> first = Piece.of(["a", "b", "a"], [0, 0, 1], [[0.0], [5.0], [10.0]])
    >>> second = Piece.of(["a", "a"], [2, 3], [[19.0], [31.0]])
    >>> tracker = AlphaBetaTracker(FixedGains(0.5, 0.2))
    >>> for tracked in run_iter(tracker, [first, second], keep=("predicted",)):
    ...     print(tracked.outputs["predicted"].ravel())
    [nan nan nan]
    [20.  29.3]
    """
    tracks = OpenTracks(tracker, sigma, keep)
    for piece in pieces:
        yield tracks.advance(piece)


class OpenTracks:
    """The states of many tracks, which go on together.

    Parameters
    ----------
    tracker, sigma, keep
        As for `run_iter`.

    Raises
    ------
    ValueError
        If `keep` names what there is not.
    """

    def __init__(
        self,
        tracker: LaneTracker,
        sigma: float | None = None,
        keep: Sequence[str] | None = None,
    ) -> None:
        self.tracker, self.sigma = tracker, sigma
        self._keep = checked_keep(keep)
        self._slot: dict[str, int] = {}
        self._store = _Store()

    def __len__(self) -> int:
        """Tracks that were seen so far."""
        return len(self._slot)

    @property
    def duration(self) -> float:
        """Sum of the durations of all tracks (s)."""
        count = len(self)
        return float((self._store.last[:count] - self._store.first[:count]).sum())

    def advance(self, piece: Piece) -> TrackedPiece:
        """Track one more piece.

        Parameters
        ----------
        piece : Piece

        Raises
        ------
        DataError, ValueError
            As for `run_iter`; the tracks are then of no more use.
        """
        names = [name for kept in self._keep for name in (_GAINS if kept == "gains" else (kept,))]
        outputs = {name: np.empty(piece.plots.shape) for name in names}
        if len(piece.time):
            _check_finite(piece)
            if not self._slot:
                announce(self.tracker, piece.plots.shape[1], piece.plots.size)
            self._advance(piece, outputs)
        return TrackedPiece(piece, outputs)

    def _advance(self, piece: Piece, outputs: Mapping[str, Array]) -> None:
        codes = piece.ids.codes
        order = np.argsort(codes, kind="stable")
        counts = np.bincount(codes)
        starts = np.cumsum(counts) - counts
        present = np.flatnonzero(counts)
        counts, starts = counts[present], starts[present]
        slot, store = self._slot, self._store
        names = piece.ids.names
        slots = np.array([slot.setdefault(names[k], len(slot)) for k in present.tolist()])
        store.make_room(len(slot), piece.plots.shape[1])
        _check_times(piece, order, starts, store.last[slots])
        new = np.isnan(store.first[slots])
        # Only tracks with as many plots can go on together: padding would be remembered.
        kinds = 2 * counts + new
        by_kind = np.argsort(kinds, kind="stable")
        cuts = np.flatnonzero(np.diff(kinds[by_kind])) + 1
        for members in np.split(by_kind, cuts):
            steps = np.arange(counts[members[0]])[:, None]
            places = order[starts[members] + steps]
            whom = slots[members]
            state = None if new[members[0]] else store.gather(whom)
            result = self.tracker.run(
                piece.time[places], piece.plots[places], self.sigma, state=state, keep=self._keep
            )
            for name, values in outputs.items():
                values[places] = getattr(result.gains if name in _GAINS else result, name)
            if state is None:
                store.first[whom] = result.time[0]
            store.scatter(whom, result.state)


# -------------------------------------------------------------------- states


@dataclass(eq=False)
class _Store:
    """States side by side, a row each: what is near in time is fetched together."""

    first: Array = field(default_factory=lambda: np.empty(0))
    last: Array = field(default_factory=lambda: np.empty(0))
    numbers: Array | None = None
    rows: Rows | None = None
    n_axes: int = 0

    def make_room(self, count: int, n_axes: int) -> None:
        """For so many tracks in all."""
        if self.n_axes not in (0, n_axes):
            raise ValueError(f"plots: {n_axes} axes; the pieces before have {self.n_axes}")
        self.n_axes = n_axes
        have = len(self.first)
        if count > have:
            # In place where the system can move pages, and never twice the memory.
            room = count + count // 4
            for times in (self.first, self.last):
                times.resize(room, refcheck=False)
                times[have:] = math.nan
            if self.numbers is not None:
                self.numbers.resize((room, self.numbers.shape[1]), refcheck=False)

    def gather(self, slots: Places) -> TrackState:
        """State of some tracks, as of a batch."""
        assert self.numbers is not None
        assert self.rows is not None
        rows, count = self.rows, len(slots)
        lanes = self.numbers[slots].reshape(count, rows.kept, -1).swapaxes(0, 1)
        shape = (count, self.n_axes)
        return TrackState(self.last[slots], shape, lanes.reshape(rows.kept, -1), rows)

    def scatter(self, slots: Places, state: TrackState | None) -> None:
        """Keep the state of a batch."""
        assert state is not None
        kept, count = state.rows.kept, len(slots)
        lanes = state.lanes.reshape(kept, count, -1).swapaxes(0, 1).reshape(count, -1)
        if self.numbers is None:
            self.numbers = np.zeros((len(self.first), lanes.shape[1]))
            self.rows = state.rows
        self.numbers[slots] = lanes
        self.last[slots] = state.time


# -------------------------------------------------------------------- checks


def _check_finite(piece: Piece) -> None:
    for name, bad, wanted in (
        ("time", ~np.isfinite(piece.time), "a finite number"),
        ("plot", np.isinf(piece.plots).any(axis=1), "finite numbers, or NaN where missed"),
    ):
        if bad.any():
            row = int(np.argmax(bad))
            value = piece.time[row] if name == "time" else piece.plots[row]
            raise DataError(f"{_where(piece, row)}: {name} {value}; expected {wanted}")


def _check_times(piece: Piece, order: Places, starts: Places, last: Array) -> None:
    times = piece.time[order]
    before = np.empty_like(times)
    before[1:] = times[:-1]
    before[starts] = last
    bad = np.flatnonzero(times <= before)
    if len(bad):
        place = bad[np.argmin(order[bad])]
        row = int(order[place])
        what = "repeats" if times[place] == before[place] else "is earlier than"
        raise DataError(
            f"{_where(piece, row)}: time {times[place]:.15g}{_whose(piece, row)} {what} "
            f"{before[place]:.15g}, the time of the plot before; expected increasing times in each "
            "track, from piece to piece and from file to file"
        )


def _where(piece: Piece, row: int) -> str:
    place = f"row {piece.rows[row]}"
    return f"{piece.file}: {place}" if piece.file else place


def _whose(piece: Piece, row: int) -> str:
    id = piece.ids.names[piece.ids.codes[row]]
    return f" (id {id!r})" if id else ""
