"""The step of an α-β-γ filter with the gains of any scheduler.

::

    predict   a⁻ = φ·a   φ = fade(T/τ)    x⁻ = x + v·T + a⁻·T²/2    v⁻ = v + a⁻·T
    correct   e = z − x⁻
              x = x⁻ + α·e                v = v⁻ + (β/T)·e          a = a⁻ + (γ/(2T²))·e

The retention time τ is that of the last plot, from a scheduler that sets one; otherwise φ is 1 and
not computed. T is the time from that of the state: its last plot, or with ``missed="step"`` its
last step.

`_advance` makes the function that does this for one lane. The same source runs in plain Python
over a list, for streaming and small jobs, and compiled over arrays, for batches, with the same
results to the last bit. So it works on a flat sequence, in which the numbers of a block of lanes
lie row by row (see `Rows`), with selections (``a if condition else b``) instead of branches: the
compiler can then work on neighboring lanes at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fuzzytrack.gains.singer import fade
from fuzzytrack.kernels.language import (
    own_numbers,
    promise_independent_turns,
    use_wide_vectors,
)
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.start import (
    axis_results,
    axis_shown,
    begin_step,
    gain_results,
    lane_end,
    velocity_before,
)
from fuzzytrack.lanes.tuples import gather, scatter
from fuzzytrack.schedulers.base import GainScheduler

__all__ = ["StepWay", "steady_function", "step_function"]


@dataclass(frozen=True, eq=False)
class StepWay:
    """What decides how the steps of an α-β-γ filter are done.

    Attributes
    ----------
    scheduler : GainScheduler
    two_point : bool
        Whether velocity starts from the first two plots; otherwise it starts at 0, and the
        scheduler corrects it from the second plot on.
    elapsed : bool
        Whether a missed plot leaves the state as it was.
    """

    scheduler: GainScheduler
    two_point: bool
    elapsed: bool


def _caller(scheduler: GainScheduler, rows: Rows, stride: int) -> Callable[..., Any]:
    """The scheduler's kernel, called with scalars or, if it is coupled, with tuples.

    It gets zeros where there is no plot or no prediction; then its answer is dropped.
    """
    n_axes = rows.n_axes
    kernel = scheduler.kernel(n_axes)
    last_row, sigma_row = rows.last_plot * stride, rows.sigma * stride
    missed_sigma = math.inf if _follows(scheduler) else 1.0
    if not scheduler.coupled:

        def alone(
            b: Any, i: int, own: Any, dt: float, update: bool, told: bool, memory: Any
        ) -> tuple[float, float, float, float, tuple[float, ...]]:
            change = own[0] - b[last_row + i]
            sigma = b[sigma_row + i]
            return kernel(
                own[2], change if update else 0.0, dt, sigma if told else missed_sigma, memory
            )

        return alone

    axes, spread = gather(n_axes, 1), scatter(n_axes, 1)

    def together(
        b: Any, i: int, own: Any, dt: float, update: bool, told: bool, memory: Any
    ) -> tuple[float, float, float, float, tuple[float, ...]]:
        for j in range(n_axes):
            at = j * stride + i
            change = own[j] - b[last_row + at]
            own[3 * n_axes + j] = change if update else 0.0
            sigma = b[sigma_row + at]
            own[4 * n_axes + j] = sigma if told else missed_sigma
        return kernel(
            axes(own, 2 * n_axes), axes(own, 3 * n_axes), dt, axes(own, 4 * n_axes), memory
        )

    if not scheduler.own_gains:
        return together

    def each(
        b: Any, i: int, own: Any, dt: float, update: bool, told: bool, memory: Any
    ) -> tuple[float, float, float, float, tuple[float, ...]]:
        answer: Any = together(b, i, own, dt, update, told, memory)
        alpha, beta, gamma, retention, memory = answer
        spread(own, 5 * n_axes, alpha, True)
        spread(own, 6 * n_axes, beta, True)
        spread(own, 7 * n_axes, gamma, True)
        # The gains of each axis are now where `_picker` finds them.
        return 0.0, 0.0, 0.0, retention, memory

    return each


def _picker(scheduler: GainScheduler, n_axes: int) -> Callable[..., tuple[float, float, float]]:
    """Function from the answer of `_caller` to the gains of axis `j`."""

    def shared(
        own: Any, j: int, alpha: float, beta: float, gamma: float
    ) -> tuple[float, float, float]:
        return alpha, beta, gamma

    def each(
        own: Any, j: int, alpha: float, beta: float, gamma: float
    ) -> tuple[float, float, float]:
        return own[5 * n_axes + j], own[6 * n_axes + j], own[7 * n_axes + j]

    return each if scheduler.own_gains else shared


def _room(scheduler: GainScheduler, n_axes: int) -> int:
    """How many numbers of its own a lane needs for a step, see `_advance`."""
    return (8 if scheduler.own_gains else 5) * n_axes


def _follows(scheduler: GainScheduler) -> bool:
    """Whether a scheduler's memory is kept at steps that need no gains."""
    return scheduler.sees_starts or scheduler.sees_misses


