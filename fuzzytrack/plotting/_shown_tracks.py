"""Tracks as they are drawn: all in flat arrays, one after the other, with gaps between parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.plotting._batch_track import batch_of, one_track
from fuzzytrack.trackers.result import TrackResult

__all__ = [
    "MARKED",
    "Project",
    "ShownTracks",
    "shown_id",
]

#: Positions as they are drawn, of positions of shape (n, n_axes) as they were tracked.
Project = Callable[[Array], Array]

#: Steps of a track up to which every one has its marks.
MARKED = 75

_FIELDS = ("time", "measured", "predicted", "filtered", "innovation", "alpha", "beta", "gamma")
_Part = dict[str, Array]
# Characters of an identity that are shown, at most.
_LONGEST = 24


@dataclass(frozen=True, eq=False)
class ShownTracks:
    """Tracks, each of one part or more; a row of NaN between two parts, so that no line joins them.

    Attributes
    ----------
    ids : tuple of str
        One for each track.
    edges : ndarray of int, shape (n_tracks + 1,)
        Rows at which the tracks begin, and at which one more would.
    time : ndarray, shape (n_rows,)
        Times (s).
    measured, predicted, filtered : ndarray, shape (n_rows, n_axes)
        Positions.
    coasted, rejected : ndarray of bool, shape (n_rows,)
        Rows without a plot that was used; those of them that have a plot.
    alpha, beta, gamma : ndarray, shape (n_rows, n_axes)
        Gains.
    """

    ids: tuple[str, ...]
    edges: NDArray[np.int64]
    time: Array
    measured: Array
    predicted: Array
    filtered: Array
    coasted: Mask
    rejected: Mask
    alpha: Array
    beta: Array
    gamma: Array

    @classmethod
    def of(
        cls, results: TrackResult | Sequence[TrackResult], ids: Sequence[str] | None
    ) -> ShownTracks:
        """Tracks of results; those that share an identity are parts of one track.

        Raises
        ------
        ValueError
            If there is none, there are more or fewer identities than results, or their numbers of
            axes differ.
        """
        parts, numbers = _parts_of(results)
        names = numbers if ids is None else [str(id) for id in ids]
        if len(names) != len(parts):
            raise ValueError(f"ids: {len(names)} for {len(parts)} tracks; one each is needed")
        found = {part["measured"].shape[1] for part in parts}
        if len(found) > 1:
            raise ValueError(f"results: tracks with {sorted(found)} axes; all need the same number")
        together: dict[str, list[_Part]] = {}
        for name, part in zip(names, parts, strict=True):
            together.setdefault(name, []).append(part)
        lengths = [sum(len(p["time"]) + 1 for p in group) for group in together.values()]
        flat = _joined([part for group in together.values() for part in group])
        return cls._marked(tuple(together), np.cumsum([0, *lengths]), flat)

    @classmethod
    def one(cls, result: TrackResult, place: tuple[int, ...]) -> ShownTracks:
        """One track of a result."""
        part = _part(result, place)
        return cls._marked(("",), np.array([0, len(part["time"]) + 1]), _joined([part]))

    @classmethod
    def _marked(cls, ids: tuple[str, ...], edges: NDArray[np.int64], flat: _Part) -> ShownTracks:
        idle = np.isnan(flat.pop("innovation")) & ~np.isnan(flat["predicted"])
        coasted = np.asarray(idle.any(axis=1))
        rejected = np.asarray((idle & ~np.isnan(flat["measured"])).any(axis=1))
        return cls(ids=ids, edges=edges, coasted=coasted, rejected=rejected, **flat)

    def __len__(self) -> int:
        """Number of tracks."""
        return len(self.ids)

    @property
    def plots(self) -> int:
        """Number of plots."""
        return int(self.seen.sum())

    @property
    def seen(self) -> Mask:
        """Rows with a plot."""
        return np.asarray(np.isfinite(self.measured).any(axis=1))

    def rows(self, track: int) -> slice:
        """Rows of a track, without the gap at its end."""
        return slice(int(self.edges[track]), int(self.edges[track + 1]) - 1)

    def ends(self, drawn: Mask) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """First and last row of each track, out of some rows; tracks with none are left out."""
        known = np.flatnonzero(drawn)
        first = np.searchsorted(known, self.edges[:-1])
        after = np.searchsorted(known, self.edges[1:])
        some = after > first
        return known[first[some]], known[after[some] - 1]

    @property
    def marked(self) -> bool:
        """Whether it is one track with marks at every step, predictions among them."""
        return len(self) == 1 and len(self.time) <= MARKED

    def projected(self, project: Project) -> ShownTracks:
        """Tracks at other positions; predictions that are not drawn are NaN."""
        none = np.full_like(self.predicted, np.nan)
        return replace(
            self,
            measured=project(self.measured),
            predicted=project(self.predicted) if self.marked else none,
            filtered=project(self.filtered),
        )


def _parts_of(
    results: TrackResult | Sequence[TrackResult],
) -> tuple[list[_Part], list[str]]:
    """Tracks of results or of a batch, and their numbers."""
    if isinstance(results, TrackResult):
        places = list(np.ndindex(batch_of(results)))
        parts = [_part(results, place) for place in places]
        return parts, [",".join(map(str, place)) for place in places]
    if not isinstance(results, Sequence) or not results:
        raise ValueError(
            f"results: must be a TrackResult or a sequence of at least one, got {results!r}"
        )
    for number, result in enumerate(results):
        if not isinstance(result, TrackResult) or batch_of(result):
            shown = result if isinstance(result, TrackResult) else type(result).__name__
            raise ValueError(f"results: {number}: must be a TrackResult of one track, got {shown}")
    return [_part(result, ()) for result in results], [str(k) for k in range(len(results))]


def _part(result: TrackResult, place: tuple[int, ...]) -> _Part:
    time = one_track(result.time, place)[:, 0] if result.time.ndim > 1 else result.time
    values = {
        name: one_track(getattr(result, name), place)
        for name in ("measured", "predicted", "filtered", "innovation")
    }
    gains = {
        name: one_track(getattr(result.gains, name), place) for name in ("alpha", "beta", "gamma")
    }
    return {"time": np.asarray(time, dtype=np.float64), **values, **gains}


def _joined(parts: Sequence[_Part]) -> _Part:
    flat = {}
    for name in _FIELDS:
        gap = np.full((1, *parts[0][name].shape[1:]), np.nan)
        flat[name] = np.concatenate([piece for part in parts for piece in (part[name], gap)][:-1])
    return flat


def shown_id(id: str) -> str:
    """An identity as a label; matplotlib leaves out labels that begin with an underscore."""
    text = id if len(id) <= _LONGEST else f"{id[: _LONGEST - 1]}…"
    return f" {text}" if text.startswith("_") else text or "track"
