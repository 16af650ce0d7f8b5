"""Runs the recursion over lanes and time, in plain Python or compiled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.trackers.native import compiled, fingerprint
from fuzzytrack.trackers.rows import Rows

__all__ = ["Recursion", "Runner"]

Array = NDArray[np.float64]

#: Lanes a block. Rows 4,096 bytes apart would share cache sets and evict one another.
BLOCK = 248
#: Coordinates, over all jobs of a runner, above which compiling pays; below, plain Python is done
#: sooner.
COMPILE_ABOVE = 200_000

_GAINS = ("alpha", "beta", "gamma")


@dataclass(frozen=True, eq=False)
class Recursion:
    """A tracker's arithmetic: what a lane remembers, and how it goes one step on.

    Attributes
    ----------
    rows : Rows
        Layout of a lane.
    memory : tuple of float
        Memory of a lane that has seen nothing, as long as `rows` says.
    step : callable
        Makes, for a number of lanes, the function that does one time step of them in place in their
        buffer, in which row `r` of lane `i` is at ``r * lanes + i``. It finds plot, sigma and dt
        filled in, and leaves state and results. It is run in plain Python over a list and compiled
        over an array, so it has loops, selects and numbers in it, and calls nothing else.
    """

    rows: Rows
    memory: tuple[float, ...]
    step: Callable[[int], Callable[[Any], None]]


@dataclass(eq=False)
class Runner:
    """Runs a recursion over lanes and time.

    Lanes are kept as an array of shape (rows.kept, lanes), see `fuzzytrack.trackers.rows.Rows`.

    Attributes
    ----------
    recursion : Recursion
    work : int
        Coordinates that were tracked so far, or are announced: a job in many parts may raise it
        before the first.
    """

    recursion: Recursion
    work: int = 0

    @property
    def rows(self) -> Rows:
        """Layout of a lane."""
        return self.recursion.rows

    def fresh(self, count: int) -> Array:
        """Lanes that have seen nothing, shape (rows.kept, count)."""
        lanes = np.zeros((self.rows.kept, count))
        lanes[: self.rows.velocity] = np.nan
        lanes[self.rows.memory : self.rows.state] = np.reshape(self.recursion.memory, (-1, 1))
        return lanes

    def __call__(
        self,
        lanes: Array,
        plots: Array,
        dts: Array,
        sigmas: Array,
        native: bool | None = None,
    ) -> tuple[Array, dict[str, Array]]:
        """Run over time.

        Parameters
        ----------
        lanes : ndarray, shape (rows.kept, lanes)
        plots : ndarray, shape (n_steps, lanes, n_axes)
        dts : ndarray, shape (n_steps, lanes or 1)
        sigmas : ndarray of three axes that broadcasts with `plots`
        native : bool, optional
            Whether to run compiled; unless given, once the jobs together are large enough to pay
            for the compilation. The results are the same.

        Returns
        -------
        lanes : ndarray
            The lanes after the last step.
        outputs : dict of ndarray
            predicted, filtered, velocity, acceleration, innovation, shaped as `plots`, and alpha,
            beta, gamma, shape (n_steps, lanes).
        """
        if native is None:
            native = self.work + plots.size > COMPILE_ABOVE
        self.work += plots.size
        return (self._run_compiled if native else self._run_plain)(lanes, plots, dts, sigmas)

    def step(
        self, lanes: Array, plots: Array, dts: list[float], sigmas: list[list[float]]
    ) -> Array:
        """One step in plain Python.

        Parameters
        ----------
        lanes : ndarray, shape (rows.kept, lanes)
        plots : ndarray, shape (lanes, n_axes)
        dts : list of float
            One a lane.
        sigmas : list of list of float
            One an axis for each lane.

        Returns
        -------
        ndarray
            The lanes after the step.
        """
        step, kept, scratch = self._plain_step, self.rows.kept, [0.0] * self.rows.n_axes
        after = []
        for lane, z, sigma, dt in zip(lanes.T.tolist(), plots.tolist(), sigmas, dts, strict=True):
            b = [*lane, *z, *sigma, dt, *scratch]
            step(b)
            after.append(b[:kept])
        return np.array(after).reshape(len(after), kept).T

    @cached_property
    def _plain_step(self) -> Callable[[Any], None]:
        return self.recursion.step(1)

    def _run_plain(
        self, lanes: Array, plots: Array, dts: Array, sigmas: Array
    ) -> tuple[Array, dict[str, Array]]:
        step, rows = self._plain_step, self.rows
        n_steps, count, _ = plots.shape
        # What a step is given, in the order of the rows: plot, sigma, time step.
        all_dts = np.broadcast_to(dts[:, :, None], (n_steps, count, 1))
        given = np.concatenate([plots, np.broadcast_to(sigmas, plots.shape), all_dts], axis=2)
        n_state = rows.last_plot
        trace = np.empty((n_steps, count, n_state + rows.kept - rows.predicted))
        after = lanes.copy()
        for lane in range(count):
            b = lanes[:, lane].tolist() + [0.0] * (rows.total - rows.kept)
            history = []
            for row in given[:, lane].tolist():
                b[rows.plot : rows.change] = row
                step(b)
                history.append(b[:n_state] + b[rows.predicted : rows.kept])
            if history:
                trace[:, lane] = history
                after[:, lane] = b[: rows.kept]
        # What lies between state and results is not in the trace.
        skipped = rows.predicted - n_state
        outputs = {}
        for name, row in self._positions.items():
            column = row if row < n_state else row - skipped
            outputs[name] = trace[:, :, column : column + rows.n_axes].copy()
        for k, name in enumerate(_GAINS):
            outputs[name] = trace[:, :, rows.gains - skipped + k].copy()
        return after, outputs

    @property
    def _positions(self) -> dict[str, int]:
        """Outputs with an axis of space, and their first rows."""
        rows = self.rows
        return {
            "predicted": rows.predicted,
            "filtered": rows.position,
            "velocity": rows.velocity,
            "acceleration": rows.acceleration,
            "innovation": rows.innovation,
        }

    def _run_compiled(
        self, lanes: Array, plots: Array, dts: Array, sigmas: Array
    ) -> tuple[Array, dict[str, Array]]:
        n_steps, count, _ = plots.shape
        after = np.array(lanes, order="C")
        outputs = {name: np.empty(plots.shape) for name in self._positions}
        outputs |= {name: np.empty((n_steps, count)) for name in _GAINS}
        inputs = [np.ascontiguousarray(array).reshape(-1) for array in (plots, dts, sigmas)]
        dt_strides = _strides(dts.shape, (n_steps, count))
        sigma_strides = _strides(sigmas.shape, plots.shape)
        scratch = np.zeros(self.rows.total * BLOCK)
        for first in range(0, count, BLOCK):
            self._compiled_run(
                scratch, n_steps, count, first, min(BLOCK, count - first),
                *inputs, dt_strides, sigma_strides, after.reshape(-1),
                *(array.reshape(-1) for array in outputs.values()),
            )  # fmt: skip
        return after, outputs

    @cached_property
    def _compiled_run(self) -> Callable[..., None]:
        # Compiled one by one, lest they be inlined into each other at every use.
        step = self.recursion.step(BLOCK)
        # What is kept on disk is known by all that it is made of, in plain Python.
        digest = fingerprint(_run_function(step, _copy_in, _copy_out, self.rows, BLOCK))
        copies = _compiled_once(_copy_in), _compiled_once(_copy_out)
        return compiled(_run_function(compiled(step), *copies, self.rows, BLOCK), digest)


_compiled_once = lru_cache(maxsize=None)(compiled)


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


def _copy_out(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
    out_of, into = b[row : row + count], target[start:]
    for i in range(count):
        into[i * stride] = out_of[i]


def _run_function(
    step: Callable[[Any], None],
    copy_in: Callable[..., None],
    copy_out: Callable[..., None],
    rows: Rows,
    block: int,
) -> Callable[..., None]:
    """Function that runs the lanes ``first`` to ``first + count`` of a job over all time steps."""
    n_axes, state, kept = rows.n_axes, rows.state, rows.kept
    position_row, velocity_row, acceleration_row = rows.position, rows.velocity, rows.acceleration
    predicted_row, innovation_row, gains_row = rows.predicted, rows.innovation, rows.gains
    plot_row, sigma_row, dt_row = rows.plot, rows.sigma, rows.dt

    def run(
        b: Any, n_steps: int, lanes: int, first: int, count: int,
        plots: Any, dts: Any, sigmas: Any, dt_strides: Any, sigma_strides: Any, states: Any,
        predicted: Any, filtered: Any, velocity: Any, acceleration: Any, innovation: Any,
        alpha: Any, beta: Any, gamma: Any,
    ) -> None:  # fmt: skip
        for r in range(state):
            copy_in(b, r * block, states, r * lanes + first, 1, count)
        for k in range(n_steps):
            start = k * dt_strides[0] + first * dt_strides[1]
            copy_in(b, dt_row * block, dts, start, dt_strides[1], count)
            for j in range(n_axes):
                start = (k * lanes + first) * n_axes + j
                copy_in(b, (plot_row + j) * block, plots, start, n_axes, count)
                start = k * sigma_strides[0] + first * sigma_strides[1] + j * sigma_strides[2]
                copy_in(b, (sigma_row + j) * block, sigmas, start, sigma_strides[1], count)
            step(b)
            for j in range(n_axes):
                start = (k * lanes + first) * n_axes + j
                copy_out(b, (predicted_row + j) * block, predicted, start, n_axes, count)
                copy_out(b, (position_row + j) * block, filtered, start, n_axes, count)
                copy_out(b, (velocity_row + j) * block, velocity, start, n_axes, count)
                copy_out(b, (acceleration_row + j) * block, acceleration, start, n_axes, count)
                copy_out(b, (innovation_row + j) * block, innovation, start, n_axes, count)
            start = k * lanes + first
            copy_out(b, gains_row * block, alpha, start, 1, count)
            copy_out(b, (gains_row + 1) * block, beta, start, 1, count)
            copy_out(b, (gains_row + 2) * block, gamma, start, 1, count)
        for r in range(kept):
            copy_out(b, r * block, states, r * lanes + first, 1, count)

    return run


def _strides(shape: tuple[int, ...], full: tuple[int, ...]) -> tuple[int, ...]:
    """Strides, in elements, of a contiguous array that broadcasts to `full`."""
    strides, step = [], 1
    for length in reversed(shape):
        strides.append(step if length > 1 else 0)
        step *= length
    return (*(0,) * (len(full) - len(shape)), *reversed(strides))
