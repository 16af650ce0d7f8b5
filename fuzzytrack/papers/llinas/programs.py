"""Trackers of Llinas et al. (1998), equation by equation, to count their operations (Table 5.7).

Each program tracks plots of two axes and takes the distance of every prediction from the target.
Its numbers all pass through `number`, so that `fuzzytrack.testbed.operations.count_program` can
count them in the convention written there: operations as in MATLAB 5. They are the report's
equations as printed, which means in particular

- the innovation x_o - x_p is computed wherever it is written;
- a fraction in an equation, like the 1/2 of Eq. 2.35, is a division;
- a predicted quantity is stored under its index k + 1, which is an addition; smoothed ones are
  overwritten, and a plot comes without an index;
- the two points of a start cost what Eq. 2.5 costs, once for each axis; the Kalman programs get
  their start.

So an update costs 13 an axis without acceleration and 27 with, of which 3 are half a distance. The
report does not print its programs: which indices count, and that the 1/2 does, is a uniform reading
that gives its totals (470 and 974 there: with the start of a single axis).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.papers.llinas.columns import Columns
from fuzzytrack.reprs import summary

__all__ = [
    "Run",
    "alpha_beta",
    "alpha_beta_gamma",
    "chan",
    "kalman_matrix",
    "kalman_scalar",
    "proposed",
]

Number = Callable[[float], Any]
Plots = Sequence[Sequence[float]]
Matrix = list[list[Any]]


@dataclass
class _Axis:
    """Plots of an axis, and the state of the target on it."""

    plots: list[Any]
    truth: list[Any]
    x: Any = None
    v: Any = None
    a: Any = None
    error: Any = None
    predicted: list[Any] = field(default_factory=list)
    rate: list[Any] = field(default_factory=list)


@dataclass(frozen=True)
class Run:
    """Result of a program, from the third scan on.

    Attributes
    ----------
    predicted : ndarray, shape (n_scans - 2, n_axes)
        Predictions (m).
    distance : ndarray, shape (n_scans - 2,)
        Their distances from the target (m).
    """

    predicted: Array
    distance: Array

    def __repr__(self) -> str:
        return summary(self, "predicted")


def _axes(plots: Plots, truth: Plots, number: Number) -> list[_Axis]:
    """Axes with their plots and the target's positions, both of shape (n_scans, 2)."""
    measured, true = (np.asarray(given, dtype=np.float64) for given in (plots, truth))
    if measured.ndim != 2 or measured.shape[1] != 2 or true.shape != measured.shape:
        raise ValueError(
            "plots and truth must have one shape (n_scans, 2); got "
            f"{measured.shape} and {true.shape}"
        )
    if len(measured) < 2:
        raise ValueError(f"plots must have at least 2 scans, got {len(measured)}")
    axes = []
    for z, x in zip(measured.T.tolist(), true.T.tolist(), strict=True):
        axis = _Axis([number(value) for value in z], [number(value) for value in x])
        axis.predicted, axis.rate = [None] * len(z), [None] * len(z)
        axes.append(axis)
    return axes


def _start(axes: list[_Axis], t: Any) -> None:
    for axis in axes:
        axis.x = axis.plots[1]  # 2.4
        axis.v = (axis.plots[1] - axis.plots[0]) / t  # 2.5


def _distance(axes: list[_Axis], scan: int) -> Any:
    first, second = axes
    dx = first.predicted[scan] - first.truth[scan]
    dy = second.predicted[scan] - second.truth[scan]
    return (dx**2 + dy**2) ** 0.5


def _result(axes: list[_Axis], distances: list[Any]) -> Run:
    predicted = [[float(value) for value in axis.predicted[2:]] for axis in axes]
    return Run(np.array(predicted).T, np.array([float(d) for d in distances]))


def _predict(axis: _Axis, k: Any, t: Any) -> None:
    axis.predicted[k + 1] = axis.x + t * axis.v  # 2.1


