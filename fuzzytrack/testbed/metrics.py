"""Statistics of errors over Monte Carlo runs: means, variances, quantiles, consistency.

Arrays of errors have their runs and scans last, shape (..., runs, n_steps). Runs are independent
of each other, the scans of a run are not: standard errors are those over runs, each with its own
number of scans that count (ratio estimator, by the delta method).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.reprs import summary

__all__ = [
    "Consistency",
    "Estimate",
    "PairedDifference",
    "Peak",
    "compared",
    "consistency",
    "cumulative",
    "distance",
    "mean",
    "paired_difference",
    "peak",
    "per_scan",
    "quantiles",
    "root",
    "run_means",
    "squared_distance",
    "variance",
]


@dataclass(frozen=True, eq=False)
class Estimate:
    """Estimates from the mean over runs, with standard errors.

    Attributes
    ----------
    value : ndarray
        The estimate; NaN where nothing counts.
    error : ndarray
        Its standard error; NaN where fewer than two runs count.
    """

    value: Array
    error: Array

    def __repr__(self) -> str:
        return summary(self, "value", "error")


@dataclass(frozen=True, eq=False)
class Peak:
    """Largest value over the scans.

    Attributes
    ----------
    value : ndarray
        The value; NaN where nothing counts.
    scan : ndarray of int
        Its scan, from 0; -1 where nothing counts.
    """

    value: Array
    scan: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "value", "scan")


@dataclass(frozen=True)
class PairedDifference:
    """Difference between the errors of two trackers in the same runs.

    Attributes
    ----------
    first, second : str
        The trackers.
    quantity : {"predicted", "filtered", "velocity"}
        Whose errors.
    of : {"rmse", "mean"}
        Statistic of each run: root mean square or mean distance.
    difference : float
        Mean over runs of second minus first; negative where the second is better.
    standard_error : float
        Of the difference; NaN for fewer than two runs.
    level : float
        Confidence level of the interval.
    low, high : float
        Confidence interval of the difference (Student t over runs); NaN for fewer than two runs.
    runs : int
        Runs that count.
    """

    first: str
    second: str
    quantity: str
    of: str
    difference: float
    standard_error: float
    level: float
    low: float
    high: float
    runs: int

    def __repr__(self) -> str:
        return summary(self, "first", "second", "difference", "low", "high", "runs")

    @property
    def significant(self) -> bool:
        """Whether 0 is outside the interval."""
        return self.low > 0 or self.high < 0


@dataclass(frozen=True, eq=False)
class Consistency:
    """Normalized squared errors compared with those of a consistent filter.

    Attributes
    ----------
    level : float
        Share of experiments in which a consistent filter stays within an interval.
    mean, expected, low, high : ndarray, shape (n_trackers,)
        Mean over runs and scans that count, that of a consistent filter, and the interval that
        its mean keeps.
    scan_mean, scan_low, scan_high : ndarray, shape (n_trackers, n_steps)
        Mean over runs at each scan, whether it counts or not, and its interval; NaN where there are
        no values.
    """

    level: float
    mean: Array
    expected: Array
    low: Array
    high: Array
    scan_mean: Array
    scan_low: Array
    scan_high: Array

    def __repr__(self) -> str:
        return summary(self, "level", "mean", "scan_mean")

    @property
    def consistent(self) -> Mask:
        """Whether each tracker's mean is within its interval."""
        return np.asarray((self.low <= self.mean) & (self.mean <= self.high))


def distance(errors: ArrayLike) -> Array:
    """Length of errors over the axes.

    Parameters
    ----------
    errors : array_like, shape (..., n_axes)
        Errors; NaN if one axis is.

    Returns
    -------
    ndarray, shape (...)
    """
    total = squared_distance(errors)
    return np.asarray(np.sqrt(total, out=total))


def squared_distance(errors: ArrayLike) -> Array:
    """Squared length of errors over the axes; as for `distance`."""
    each = np.asarray(errors, dtype=np.float64)
    # Axis by axis, so that the result does not depend on the other dimensions to the last bit.
    total: Array = np.square(each[..., 0])
    for k in range(1, each.shape[-1]):
        total += np.square(each[..., k])
    return total


def compared(predicted: ArrayLike) -> Mask:
    """Scans in which every tracker has a prediction, coasted ones included.

    Parameters
    ----------
    predicted : array_like, shape (n_trackers, runs, n_steps)
        Errors of predictions; NaN where there is none.

    Returns
    -------
    ndarray of bool, shape (runs, n_steps)
    """
    return np.asarray(~np.isnan(predicted).any(axis=0))


