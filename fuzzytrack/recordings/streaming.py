"""Recordings larger than memory: tracked piece by piece, with the same results as in one run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.io.piece import Piece, check_finite, place_of
from fuzzytrack.lanes.layout import GAINS
from fuzzytrack.recordings.judge import Judge, JudgeMemory
from fuzzytrack.recordings.judged import run_judged
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.result import checked_keep
from fuzzytrack.trackers.state import TrackState
from fuzzytrack.trackers.track_store import Slots, TrackStore

__all__ = ["OpenTracks", "TrackedPiece", "run_iter"]


@dataclass(frozen=True, eq=False)
class TrackedPiece:
    """A piece with the outputs of a tracker.

    Attributes
    ----------
    piece : Piece
        The piece.
    outputs : mapping of str to ndarray, shape (n_rows, n_axes)
        The outputs in `keep`, for each row of the piece: predicted, filtered, velocity,
        acceleration, innovation, and alpha, beta, gamma; see `fuzzytrack.TrackResult`.
    rejected, begins : ndarray of bool, shape (n_rows,), optional
        Plots that were judged, and not used, or started their track again; without a judge there
        are none.
    """

    piece: Piece
    outputs: Mapping[str, Array]
    rejected: Mask | None = None
    begins: Mask | None = None

    def __repr__(self) -> str:
        return summary(self, "piece", "outputs")


def run_iter(
    tracker: LaneTracker | str,
    pieces: Iterable[Piece],
    *,
    sigma: ArrayLike | None = None,
    keep: Sequence[str] | None = None,
    judge: Judge | None = None,
) -> Iterator[TrackedPiece]:
    """Run a tracker over many tracks, piece by piece.

    Parameters
    ----------
    tracker : LaneTracker or str
        The tracker: any of this package, or what names it, see
        `fuzzytrack.trackers.catalog.make_tracker`.
    pieces : iterable of Piece
        Rows of any tracks in any order, but the rows of each track in order of time. A track may
        continue from piece to piece. See `fuzzytrack.io.read_pieces`.
    sigma : float or sequence of float, optional
        Standard deviation of the plots (m), for pieces that have none of their own; one, or one
        for each axis.
    keep : sequence of str, optional
        Which outputs to keep, of predicted, filtered, velocity, acceleration, innovation and gains;
        all unless given.
    judge : Judge, optional
        What happens to plots before they are used; see `fuzzytrack.recordings.judged.run_judged`.
        Positions on a circle are given within one turn.

    Yields
    ------
    TrackedPiece
        One for each piece, in their order; every row is equal, to the last bit, to the same row of
        its track run as a whole.

    Raises
    ------
    DataError
        If a plot is infinite, or the times of a track do not increase; names identity and time.
    ValueError
        If `keep` names an unknown output, the number of axes changes, or the tracker needs `sigma`.

    Notes
    -----
    Holds one piece, its outputs, and the state of every track so far: ``8·rows.kept``
    bytes a lane (see `fuzzytrack.lanes.layout.Rows`), and about 250 bytes a track for its identity
    and time.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> from fuzzytrack.io.piece import Piece, check_finite, place_of
    >>> first = Piece.of(["a", "b", "a"], [0, 0, 1], [[0.0], [5.0], [10.0]])
    >>> second = Piece.of(["a", "a"], [2, 3], [[19.0], [31.0]])
    >>> tracker = AlphaBetaTracker(FixedGains(0.5, 0.2))
    >>> for tracked in run_iter(tracker, [first, second], keep=("predicted",)):
    ...     print(tracked.outputs["predicted"].ravel())
    [nan nan nan]
    [20.  29.3]
    """
    tracks = OpenTracks(tracker, sigma, keep, judge)
    for piece in pieces:
        yield tracks.advance(piece)


class OpenTracks:
    """The states of many tracks that continue from piece to piece.

    Parameters
    ----------
    tracker, sigma, keep, judge
        As for `run_iter`.

    Raises
    ------
    ValueError
        If `keep` names an unknown output, or the tracker cannot continue from piece to piece.
    """

    def __init__(
        self,
        tracker: LaneTracker | str,
        sigma: ArrayLike | None = None,
        keep: Sequence[str] | None = None,
        judge: Judge | None = None,
    ) -> None:
        self.tracker, self.sigma, self.judge = as_lane_tracker(tracker), sigma, judge
        self._keep = checked_keep(keep)
        self._slot: dict[str, int] = {}
        self._store: TrackStore | None = None
        # Beside the store, for each slot: first time, and memory of the judge.
        self._first = np.empty(0)
        self._memory = np.empty((0, 0, 0))

    def __len__(self) -> int:
        """Number of tracks so far."""
        return len(self._slot)

    @property
    def duration(self) -> float:
        """Sum of the durations of all tracks (s)."""
        if self._store is None:
            return 0.0
        slots = self._store.slots
        return float((self._store.time(slots) - self._first[slots]).sum())

    def advance(self, piece: Piece) -> TrackedPiece:
        """Track one more piece.

        Parameters
        ----------
        piece : Piece

        Raises
        ------
        DataError, ValueError
            As for `run_iter`. Make new tracks then: some may have been advanced, others not.
        """
        names = [name for kept in self._keep for name in (GAINS if kept == "gains" else (kept,))]
        outputs: dict[str, Array] = {name: np.empty(piece.plots.shape) for name in names}
        marks = (None, None) if self.judge is None else np.zeros((2, len(piece.time)), np.bool_)
        tracked = TrackedPiece(piece, outputs, *marks)
        if len(piece.time):
            check_finite(piece)
            self._advance(tracked, self._store_for(piece))
        if self.judge is not None and self.judge.circle is not None:
            for name in {"predicted", "filtered"} & outputs.keys():
                outputs[name] = self.judge.circle.wrapped(outputs[name])
        return tracked

    # ---------------------------------------------------------------- tracks as numbers

    def width(self, n_axes: int) -> int:
        """How many numbers `numbers` gives of a track of so many axes."""
        # An empty store is false.
        store = TrackStore(self.tracker, n_axes) if self._store is None else self._store
        memory = 0 if self.judge is None else JudgeMemory.fresh(1, n_axes).numbers.size
        return 1 + store.width + memory

    def numbers(self, names: Sequence[str], n_axes: int) -> Array:
        """All that is known of tracks, as plain numbers.

        Parameters
        ----------
        names : sequence of str
            The tracks, each once: identities with segments, as `Piece.tracks` names them.
        n_axes : int
            Axes of the plots.

        Returns
        -------
        ndarray, shape (n_tracks, width)
            A row of NaN for a track that does not exist.
        """
        found = np.full((len(names), self.width(n_axes)), math.nan)
        there = np.array([name in self._slot for name in names], dtype=np.bool_)
        if there.any():
            assert self._store is not None
            slots = np.array([self._slot[name] for name in names if name in self._slot])
            known = [self._first[slots], self._store.numbers(slots)]
            if self.judge is not None:
                known.append(self._memory[slots].reshape(len(slots), -1))
            found[there] = np.column_stack(known)
        return found

    def put(self, names: Sequence[str], numbers: Array, n_axes: int) -> None:
        """Set tracks back to what `numbers` gave of them; they end, or begin, if need be.

        Parameters
        ----------
        names : sequence of str
            The tracks, each once.
        numbers : ndarray, shape (n_tracks, width)
        n_axes : int
            Axes of the plots.
        """
        there = ~np.isnan(numbers[:, 0])
        self.end([name for name, now in zip(names, there, strict=True) if not now])
        if not there.any():
            return
        store = self._store_of(n_axes, 0)
        numbers = numbers[there]
        names = [name for name, now in zip(names, there, strict=True) if now]
        end = 1 + store.width
        state = store.restored(numbers[:, 1:end])
        self.end([name for name in names if name in self._slot])
        slots = store.add(state)
        self._slot.update(zip(names, slots.tolist(), strict=True))
        self._make_room(store)
        self._first[slots] = numbers[:, 0]
        if self.judge is not None:
            self._memory[slots] = numbers[:, end:].reshape(len(slots), n_axes, -1)

    def end(self, names: Sequence[str]) -> None:
        """End tracks; names of no track are passed over."""
        slots = [self._slot.pop(name) for name in names if name in self._slot]
        if slots:
            assert self._store is not None
            self._store.drop(slots)

    def _store_for(self, piece: Piece) -> TrackStore:
        return self._store_of(piece.plots.shape[1], piece.plots.size)

    def _store_of(self, n_axes: int, coordinates: int) -> TrackStore:
        if self._store is None:
            announce(self.tracker, n_axes, coordinates)
            self._store = TrackStore(self.tracker, n_axes)
        if self._store.n_axes != n_axes:
            raise ValueError(f"plots: {n_axes} axes; the pieces before have {self._store.n_axes}")
        return self._store

    def _advance(self, tracked: TrackedPiece, store: TrackStore) -> None:
        piece = tracked.piece
        tracks = piece.tracks
        codes = tracks.codes
        order = np.argsort(codes, kind="stable")
        counts = np.bincount(codes)
        starts = np.cumsum(counts) - counts
        present = np.flatnonzero(counts)
        counts, starts = counts[present], starts[present]
        names = [tracks.names[k] for k in present.tolist()]
        slots = np.array([self._slot.get(name, -1) for name in names])
        new = slots < 0
        last = np.full(len(slots), math.nan)
        last[~new] = store.time(slots[~new])
        _check_times(piece, order, starts, last)
        # Only tracks with equally many plots run together: padding would change their states.
        kinds = 2 * counts + new
        by_kind = np.argsort(kinds, kind="stable")
        cuts = np.flatnonzero(np.diff(kinds[by_kind])) + 1
        for members in np.split(by_kind, cuts):
            steps = np.arange(counts[members[0]])[:, None]
            places = order[starts[members] + steps]
            before = None if new[members[0]] else slots[members]
            state, memory = self._run(tracked, places, before, store)
            if before is None:
                before = store.add(state)
                self._slot.update(zip([names[k] for k in members], before.tolist(), strict=True))
                self._make_room(store)
                self._first[before] = piece.time[places[0]]
            else:
                store.scatter(before, state)
            if memory is not None:
                self._memory[before] = memory

    def _run(
        self, tracked: TrackedPiece, places: Slots, slots: Slots | None, store: TrackStore
    ) -> tuple[TrackState, Array | None]:
        """Run tracks over some rows, from the states in their slots; states and memories after."""
        piece, memory = tracked.piece, None
        t, z = piece.time[places], piece.plots[places]
        sigma = self.sigma if piece.sigma is None else piece.sigma[places]
        state = None if slots is None else store.gather(slots)
        if self.judge is None:
            result = self.tracker.run(t, z, sigma, state=state, keep=self._keep)
        else:
            before = None if slots is None else JudgeMemory(self._memory[slots])
            found = run_judged(
                self.tracker, t, z, sigma, self.judge, state=state, memory=before, keep=self._keep
            )
            result, memory = found.result, found.memory.numbers
            assert tracked.rejected is not None
            assert tracked.begins is not None
            tracked.rejected[places], tracked.begins[places] = found.rejected, found.begins
        for name, values in tracked.outputs.items():
            values[places] = getattr(result.gains if name in GAINS else result, name)
        assert result.state is not None
        return result.state, memory

    def _make_room(self, store: TrackStore) -> None:
        """Make room beside the store, as much as it has."""
        self._first.resize(store.room, refcheck=False)
        if self.judge is not None and len(self._memory) < store.room:
            grown = JudgeMemory.fresh(store.room, store.n_axes).numbers
            grown[: len(self._memory)] = self._memory.reshape(-1, *grown.shape[1:])
            self._memory = grown


# -------------------------------------------------------------------- checks


def _check_times(piece: Piece, order: Slots, starts: Slots, last: Array) -> None:
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
            f"{place_of(piece, row)}: time {times[place]:.15g}{_whose(piece, row)} {what} "
            f"{before[place]:.15g}, the time of the plot before; expected increasing times in each "
            "track, from piece to piece and from file to file"
        )


def _whose(piece: Piece, row: int) -> str:
    id = piece.ids.names[piece.ids.codes[row]]
    return f" (id {id!r})" if id else ""
