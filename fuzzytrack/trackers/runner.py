"""The one recursion: an α-β-γ filter over a block of tracks, for any scheduler.

::

    predict   x⁻ = x + v·T + a·T²/2        v⁻ = v + a·T        a⁻ = a
    correct   e = z − x⁻
              x = x⁻ + α·e                 v = v⁻ + (β/T)·e    a = φ·(a⁻ + (γ/(2T²))·e)

`_step_function` holds all of it. Its source runs in two ways with the same result to the last bit:
in plain Python over a list, for streaming and small jobs, and compiled over arrays, for batches.
That is why it is written over a flat sequence, with selects instead of branches, and without any
library call.

A *lane* is what gets its own gains: one axis of one track, or with a coupled scheduler the whole
track. A *block* is a fixed number of lanes, whose state lies in one buffer, row by row, so that the
compiler sees constant distances and can work on neighbouring lanes at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.trackers.native import compiled

__all__ = ["Rows", "Runner", "runner"]

Array = NDArray[np.float64]

#: Lanes a block. Rows 4,096 bytes apart would share cache sets and evict one another.
BLOCK = 248
#: Lane-updates above which compiling pays; below, plain Python is done sooner.
COMPILE_ABOVE = 100_000


@dataclass(frozen=True)
class Rows:
    """Where things lie in the buffer of a lane: row numbers, by number of axes and memory.

    The first `state` rows are what a track remembers; the rest is scratch of one step.
    """

    n_axes: int
    n_memory: int

    @property
    def position(self) -> int:
        """First of `n_axes` rows; velocity, acceleration and last plot follow in that order."""
        return 0

    @property
    def velocity(self) -> int:
        """Velocity (m/s)."""
        return self.n_axes

    @property
    def acceleration(self) -> int:
        """Acceleration (m/s²)."""
        return 2 * self.n_axes

    @property
    def last_plot(self) -> int:
        """Last plot seen (m)."""
        return 3 * self.n_axes

    @property
    def gap(self) -> int:
        """Time since the last plot seen (s)."""
        return 4 * self.n_axes

    @property
    def plots(self) -> int:
        """Plots seen, counted up to 2."""
        return 4 * self.n_axes + 1

    @property
    def memory(self) -> int:
        """First of `n_memory` rows of the scheduler."""
        return 4 * self.n_axes + 2

    @property
    def state(self) -> int:
        """Number of rows that make up the state."""
        return 4 * self.n_axes + 2 + self.n_memory

    @property
    def plot(self) -> int:
        """First row of scratch: plot, sigma, prediction, innovation, change, an axis each."""
        return self.state

    @property
    def step(self) -> int:
        """Time step (s); the gains α, β, γ follow."""
        return self.state + 5 * self.n_axes

    @property
    def total(self) -> int:
        """Number of all rows."""
        return self.state + 5 * self.n_axes + 4


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


def _step_function(
    scheduler: GainScheduler, rows: Rows, two_point: bool, block: int
) -> Callable[[Any], None]:
    """One time step of a block, in place in its buffer."""
    n_axes, n_memory = rows.n_axes, rows.n_memory
    call = _caller(scheduler, n_axes, block)
    remembered, remember = _gather(n_memory, block), _scatter(n_memory, block)
    nan = math.nan
    x_row, v_row, a_row = rows.position, rows.velocity, rows.acceleration
    last_row, gap_row, plots_row, memory_row = rows.last_plot, rows.gap, rows.plots, rows.memory
    plot_row, step_row = rows.plot, rows.step
    sigma_row, prediction_row = plot_row + n_axes, plot_row + 2 * n_axes
    innovation_row, change_row = plot_row + 3 * n_axes, plot_row + 4 * n_axes
    first_count = 1.0 if two_point else 2.0

    def step(b: Any) -> None:
        for i in range(block):
            dt = b[step_row * block + i]
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
                b[(sigma_row + j) * block + i] = sigma if update else 1.0

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

            remember(b, memory_row * block + i, memory, update)
            counted = plots + 1.0 if plots > 0.0 else first_count
            counted = counted if counted < 2.0 else 2.0
            b[plots_row * block + i] = counted if seen else plots
            b[gap_row * block + i] = 0.0 if seen else gap
            b[(step_row + 1) * block + i] = alpha if update else nan
            b[(step_row + 2) * block + i] = beta if update else nan
            b[(step_row + 3) * block + i] = gamma if update else nan

    return step


def _copy_in(b: Any, row: int, source: Any, start: int, stride: int, count: int) -> None:
    if stride == 0:
        value = source[start]
        for i in range(count):
            b[row + i] = value
    else:
        b[row : row + count] = source[start : start + count * stride : stride]


def _copy_out(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
    target[start : start + count * stride : stride] = b[row : row + count]


def _run_function(
    step: Callable[[Any], None],
    copy_in: Callable[..., None],
    copy_out: Callable[..., None],
    rows: Rows,
    block: int,
) -> Callable[..., None]:
    """All time steps of the lanes ``first`` to ``first + count`` of a job, one block."""
    n_axes, state = rows.n_axes, rows.state
    plot_row, step_row = rows.plot, rows.step
    prediction_row, innovation_row = plot_row + 2 * n_axes, plot_row + 3 * n_axes

    def run(
        b: Any, n_steps: int, lanes: int, first: int, count: int,
        plots: Any, dts: Any, dt_strides: Any, sigmas: Any, sigma_strides: Any, states: Any,
        predicted: Any, filtered: Any, velocity: Any, acceleration: Any, innovation: Any,
        alpha: Any, beta: Any, gamma: Any,
    ) -> None:  # fmt: skip
        for r in range(state):
            copy_in(b, r * block, states, r * lanes + first, 1, count)
        for k in range(n_steps):
            dt_start = k * dt_strides[0] + first * dt_strides[1]
            copy_in(b, step_row * block, dts, dt_start, dt_strides[1], count)
            for j in range(n_axes):
                start = (k * lanes + first) * n_axes + j
                copy_in(b, (plot_row + j) * block, plots, start, n_axes, count)
                start = k * sigma_strides[0] + first * sigma_strides[1] + j * sigma_strides[2]
                sigma_row = (plot_row + n_axes + j) * block
                copy_in(b, sigma_row, sigmas, start, sigma_strides[1], count)
            step(b)
            for j in range(n_axes):
                start = (k * lanes + first) * n_axes + j
                copy_out(b, (prediction_row + j) * block, predicted, start, n_axes, count)
                copy_out(b, j * block, filtered, start, n_axes, count)
                copy_out(b, (n_axes + j) * block, velocity, start, n_axes, count)
                copy_out(b, (2 * n_axes + j) * block, acceleration, start, n_axes, count)
                copy_out(b, (innovation_row + j) * block, innovation, start, n_axes, count)
            start = k * lanes + first
            copy_out(b, (step_row + 1) * block, alpha, start, 1, count)
            copy_out(b, (step_row + 2) * block, beta, start, 1, count)
            copy_out(b, (step_row + 3) * block, gamma, start, 1, count)
        for r in range(state):
            copy_out(b, r * block, states, r * lanes + first, 1, count)

    return run


@dataclass(frozen=True, eq=False)
class Runner:
    """Runs a scheduler's recursion over lanes, in plain Python or compiled; see `runner`."""

    scheduler: GainScheduler
    rows: Rows
    two_point: bool
    memory: tuple[float, ...]

    def fresh(self, lanes: int) -> Array:
        """State of `lanes` lanes that have seen nothing, shape (rows.state, lanes)."""
        states = np.zeros((self.rows.state, lanes))
        states[: self.rows.velocity] = np.nan
        states[self.rows.memory :] = np.reshape(self.memory, (-1, 1))
        return states

    def __call__(
        self,
        states: Array,
        plots: Array,
        dts: Array,
        sigmas: Array,
        native: bool | None = None,
    ) -> tuple[Array, dict[str, Array]]:
        """Run over time.

        Parameters
        ----------
        states : ndarray, shape (rows.state, lanes)
        plots : ndarray, shape (n_steps, lanes, n_axes)
        dts : ndarray, shape (n_steps, lanes or 1)
        sigmas : ndarray, broadcasts with `plots`
        native : bool, optional
            Whether to run compiled; by the size of the job unless given. The results are the same.

        Returns
        -------
        states : ndarray
            The new states.
        outputs : dict of ndarray
            predicted, filtered, velocity, acceleration, innovation, shaped as `plots`, and alpha,
            beta, gamma, shape (n_steps, lanes).
        """
        if native is None:
            native = plots.size > COMPILE_ABOVE
        run = self._run_compiled if native else self._run_plain
        return run(states, plots, dts, sigmas)

    def _run_plain(
        self, states: Array, plots: Array, dts: Array, sigmas: Array
    ) -> tuple[Array, dict[str, Array]]:
        step, rows = _plain_step(self.scheduler, self.rows, self.two_point), self.rows
        n_steps, lanes, n_axes = plots.shape
        # Rows of the buffer that a step takes in, plot and sigma of every axis; in their order.
        given = np.concatenate([plots, np.broadcast_to(sigmas, plots.shape)], axis=2)
        all_dts = np.broadcast_to(dts, (n_steps, lanes))
        trace = np.empty((n_steps, lanes, rows.total))
        for lane in range(lanes):
            b = states[:, lane].tolist() + [0.0] * (rows.total - rows.state)
            history = []
            for row, dt in zip(given[:, lane].tolist(), all_dts[:, lane].tolist(), strict=True):
                b[rows.plot : rows.plot + 2 * n_axes] = row
                b[rows.step] = dt
                step(b)
                history.append(b[:])
            if history:
                trace[:, lane] = history
        if not n_steps:
            return states.copy(), self._outputs(trace)
        return trace[-1, :, : rows.state].T.copy(), self._outputs(trace)

    def _outputs(self, trace: Array) -> dict[str, Array]:
        """Outputs out of the buffers after every step, shape (n_steps, lanes, rows.total)."""
        rows, n_axes = self.rows, self.rows.n_axes
        first = {
            "predicted": rows.plot + 2 * n_axes,
            "filtered": rows.position,
            "velocity": rows.velocity,
            "acceleration": rows.acceleration,
            "innovation": rows.plot + 3 * n_axes,
        }
        wide = {name: trace[:, :, row : row + n_axes].copy() for name, row in first.items()}
        narrow = {name: trace[:, :, rows.step + 1 + k].copy() for k, name in enumerate(_GAINS)}
        return {**wide, **narrow}

    def _run_compiled(
        self, states: Array, plots: Array, dts: Array, sigmas: Array
    ) -> tuple[Array, dict[str, Array]]:
        run = _compiled_run(self.scheduler, self.rows, self.two_point)
        n_steps, lanes, _ = plots.shape
        new_states = np.ascontiguousarray(states).copy()
        dt_strides = (dts.shape[1], 1 if dts.shape[1] > 1 else 0)
        outputs = {name: np.empty(plots.shape) for name in _POSITIONS}
        outputs |= {name: np.empty((n_steps, lanes)) for name in _GAINS}
        flat = [values.reshape(-1) for values in outputs.values()]
        scratch = np.zeros(self.rows.total * BLOCK)
        for first in range(0, lanes, BLOCK):
            run(
                scratch, n_steps, lanes, first, min(BLOCK, lanes - first),
                np.ascontiguousarray(plots).reshape(-1),
                np.ascontiguousarray(dts).reshape(-1), dt_strides,
                np.ascontiguousarray(sigmas).reshape(-1), _strides(sigmas.shape, plots.shape),
                new_states.reshape(-1), *flat,
            )  # fmt: skip
        return new_states, outputs


