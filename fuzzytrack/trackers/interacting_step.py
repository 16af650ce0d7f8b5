"""The step of interacting models that share one covariance between all axes of a track.

The same functions run in plain Python over a list and compiled over arrays, with the same results
to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.gains.singer import correct_optimally
from fuzzytrack.kernels.exponential import exponential
from fuzzytrack.kernels.language import own_numbers, use_wide_vectors
from fuzzytrack.lanes.start import axis_results, begin_step, lane_end
from fuzzytrack.lanes.tuples import gather
from fuzzytrack.trackers.model_mixing import FAR, Part, covariance_writer, in_turn, mover
from fuzzytrack.trackers.model_set import COVARIANCE, UNITS, ModelRows, ModelSet

__all__ = ["step_function"]

#: What each probability is raised by after a plot, so that no model is ever lost.
_LEAST = 1e-7


def step_function(numbers: ModelSet, places: ModelRows, stride: int) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes of a buffer, in place.

    Parameters
    ----------
    numbers : ModelSet
    places : ModelRows
    stride : int
        Numbers between rows.
    """
    correct = _corrected(places, stride)

    def corrected(j: int) -> Part:
        model, moved, p_row, gain_row = (
            places.model(j), places.moved(j), places.probability + j, places.scratch("gain") + 3 * j
        )  # fmt: skip
        accelerates = numbers.models[j].accelerates
        q = (numbers.start_acceleration if accelerates else numbers.models[j].noise) ** 2
        return lambda b, i: correct(b, i, model, moved, p_row, gain_row, q, accelerates)

    advance = in_turn([
        _begin(numbers, places, stride),
        mover(numbers, places, stride, _bounded),
        _measure(numbers, places, stride),
        _judge(numbers, places, stride),
        *map(corrected, range(places.n_models)),
        _end(places, stride),
    ])  # fmt: skip

    def step(b: Any, count: int) -> None:
        use_wide_vectors()
        # The compiler sees that no row runs into the next, and works on several lanes at once.
        for i in range(min(count, stride)):
            advance(b, i)

    return step


def _bounded(value: float) -> float:
    value = value if value < FAR else FAR
    return value if value > -FAR else -FAR


def _begin(numbers: ModelSet, places: ModelRows, stride: int) -> Part:
    """What a step is, and the variance of its plot."""
    rows, n_axes, nan = places.rows, places.n_axes, math.nan
    plot_row, sigma_row, dt_row, gap_row, plots_row = (
        rows.plot, rows.sigma, rows.dt, rows.gap, rows.plots
    )  # fmt: skip
    variance_row, pace_row = places.scratch("plot_variance"), places.scratch("pace")
    fixed = numbers.plot_variance is not None
    variance = 1.0 if numbers.plot_variance is None else numbers.plot_variance

    def begin(b: Any, i: int) -> None:
        seen, total = True, 0.0
        for j in range(n_axes):
            z, sigma = b[(plot_row + j) * stride + i], b[(sigma_row + j) * stride + i]
            seen, total = seen & (z == z), total + sigma * sigma
        for j in range(n_axes):
            z = b[(plot_row + j) * stride + i]
            b[(plot_row + j) * stride + i] = z if seen else nan
        r = variance if fixed else total / n_axes
        b[variance_row * stride + i] = r if seen else 1.0
        dt, gap, _, _ = begin_step(
            b[plots_row * stride + i], b[gap_row * stride + i], b[dt_row * stride + i], seen
        )
        b[dt_row * stride + i], b[gap_row * stride + i] = dt, gap
        b[pace_row * stride + i] = 1.0 / gap

    return begin


def _measure(numbers: ModelSet, places: ModelRows, stride: int) -> Part:
    """Units of the track; the interval before a plot does not count for its own prediction."""
    rows, a0 = places.rows, numbers.acceleration
    plot_row, gap_row, plots_row = rows.plot, rows.gap, rows.plots
    first_row, rate_row, noise_row, intervals_row = range(rows.memory, rows.memory + UNITS)
    variance_row = places.scratch("plot_variance")
    declared, level = a0 is not None, a0 or 0.0

    def measure(b: Any, i: int) -> None:
        z, plots = b[plot_row * stride + i], b[plots_row * stride + i]
        gap, rate = b[gap_row * stride + i], b[rate_row * stride + i]
        seen = z == z
        new = seen & (plots == 0.0)
        r, first = b[variance_row * stride + i], b[first_row * stride + i]
        first = r if new else first
        b[first_row * stride + i] = first
        if declared:
            b[rate_row * stride + i] = math.sqrt(level / math.sqrt(first)) if new else rate
            b[noise_row * stride + i] = level * level
        else:
            intervals, later = b[intervals_row * stride + i], seen & (plots > 0.0)
            total = intervals / rate if intervals > 0.0 else 0.0
            rate = (intervals + 1.0) / (total + gap) if later else rate
            b[rate_row * stride + i] = rate
            b[noise_row * stride + i] = first * (rate * rate) * (rate * rate)
            b[intervals_row * stride + i] = intervals + 1.0 if later else intervals

    return measure