def _advance(
    way: StepWay, rows: Rows, stride: int, settled: bool, results: bool
) -> Callable[[Any, int, Any, float, float], None]:
    """Function that takes lane `i` one step of length `dt` on, after so many plots.

    `own` are numbers of the lane for this step: plots, predictions, innovations, room for the
    arguments of a coupled kernel, and for gains, each of all axes.
    """
    scheduler, elapsed = way.scheduler, way.elapsed
    n_axes, fades, own_gains = rows.n_axes, scheduler.uses_retention, scheduler.own_gains
    # The retention time follows the memory of the scheduler.
    n_memory = rows.n_memory - fades
    call = _caller(scheduler, rows, stride)
    remembered, remember = gather(n_memory, stride), scatter(n_memory, stride)
    write_results, show = axis_results(rows, stride), axis_shown(rows, stride)
    pick, write_gains = _picker(scheduler, n_axes), gain_results(rows, stride)
    # The time since the last plot is used at the second plot only.
    end_lane = lane_end(
        rows, stride, two_point=way.two_point, keep_gap=False, count_gap=not elapsed,
        settled=settled, results=results and not own_gains,
    )  # fmt: skip
    x_row, v_row, a_row, last_row, gap_row, memory_row = (
        row * stride
        for row in (
            rows.position, rows.velocity, rows.acceleration, rows.last_plot, rows.gap, rows.memory
        )
    )  # fmt: skip
    retention_row = memory_row + n_memory * stride
    every_step = _follows(scheduler)
    follows_misses = scheduler.sees_misses if elapsed else every_step
    accelerating = scheduler.uses_acceleration

    def advance(b: Any, i: int, own: Any, dt: float, plots: float) -> None:
        seen = True
        for j in range(n_axes):
            z = own[j]
            seen = seen & (z == z)
        dt, gap, running, update = begin_step(plots, b[gap_row + i], dt, seen)
        rate = 1.0 / dt
        # Whether the kernel is given the plot's sigma, and whether its memory is kept.
        told = update | (seen & every_step)
        kept = told | ((plots > 0.0) & (not seen) & follows_misses)

        phi = fade(dt / b[retention_row + i]) if fades else 1.0
        for j in range(n_axes):
            at = j * stride + i
            prediction = b[x_row + at] + b[v_row + at] * dt
            if accelerating:
                a = phi * b[a_row + at] if fades else b[a_row + at]
                prediction = prediction + a * (0.5 * dt * dt)
            own[n_axes + j] = prediction
            own[2 * n_axes + j] = own[j] - prediction if update else 0.0

        memory = remembered(b, memory_row + i)
        alpha, beta, gamma, retention, memory = call(b, i, own, dt, update, told, memory)

        for j in range(n_axes):
            at = j * stride + i
            last, x_last, v_last, a_last = (
                b[last_row + at], b[x_row + at], b[v_row + at], b[a_row + at]
            )  # fmt: skip
            z, prediction, e = own[j], own[n_axes + j], own[2 * n_axes + j]
            alpha_j, beta_j, gamma_j = pick(own, j, alpha, beta, gamma)
            v, a = v_last, 0.0
            if accelerating:
                a = phi * a_last if fades else a_last
                v = v + a * dt
                a_new = a + (gamma_j * (0.5 * rate * rate)) * e if running else 0.0
                a = a_new if seen else a
            v = velocity_before(plots, v, z, last, gap, seen)
            v = v + (beta_j * rate) * e if update else v
            x = prediction + alpha_j * e if running else z
            x = x if seen else prediction
            # A missed plot leaves the state as it was.
            follows_time = seen | (not elapsed)
            b[x_row + at] = x if follows_time else x_last
            b[v_row + at] = v if follows_time else v_last
            if accelerating:
                b[a_row + at] = a if follows_time else a_last
            elif not settled:
                b[a_row + at] = 0.0
            b[last_row + at] = z if seen else last
            if results:
                write_results(b, at, prediction, e, seen, running)
                if own_gains:
                    write_gains(b, at, update, alpha_j, beta_j, gamma_j)
                if elapsed:
                    show(b, at, x, v, a)

        remember(b, memory_row + i, memory, kept)
        if fades:
            b[retention_row + i] = retention if told else b[retention_row + i]
        end_lane(b, i, plots, gap, seen, alpha, beta, gamma)

    return advance