def _smooth(axis: _Axis, scan: int, t: Any, alpha: Any, beta: Any) -> None:
    z, x = axis.plots[scan], axis.predicted[scan]
    axis.x = x + alpha * (z - x)  # 2.2
    axis.v = axis.v + beta / t * (z - x)  # 2.3


def alpha_beta(
    plots: Plots, truth: Plots, dt: float, alpha: float, beta: float, number: Number = float
) -> Run:
    """Fixed gains without acceleration, Eqs. 2.1 to 2.5.

    Parameters
    ----------
    plots, truth : sequence of pairs, n_scans long
        Plots and true positions (m), at least 2 scans.
    dt : float
        T (s).
    alpha, beta : float
        Gains.
    number : callable
        Makes the numbers that the program calculates with.
    """
    axes = _axes(plots, truth, number)
    t, a, b = number(dt), number(alpha), number(beta)
    _start(axes, t)
    distances = []
    for scan in range(2, len(plots)):
        k = _index(scan - 1, number)
        for axis in axes:
            _predict(axis, k, t)
        distances.append(_distance(axes, scan))
        for axis in axes:
            _smooth(axis, scan, t, a, b)
    return _result(axes, distances)


def alpha_beta_gamma(
    plots: Plots,
    truth: Plots,
    dt: float,
    alpha: float,
    beta: float,
    gamma: float,
    number: Number = float,
) -> Run:
    """Fixed gains with acceleration, Eqs. 2.35 to 2.39; started from two plots with acceleration 0.

    Parameters are those of `alpha_beta`, and `gamma`, as γ/(2T²).
    """
    axes = _axes(plots, truth, number)
    t, a, b, c, one = (number(value) for value in (dt, alpha, beta, gamma, 1.0))
    _start(axes, t)
    for axis in axes:
        axis.a = number(0.0)
    distances = []
    for scan in range(2, len(plots)):
        k = _index(scan - 1, number)
        for axis in axes:
            axis.predicted[k + 1] = axis.x + t * axis.v + one / 2 * t**2 * axis.a  # 2.35
            axis.rate[k + 1] = axis.v + t * axis.a  # 2.36
        distances.append(_distance(axes, scan))
        for axis in axes:
            z, x = axis.plots[scan], axis.predicted[scan]
            axis.x = x + a * (z - x)  # 2.37
            axis.v = axis.rate[scan] + b / t * (z - x)  # 2.38
            axis.a = axis.a + c / (2 * t**2) * (z - x)  # 2.39
    return _result(axes, distances)


def _index(k: int, number: Number) -> Any:
    """An index that counts; a plain one where numbers are plain."""
    return k if number is float else number(k)


# ---------------------------------------------------------------- fuzzy gains


def _normalized(axis: _Axis, scan: int) -> tuple[Any, Any]:
    """E and ΔE, Eqs. 3.16 to 3.19 with absolute denominators; the previous E is then this one."""
    e = axis.plots[scan] - axis.predicted[scan]
    moved = axis.plots[scan] - axis.plots[scan - 1]
    error = _relative(e, moved)
    change = error - axis.error
    rate = _relative(change, axis.error)
    axis.error = error
    return error, rate


def _relative(part: Any, whole: Any) -> Any:
    if abs(part) < abs(whole):
        return part / abs(whole)
    return part / abs(part) if part != 0 else part


def chan(
    plots: Plots,
    truth: Plots,
    dt: float,
    rules: Callable[[tuple[float, float]], tuple[float, ...]],
    number: Number = float,
) -> Run:
    """Chan's tracker: one pair of gains for both axes, from magnitudes of the normalized error.

    Parameters are those of `alpha_beta`, but for the gains `rules`: function of the magnitudes of
    error and error rate (Eqs. 3.20 and 3.21) to α and β. Like the toolbox call of the report it
    works with plain numbers and is not counted.
    """
    axes = _axes(plots, truth, number)
    t = number(dt)
    _start(axes, t)
    for axis in axes:
        axis.error = number(0.0)
    distances = []
    for scan in range(2, len(plots)):
        k = _index(scan - 1, number)
        for axis in axes:
            _predict(axis, k, t)
        distances.append(_distance(axes, scan))
        (e1, d1), (e2, d2) = (_normalized(axis, scan) for axis in axes)
        error = ((e1**2 + e2**2) / 2) ** 0.5  # 3.20
        rate = ((d1**2 + d2**2) / 2) ** 0.5  # 3.21
        alpha, beta = rules((float(error), float(rate)))
        for axis in axes:
            _smooth(axis, scan, t, number(alpha), number(beta))
    return _result(axes, distances)


