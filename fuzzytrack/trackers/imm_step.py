"""The step of interacting multiple models, for `fuzzytrack.trackers.imm`.

The same functions run in plain Python over a list and compiled over arrays, with the same results
to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fuzzytrack.gains.joseph import correct_ca, predict_ca
from fuzzytrack.kernels.exponential import exponential
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.start import axis_results, begin_step, lane_end

__all__ = [
    "FAR", "MODEL", "PROBABILITIES", "ModelPair", "imm_rows", "mixed", "moved", "step_function",
    "switched",
]  # fmt: skip

#: Model of an axis: x, v, a, and P by rows, without what is below its diagonal.
Model = tuple[float, float, float, float, float, float, float, float, float]

#: The memory: two probabilities, then for each axis the quiet model and the maneuvering one.
PROBABILITIES, MODEL = 2, 9

# Bounds of the likelihood ratio: exp(±300)·1e±50 times a probability neither over- nor underflows.
_EXPONENT, _RATIO = 300.0, 1e100

# Differences of models, and innovations in a likelihood, count as no larger (m, m/s, m/s²), and
# squares of innovations as no larger multiples of their variance: all stay finite, in single
# precision as well, and so does a difference of two of them.
FAR, _UNLIKELY = 1e12, 1e30


# Intermediate results from one pass through the lanes to the next: for each model the share of the
# other one in the mixture from which it starts; and the likelihood of the maneuvering model over
# that of the quiet one, which is sqrt(ratio)·exp(exponent).
_SCRATCH = ("quiet_share", "maneuver_share", "ratio", "exponent")


@dataclass(frozen=True)
class ModelPair:
    """Numbers of a quiet and a maneuvering model of a target.

    Attributes
    ----------
    quiet_variance, maneuver_variance : float
        Variance of the process noise of a step: of the acceleration (m²/s⁴), or of its change if
        the maneuvering model `accelerates`.
    quiet_stay, maneuver_stay : float
        Probability that the target stays in its model for a step.
    accelerates : bool
        Whether the maneuvering model has an acceleration.
    floor : float
        Least probability of a model.
    plot_variance : float or None
        Variance of all plots (m²); None where each has its own.
    start_velocity : float or None
        Variance of a new track's velocity (m²/s²); None where velocity starts from two plots.
    start_acceleration : float
        Variance of a new track's acceleration if it maneuvers (m²/s⁴).
    """

    quiet_variance: float
    maneuver_variance: float
    quiet_stay: float
    maneuver_stay: float
    accelerates: bool
    floor: float
    plot_variance: float | None
    start_velocity: float | None
    start_acceleration: float


def imm_rows(n_axes: int) -> Rows:
    """Layout of a lane."""
    return Rows(n_axes, PROBABILITIES + 2 * MODEL * n_axes, _SCRATCH)


def switched(
    quiet: float, maneuver: float, quiet_stay: float, maneuver_stay: float
) -> tuple[float, float, float, float]:
    """Probabilities of both models a step later, and the parts that come from the other one."""
    to_maneuver = (1.0 - quiet_stay) * quiet
    to_quiet = (1.0 - maneuver_stay) * maneuver
    return (
        quiet_stay * quiet + to_quiet,
        maneuver_stay * maneuver + to_maneuver,
        to_quiet,
        to_maneuver,
    )


def mixed(own: Model, other: Model, share: float, bounded: Callable[[Any], Any]) -> Model:
    """Mean and covariance of a mixture of two models, with the share of the other one.

    `bounded` limits a difference of the models, so that its square is finite.
    """
    x, v, a, p11, p12, p13, p22, p23, p33 = own
    x2, v2, a2, q11, q12, q13, q22, q23, q33 = other
    dx, dv, da = x2 - x, v2 - v, a2 - a
    means = x + share * dx, v + share * dv, a + share * da
    dx, dv, da = bounded(dx), bounded(dv), bounded(da)
    spread = share * (1.0 - share)
    return (
        *means,
        p11 + share * (q11 - p11) + spread * dx * dx,
        p12 + share * (q12 - p12) + spread * dx * dv,
        p13 + share * (q13 - p13) + spread * dx * da,
        p22 + share * (q22 - p22) + spread * dv * dv,
        p23 + share * (q23 - p23) + spread * dv * da,
        p33 + share * (q33 - p33) + spread * da * da,
    )


def moved(model: Model, dt: float, q: float, accelerates: bool) -> Model:
    """Model a time step later, with process noise GGᵀq."""
    x, v, a, p11, p12, p13, p22, p23, p33 = model
    a = a if accelerates else 0.0
    p13 = p13 if accelerates else 0.0
    p23 = p23 if accelerates else 0.0
    p33 = p33 if accelerates else 0.0
    g = 0.5 * dt * dt
    p11, p12, p13, p22, p23, p33 = predict_ca(p11, p12, p13, p22, p23, p33, dt, g)
    p11 = p11 + q * g * g
    p13 = p13 + q * g if accelerates else 0.0
    p23 = p23 + q * dt if accelerates else 0.0
    p33 = p33 + q if accelerates else 0.0
    return (
        x + v * dt + a * g,
        v + a * dt,
        a,
        p11,
        p12 + q * g * dt,
        p13,
        p22 + q * dt * dt,
        p23,
        p33,
    )


def _predicted(model: Model, dt: float, q: float, accelerates: bool) -> Model:
    """As `moved`; no variance of position is negative by rounding."""
    x, v, a, p11, p12, p13, p22, p23, p33 = moved(model, dt, q, accelerates)
    return x, v, a, p11 if p11 > 0.0 else 0.0, p12, p13, p22, p23, p33


def _corrected(
    model: Model, e: float, s: float, r: float, gains: tuple[float, float, float]
) -> Model:
    """Model after a plot of variance `r` with innovation `e` of variance `s`; Joseph form."""
    x, v, a, p11, p12, p13, p22, p23, p33 = model
    k1, k2, k3 = gains
    n11, n12, n13, n22, n23, n33 = correct_ca(p11, p12, p13, p22, p23, p33, k1, k2, k3, s, r)
    return (
        x + k1 * e,
        v + k2 * e,
        a + k3 * e,
        n11,
        n12,
        n13,
        # After a long gap rounding could make it negative.
        n22 if n22 > 0.0 else 0.0,
        n23,
        n33 if n33 > 0.0 else 0.0,
    )


def _gains(
    model: Model, s: float, seen: bool, unknown: bool, gap: float
) -> tuple[float, float, float]:
    """K of a model; the one that takes the velocity from two plots while it is unknown."""
    k1 = 1.0 if unknown else model[3] / s
    k2 = 1.0 / gap if unknown else model[4] / s
    k3 = 0.0 if unknown else model[5] / s
    return k1 if seen else 0.0, k2 if seen else 0.0, k3 if seen else 0.0


def _started(
    model: Model, z: float, r: float, velocity: float, acceleration: float, first: bool
) -> Model:
    """Model after the first plot of a track, with variances; or the one there is."""
    x, v, a, p11, p12, p13, p22, p23, p33 = model
    return (
        z if first else x,
        0.0 if first else v,
        0.0 if first else a,
        r if first else p11,
        0.0 if first else p12,
        0.0 if first else p13,
        velocity if first else p22,
        0.0 if first else p23,
        acceleration if first else p33,
    )


def _bounded(value: float) -> float:
    value = value if value < FAR else FAR
    return value if value > -FAR else -FAR


def _between(low: float, value: float, high: float) -> float:
    value = value if value > low else low
    return value if value < high else high


def _access(stride: int) -> tuple[Callable[[Any, int], Model], Callable[[Any, int, Model], None]]:
    """Functions that read and write a model, its numbers `stride` apart."""

    def read(b: Any, at: int) -> Model:
        return (
            b[at], b[at + stride], b[at + 2 * stride],
            b[at + 3 * stride], b[at + 4 * stride], b[at + 5 * stride],
            b[at + 6 * stride], b[at + 7 * stride], b[at + 8 * stride],
        )  # fmt: skip

    def write(b: Any, at: int, model: Model) -> None:
        (
            b[at], b[at + stride], b[at + 2 * stride],
            b[at + 3 * stride], b[at + 4 * stride], b[at + 5 * stride],
            b[at + 6 * stride], b[at + 7 * stride], b[at + 8 * stride],
        ) = model  # fmt: skip

    return read, write


def step_function(pair: ModelPair, rows: Rows, stride: int) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes of a buffer, in place.

    It goes through all lanes five times, once for each thing to be done to them, and through the
    lanes inside of the axes: so the compiler can work on neighboring lanes at once.

    Parameters
    ----------
    pair : ModelPair
    rows : Rows
        From `imm_rows`.
    stride : int
        Numbers between rows.
    """
    begin, judge, end = _lane_passes(pair, rows, stride)
    predict, correct = _axis_passes(pair, rows, stride)
    n_axes = rows.n_axes

    def step(b: Any, count: int) -> None:
        begin(b, count)
        for j in range(n_axes):
            predict(b, count, j)
        judge(b, count)
        for j in range(n_axes):
            correct(b, count, j)
        end(b, count)

    return step