def mean(values: ArrayLike, counts: ArrayLike) -> Estimate:
    """Mean over all scans that count, pooled over runs.

    Parameters
    ----------
    values : array_like, shape (..., runs, n_steps)
        NaN is left out.
    counts : array_like of bool, broadcast against `values`
        Which scans count.

    Returns
    -------
    Estimate
        Shape (...).
    """
    sums, scans = _sums(values, counts)
    total = scans.sum(axis=-1)
    found = _divide(sums.sum(axis=-1), total)
    runs = (scans > 0).sum(axis=-1)
    off = np.square(sums - found[..., None] * scans).sum(axis=-1)
    spread = _divide(off * _divide(runs, runs - 1), np.square(total.astype(np.float64)))
    return Estimate(found, np.sqrt(spread))


def variance(values: ArrayLike, counts: ArrayLike) -> Estimate:
    """Variance over all scans that count about their pooled mean; as for `mean`.

    The mean square about the mean, divided by the number of scans.
    """
    each = np.asarray(values, dtype=np.float64)
    middle = mean(each, counts).value
    return mean(np.square(each - middle[..., None, None]), counts)


def root(squares: ArrayLike, counts: ArrayLike) -> Estimate:
    """Root of the mean over all scans that count; as for `mean`."""
    return _root(mean(squares, counts))


def per_scan(squares: ArrayLike, counts: ArrayLike) -> Estimate:
    """Root of the mean over runs, scan by scan; as for `mean`, shape (..., n_steps)."""
    each, which = np.asarray(squares), np.asarray(counts)
    return _root(mean(each.swapaxes(-1, -2)[..., None], which.swapaxes(-1, -2)[..., None]))


def cumulative(values: ArrayLike, counts: ArrayLike) -> Estimate:
    """Mean over runs of the sum over the scans that count; as for `mean`.

    A run without such a scan is left out.
    """
    sums, scans = _sums(values, counts)
    return mean(np.where(scans > 0, sums, np.nan)[..., None], True)


def run_means(values: ArrayLike, counts: ArrayLike) -> Array:
    """Mean of each run over its scans that count, shape (..., runs); NaN without one."""
    return _divide(*_sums(values, counts))


def peak(values: ArrayLike) -> Peak:
    """Largest value along the last axis, NaN left out.

    Parameters
    ----------
    values : array_like, shape (..., n_steps)

    Returns
    -------
    Peak
        Shape (...).
    """
    curve = np.asarray(values, dtype=np.float64)
    unknown = np.isnan(curve)
    scan = np.where(unknown, -np.inf, curve).argmax(axis=-1)
    value = np.take_along_axis(curve, scan[..., None], axis=-1)[..., 0]
    none = unknown.all(axis=-1)
    return Peak(np.where(none, np.nan, value), np.where(none, -1, scan))


def quantiles(values: ArrayLike, counts: ArrayLike, levels: ArrayLike) -> Array:
    """Quantiles over runs, scan by scan, interpolated between neighbors.

    Parameters
    ----------
    values : array_like, shape (..., runs, n_steps)
        NaN is left out.
    counts : array_like of bool, broadcast against `values`
        Which values count.
    levels : array_like
        From 0 to 1.

    Returns
    -------
    ndarray, shape (n_levels, ..., n_steps)
        Without the first axis if `levels` is a number; NaN where nothing counts.

    Raises
    ------
    ValueError
        If a level is out of range.
    """
    wanted = np.asarray(levels, dtype=np.float64)
    if not ((wanted >= 0) & (wanted <= 1)).all():
        raise ValueError(f"levels must be from 0 to 1, got {wanted.tolist()}")
    each = np.asarray(values, dtype=np.float64)
    good = np.asarray(counts) & ~np.isnan(each)
    ordered = np.sort(np.where(good, each, np.inf), axis=-2)
    number = good.sum(axis=-2)
    found = np.empty((wanted.size, *number.shape))
    for k, level in enumerate(wanted.flat):
        place = level * np.maximum(number - 1, 0)
        below = np.floor(place).astype(np.int64)
        low, high = (
            np.take_along_axis(ordered, at[..., None, :], axis=-2)[..., 0, :]
            for at in (below, np.ceil(place).astype(np.int64))
        )
        # Values that do not count are infinite and sorted last; a scan of them only becomes NaN.
        step = np.subtract(high, low, out=np.zeros_like(low), where=number > 0)
        found[k] = np.where(number > 0, low + (place - below) * step, np.nan)
    return found.reshape(wanted.shape + number.shape)