def proposed(
    plots: Plots,
    truth: Plots,
    dt: float,
    table: Columns,
    *,
    weighted_sum: bool = False,
    number: Number = float,
) -> Run:
    """The report's fuzzy tracker: stiffness and damping from a relational matrix, axis by axis.

    Parameters are those of `alpha_beta`, but for the gains `table`: columns of stiffness and
    damping, found at the nearest grid point. With `weighted_sum` they are taken as levels that add
    up to 1, Eq. 3.13, instead of through the centroid, Eq. 3.10.
    """
    axes = _axes(plots, truth, number)
    t = number(dt)
    low, step = ([number(v) for v in pair] for pair in (table.low, table.step))
    centers = [[number(v) for v in center] for center in table.centers]
    output = _weighted_sum if weighted_sum else _centroid
    _start(axes, t)
    for axis in axes:
        axis.error = number(0.0)
    distances = []
    for scan in range(2, len(plots)):
        k = _index(scan - 1, number)
        for axis in axes:
            _predict(axis, k, t)
        distances.append(_distance(axes, scan))
        for axis in axes:
            error, rate = _normalized(axis, scan)
            i, j = round((error - low[0]) / step[0]), round((rate - low[1]) / step[1])
            cells = [[number(v) for v in levels[i][j]] for levels in table.levels]
            stiffness, damping = (output(c, y) for c, y in zip(cells, centers, strict=True))
            alpha = 4 * damping * stiffness / (2 * damping * stiffness + stiffness**2 + 1)  # 3.26
            beta = 4 * stiffness**2 / (2 * damping * stiffness + stiffness**2 + 1)
            _smooth(axis, scan, t, alpha, beta)
    return _result(axes, distances)


def _weighted_sum(levels: list[Any], centers: list[Any]) -> Any:
    total = levels[0] * centers[0]
    for level, center in zip(levels[1:], centers[1:], strict=True):
        total = total + level * center
    return total


def _centroid(levels: list[Any], centers: list[Any]) -> Any:
    area = levels[0]
    for level in levels[1:]:
        area = area + level
    return _weighted_sum(levels, centers) / area


# ---------------------------------------------------------------- Kalman filters


def kalman_matrix(
    plots: Plots,
    truth: Plots,
    dt: float,
    sigma: float,
    sigma_v: float,
    joseph: bool = False,
    number: Number = float,
) -> Run:
    """Kalman filter of each axis with full matrices.

    Started as `fuzzytrack.schedulers.KalmanCV` is from two plots.

    Parameters
    ----------
    plots, truth, dt, number
        As for `alpha_beta`.
    sigma, sigma_v : float
        Standard deviations of the plots (m) and of the target's acceleration (m/s²).
    joseph : bool
        Whether P is (I - KH)P⁻(I - KH)ᵀ + K R Kᵀ, computed as it is written, instead of (I - KH)P⁻.
    """
    axes = _axes(plots, truth, number)
    (p0, q0), r = _kalman_start(dt, sigma, sigma_v), number(sigma**2)
    given: tuple[Matrix, ...] = (
        [[1.0, dt], [0.0, 1.0]],
        q0,
        [[1.0, 0.0], [0.0, 1.0]],
        [[1.0, 0.0]],
    )
    move, noise, one, h = ([[number(v) for v in row] for row in matrix] for matrix in given)
    states = [_two_points(axis, dt, number) for axis in axes]
    covariances = [[[number(v) for v in row] for row in p0] for _ in axes]
    distances = []
    for scan in range(2, len(plots)):
        for n, axis in enumerate(axes):
            states[n] = _times(move, states[n])
            covariances[n] = _plus(_times(_times(move, covariances[n]), _turned(move)), noise)
            axis.predicted[scan] = states[n][0][0]
        distances.append(_distance(axes, scan))
        for n, axis in enumerate(axes):
            x, p = states[n], covariances[n]
            s = _times(_times(h, p), _turned(h))[0][0] + r
            gain = [[row[0] / s] for row in _times(p, _turned(h))]
            e = axis.plots[scan] - _times(h, x)[0][0]
            states[n] = _plus(x, _scaled(gain, e))
            kept = _times(_minus(one, _times(gain, h)), p)
            if joseph:
                again = _turned(_minus(one, _times(gain, h)))
                kept = _plus(_times(kept, again), _times(_scaled(gain, r), _turned(gain)))
            covariances[n] = kept
    return _result(axes, distances)


