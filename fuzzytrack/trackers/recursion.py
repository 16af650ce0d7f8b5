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

from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.trackers.rows import Rows

__all__ = ["steady_function", "step_function"]


def _gather(count: int, stride: int) -> Callable[[Any, int], tuple[float, ...]]:
    """Function that reads `count` numbers, `stride` apart, into a tuple.

    Grown one by one, since compiled code cannot fill a tuple in a loop.
    """
    if count == 0:

        def nothing(buffer: Any, start: int) -> tuple[float, ...]:
            return ()

        return nothing

    before = _gather(count - 1, stride)
    offset = (count - 1) * stride

    def one_more(buffer: Any, start: int) -> tuple[float, ...]:
        return (*before(buffer, start), buffer[start + offset])

    return one_more


def _scatter(count: int, stride: int) -> Callable[[Any, int, tuple[float, ...], bool], None]:
    """Function that writes a tuple to places `stride` apart, or leaves them as they are."""
    if count == 0:

        def nothing(buffer: Any, start: int, values: tuple[float, ...], write: bool) -> None:
            return

        return nothing

    before = _scatter(count - 1, stride)
    last, offset = count - 1, (count - 1) * stride

    def one_more(buffer: Any, start: int, values: tuple[float, ...], write: bool) -> None:
        before(buffer, start, values, write)
        buffer[start + offset] = values[last] if write else buffer[start + offset]

    return one_more


def _caller(scheduler: GainScheduler, rows: Rows, stride: int) -> Callable[..., Any]:
    """The scheduler's kernel, called with scalars or, if it is coupled, with tuples.

    A kernel never sees a missing plot: where it is not asked, it gets zeros.
    """
    n_axes = rows.n_axes
    kernel = scheduler.kernel(n_axes)
    plot_row, last_row, sigma_row, innovation_row = (
        row * stride for row in (rows.plot, rows.last_plot, rows.sigma, rows.innovation)
    )
    missed_sigma = math.inf if scheduler.sees_every_step else 1.0
    if not scheduler.coupled:

        def alone(
            b: Any, i: int, dt: float, update: bool, told: bool, memory: Any
        ) -> tuple[float, float, float, float, tuple[float, ...]]:
            change = b[plot_row + i] - b[last_row + i]
            sigma = b[sigma_row + i]
            return kernel(
                b[innovation_row + i], change if update else 0.0, dt,
                sigma if told else missed_sigma, memory,
            )  # fmt: skip

        return alone

    axes = _gather(n_axes, stride)
    change_row, noise_row = rows.change * stride, rows.noise * stride

    def together(
        b: Any, i: int, dt: float, update: bool, told: bool, memory: Any
    ) -> tuple[float, float, float, float, tuple[float, ...]]:
        for j in range(n_axes):
            at = j * stride + i
            change = b[plot_row + at] - b[last_row + at]
            b[change_row + at] = change if update else 0.0
            sigma = b[sigma_row + at]
            b[noise_row + at] = sigma if told else missed_sigma
        return kernel(
            axes(b, innovation_row + i), axes(b, change_row + i), dt, axes(b, noise_row + i), memory
        )

    return together


def _advance(
    scheduler: GainScheduler, rows: Rows, two_point: bool, stride: int, settled: bool, gains: bool
) -> Callable[[Any, int, float, float], None]:
    """Function that takes lane `i` a step of length `dt` on, after so many plots."""
    n_axes, n_memory = rows.n_axes, rows.n_memory
    call = _caller(scheduler, rows, stride)
    remembered, remember = _gather(n_memory, stride), _scatter(n_memory, stride)
    nan = math.nan
    x_row, v_row, a_row, last_row, gap_row, plots_row, memory_row = (
        row * stride
        for row in (
            rows.position, rows.velocity, rows.acceleration, rows.last_plot, rows.gap, rows.plots,
            rows.memory,
        )
    )  # fmt: skip
    prediction_row, innovation_row, gains_row, plot_row = (
        row * stride for row in (rows.predicted, rows.innovation, rows.gains, rows.plot)
    )
    first_count = 1.0 if two_point else 2.0
    every_step = scheduler.sees_every_step

    def advance(b: Any, i: int, dt: float, plots: float) -> None:
        rate = 1.0 / dt
        seen = True
        for j in range(n_axes):
            z = b[plot_row + j * stride + i]
            seen = seen & (z == z)
        running = plots >= 2.0
        update = seen & running
        # A plot that the kernel is told of, and a step after which its memory is kept.
        told = update | (seen & every_step)
        kept = told | ((plots > 0.0) & every_step)

        for j in range(n_axes):
            at = j * stride + i
            prediction = b[x_row + at] + b[v_row + at] * dt + b[a_row + at] * (0.5 * dt * dt)
            b[prediction_row + at] = prediction
            b[innovation_row + at] = b[plot_row + at] - prediction if update else 0.0

        memory = remembered(b, memory_row + i)
        alpha, beta, gamma, phi, memory = call(b, i, dt, update, told, memory)
        gap = b[gap_row + i] + dt

        for j in range(n_axes):
            at = j * stride + i
            z, last, v, a = b[plot_row + at], b[last_row + at], b[v_row + at], b[a_row + at]
            prediction, e = b[prediction_row + at], b[innovation_row + at]
            moved = v + a * dt
            start = (z - last) / gap if plots == 1.0 else 0.0
            x_new = prediction + alpha * e if running else z
            v_new = moved + (beta * rate) * e if running else start
            a_new = phi * (a + (gamma * (0.5 * rate * rate)) * e) if running else 0.0
            b[x_row + at] = x_new if seen else prediction
            b[v_row + at] = v_new if seen else moved
            b[a_row + at] = a_new if seen else a
            b[last_row + at] = z if seen else last
            b[prediction_row + at] = prediction if running else nan
            b[innovation_row + at] = e if update else nan

        remember(b, memory_row + i, memory, kept)
        if not settled:
            counted = plots + 1.0 if plots > 0.0 else first_count
            counted = counted if counted < 2.0 else 2.0
            b[plots_row + i] = counted if seen else plots
            b[gap_row + i] = 0.0 if seen | running else gap
        if gains:
            b[gains_row + i] = alpha if update else nan
            b[gains_row + stride + i] = beta if update else nan
            b[gains_row + 2 * stride + i] = gamma if update else nan

    return advance


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
    advance = _advance(scheduler, rows, two_point, stride, settled=False, gains=True)
    plots_row, dt_row = rows.plots * stride, rows.dt * stride

    def step(b: Any, count: int) -> None:
        # The compiler sees that no row runs into the next, and works on several lanes at once.
        for i in range(min(count, stride)):
            dt = b[dt_row + i]
            # The first step of a track has no length; its value is not used.
            advance(b, i, dt if dt > 0.0 else 1.0, b[plots_row + i])

    return step


def steady_function(
    scheduler: GainScheduler, rows: Rows, stride: int, gains: bool
) -> Callable[[Any, int, float], None]:
    """As `step_function`, for lanes that have all started and have their time step in common.

    What is known beforehand drops out when it is compiled: divisions by the time step, starts.

    Parameters
    ----------
    scheduler, rows, stride
        As there.
    gains : bool
        Whether to write down the gains.
    """
    advance = _advance(scheduler, rows, True, stride, settled=True, gains=gains)

    def steady(b: Any, count: int, dt: float) -> None:
        for i in range(min(count, stride)):
            advance(b, i, dt, 2.0)

    return steady