_POSITIONS = ("predicted", "filtered", "velocity", "acceleration", "innovation")
_GAINS = ("alpha", "beta", "gamma")


def _strides(shape: tuple[int, ...], full: tuple[int, ...]) -> tuple[int, ...]:
    """Strides, in elements, of a contiguous array that broadcasts to `full`."""
    strides, step = [], 1
    for length in reversed(shape):
        strides.append(step if length > 1 else 0)
        step *= length
    return (*(0,) * (len(full) - len(shape)), *reversed(strides))


_compiled_once = lru_cache(maxsize=None)(compiled)


@lru_cache(maxsize=64)
def _compiled_run(scheduler: GainScheduler, rows: Rows, two_point: bool) -> Callable[..., None]:
    # Compiled one by one, lest they be inlined into each other at every use.
    step = compiled(_step_function(scheduler, rows, two_point, BLOCK))
    copies = _compiled_once(_copy_in), _compiled_once(_copy_out)
    return compiled(_run_function(step, *copies, rows, BLOCK))


@lru_cache(maxsize=64)
def _plain_step(scheduler: GainScheduler, rows: Rows, two_point: bool) -> Callable[[Any], None]:
    return _step_function(scheduler, rows, two_point, 1)


@lru_cache(maxsize=64)
def runner(scheduler: GainScheduler, n_axes: int, two_point: bool) -> Runner:
    """Runner of a scheduler.

    Parameters
    ----------
    scheduler : GainScheduler
    n_axes : int
        Axes of a lane: 1 unless the scheduler is coupled.
    two_point : bool
        Whether velocity starts from the first two plots, without asking the scheduler.
    """
    memory = tuple(float(m) for m in scheduler.initial_memory(n_axes))
    return Runner(scheduler, Rows(n_axes, len(memory)), two_point, memory)