def _lane_passes(
    pair: ModelPair, rows: Rows, stride: int
) -> tuple[Callable[[Any, int], None], Callable[[Any, int], None], Callable[[Any, int], None]]:
    """Functions that run once for each lane: before prediction, before correction, at the end."""
    n_axes, nan = rows.n_axes, math.nan
    quiet_stay, maneuver_stay, floor = pair.quiet_stay, pair.maneuver_stay, pair.floor
    quiet_row, maneuver_row, gains_row = rows.memory, rows.memory + 1, rows.gains
    plot_row, dt_row, gap_row, plots_row = rows.plot, rows.dt, rows.gap, rows.plots
    quiet_share_row, maneuver_share_row, ratio_row, exponent_row = map(rows.scratch_row, _SCRATCH)
    end_lane = lane_end(rows, stride, two_point=pair.start_velocity is None)

    def begin(b: Any, count: int) -> None:
        """Switch probabilities, and the share of the other model where each starts."""
        for i in range(min(count, stride)):
            seen = True
            for j in range(n_axes):
                z = b[(plot_row + j) * stride + i]
                seen = seen & (z == z)
            for j in range(n_axes):
                z = b[(plot_row + j) * stride + i]
                b[(plot_row + j) * stride + i] = z if seen else nan
            dt, gap, running, _ = begin_step(
                b[plots_row * stride + i], b[gap_row * stride + i], b[dt_row * stride + i], seen
            )
            b[dt_row * stride + i] = dt
            b[gap_row * stride + i] = gap

            was_quiet = b[quiet_row * stride + i]
            was_maneuver = b[maneuver_row * stride + i]
            quiet, maneuver, to_quiet, to_maneuver = switched(
                was_quiet, was_maneuver, quiet_stay, maneuver_stay
            )
            quiet_share = to_quiet / (quiet if quiet > 0.0 else 1.0)
            maneuver_share = to_maneuver / (maneuver if maneuver > 0.0 else 1.0)
            b[quiet_share_row * stride + i] = quiet_share if running else 0.0
            b[maneuver_share_row * stride + i] = maneuver_share if running else 0.0
            b[quiet_row * stride + i] = quiet if running else was_quiet
            b[maneuver_row * stride + i] = maneuver if running else was_maneuver
            b[ratio_row * stride + i] = 1.0
            b[exponent_row * stride + i] = 0.0

    def judge(b: Any, count: int) -> None:
        """Probabilities after the plot."""
        for i in range(min(count, stride)):
            z = b[plot_row * stride + i]
            update = (z == z) & (b[plots_row * stride + i] >= 2.0)
            quiet, maneuver = b[quiet_row * stride + i], b[maneuver_row * stride + i]
            ratio = math.sqrt(_between(1.0 / _RATIO, b[ratio_row * stride + i], _RATIO))
            exponent = _between(-_EXPONENT, b[exponent_row * stride + i], _EXPONENT)
            odds = maneuver * (ratio * exponential(exponent))
            total = quiet + odds
            total = total if total > 0.0 else 1.0
            after_quiet = _between(floor, quiet / total, 1.0 - floor)
            after_maneuver = _between(floor, odds / total, 1.0 - floor)
            b[quiet_row * stride + i] = after_quiet if update else quiet
            b[maneuver_row * stride + i] = after_maneuver if update else maneuver
            for k in range(3):
                b[(gains_row + k) * stride + i] = 0.0

    def end(b: Any, count: int) -> None:
        """Gains out of the sums of K over the axes, and the count of the plot."""
        for i in range(min(count, stride)):
            z, dt = b[plot_row * stride + i], b[dt_row * stride + i]
            alpha = b[gains_row * stride + i] / n_axes
            beta = b[(gains_row + 1) * stride + i] * dt / n_axes
            gamma = 2.0 * b[(gains_row + 2) * stride + i] * dt * dt / n_axes
            plots, gap = b[plots_row * stride + i], b[gap_row * stride + i]
            end_lane(b, i, plots, gap, z == z, alpha, beta, gamma)

    return begin, judge, end


