"""The one recursion: an α-β-γ filter over a block of tracks, for any scheduler.

::

    predict   x⁻ = x + v·T + a·T²/2        v⁻ = v + a·T        a⁻ = a
    correct   e = z − x⁻
              x = x⁻ + α·e                 v = v⁻ + (β/T)·e    a = φ·(a⁻ + (γ/(2T²))·e)

`_advance` holds all of it. Its source runs in two ways with the same result to the last bit:
in plain Python over a list, for streaming and small jobs, and compiled over arrays, for batches.
That is why it is written over a flat sequence, with selects instead of branches, and without any
library call. The state of a block of lanes lies in one buffer, row by row (see `Rows`), so that the
compiler sees constant distances and can work on neighbouring lanes at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.kernels.language import (
    own_numbers,
    promise_independent_turns,
    use_wide_vectors,
)
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.start import axis_end, begin_step, lane_end, velocity_before
from fuzzytrack.lanes.tuples import gather, scatter
from fuzzytrack.schedulers.base import GainScheduler

__all__ = ["steady_function", "step_function"]


def _caller(scheduler: GainScheduler, rows: Rows, stride: int) -> Callable[..., Any]:
    """The scheduler's kernel, called with scalars or, if it is coupled, with tuples.

    A kernel never sees a missing plot: where it is not asked, it gets zeros.
    """
    n_axes = rows.n_axes
    kernel = scheduler.kernel(n_axes)
    last_row, sigma_row = rows.last_plot * stride, rows.sigma * stride
    missed_sigma = math.inf if scheduler.sees_every_step else 1.0
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

    axes = gather(n_axes, 1)

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

    return together


def _advance(
    scheduler: GainScheduler, rows: Rows, two_point: bool, stride: int, settled: bool, results: bool
) -> Callable[[Any, int, Any, float, float], None]:
    """Function that takes lane `i` one step of length `dt` on, after so many plots.

    `own` are numbers of the lane for this step: plots, predictions, innovations, and room for the
    arguments of a coupled kernel, each of all axes.
    """
    n_axes, n_memory = rows.n_axes, rows.n_memory
    call = _caller(scheduler, rows, stride)
    remembered, remember = gather(n_memory, stride), scatter(n_memory, stride)
    end_axis = axis_end(rows, stride, results=results)
    # While a track is running nobody asks for the time since its last plot.
    end_lane = lane_end(
        rows, stride, two_point=two_point, keep_gap=False, settled=settled, results=results
    )
    x_row, v_row, a_row, last_row, gap_row, memory_row = (
        row * stride
        for row in (
            rows.position, rows.velocity, rows.acceleration, rows.last_plot, rows.gap, rows.memory
        )
    )  # fmt: skip
    every_step = scheduler.sees_every_step
    accelerating = scheduler.uses_acceleration

    def advance(b: Any, i: int, own: Any, dt: float, plots: float) -> None:
        seen = True
        for j in range(n_axes):
            z = own[j]
            seen = seen & (z == z)
        dt, gap, running, update = begin_step(plots, b[gap_row + i], dt, seen)
        rate = 1.0 / dt
        # A plot that the kernel is told of, and a step after which its memory is kept.
        told = update | (seen & every_step)
        kept = told | ((plots > 0.0) & every_step)

        for j in range(n_axes):
            at = j * stride + i
            prediction = b[x_row + at] + b[v_row + at] * dt
            if accelerating:
                prediction = prediction + b[a_row + at] * (0.5 * dt * dt)
            own[n_axes + j] = prediction
            own[2 * n_axes + j] = own[j] - prediction if update else 0.0

        memory = remembered(b, memory_row + i)
        alpha, beta, gamma, phi, memory = call(b, i, own, dt, update, told, memory)

        for j in range(n_axes):
            at = j * stride + i
            last, v = b[last_row + at], b[v_row + at]
            z, prediction, e = own[j], own[n_axes + j], own[2 * n_axes + j]
            if accelerating:
                a = b[a_row + at]
                v = v + a * dt
                a_new = phi * (a + (gamma * (0.5 * rate * rate)) * e) if running else 0.0
                b[a_row + at] = a_new if seen else a
            elif not settled:
                b[a_row + at] = 0.0
            v = velocity_before(plots, v, z, last, gap, seen)
            b[v_row + at] = v + (beta * rate) * e if update else v
            end_axis(b, at, z, last, prediction, prediction + alpha * e, e, seen, running)

        remember(b, memory_row + i, memory, kept)
        end_lane(b, i, plots, gap, seen, alpha, beta, gamma)

    return advance


# The loops over axes stand in functions of their own: a variable that outlives a lane makes the
# compiler take the first lane of a block apart from the others.
def _take(own: Any, n_axes: int, source: Any, start: int, stride: int) -> None:
    for j in range(n_axes):
        own[j] = source[start + j * stride]


def _give(own: Any, n_axes: int, target: Any, start: int) -> None:
    """Hand the predictions out, but for that of the last axis."""
    for j in range(n_axes - 1):
        target[start + j] = own[n_axes + j]


def _no_promise() -> None:
    """Lanes of several axes share the memory of their `own_numbers`."""


def step_function(
    scheduler: GainScheduler, rows: Rows, two_point: bool, stride: int
) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes of a buffer, in place.

    Parameters
    ----------
    scheduler : GainScheduler
    rows : Rows
        Layout of the buffer: row `r` of lane `i` is at ``r * stride + i``.
    two_point : bool
        Whether velocity starts from the first two plots, without asking the scheduler.
    stride : int
        Numbers between rows.
    """
    advance = _advance(scheduler, rows, two_point, stride, settled=False, results=True)
    n_axes, size = rows.n_axes, 5 * rows.n_axes
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
    scheduler: GainScheduler, rows: Rows, stride: int, results: bool
) -> Callable[[Any, int, float, Any, Any], None]:
    """As `step_function`, for lanes that have all started and have their time step in common.

    What is known beforehand drops out when it is compiled: divisions by the time step, starts.
    Plots come straight from the job, and predictions go straight into the result.

    Parameters
    ----------
    scheduler, rows, stride
        As there.
    results : bool
        Whether to leave the results in the buffer, too.

    Returns
    -------
    callable
        ``steady(buffer, count, dt, plots, predicted)``. The last two have the axes of a lane side
        by side.
    """
    advance = _advance(scheduler, rows, True, stride, settled=True, results=results)
    n_axes, size, last = rows.n_axes, 5 * rows.n_axes, rows.n_axes - 1
    promise = promise_independent_turns if n_axes == 1 else _no_promise

    def steady(b: Any, count: int, dt: float, plots: Any, predicted: Any) -> None:
        use_wide_vectors()
        own = own_numbers(size)
        for i in range(min(count, stride)):
            _take(own, n_axes, plots, i * n_axes, 1)
            advance(b, i, own, dt, 2.0)
            _give(own, n_axes, predicted, i * n_axes)
            predicted[i * n_axes + last] = own[n_axes + last]
        promise()

    return steady
