"""Which lines are too ragged to be read, and what is drawn instead: running means, quartiles."""

from __future__ import annotations

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["is_ragged", "running_quartiles", "running_rms"]

# Steps below which a line is drawn as it is.
_FEW = 60
# A line that goes up and down over its whole range so often is ragged.
_CROSSINGS = 10


def is_ragged(values: Array) -> bool:
    """Whether a line goes up and down so often that it covers an area.

    Parameters
    ----------
    values : ndarray, shape (n_steps,)
        NaN where there is none.
    """
    known = values[np.isfinite(values)]
    if len(known) <= _FEW:
        return False
    low, high = np.quantile(known, [0.05, 0.95])
    return bool(np.abs(np.diff(known)).sum() > _CROSSINGS * (high - low) > 0)


def running_rms(values: Array, count: int) -> Array:
    """Root mean square of `count` values about each, those that are NaN left out.

    Parameters
    ----------
    values : ndarray, shape (n_steps,)
    count : int
        An odd number; fewer at both ends.

    Returns
    -------
    ndarray, shape (n_steps,)
        NaN where the value itself is NaN.
    """
    if count == 1:
        return values
    known = np.isfinite(values)
    window = np.ones(count)
    # As long as the values, even where these are fewer than the window.
    half = slice(count // 2, count // 2 + len(values))
    sums = np.convolve(np.where(known, values, 0.0) ** 2, window)[half]
    mean = sums / np.maximum(np.convolve(known, window)[half], 1.0)
    return np.where(known, np.sqrt(mean), np.nan)


def running_quartiles(time: Array, values: Array, blocks: int) -> tuple[Array, Array]:
    """Quartiles of values in blocks of time.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        In any order; pairs with NaN are left out.
    blocks : int
        Number of blocks of equal duration.

    Returns
    -------
    time : ndarray, shape (n_blocks,)
        Middles of the blocks that have values.
    quartiles : ndarray, shape (3, n_blocks)
    """
    known = np.isfinite(time) & np.isfinite(values)
    time, values = time[known], values[known]
    if not len(time):
        return np.empty(0), np.empty((3, 0))
    edges = np.linspace(time.min(), time.max(), blocks + 1)
    block = np.clip(np.searchsorted(edges, time, side="right") - 1, 0, blocks - 1)
    order = np.argsort(block, kind="stable")
    used, begins = np.unique(block[order], return_index=True)
    pieces = np.split(values[order], begins[1:])
    quartiles = np.array([np.quantile(piece, [0.25, 0.5, 0.75]) for piece in pieces]).T
    return 0.5 * (edges[used] + edges[used + 1]), quartiles