def kalman_scalar(
    plots: Plots, truth: Plots, dt: float, sigma: float, sigma_v: float, number: Number = float
) -> Run:
    """The filter of `kalman_matrix`, written out in scalars, five an axis."""
    axes = _axes(plots, truth, number)
    (p0, q0), r = _kalman_start(dt, sigma, sigma_v), number(sigma**2)
    t, q11, q12, q22 = (number(v) for v in (dt, q0[0][0], q0[0][1], q0[1][1]))
    covariances = [[number(v) for v in (p0[0][0], p0[0][1], p0[1][1])] for _ in axes]
    for axis in axes:
        ((axis.x,), (axis.v,)) = _two_points(axis, dt, number)
    distances = []
    for scan in range(2, len(plots)):
        for n, axis in enumerate(axes):
            axis.predicted[scan] = axis.x + t * axis.v
            p11, p12, p22 = covariances[n]
            c = t * p22
            covariances[n] = [p11 + t * (2 * p12 + c) + q11, p12 + c + q12, p22 + q22]
        distances.append(_distance(axes, scan))
        for n, axis in enumerate(axes):
            p11, p12, p22 = covariances[n]
            s = p11 + r
            k1, k2 = p11 / s, p12 / s
            e = axis.plots[scan] - axis.predicted[scan]
            axis.x, axis.v = axis.predicted[scan] + k1 * e, axis.v + k2 * e
            rest = 1 - k1
            covariances[n] = [rest * p11, rest * p12, p22 - k2 * p12]
    return _result(axes, distances)


def _kalman_start(dt: float, sigma: float, sigma_v: float) -> tuple[Matrix, Matrix]:
    """Covariance after two plots, and that of the process noise, in plain numbers."""
    r, q = sigma**2, sigma_v**2
    p = [[r, r / dt], [r / dt, 2 * r / dt**2 + q * dt**2 / 4]]
    return p, [[q * dt**4 / 4, q * dt**3 / 2], [q * dt**3 / 2, q * dt**2]]


def _two_points(axis: _Axis, dt: float, number: Number) -> Matrix:
    first, second = (float(z) for z in axis.plots[:2])
    return [[number(second)], [number((second - first) / dt)]]


def _times(a: Matrix, b: Matrix) -> Matrix:
    """Matrix product in 2mnp operations, with sums that begin at 0."""
    product = []
    for row in a:
        sums = [0.0] * len(b[0])
        for value, others in zip(row, b, strict=True):
            sums = [total + value * other for total, other in zip(sums, others, strict=True)]
        product.append(sums)
    return product


def _plus(a: Matrix, b: Matrix) -> Matrix:
    return [[x + y for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]


def _minus(a: Matrix, b: Matrix) -> Matrix:
    return [[x - y for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]


def _scaled(a: Matrix, factor: Any) -> Matrix:
    return [[value * factor for value in row] for row in a]


def _turned(a: Matrix) -> Matrix:
    return [list(column) for column in zip(*a, strict=True)]
