"""The compiled passage of a job: all its lanes, block by block, over all time steps."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.trackers.rows import Rows

__all__ = ["BLOCK", "OUTPUTS", "aligned", "hop_function", "run_function"]

#: Lanes a block, and numbers between the rows of its buffer. A few rows of it stay clear of one
#: another in the cache, where distances count by the remainder of 4,096 bytes.
BLOCK = 248

#: What a passage can write down, in this order.
OUTPUTS = (
    "predicted", "filtered", "velocity", "acceleration", "innovation", "alpha", "beta", "gamma"
)  # fmt: skip


def aligned(count: int) -> NDArray[np.float64]:
    """Zeros that begin with a line of the cache."""
    numbers = np.zeros(count + 8)
    skipped = -(numbers.ctypes.data // 8) % 8
    return numbers[skipped : skipped + count]


# Views first: the compiler sees that their indices cannot be negative, and copies in one go.
def _copy_in(b: Any, row: int, source: Any, start: int, stride: int, count: int) -> None:
    into = b[row : row + count]
    if stride == 0:
        value = source[start]
        for i in range(count):
            into[i] = value
    else:
        out_of = source[start:]
        for i in range(count):
            into[i] = out_of[i * stride]


def _copy_plots(b: Any, row: int, source: Any, start: int, stride: int, count: int) -> int:
    """Copy plots in; how many are infinite."""
    into, out_of, infinite = b[row : row + count], source[start:], 0
    for i in range(count):
        z = out_of[i * stride]
        infinite += (z == math.inf) | (z == -math.inf)
        into[i] = z
    return infinite


def _copy_out(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
    out_of, into = b[row : row + count], target[start:]
    for i in range(count):
        into[i * stride] = out_of[i]


def _all_have(b: Any, row: int, count: int, least: float) -> bool:
    lacking = 0
    for value in b[row : row + count]:
        lacking += value < least
    return lacking == 0


def _never(b: Any, count: int, dt: float) -> None:
    return


def run_function(
    step: Callable[[Any, int], None],
    steady: Callable[[Any, int, float], None] | None,
    gains: bool,
    rows: Rows,
    prepare: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda function: function,
) -> Callable[..., int]:
    """Function that runs the lanes from `first` to before `last` of a job over all time steps.

    Parameters
    ----------
    step, steady : callable
        See `fuzzytrack.trackers.runner.Recursion`, for the stride `BLOCK`.
    gains : bool
        Whether `steady` writes the gains down. The last step does, for the state.
    rows : Rows
    prepare : callable
        Done to the functions that it calls; they are compiled one by one, lest they be inlined into
        each other at every use.
    """
    n_axes, state, kept, block = rows.n_axes, rows.state, rows.kept, BLOCK
    position_row, velocity_row, acceleration_row = rows.position, rows.velocity, rows.acceleration
    predicted_row, innovation_row, gains_row = rows.predicted, rows.innovation, rows.gains
    plot_row, sigma_row, dt_row, plots_row = rows.plot, rows.sigma, rows.dt, rows.plots
    can_be_steady = steady is not None
    step, go_on = prepare(step), prepare(_never if steady is None else steady)
    copy_in, copy_out = prepare(_copy_in), prepare(_copy_out)
    copy_plots, all_have = prepare(_copy_plots), prepare(_all_have)

    def write(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
        """Write a row down, if it is wanted."""
        if len(target):
            copy_out(b, row * block, target, start, stride, count)

    def run(
        b: Any, n_steps: int, lanes: int, first: int, last: int, plots: Any, dts: Any, sigmas: Any,
        dt_strides: Any, sigma_strides: Any, states: Any, outputs: Any,
    ) -> int:  # fmt: skip
        predicted, filtered, velocity, acceleration, innovation, alpha, beta, gamma = outputs
        infinite = 0
        for begin in range(first, last, block):
            count = min(block, last - begin)
            for r in range(state):
                copy_in(b, r * block, states, r * lanes + begin, 1, count)
            settled = False
            for k in range(n_steps):
                for j in range(n_axes):
                    start = (k * lanes + begin) * n_axes + j
                    infinite += copy_plots(b, (plot_row + j) * block, plots, start, n_axes, count)
                    if (k == 0) | (sigma_strides[0] > 0):
                        start = k * sigma_strides[0] + begin * sigma_strides[1]
                        start += j * sigma_strides[2]
                        copy_in(b, (sigma_row + j) * block, sigmas, start, sigma_strides[1], count)
                start = k * dt_strides[0] + begin * dt_strides[1]
                if settled & (gains | (k < n_steps - 1)):
                    go_on(b, count, dts[start])
                else:
                    copy_in(b, dt_row * block, dts, start, dt_strides[1], count)
                    step(b, count)
                    settled = can_be_steady & (dt_strides[1] == 0)
                    settled = settled and all_have(b, plots_row * block, count, 2.0)
                start = k * lanes + begin
                for j in range(n_axes):
                    at = start * n_axes + j
                    write(b, predicted_row + j, predicted, at, n_axes, count)
                    write(b, position_row + j, filtered, at, n_axes, count)
                    write(b, velocity_row + j, velocity, at, n_axes, count)
                    write(b, acceleration_row + j, acceleration, at, n_axes, count)
                    write(b, innovation_row + j, innovation, at, n_axes, count)
                write(b, gains_row, alpha, start, 1, count)
                write(b, gains_row + 1, beta, start, 1, count)
                write(b, gains_row + 2, gamma, start, 1, count)
            for r in range(kept):
                copy_out(b, r * block, states, r * lanes + begin, 1, count)
        return infinite

    return run


def hop_function(
    step: Callable[[Any, int], None],
    rows: Rows,
    prepare: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda function: function,
) -> Callable[..., int]:
    """Function that does one step of all lanes, with one time step and one sigma for all.

    It is what `run_function` makes, cut down to what a track that comes plot by plot needs.
    """
    n_axes, state, kept, block = rows.n_axes, rows.state, rows.kept, BLOCK
    plot_row, sigma_row, dt_row = rows.plot * block, rows.sigma * block, rows.dt * block
    step, copy_plots = prepare(step), prepare(_copy_plots)
    copy_in, copy_out = prepare(_copy_in), prepare(_copy_out)

    def hop(b: Any, lanes: int, old: Any, plots: Any, dt: float, sigma: float, new: Any) -> int:
        before, after, infinite = old.reshape(-1), new.reshape(-1), 0
        for begin in range(0, lanes, block):
            count = min(block, lanes - begin)
            for r in range(state):
                copy_in(b, r * block, before, r * lanes + begin, 1, count)
            for j in range(n_axes):
                row, start = plot_row + j * block, begin * n_axes + j
                infinite += copy_plots(b, row, plots, start, n_axes, count)
                for i in range(count):
                    b[sigma_row + j * block + i] = sigma
            for i in range(count):
                b[dt_row + i] = dt
            step(b, count)
            for r in range(kept):
                copy_out(b, r * block, after, r * lanes + begin, 1, count)
        return infinite

    return hop