# These loops over axes are functions of their own: with a loop variable that is still there at the
# next lane, the compiler treats the first lane of a block apart from the others.
def _take(own: Any, n_axes: int, source: Any, start: int, stride: int) -> None:
    for j in range(n_axes):
        own[j] = source[start + j * stride]


def _give(own: Any, n_axes: int, target: Any, start: int) -> None:
    """Write the predictions of all axes but the last one."""
    for j in range(n_axes - 1):
        target[start + j] = own[n_axes + j]


def _no_promise() -> None:
    """Do nothing: lanes of several axes are not independent, they share their `own_numbers`."""


def step_function(way: StepWay, rows: Rows, stride: int) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes of a buffer, in place.

    Parameters
    ----------
    way : StepWay
    rows : Rows
        Layout of the buffer: row `r` of lane `i` is at ``r * stride + i``.
    stride : int
        Numbers between rows.
    """
    advance = _advance(way, rows, stride, settled=False, results=True)
    n_axes, size = rows.n_axes, _room(way.scheduler, rows.n_axes)
    plot_row, plots_row, dt_row = (row * stride for row in (rows.plot, rows.plots, rows.dt))

    def step(b: Any, count: int) -> None:
        use_wide_vectors()
        own = own_numbers(size)
        # The compiler sees that no row runs into the next, and works on several lanes at once.
        for i in range(min(count, stride)):
            _take(own, n_axes, b, plot_row + i, stride)
            advance(b, i, own, b[dt_row + i], b[plots_row + i])

    return step


def steady_function(
    way: StepWay, rows: Rows, stride: int, results: bool, common: bool
) -> Callable[[Any, int, float, Any, Any], None]:
    """As `step_function`, for lanes that have all started.

    The compiler removes what is the same for all of them: starts, and divisions by a time step that
    they have in common. Plots are read from the arrays of the job, and predictions are written into
    its result.

    Parameters
    ----------
    way, rows, stride
        As there.
    results : bool
        Whether to write the other results into the buffer.
    common : bool
        Whether the time step is the one that the function is given; otherwise that in the buffer.

    Returns
    -------
    callable
        ``steady(buffer, count, dt, plots, predicted)``; the axes of a lane are side by side in
        `plots` and `predicted`.
    """
    advance = _advance(way, rows, stride, settled=True, results=results)
    n_axes, size, last = rows.n_axes, _room(way.scheduler, rows.n_axes), rows.n_axes - 1
    dt_row = rows.dt * stride
    promise = promise_independent_turns if n_axes == 1 else _no_promise

    def steady(b: Any, count: int, dt: float, plots: Any, predicted: Any) -> None:
        use_wide_vectors()
        own = own_numbers(size)
        for i in range(min(count, stride)):
            _take(own, n_axes, plots, i * n_axes, 1)
            advance(b, i, own, dt if common else b[dt_row + i], 2.0)
            _give(own, n_axes, predicted, i * n_axes)
            predicted[i * n_axes + last] = own[n_axes + last]
        promise()

    return steady