def _axis_passes(
    pair: ModelPair, rows: Rows, stride: int
) -> tuple[Callable[[Any, int, int], None], Callable[[Any, int, int], None]]:
    """Functions that run for each axis of a lane: prediction of the models, and correction."""
    nan = math.nan
    quiet_q, maneuver_q, accelerates = (
        pair.quiet_variance, pair.maneuver_variance, pair.accelerates
    )  # fmt: skip
    fixed = pair.plot_variance is not None
    variance = 0.0 if pair.plot_variance is None else pair.plot_variance
    start_22 = 0.0 if pair.start_velocity is None else pair.start_velocity
    start_33 = pair.start_acceleration
    read, write = _access(stride)
    write_results = axis_results(rows, stride)
    models_row, maneuver_row = rows.memory + PROBABILITIES, rows.memory + 1
    x_row, v_row, a_row = rows.position, rows.velocity, rows.acceleration
    last_row, gap_row, plots_row, gains_row = rows.last_plot, rows.gap, rows.plots, rows.gains
    plot_row, sigma_row, dt_row = rows.plot, rows.sigma, rows.dt
    quiet_share_row, maneuver_share_row, ratio_row, exponent_row = map(rows.scratch_row, _SCRATCH)

    def plot_variance(z: float, sigma: float) -> float:
        r = variance if fixed else sigma * sigma
        return r if z == z else 1.0

    def predict(b: Any, count: int, j: int) -> None:
        """Mix and predict; likelihood of the maneuvering model over that of the quiet one."""
        quiet_at = (models_row + 2 * j * MODEL) * stride
        maneuver_at = quiet_at + MODEL * stride
        for i in range(min(count, stride)):
            dt = b[dt_row * stride + i]
            one, two = read(b, quiet_at + i), read(b, maneuver_at + i)
            mixed_one = mixed(one, two, b[quiet_share_row * stride + i], _bounded)
            mixed_two = mixed(two, one, b[maneuver_share_row * stride + i], _bounded)
            one = _predicted(mixed_one, dt, quiet_q, False)
            two = _predicted(mixed_two, dt, maneuver_q, accelerates)
            write(b, quiet_at + i, one)
            write(b, maneuver_at + i, two)

            z = b[(plot_row + j) * stride + i]
            running = b[plots_row * stride + i] >= 2.0
            prediction = one[0] + b[maneuver_row * stride + i] * (two[0] - one[0])
            write_results(b, j * stride + i, prediction, z - prediction, z == z, running)

            r = plot_variance(z, b[(sigma_row + j) * stride + i])
            s_one, s_two = one[3] + r, two[3] + r
            e_one, e_two = _bounded(z - one[0]), _bounded(z - two[0])
            square_one, square_two = e_one * e_one / s_one, e_two * e_two / s_two
            square_one = square_one if square_one < _UNLIKELY else _UNLIKELY
            square_two = square_two if square_two < _UNLIKELY else _UNLIKELY
            exponent = 0.5 * (square_one - square_two)
            ratio = b[ratio_row * stride + i]
            b[ratio_row * stride + i] = ratio * (s_one / s_two)
            b[exponent_row * stride + i] = b[exponent_row * stride + i] + exponent

    def correct(b: Any, count: int, j: int) -> None:
        """Start or correct the models, and take their mean."""
        quiet_at = (models_row + 2 * j * MODEL) * stride
        maneuver_at = quiet_at + MODEL * stride
        for i in range(min(count, stride)):
            one, two = read(b, quiet_at + i), read(b, maneuver_at + i)
            z = b[(plot_row + j) * stride + i]
            r = plot_variance(z, b[(sigma_row + j) * stride + i])
            plots, gap = b[plots_row * stride + i], b[gap_row * stride + i]
            seen, unknown = z == z, plots == 1.0
            s_one, s_two = one[3] + r, two[3] + r
            e_one, e_two = z - one[0] if seen else 0.0, z - two[0] if seen else 0.0
            gains_one = _gains(one, s_one, seen, unknown, gap)
            gains_two = _gains(two, s_two, seen, unknown, gap)
            one = _corrected(one, e_one, s_one, r, gains_one)
            two = _corrected(two, e_two, s_two, r, gains_two)
            first = seen & (plots == 0.0)
            one = _started(one, z, r, start_22, 0.0, first)
            two = _started(two, z, r, start_22, start_33, first)
            write(b, quiet_at + i, one)
            write(b, maneuver_at + i, two)

            maneuver, last = b[maneuver_row * stride + i], b[(last_row + j) * stride + i]
            for k in range(3):
                gain = gains_one[k] + maneuver * (gains_two[k] - gains_one[k])
                b[(gains_row + k) * stride + i] = b[(gains_row + k) * stride + i] + gain
            x = one[0] + maneuver * (two[0] - one[0])
            b[(x_row + j) * stride + i] = x if seen | (plots > 0.0) else nan
            b[(v_row + j) * stride + i] = one[1] + maneuver * (two[1] - one[1])
            b[(a_row + j) * stride + i] = one[2] + maneuver * (two[2] - one[2])
            b[(last_row + j) * stride + i] = z if seen else last

    return predict, correct
