"""Objects at the instants of a scene: their rows there, or what lies between two rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scoring.positions import Positions
from fuzzytrack.scoring.scored_scene import ObjectRows

__all__ = ["at_instants", "usual_interval"]

Integers = NDArray[np.int64]


def usual_interval(positions: Positions) -> float:
    """Median of the times between rows of an object (s); NaN if no object has two."""
    _, id = np.unique(positions.id, return_inverse=True)
    order = np.lexsort((positions.time, id))
    steps = np.diff(positions.time[order])[np.diff(id[order]) == 0]
    return float(np.median(steps)) if len(steps) else np.nan


def at_instants(
    positions: Positions, instants: Array, longest: float, span: float, beyond: float = 0.0
) -> ObjectRows:
    """Objects at instants, interpolated linearly between their rows.

    Parameters
    ----------
    positions : Positions
    instants : ndarray, shape (n_instants,)
        Increasing times (s).
    longest : float
        Longest time between two rows (s) over which is interpolated; 0 takes rows only that are at
        an instant.
    span : float
        Time over which positions are differenced where no velocities are given (s).
    beyond : float
        Time before the first row of an object, and after the last one, for which it still exists
        (s), along the line through the next two rows.

    Returns
    -------
    ObjectRows
        Its rows are in order of instant and identity. The kind is that of the row before.
    """
    names, id = np.unique(positions.id, return_inverse=True)
    order = np.lexsort((positions.time, id))
    rows = _Rows.of(id[order], positions.time[order], positions.position[order], len(names))
    where, object_ = rows.lives(instants, beyond)
    when = instants[where]
    before, after, share = rows.around(object_, when, longest)
    kept = np.flatnonzero(before >= 0)
    chosen = kept[np.lexsort((object_[kept], where[kept]))]
    where, object_, share = where[chosen], object_[chosen], share[chosen]
    before, after = before[chosen], after[chosen]
    # Exactly the row where there is one.
    change = rows.position[after] - rows.position[before]
    place = rows.position[before] + share[:, None] * change
    if positions.velocity is None:
        velocity = rows.slopes(object_, instants[where], span)
    else:
        known, part = positions.velocity[order], np.clip(share, 0, 1)[:, None]
        velocity = known[before] + part * (known[after] - known[before])
    nearest = np.where(share >= 1, after, before)
    kinds = None if positions.kind is None else positions.kind[order][nearest]
    return ObjectRows(where, object_, place, velocity, names, kinds)


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of objects, in order of object and time; `bounds` are those of each object."""

    id: Integers
    time: Array
    position: Array
    bounds: Integers

    @classmethod
    def of(cls, id: Integers, time: Array, position: Array, count: int) -> _Rows:
        return cls(id, time, position, np.searchsorted(id, np.arange(count + 1)))

    def lives(self, instants: Array, beyond: float) -> tuple[Integers, Integers]:
        """Instants at which objects exist, and which object it is."""
        first = np.searchsorted(instants, self.time[self.bounds[:-1]] - beyond)
        end = np.searchsorted(instants, self.time[self.bounds[1:] - 1] + beyond, side="right")
        count = np.maximum(end - first, 0)
        object_ = np.repeat(np.arange(len(count)), count)
        place = np.arange(len(object_)) - np.repeat(np.cumsum(count) - count, count)
        return first[object_] + place, object_

    def around(
        self, object_: Integers, when: Array, longest: float
    ) -> tuple[Integers, Integers, Array]:
        """Rows before and after times, and the share of the way; -1 in a gap."""
        first, last = self.bounds[object_], self.bounds[object_ + 1] - 1
        before = np.clip(self._before(object_, when), first, last)
        exact = self.time[before] == when
        outside = (when < self.time[first]) | (when > self.time[last])
        # Beyond an end: along the line through the two rows there.
        before = np.where(~exact & (before == last), np.maximum(last - 1, first), before)
        after = np.where(exact, before, np.minimum(before + 1, last))
        gap = self.time[after] - self.time[before]
        share = np.where(gap > 0, (when - self.time[before]) / np.where(gap > 0, gap, 1.0), 0.0)
        # A row far from the next one has no line; it stays where it is.
        share = np.where(outside & (gap > longest), np.round(np.clip(share, 0, 1)), share)
        return np.where(exact | outside | (gap <= longest), before, -1), after, share

    def _before(self, object_: Integers, when: Array) -> Integers:
        """The last row of an object that is not later than a time; that before its first if none.

        Objects and times are compared as whole numbers: the places of times among all of them.
        """
        every = np.unique(np.concatenate([self.time, when]))
        key = self.id * len(every) + np.searchsorted(every, self.time)
        wanted = object_ * len(every) + np.searchsorted(every, when)
        return np.asarray(np.searchsorted(key, wanted, side="right") - 1)

    def slopes(self, object_: Integers, when: Array, span: float) -> Array:
        """Mean velocity about times, as far as the object exists there; NaN of a single row."""
        first, last = self.time[self.bounds[object_]], self.time[self.bounds[object_ + 1] - 1]
        ends = [np.clip(when + side * span / 2, first, last) for side in (-1, 1)]
        places = []
        for end in ends:
            before, after, share = self.around(object_, end, np.inf)
            change = self.position[after] - self.position[before]
            places.append(self.position[before] + share[:, None] * change)
        gap = (ends[1] - ends[0])[:, None]
        return np.where(gap > 0, (places[1] - places[0]) / np.where(gap > 0, gap, 1.0), np.nan)
