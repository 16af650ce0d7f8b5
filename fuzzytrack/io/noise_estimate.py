"""The standard deviation of plots, estimated from the plots themselves, for `sigma` "auto"."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary

__all__ = ["NoiseEstimate", "estimate_noise"]


#: Differences that the estimate of an axis needs at least.
FEWEST = 8
#: Order of the differences: what a target does with constant acceleration gives 0.
_ORDER = 3
#: Plots that follow another after less than this part of the track's median interval are left out:
#: receivers that see the same pulse have the same error.
_CLOSE = 0.05
# Gaussian: median of the absolute value, and the limit of nine in ten.
_MEDIAN, _NINE_TENTHS = 0.6744897501960817, 1.6448536269514722
# Steps of a number, over the deviation of rounding to them.
_ROUNDING = math.sqrt(12)
# Differences of more deviations than this are spikes or maneuvers. What is left of a Gaussian
# variable has _WITHIN of its variance, and the estimate loses 14 % of its precision.
_LIMIT = 3.0
_DENSITY = math.exp(-(_LIMIT**2) / 2) / math.sqrt(2 * math.pi)
_INSIDE = math.erf(_LIMIT / math.sqrt(2))
_WITHIN = 1 - 2 * _LIMIT * _DENSITY / _INSIDE
# Slope of the mean of `_influence` in the logarithm of the deviation, which is its variance, too.
_SLOPE = 2 * _WITHIN * _INSIDE - 2 * _LIMIT * _DENSITY * (_LIMIT**2 - _WITHIN)
# Rounds of leaving differences out; some ten are enough.
_ROUNDS = 60
# Axes differ if they do by more than this factor, and by more than this many standard errors.
_FACTOR, _ERRORS = 1.5, 2.5
# Differences in a block, and blocks that are needed for a standard error from blocks.
_SHORTEST, _LONGEST, _BLOCKS = 12, 64, 12


@dataclass(frozen=True, eq=False)
class NoiseEstimate:
    """Standard deviation of plots, with its standard error.

    Attributes
    ----------
    sigma : ndarray, shape (n_axes,)
        Standard deviation of each axis, in the unit of the plots.
    standard_error : ndarray, shape (n_axes,)
        Of each `sigma`.
    pooled : float
        Standard deviation of all axes together: the root of the mean of their variances.
    pooled_error : float
        Its standard error.
    differences : int
        Differences that were used, of all axes together.
    axes_differ : bool
        Whether the axes differ by more than 1.5:1, and by more than their errors.
    rounded : ndarray of bool, shape (n_axes,)
        Axes whose noise is smaller than the steps of the numbers in which the plots are given;
        their `sigma` is the deviation of such rounding, the step divided by the root of 12.
    motion : ndarray, shape (n_axes,)
        How much plots differ from a straight line through those before: the limit of nine in ten
        second differences, as a deviation, single plots that are far off left out. `sigma` where
        targets fly straight, and more where they maneuver by more than the noise from plot to plot.
    """

    sigma: Array
    standard_error: Array
    pooled: float
    pooled_error: float
    differences: int
    axes_differ: bool
    rounded: Mask
    motion: Array

    def __repr__(self) -> str:
        return summary(
            self, axes=len(self.sigma), pooled=self.pooled, pooled_error=self.pooled_error
        )


def estimate_noise(
    time: ArrayLike,
    plots: ArrayLike,
    tracks: ArrayLike,
    *,
    names: Sequence[str] | None = None,
) -> NoiseEstimate:
    """Estimate the standard deviation of plots, without knowing where the targets were.

    Parameters
    ----------
    time : array_like, shape (n,)
        Times (s).
    plots : array_like, shape (n, n_axes)
        Positions; NaN where missed.
    tracks : array_like of int, shape (n,)
        Number of the track of each plot. Those of a track are in order of time; other tracks may
        lie between them.
    names : sequence of str, optional
        Names of the axes, for messages; ``axis 0`` and so on unless given.

    Returns
    -------
    NoiseEstimate

    Raises
    ------
    DataError
        If an axis has too few plots, no noise, or mostly repeated plots.
    ValueError
        If the shapes do not fit.

    Notes
    -----
    The third divided difference of four successive plots of a track does not depend on position,
    velocity and acceleration of the target. With weights that are divided by the root of the sum
    of their squares, it has the deviation of a plot, at any times. Their median gives a first
    deviation; from then on those of more than three deviations, which are spikes and maneuvers,
    are left out, and the deviation of the rest is corrected for what a Gaussian variable loses.

    White noise is assumed: plots that were smoothed before have more noise than is found. Up to a
    tenth of the plots may be spikes.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.io.noise_estimate import estimate_noise
    >>> rng = np.random.default_rng(1)
    >>> t = np.cumsum(rng.uniform(0.5, 2, 1000))
    >>> plots = np.stack([30 * t, 5 * t], axis=1) + 10 * rng.normal(size=(1000, 2))
    >>> found = estimate_noise(t, plots, np.zeros(1000, dtype=int))
    >>> print(found.sigma.round(1), found.standard_error.round(1))
    [9.9 9.8] [0.4 0.4]
    """
    times, places = np.asarray(time, dtype=np.float64), np.asarray(plots, dtype=np.float64)
    codes = np.asarray(tracks)
    if places.ndim != 2 or not places.shape[1]:
        raise ValueError(f"plots: shape must be (n, n_axes), got {places.shape}")
    for name, values in (("time", times), ("tracks", codes)):
        if values.shape != places.shape[:1]:
            raise ValueError(
                f"{name}: shape {values.shape} does not fit plots of shape {places.shape}"
            )
    order = np.argsort(codes, kind="stable")
    times, codes = times[order], codes[order]
    named = names or [f"axis {k}" for k in range(places.shape[1])]
    axes = [_axis(times, places[order, k], codes, name) for k, name in enumerate(named)]
    sigma = np.array([axis.sigma for axis in axes])
    errors = np.array([axis.error for axis in axes])
    # From relative numbers: squares of plots may be out of range.
    unit = float(sigma.max())
    pooled = math.sqrt(float(((sigma / unit) ** 2).mean()))
    pooled_error = math.sqrt(float(((sigma / unit * errors) ** 2).sum())) / len(axes) / pooled
    return NoiseEstimate(
        sigma,
        errors,
        unit * pooled,
        pooled_error,
        sum(axis.used for axis in axes),
        _differ(sigma, errors),
        np.array([axis.rounded for axis in axes]),
        np.array([axis.motion for axis in axes]),
    )


def _differ(sigma: Array, errors: Array) -> bool:
    low, high = int(np.argmin(sigma)), int(np.argmax(sigma))
    ratio = sigma[high] / sigma[low]
    error = math.hypot(errors[low] / sigma[low], errors[high] / sigma[high])
    return bool(ratio > _FACTOR and math.log(ratio) > _ERRORS * error)


# -------------------------------------------------------------------- one axis


@dataclass(frozen=True)
class _Axis:
    sigma: float
    error: float
    used: int
    motion: float
    rounded: bool = False


def _axis(times: Array, plots: Array, codes: NDArray[np.int64], axis: str) -> _Axis:
    """Estimate of an axis; rows are in order of tracks."""
    seen = np.isfinite(plots) & np.isfinite(times)
    times, plots, codes = times[seen], plots[seen], codes[seen]
    apart = _apart(times, codes)
    repeated = (plots[1:] == plots[:-1])[codes[1:] == codes[:-1]]
    chosen = _Differences.of(times[apart], plots[apart], codes[apart])
    if len(chosen.values) < FEWEST:
        raise DataError(
            f"too few plots to estimate their noise: {axis} has "
            f"{counted(len(chosen.values), 'run')} of {_ORDER + 1} plots in one track; {FEWEST} "
            "are needed. `sigma` gives it"
        )
    sigma, used = _deviation(chosen.values)
    bends = _Differences.of(times[apart], plots[apart], codes[apart], 2).values
    motion = max(sigma, _motion(bends))
    # Differences of plots without noise are those of rounding.
    nothing = 64 * float(np.finfo(np.float64).eps) * float(np.median(np.abs(plots)))
    if sigma <= nothing:
        grid = _grid(plots, nothing)
        _check_rounded(plots, grid, repeated, axis)
        return _Axis(grid / _ROUNDING, grid / _ROUNDING, used, motion, True)
    error = _relative_error(chosen, sigma)
    rounding = _grid(plots, _ROUNDING * sigma) / _ROUNDING
    if rounding > sigma:
        return _Axis(rounding, error * rounding, used, motion, True)
    return _Axis(sigma, error * sigma, used, motion)


def _motion(bends: Array) -> float:
    """Limit of nine in ten second differences, as a deviation.

    One plot that is far off bends the track to and fro at three plots, and a maneuver to one side:
    the median of three neighbors keeps the maneuver, and of the three bends of the plot one.
    """
    steady = np.median(sliding_window_view(bends, 3), axis=-1) if len(bends) > 2 else bends
    return float(np.quantile(np.abs(steady), 0.9)) / _NINE_TENTHS


def _apart(times: Array, codes: NDArray[np.int64]) -> Mask:
    """Plots that do not follow another of their track at once."""
    steps, same = np.diff(times), codes[1:] == codes[:-1]
    apart = np.ones(len(times), dtype=np.bool_)
    if not same.any():
        return apart
    # The median interval of each track; rows are in order of tracks, and those of no time apart
    # are no intervals.
    inside = same & (steps > 0)
    owners, lengths = codes[1:][inside], steps[inside]
    order = np.lexsort((lengths, owners))
    owners, lengths = owners[order], lengths[order]
    names, starts, counts = np.unique(owners, return_index=True, return_counts=True)
    middle = lengths[starts + counts // 2] if len(names) else np.empty(0)
    typical = np.zeros(len(steps))
    place = np.searchsorted(names, codes[1:])
    known = place < len(names)
    known[known] = names[place[known]] == codes[1:][known]
    typical[known] = middle[place[known]]
    apart[1:] = ~same | ((steps > 0) & (steps >= _CLOSE * typical))
    return apart


def _grid(plots: Array, least: float) -> float:
    """Step of which all differences of plots are multiples; 0 if it is not larger than `least`.

    It is found as Euclid finds the greatest common divisor.
    """
    with np.errstate(over="ignore"):
        steps = np.diff(np.unique(plots))
    # Numbers that should be equal differ by their own rounding.
    steps = steps[steps > 16 * np.finfo(np.float64).eps * float(np.median(np.abs(plots)))]
    step = 0.0
    while len(steps):
        step = float(steps.min())
        if step <= least:
            return 0.0
        # In a much larger one there are not enough digits to tell.
        steps = steps[steps < 1e4 * step]
        steps = np.abs(steps - step * np.round(steps / step))
        steps = steps[steps > 1e-6 * step]
    return step


def _check_rounded(plots: Array, grid: float, repeated: Mask, axis: str) -> None:
    """Raise DataError unless plots without noise stay on a grid, as those of a slow target do."""
    if repeated.mean() < 0.5:
        raise DataError(
            f"plots: those of {axis} have no noise that could be estimated: more than half of "
            "their differences of third order are 0; give `sigma`"
        )
    with np.errstate(over="ignore"):
        moves = np.abs(np.diff(plots))
    if not grid or np.median(moves[moves > 0]) > 3 * grid:
        raise DataError(
            f"plots: {100 * repeated.mean():.0f} % of those of {axis} repeat the one before, "
            "so that their noise cannot be estimated; leave old positions out, or give `sigma`"
        )


# -------------------------------------------------------------------- differences


@dataclass(frozen=True, eq=False)
class _Differences:
    """Differences of successive plots, each with the deviation of a plot.

    Attributes
    ----------
    values : ndarray, shape (n,)
    weights : ndarray, shape (order + 1, n)
        Of the plots.
    first : ndarray of int, shape (n,)
        Place of the first of its plots.
    """

    values: Array
    weights: Array
    first: NDArray[np.intp]

    @classmethod
    def of(
        cls, times: Array, plots: Array, codes: NDArray[np.int64], order: int = _ORDER
    ) -> _Differences:
        """Differences of all runs of plots in one track; rows are in order of tracks."""
        count = max(0, len(times) - order)
        first = np.flatnonzero(codes[order:] == codes[:count])
        runs = first + np.arange(order + 1)[:, None]
        # In parts of the run, so that no product is out of range; and about its second plot, since
        # large positions have no part in it.
        when = times[runs] - times[first]
        when /= when[-1].copy()
        weights = np.ones_like(when)
        for one in range(order + 1):
            for other in range(order + 1):
                if one != other:
                    weights[one] *= when[one] - when[other]
        np.divide(1.0, weights, out=weights)
        weights /= np.sqrt((weights**2).sum(axis=0))
        with np.errstate(over="ignore", invalid="ignore"):
            values = (weights * (plots[runs] - plots[runs[1]])).sum(axis=0)
        # Numbers at the end of the range are no plots.
        fine = np.isfinite(values)
        return cls(values[fine], weights[:, fine], first[fine])

    def correlations(self) -> float:
        """Sum of the squared correlations of a difference with all others, on average, plus 1."""
        total = float(len(self.values))
        for lag in range(1, _ORDER + 1):
            one = np.arange(len(self.first) - lag)
            one = one[self.first[one + lag] == self.first[one] + lag]
            common = self.weights[lag:, one] * self.weights[: _ORDER + 1 - lag, one + lag]
            total += 2 * float((common.sum(axis=0) ** 2).sum())
        return total / len(self.values)


def _deviation(values: Array) -> tuple[float, int]:
    """Deviation of differences most of which are Gaussian, and how many were used."""
    size = np.sort(np.abs(values))
    sigma = float(np.median(size)) / _MEDIAN
    used = len(size)
    if not sigma:
        return 0.0, used
    # Relative to the first deviation, so that squares are in range.
    with np.errstate(over="ignore"):
        size, unit = size / sigma, sigma
        squares = np.cumsum(size**2)
    relative, before = 1.0, 0.0
    for _ in range(_ROUNDS):
        used = int(np.searchsorted(size, _LIMIT * relative, side="right"))
        before, relative = relative, math.sqrt(squares[used - 1] / used / _WITHIN)
        if relative == before:
            break
    return unit * relative, used


# -------------------------------------------------------------------- standard error


def _relative_error(differences: _Differences, sigma: float) -> float:
    """Standard error of a deviation in parts of it.

    The larger of that of white noise, where only neighbors are correlated, and that of the spread
    of blocks, in which maneuvers and tracks of more noise show.
    """
    count = len(differences.values)
    variance = differences.correlations() * _SLOPE / (count * _SLOPE**2)
    length = min(max(count // 50, _SHORTEST), _LONGEST)
    # A block is a track, or part of one where tracks are few.
    starts = np.flatnonzero(np.diff(differences.first, prepend=-2) != 1)
    if len(starts) < _BLOCKS:
        since = np.arange(count) - np.repeat(starts, np.diff(starts, append=count))
        starts = np.flatnonzero(since % length == 0)
    if len(starts) >= _BLOCKS:
        sums = np.add.reduceat(_influence(differences.values / sigma), starts)
        spread = float((sums**2).sum()) * len(starts) / (len(starts) - 1)
        variance = max(variance, spread / (count * _SLOPE) ** 2)
    return math.sqrt(variance)


def _influence(values: Array) -> Array:
    """What a difference of a deviation of 1 adds to the mean that is 0 at the estimate."""
    size = np.minimum(np.abs(values), 2 * _LIMIT)
    return np.where(size <= _LIMIT, size**2 - _WITHIN, 0.0)
