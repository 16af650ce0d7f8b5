"""Objects at the instants of a scene: their rows there, or what lies between two rows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scoring.positions import Positions
from fuzzytrack.scoring.scene import ObjectRows

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
    time, position = positions.time[order], positions.position[order]
    bounds = np.searchsorted(id[order], np.arange(len(names) + 1))
    parts: list[tuple[Integers, Integers, Integers, Integers, Array, Array]] = []
    for number, (first, end) in enumerate(pairwise(bounds.tolist())):
        mine = slice(first, end)
        where, before, after, share = _between(time[mine], instants, longest, beyond)
        slopes = np.full((len(where), positions.n_axes), np.nan)
        if positions.velocity is None:
            slopes = _slopes(time[mine], position[mine], instants[where], span)
        same = np.full(len(where), number, dtype=np.int64)
        parts.append((where, same, before + first, after + first, share, slopes))
    if not parts:
        none = np.empty(0, dtype=np.int64)
        vectors = np.empty((0, positions.n_axes))
        kind = None if positions.kind is None else none
        return ObjectRows(none, none, vectors, vectors, names, kind)
    joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
    in_order = np.lexsort((joined[1], joined[0]))
    where, number_of, before, after, share, velocity = (each[in_order] for each in joined)
    # Exactly the row where there is one.
    place = position[before] + share[:, None] * (position[after] - position[before])
    if positions.velocity is not None:
        known, part = positions.velocity[order], np.clip(share, 0, 1)[:, None]
        velocity = known[before] + part * (known[after] - known[before])
    nearest = np.where(share >= 1, after, before)
    kinds = None if positions.kind is None else positions.kind[order][nearest]
    return ObjectRows(where, number_of, place, velocity, names, kinds)


def _between(
    time: Array, instants: Array, longest: float, beyond: float
) -> tuple[Integers, Integers, Integers, Array]:
    """Instants at which an object exists, the rows before and after, and the share of the way."""
    first = np.searchsorted(instants, time[0] - beyond)
    end = np.searchsorted(instants, time[-1] + beyond, side="right")
    where = np.arange(first, end)
    when = instants[where]
    before = np.clip(np.searchsorted(time, when, side="right") - 1, 0, len(time) - 1)
    exact = time[before] == when
    outside = (when < time[0]) | (when > time[-1])
    if len(time) > 1:
        after = np.where(exact, before, np.minimum(before + 1, len(time) - 1))
        # Beyond an end: along the line through the two rows there.
        last = ~exact & (after == before)
        before = np.where(last, before - 1, before)
        after = np.where(last, before + 1, after)
    else:
        after = before
    gap = time[after] - time[before]
    share = np.where(gap > 0, (when - time[before]) / np.where(gap > 0, gap, 1.0), 0.0)
    # A row far from the next one has no line; it stays where it is.
    share = np.where(outside & (gap > longest), np.round(np.clip(share, 0, 1)), share)
    kept = exact | outside | (gap <= longest)
    return where[kept], before[kept], after[kept], share[kept]


def _slopes(time: Array, position: Array, when: Array, span: float) -> Array:
    """Mean velocity of an object about some times, as far as it exists there."""
    low = np.clip(when - span / 2, time[0], time[-1])
    high = np.clip(when + span / 2, time[0], time[-1])
    ends = (np.stack([np.interp(t, time, x) for x in position.T], axis=1) for t in (high, low))
    change = np.subtract(*ends)
    gap = (high - low)[:, None]
    return np.where(gap > 0, change / np.where(gap > 0, gap, 1.0), np.nan)