def _judge(numbers: ModelSet, places: ModelRows, stride: int) -> Part:
    """Predictions, and probabilities after the plot."""
    rows, n, n_axes, size = places.rows, places.n_models, places.n_axes, places.size
    p_row, c_row, moved_row = places.probability, places.scratch("chance"), places.moved(0)
    plot_row, plots_row = rows.plot, rows.plots
    variance_row = places.scratch("plot_variance")
    fitting, likelihood = _likelihood(numbers.half_freedom, n_axes)
    write_results, least, lowest = axis_results(rows, stride), _LEAST, -math.inf
    n_own, all_least = 3 * n, 1.0 / (1.0 + n * _LEAST)

    def judge(b: Any, i: int) -> None:
        own = own_numbers(n_own)
        running = b[plots_row * stride + i] >= 2.0
        seen = True
        for k in range(n_axes):
            z, x = b[(plot_row + k) * stride + i], b[(moved_row + k) * stride + i]
            seen = z == z
            apart = 0.0
            for j in range(n):
                other = b[(moved_row + j * size + k) * stride + i]
                apart = apart + b[(c_row + j) * stride + i] * (other - x)
            x = x + apart
            write_results(b, k * stride + i, x, z - x, seen, running)

        r, best, narrowest = b[variance_row * stride + i], lowest, 0.0
        for j in range(n):
            p11 = b[(moved_row + j * size + 3 * n_axes) * stride + i]
            square = 0.0
            for k in range(n_axes):
                z = b[(plot_row + k) * stride + i]
                e = _bounded(z - b[(moved_row + j * size + k) * stride + i])
                square = square + e * e
            fit, inverse = fitting((p11 if p11 > 0.0 else 0.0) + r, square if seen else 0.0)
            own[j], own[n + j] = fit, inverse
            best = fit if fit > best else best
            narrowest = inverse if inverse > narrowest else narrowest
        total, width = 0.0, 1.0 / narrowest
        for j in range(n):
            weight = likelihood(own[j], best, own[n + j] * width)
            weight = weight * b[(c_row + j) * stride + i]
            own[2 * n + j] = weight
            total = total + weight
        update = seen & running
        scale = 1.0 / (total if total > 0.0 else 1.0)
        for j in range(n):
            chance, before = b[(c_row + j) * stride + i], b[(p_row + j) * stride + i]
            before = chance if running else before
            after = (own[2 * n + j] * scale + least) * all_least
            b[(p_row + j) * stride + i] = after if update else before

    return judge


def _likelihood(
    half_freedom: int | None, n_axes: int
) -> tuple[Callable[[float, float], tuple[float, float]], Callable[[float, float, float], float]]:
    """Functions for the likelihood of a plot, up to a factor that all models have in common.

    The first one makes two numbers of S and e'e: how well the model fits, and 1/S, or what stands
    for it. The second one makes the likelihood of the first, the greatest of all models, and the
    quotient of the second and its greatest. No quotient is larger than 1, however large the
    innovations are.
    """
    halves, odd = n_axes // 2, n_axes % 2 == 1

    def root_power(x: float) -> float:
        y = math.sqrt(x) if odd else 1.0
        for _ in range(halves):
            y = y * x
        return y

    if half_freedom is None:

        def exponent(s: float, square: float) -> tuple[float, float]:
            inverse = 1.0 / s
            return -0.5 * square * inverse, inverse

        def gaussian(fit: float, best: float, narrow: float) -> float:
            worse = fit - best
            return root_power(narrow) * exponential(worse if worse > -300.0 else -300.0)

        return exponent, gaussian

    freedom = 2.0 * half_freedom

    def share(s: float, square: float) -> tuple[float, float]:
        inverse = 1.0 / (freedom * s + square)
        return s * inverse, inverse

    def student(fit: float, best: float, narrow: float) -> float:
        # Where the likelihood of all models underflows, none is better.
        ratio, y = fit / best if best > 0.0 else 1.0, root_power(narrow)
        for _ in range(half_freedom):
            y = y * ratio
        return y

    return share, student


