"""Variance of the filtered position at every step of a run, from the memories of its lanes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.lanes.layout import Rows

__all__ = ["filtered_variance"]


def filtered_variance(
    of: Callable[[Any, Any], Any],
    memories: NDArray[Any],
    plots: NDArray[Any],
    times: Array,
    sigmas: Array,
    lanes: Array | None,
    rows: Rows,
    elapsed: bool,
) -> Array:
    """Variance of the position of each lane after each step (m²).

    Parameters
    ----------
    of : callable
        The tracker's `prediction_variance`, of memories and of the time since their plots.
    memories : ndarray, shape (n_steps, lanes, n_memory)
        Memories after each step.
    plots : ndarray, shape (n_steps, lanes, n_axes)
        NaN where missed.
    times : ndarray, shape (n_steps, lanes or 1)
        Times (s).
    sigmas : ndarray
        Standard deviations of the plots (m), which broadcast with them; NaN where unknown.
    lanes : ndarray, shape (rows.kept, lanes), or None
        State before the run; None for new lanes.
    rows : Rows
        Layout of a lane.
    elapsed : bool
        Whether a memory is that of the last plot, and not of the last step.

    Returns
    -------
    ndarray, shape (n_steps, lanes, n_axes)
        NaN where the tracker has none, before the first plot, and where a plot was missed before
        the second one: then the velocity is unknown.
    """
    n_steps, count, n_axes = plots.shape
    seen = ~np.isnan(plots).any(axis=-1)
    before = np.zeros(count) if lanes is None else lanes[rows.plots]
    begun = np.full(count, np.nan) if lanes is None else lanes[rows.last_time]
    dt = np.zeros((n_steps, count))
    if elapsed:
        # The first row is that of the state, to which a time before all others belongs.
        marks = np.where(seen, np.arange(1, n_steps + 1)[:, None], 0)
        last = np.maximum.accumulate(marks, axis=0)
        every = np.concatenate([begun[None], np.broadcast_to(times, (n_steps, count))])
        dt = every[1:] - np.take_along_axis(every, last, axis=0)
    # Of lanes that have not started it may be anything.
    with np.errstate(all="ignore"):
        memory = memories.reshape(n_steps * count, memories.shape[-1]).T.astype(np.float64)
        found = np.asarray(of(memory, dt.reshape(-1)))
    if found.ndim == 0:
        return np.full(plots.shape, np.nan)
    by_axis = np.broadcast_to(found, (n_axes, n_steps * count))
    variance = np.moveaxis(by_axis.reshape(n_axes, n_steps, count), 0, -1)
    plots_so_far = (before + np.cumsum(seen, axis=0))[..., None]
    # A new track is where its plot is.
    first = (plots_so_far == 1) & seen[..., None]
    start = np.where(first, np.broadcast_to(sigmas, plots.shape) ** 2, np.nan)
    return np.where(plots_so_far >= 2, variance, start)