def paired_difference(one: ArrayLike, two: ArrayLike, level: float) -> tuple[float, ...]:
    """Mean of the second minus the first, its standard error and confidence interval.

    Parameters
    ----------
    one, two : array_like, shape (runs,)
        A number a run; a run in which either is NaN is left out.
    level : float
        Confidence level, 0 < level < 1.

    Returns
    -------
    difference, standard_error, low, high : float
        NaN for no run, and all but the difference for a single one.
    runs : float
        Runs that count.

    Raises
    ------
    ValueError
        If `level` is out of range.

    Notes
    -----
    Student t: runs are independent of each other, and a mean over many of them is nearly normal.
    """
    _check_level(level)
    off = np.asarray(two, dtype=np.float64) - np.asarray(one, dtype=np.float64)
    off = off[~np.isnan(off)]
    runs = len(off)
    difference = float(off.mean()) if runs else math.nan
    if runs < 2:
        return difference, math.nan, math.nan, math.nan, runs
    from scipy.special import stdtrit

    error = float(off.std(ddof=1)) / math.sqrt(runs)
    half = float(stdtrit(runs - 1, 0.5 + level / 2)) * error
    return difference, error, difference - half, difference + half, runs


def consistency(
    values: ArrayLike,
    axes: ArrayLike,
    counts: ArrayLike,
    *,
    independent_scans: bool,
    level: float = 0.95,
) -> Consistency:
    """Compare normalized squared errors with the chi-square distribution.

    Parameters
    ----------
    values : array_like, shape (n_trackers, runs, n_steps)
        NIS or NEES; NaN where there is none.
    axes : array_like of int, broadcast against `values`
        Degrees of freedom: the axes summed in each.
    counts : array_like of bool, broadcast against `values`
        Which scans count.
    independent_scans : bool
        Whether a consistent filter's values at different scans of a run are independent. They are
        for NIS. They are not for NEES: its interval counts each run as one independent value, so a
        consistent filter stays within it at least as often as `level` says.
    level : float
        0 < level < 1.

    Returns
    -------
    Consistency

    Raises
    ------
    ValueError
        If `level` is out of range.

    Notes
    -----
    The sum of independent values of a consistent filter has the chi-square distribution with as
    many degrees of freedom as axes were summed (Bar-Shalom, Li and Kirubarajan, 2001, section
    5.4.2).
    """
    _check_level(level)
    each = np.asarray(values, dtype=np.float64)
    freedom = np.broadcast_to(np.where(np.isnan(each), 0, axes), each.shape)
    sums, scans = _sums(each, counts)
    summed = np.where(counts, freedom, 0).sum(axis=(-1, -2))
    number = scans.sum(axis=-1)
    # The number of independent values is that of the scans, or that of the runs.
    weight = number if independent_scans else (scans > 0).sum(axis=-1)
    expected = _divide(summed, number)
    low, high = _interval(expected * weight, weight, level)
    by_scan = (~np.isnan(each)).sum(axis=-2)
    scan_low, scan_high = _interval(freedom.sum(axis=-2), by_scan, level)
    return Consistency(
        level=level,
        mean=_divide(sums.sum(axis=-1), number),
        expected=expected,
        low=low,
        high=high,
        scan_mean=_divide(np.where(np.isnan(each), 0.0, each).sum(axis=-2), by_scan),
        scan_low=scan_low,
        scan_high=scan_high,
    )


def _interval(freedom: Array, number: NDArray[np.int64], level: float) -> tuple[Array, Array]:
    """Interval of the mean of some values with the given degrees of freedom in total."""
    from scipy.special import gammaincinv

    # Quantiles of chi-square from scipy.special: scipy.stats takes seconds to import.
    known = np.where(number > 0, freedom, np.nan)
    low, high = (2 * gammaincinv(known / 2, 0.5 + side * level / 2) for side in (-1, 1))
    return _divide(low, number), _divide(high, number)


def _sums(values: ArrayLike, counts: ArrayLike) -> tuple[Array, NDArray[np.int64]]:
    """Sum of each run and its number of scans, both of shape (..., runs)."""
    each = np.asarray(values, dtype=np.float64)
    good = np.asarray(counts) & ~np.isnan(each)
    return np.where(good, each, 0.0).sum(axis=-1), good.sum(axis=-1)


def _root(squares: Estimate) -> Estimate:
    value = np.sqrt(squares.value)
    # Errors that are 0 in every run have a standard error of 0.
    certain = squares.error == 0
    return Estimate(value, np.where(certain, 0.0, _divide(squares.error, 2 * value)))


def _divide(above: ArrayLike, below: ArrayLike) -> Array:
    """Quotient, NaN where the divisor is not positive."""
    one, two = np.broadcast_arrays(np.asarray(above, np.float64), np.asarray(below, np.float64))
    return np.asarray(np.divide(one, two, out=np.full(one.shape, np.nan), where=two > 0))


def _check_level(level: float) -> None:
    if not 0 < level < 1:
        raise ValueError(f"level must be > 0 and < 1, got {level}")
