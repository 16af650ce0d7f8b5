"""The change of an RMS error from one tracker to another, with its interval by a block bootstrap.

The errors of a track are not independent of each other: a tracker is late through a whole maneuver.
Blocks of plots that follow each other are therefore drawn, and whole tracks where there are enough.
SciPy's bootstrap draws single values only, hence this module.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["RmsChange", "rms_change"]

# Blocks into which all plots are divided, where there are few tracks: few, so that each is longer
# than a maneuver. Student's way allows for their number.
_BLOCKS = 15
# More tracks than this are put together to so many units.
_UNITS = 200
# Level of the interval.
_LEVEL = 0.95


@dataclass(frozen=True)
class RmsChange:
    """Relative change of an RMS error.

    Attributes
    ----------
    change : float
        RMS of the second over that of the first, minus 1.
    low, high : float
        Interval that covers it in 95 % of recordings like this; NaN where there is too little.
    blocks : int
        Blocks that were drawn, with replacement: tracks, or parts of them.
    """

    change: float
    low: float
    high: float
    blocks: int

    def __repr__(self) -> str:
        return summary(self, "change", "low", "high", "blocks")

    @property
    def text(self) -> str:
        """The change in percent, with its interval if it has one; a dash for NaN."""
        if math.isnan(self.change):
            return "–"
        middle, low, high = map(_percent, (self.change, self.low, self.high))
        return f"{middle} %" if math.isnan(self.low) else f"{middle} % ({low} to {high})"


def _percent(share: float) -> str:
    """Percent with its sign; large ones without digits that mean nothing."""
    percent = 100 * share
    return f"{percent:+.1f}" if abs(percent) < 99.95 else f"{percent:+.3g}"


def rms_change(
    first: ArrayLike,
    second: ArrayLike,
    tracks: ArrayLike,
    *,
    seed: int = 0,
    resamples: int = 999,
) -> RmsChange:
    """Change of an RMS error from one tracker to another on the same plots.

    Parameters
    ----------
    first, second : array_like, shape (n_plots,)
        Squared errors of both, the plots of a track in order of time.
    tracks : array_like of int, shape (n_plots,)
        To which track each plot belongs; those of a track follow each other.
    seed : int
        Of the draws, not negative.
    resamples : int
        Number of resamples.

    Returns
    -------
    RmsChange
        Infinite where an error is, or where the end of an interval is too large for a number; NaN
        where the first one has no error, or there is no plot.

    Notes
    -----
    Moving blocks within each track, which is closed to a circle so that every plot counts alike
    (Politis and Romano, 1992). A track shorter than two blocks is a block of its own. The interval
    is that of the logarithm of the ratio, symmetric, and studentized: each resample is divided by
    its own standard error (Hall, 1992, section 3.6), without which intervals of few blocks are too
    short.
    """
    one, two = (np.asarray(each, dtype=np.float64) for each in (first, second))
    total = one.sum(), two.sum()
    if not (np.isfinite(total).all() and min(total) > 0):
        with np.errstate(all="ignore"):
            ratio = float(np.sqrt(np.divide(total[1], total[0])))
        return RmsChange(ratio - 1, *((math.inf,) * 2 if ratio == math.inf else (math.nan,) * 2), 0)
    middle = 0.5 * math.log(total[1] / total[0])
    sums, chance, count = _blocks(np.stack([one, two]), np.asarray(tracks))
    if count < 2:
        return RmsChange(math.expm1(middle), math.nan, math.nan, count)
    # Share of each block in the logarithm; its mean over the draws is 0.
    shares = 0.5 * (sums[1] / (sums[1] @ chance) - sums[0] / (sums[0] @ chance)) / count
    error = math.sqrt(count * float(shares**2 @ chance) * count / (count - 1))
    draws = np.random.default_rng(seed).choice(len(chance), (resamples, count), p=chance)
    reach = error * _student(sums[:, draws], middle)
    # Errors that grow without limit leave an interval whose end is larger than any number.
    with np.errstate(over="ignore"):
        change, low, high = np.expm1([middle, middle - reach, middle + reach]).tolist()
    return RmsChange(change, low, high, count)


def _student(drawn: Array, middle: float) -> float:
    """Size that 95 % of studentized deviations stay within.

    `drawn` has shape (2, n_resamples, n_blocks).
    """
    count = drawn.shape[2]
    totals = drawn.sum(axis=2, keepdims=True)
    with np.errstate(all="ignore"):
        shares = 0.5 * (drawn[1] / totals[1] - drawn[0] / totals[0])
        errors = np.sqrt((shares**2).sum(axis=1) * count / (count - 1))
        sizes = np.abs(0.5 * np.log(totals[1] / totals[0])[:, 0] - middle) / errors
    # A resample of one block many times says nothing.
    known = sizes[errors > 0]
    return float(np.quantile(known, _LEVEL)) if len(known) else 0.0


def _blocks(squares: Array, tracks: NDArray[np.int64]) -> tuple[Array, Array, int]:
    """Sums over each block, shape (2, n_blocks), their chances, and how many to draw."""
    starts = np.flatnonzero(np.diff(tracks, prepend=tracks[0] - 1))
    lengths = np.diff(starts, append=len(tracks))
    block = max(1, round(len(tracks) / _BLOCKS))
    whole = lengths < 2 * block
    sums = np.add.reduceat(squares, starts, axis=1)[:, whole]
    if sums.shape[1] > _UNITS:
        edges = np.linspace(0, sums.shape[1], _UNITS, endpoint=False).astype(np.int64)
        sums = np.add.reduceat(sums, edges, axis=1)
    units, parts = sums.shape[1], [sums]
    for start, length in zip(starts[~whole].tolist(), lengths[~whole].tolist(), strict=True):
        own = squares[:, start : start + length]
        running = np.cumsum(np.concatenate([np.zeros((2, 1)), own, own[:, :block]], axis=1), axis=1)
        parts.append(running[:, block : block + length] - running[:, :length])
    inside = int(lengths[~whole].sum())
    count = units + round(inside / block)
    chance = np.full(units + inside, 1 / count)
    if inside:
        chance[units:] = (1 - units / count) / inside
    return np.concatenate(parts, axis=1), chance, count
