"""The one recursion: an α-β-γ filter over a block of tracks, for any scheduler.

::

    predict   x⁻ = x + v·T + a·T²/2        v⁻ = v + a·T        a⁻ = a
    correct   e = z − x⁻
              x = x⁻ + α·e                 v = v⁻ + (β/T)·e    a = φ·(a⁻ + (γ/(2T²))·e)

`step_function` holds all of it. Its source runs in two ways with the same result to the last bit:
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

__all__ = ["step_function"]


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


def _caller(scheduler: GainScheduler, n_axes: int, block: int) -> Callable[..., Any]:
    """The scheduler's kernel, called with scalars or, if it is coupled, with tuples."""
    kernel = scheduler.kernel(n_axes)
    if not scheduler.coupled:

        def alone(
            b: Any, innovation: int, change: int, dt: float, sigma: int, memory: Any
        ) -> tuple[float, float, float, float, tuple[float, ...]]:
            return kernel(b[innovation], b[change], dt, b[sigma], memory)

        return alone

    axes = _gather(n_axes, block)

    def together(
        b: Any, innovation: int, change: int, dt: float, sigma: int, memory: Any
    ) -> tuple[float, float, float, float, tuple[float, ...]]:
        return kernel(axes(b, innovation), axes(b, change), dt, axes(b, sigma), memory)

    return together


def step_function(
    scheduler: GainScheduler, rows: Rows, two_point: bool, block: int
) -> Callable[[Any], None]:
    """Function that does one time step of a block, in place in its buffer.

    Parameters
    ----------
    scheduler : GainScheduler
    rows : Rows
        Layout of the buffer: row `r` of lane `i` is at ``r * block + i``.
    two_point : bool
        Whether velocity starts from the first two plots, without asking the scheduler.
    block : int
        Number of lanes.
    """
    n_axes, n_memory = rows.n_axes, rows.n_memory
    call = _caller(scheduler, n_axes, block)
    remembered, remember = _gather(n_memory, block), _scatter(n_memory, block)
    nan = math.nan
    x_row, v_row, a_row = rows.position, rows.velocity, rows.acceleration
    last_row, gap_row, plots_row, memory_row = rows.last_plot, rows.gap, rows.plots, rows.memory
    prediction_row, innovation_row, gains_row = rows.predicted, rows.innovation, rows.gains
    plot_row, sigma_row, change_row, dt_row = rows.plot, rows.sigma, rows.change, rows.dt
    first_count = 1.0 if two_point else 2.0
    every_step = scheduler.sees_every_step
    missed_sigma = math.inf if every_step else 1.0

    def step(b: Any) -> None:
        for i in range(block):
            dt = b[dt_row * block + i]
            # The first step of a track has no length; its value is not used.
            dt = dt if dt > 0.0 else 1.0
            gap = b[gap_row * block + i] + dt
            plots = b[plots_row * block + i]
            seen = True
            for j in range(n_axes):
                z = b[(plot_row + j) * block + i]
                seen = seen & (z == z)
            running = plots >= 2.0
            update = seen & running
            # A plot that the kernel is told of, and a step after which its memory is kept.
            told = update | (seen & every_step)
            kept = told | ((plots > 0.0) & every_step)

            for j in range(n_axes):
                x = b[(x_row + j) * block + i]
                v = b[(v_row + j) * block + i]
                a = b[(a_row + j) * block + i]
                z = b[(plot_row + j) * block + i]
                prediction = x + v * dt + a * (0.5 * dt * dt)
                b[(prediction_row + j) * block + i] = prediction
                # A kernel never sees a missing plot: where it is not asked, it gets zeros.
                b[(innovation_row + j) * block + i] = z - prediction if update else 0.0
                change = z - b[(last_row + j) * block + i]
                b[(change_row + j) * block + i] = change if update else 0.0
                sigma = b[(sigma_row + j) * block + i]
                b[(sigma_row + j) * block + i] = sigma if told else missed_sigma

            memory = remembered(b, memory_row * block + i)
            alpha, beta, gamma, phi, memory = call(
                b, innovation_row * block + i, change_row * block + i, dt,
                sigma_row * block + i, memory,
            )  # fmt: skip

            for j in range(n_axes):
                z = b[(plot_row + j) * block + i]
                last = b[(last_row + j) * block + i]
                v = b[(v_row + j) * block + i]
                a = b[(a_row + j) * block + i]
                prediction = b[(prediction_row + j) * block + i]
                e = b[(innovation_row + j) * block + i]
                moved = v + a * dt
                start = (z - last) / gap if plots == 1.0 else 0.0
                x_new = prediction + alpha * e if running else z
                v_new = moved + (beta / dt) * e if running else start
                a_new = phi * (a + (gamma / (2.0 * dt * dt)) * e) if running else 0.0
                b[(x_row + j) * block + i] = x_new if seen else prediction
                b[(v_row + j) * block + i] = v_new if seen else moved
                b[(a_row + j) * block + i] = a_new if seen else a
                b[(last_row + j) * block + i] = z if seen else last
                b[(prediction_row + j) * block + i] = prediction if running else nan
                b[(innovation_row + j) * block + i] = e if update else nan

            remember(b, memory_row * block + i, memory, kept)
            counted = plots + 1.0 if plots > 0.0 else first_count
            counted = counted if counted < 2.0 else 2.0
            b[plots_row * block + i] = counted if seen else plots
            b[gap_row * block + i] = 0.0 if seen else gap
            b[gains_row * block + i] = alpha if update else nan
            b[(gains_row + 1) * block + i] = beta if update else nan
            b[(gains_row + 2) * block + i] = gamma if update else nan

    return step