def _corrected(
    places: ModelRows, stride: int
) -> Callable[[Any, int, int, int, int, int, float, bool], None]:
    """Function that starts or corrects a model."""
    rows, n_axes, infinity = places.rows, places.n_axes, math.inf
    plot_row, last_row, dt_row, gap_row, plots_row = (
        rows.plot, rows.last_plot, rows.dt, rows.gap, rows.plots
    )  # fmt: skip
    first_row, pace_row = rows.memory, places.scratch("pace")
    variance_row, noise_row = places.scratch("plot_variance"), places.noise_unit
    read, write = gather(COVARIANCE, stride), covariance_writer(stride)

    def correct(
        b: Any, i: int, model_row: int, moved_row: int, p_row: int, gain_row: int, begun: float,
        accelerates: bool,
    ) -> None:  # fmt: skip
        # All values first, then selections: the compiler turns longer expressions in a selection
        # into branches.
        plots, gap, z = b[plots_row * stride + i], b[gap_row * stride + i], b[plot_row * stride + i]
        seen, running = z == z, plots >= 2.0
        second = seen & (plots == 1.0)
        r, pace = b[variance_row * stride + i], b[pace_row * stride + i]
        p11, p12, p13, p22, p23, p33 = read(b, (moved_row + 3 * n_axes) * stride + i)
        p11 = p11 if p11 > 0.0 else 0.0
        variance = r if seen else infinity
        k1, k2, k3, after = correct_optimally(p11, p12, p13, p22, p23, p33, variance)
        for k in range(n_axes):
            z, last = b[(plot_row + k) * stride + i], b[(last_row + k) * stride + i]
            m = k * stride + i
            x, v = b[moved_row * stride + m], b[(moved_row + n_axes) * stride + m]
            a = b[(moved_row + 2 * n_axes) * stride + m]
            e, slope = z - x, (z - last) * pace
            e = e if seen else 0.0
            x, v, a = x + k1 * e, v + k2 * e, a + k3 * e
            first_x, first_v = z if seen else last, slope if second else 0.0
            b[model_row * stride + m] = x if running else first_x
            b[(model_row + n_axes) * stride + m] = v if running else first_v
            b[(model_row + 2 * n_axes) * stride + m] = a if running else 0.0

        q = begun * b[noise_row * stride + i]
        s12, s22 = r * pace, (b[first_row * stride + i] + r) * pace * pace + 0.25 * q * gap * gap
        s33 = q if accelerates else 0.0
        s23 = 0.5 * s33 * gap
        n11, n12, n13, n22, n23, n33 = after
        after = (
            n11 if running else r, n12 if running else s12, n13 if running else 0.0,
            n22 if running else s22, n23 if running else s23, n33 if running else s33,
        )  # fmt: skip
        write(b, (model_row + 3 * n_axes) * stride + i, after)

        p, dt = b[p_row * stride + i], b[dt_row * stride + i]
        b[gain_row * stride + i] = p * k1
        b[(gain_row + 1) * stride + i] = p * (k2 * dt)
        b[(gain_row + 2) * stride + i] = p * (2.0 * k3 * dt * dt)

    return correct


def _end(places: ModelRows, stride: int) -> Part:
    """Mean of the models, and the count of the plot."""
    rows, n, n_axes, size = places.rows, places.n_models, places.n_axes, places.size
    model_row, p_row, nan = places.model(0), places.probability, math.nan
    plot_row, last_row, gap_row, plots_row = rows.plot, rows.last_plot, rows.gap, rows.plots
    gain_row, end_lane = places.scratch("gain"), lane_end(rows, stride)

    def end(b: Any, i: int) -> None:
        plots, z = b[plots_row * stride + i], b[plot_row * stride + i]
        seen = z == z
        for k in range(n_axes):
            z, last = b[(plot_row + k) * stride + i], b[(last_row + k) * stride + i]
            b[(last_row + k) * stride + i] = z if seen else last
        # Positions, velocities, accelerations: in the same order in a state and in a model.
        for k in range(3 * n_axes):
            first, apart = b[(model_row + k) * stride + i], 0.0
            for j in range(n):
                other = b[(model_row + j * size + k) * stride + i]
                apart = apart + b[(p_row + j) * stride + i] * (other - first)
            known = seen | (plots > 0.0) | (k >= n_axes)
            b[k * stride + i] = first + apart if known else nan
        alpha, beta, gamma = 0.0, 0.0, 0.0
        for j in range(n):
            at = (gain_row + 3 * j) * stride + i
            alpha = alpha + b[at]
            beta = beta + b[at + stride]
            gamma = gamma + b[at + 2 * stride]
        end_lane(b, i, plots, b[gap_row * stride + i], seen, alpha, beta, gamma)

    return end
