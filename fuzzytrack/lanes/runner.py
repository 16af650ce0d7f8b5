"""Runs a lane program over lanes and time, in plain Python or compiled."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.kernels.compile import entry_point
from fuzzytrack.lanes.layout import BLOCK, GAINS, MEMORY, OUTPUTS, Rows, aligned
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.reprs import summary

__all__ = ["InfinitePlotError", "Runner"]


#: Number of coordinates, over all jobs of a runner, above which compiling saves time. Measured for
#: a tracker that is not on disk yet; for one that is, it would be a third.
COMPILE_ABOVE = 200_000
#: Number of coordinates of a job from which several threads save time.
THREADS_ABOVE = 500_000
#: Number of lanes that are looked at for missing plots.
_SAMPLE = 64
#: Parts of a job for each thread: more than one, since parts do not take equally long.
PARTS = 4


#: Compiles a function, as `fuzzytrack.kernels.compile.entry_point` does.
Compiler = Callable[[Callable[..., Any], str, type], Any]


class InfinitePlotError(ValueError):
    """A plot is infinite."""


@dataclass(eq=False)
class Runner:
    """Runs a lane program over lanes and time.

    Lanes are kept as an array of shape (rows.kept, lanes), see `fuzzytrack.lanes.layout.Rows`.

    Attributes
    ----------
    program : LaneProgram
    elapsed : bool
        Whether time counts from the last plot: what a step writes where a plot is missing is given
        out, and the state remains that of the last plot. Otherwise it counts from step to step.
    work : int
        Number of coordinates tracked so far.
    horizon : int
        What `work` will be after the jobs that were announced.
    common_step, own_step : callable or None
        After `compile`, `fuzzytrack.lanes.block_loop.compiled_one_step` from its argument `b` on:
        with one time and sigma for all lanes, and with those of each track and plot.
    """

    program: LaneProgram
    elapsed: bool = True
    work: int = 0
    horizon: int = 0
    common_step: Callable[..., int] | None = field(default=None, init=False, repr=False)
    own_step: Callable[..., int] | None = field(default=None, init=False, repr=False)
    _code: dict[tuple[object, type], Any] = field(default_factory=dict, init=False, repr=False)
    _compiler: Compiler = field(default_factory=lambda: entry_point, init=False, repr=False)

    def __repr__(self) -> str:
        return summary(self, "program", "elapsed", "work", "horizon")

    @property
    def rows(self) -> Rows:
        """Layout of a lane."""
        return self.program.rows

    def fresh(self, count: int) -> Array:
        """Lanes before their first plot, shape (rows.kept, count)."""
        rows, lanes = self.rows, np.zeros((self.rows.kept, count))
        for first in (rows.position, rows.now):
            lanes[first : first + rows.n_axes] = np.nan
        lanes[rows.last_time] = np.nan
        lanes[rows.memory : rows.state] = np.reshape(self.program.memory, (-1, 1))
        return lanes

    def lost(self, lanes: Array) -> int | None:
        """First of the lanes that have a plot and no finite position; None if there is none."""
        rows = self.rows
        finite = np.isfinite(lanes[rows.now : rows.last_time])
        # As it is nearly always; a small job takes a third of a millisecond.
        if finite.all():
            return None
        lost = ~finite.all(axis=0) & (lanes[rows.plots] > 0.0)
        return int(np.argmax(lost)) if lost.any() else None

    @property
    def restored(self) -> int:
        """How many rows, the first ones, are as before after a step without a plot."""
        return self.rows.state if self.elapsed and not self.program.keeps_state else 0

    def __call__(
        self,
        lanes: Array | None,
        plots: NDArray[Any],
        times: Array,
        sigmas: Array,
        native: bool | None = None,
        keep: Sequence[str] = OUTPUTS,
        threads: int | None = None,
        into: Mapping[str, NDArray[Any]] | None = None,
    ) -> tuple[Array, dict[str, NDArray[Any]]]:
        """Run over time.

        Parameters
        ----------
        lanes : ndarray, shape (rows.kept, lanes), or None
            None for lanes before their first plot.
        plots : ndarray, shape (n_steps, lanes, n_axes)
            Its dtype, float64 or float32, is that of the calculation.
        times : ndarray, shape (n_steps, lanes or 1)
            Times (s), later than those of the lanes.
        sigmas : ndarray of three axes that broadcasts with `plots`
        native : bool, optional
            Whether to run compiled; unless given, in single precision, or once the jobs together
            are large enough to make up for the compilation. The results are the same.
        keep : sequence of str
            Outputs wanted.
        threads : int, optional
            Threads that share the lanes of a compiled job; unless given one, or for a large job
            all processors.
        into : mapping of str to ndarray, optional
            Contiguous arrays of the dtype of the plots, by names of outputs. One that has the size
            of its output is written into and returned in the output's shape; for other outputs
            there are new arrays.

        Returns
        -------
        lanes : ndarray
            The lanes after the last step.
        outputs : dict of ndarray
            Of `keep`: predicted, filtered, velocity, acceleration, innovation, shaped as `plots`,
            and alpha, beta, gamma, shape (n_steps, lanes), or as `plots` if axes have their own;
            and memory, shape (n_steps, lanes, n_memory), after a missed plot that of the last one
            if time counts from plot to plot.

        Raises
        ------
        InfinitePlotError
            If a plot is infinite.
        """
        if native is None:
            large = max(self.horizon, self.work + plots.size) > COMPILE_ABOVE
            native = large or plots.dtype != np.float64
        self.work += plots.size
        after = self.fresh(plots.shape[1]) if lanes is None else np.array(lanes, order="C")
        outputs = {name: self._output(name, plots, (into or {}).get(name)) for name in keep}
        if native:
            self._run_compiled(after, plots, times, sigmas, outputs, threads)
        else:
            self._run_plain(after, plots, times, sigmas, outputs)
        return after, outputs

    def _output(self, name: str, plots: NDArray[Any], given: NDArray[Any] | None) -> NDArray[Any]:
        """Array for an output: one that was given, if it has the size, or a new one."""
        if name == MEMORY:
            return np.empty((*plots.shape[:2], self.rows.n_memory), plots.dtype)
        # Gains that all axes of a lane share have no axis for them.
        shared = name in GAINS and self.rows.gain_sets == 1
        shape = plots.shape[:2] if shared else plots.shape
        if given is not None and given.size == math.prod(shape):
            # Compiled code would be compiled anew for a subclass of arrays.
            return given.view(np.ndarray).reshape(shape)
        return np.empty(shape, plots.dtype)

    def step(
        self, lanes: Array, plots: Array, times: list[float], sigmas: list[list[float]]
    ) -> Array:
        """One step in plain Python.

        Parameters
        ----------
        lanes : ndarray, shape (rows.kept, lanes)
        plots : ndarray, shape (lanes, n_axes)
        times : list of float
            One for each lane.
        sigmas : list of list of float
            For each lane one for each axis.

        Returns
        -------
        ndarray
            The lanes after the step.
        """
        kept, scratch = self.rows.kept, [0.0] * (self.rows.total - self.rows.kept)
        after = []
        for lane, z, sigma, t in zip(lanes.T.tolist(), plots.tolist(), sigmas, times, strict=True):
            b = lane + scratch
            self._plain_step(b, t, [*z, *sigma])
            after.append(b[:kept])
        return np.ascontiguousarray(np.array(after).reshape(len(after), kept).T)

    @cached_property
    def _plain_step(self) -> Callable[[list[float], float, list[float]], None]:
        """Function ``f(b, t, given)``: one step of a lane to time `t`, in place.

        `given` are plot and sigma.
        """
        step, rows, restored = self.program.step(1), self.rows, self.restored
        plot_row, dt_row, last_time, n_axes = rows.plot, rows.dt, rows.last_time, rows.n_axes
        now, end = slice(rows.now, rows.last_time), 3 * rows.n_axes
        elapsed, shows = self.elapsed, not self.program.keeps_state

        def plain_step(b: list[float], t: float, given: list[float]) -> None:
            b[plot_row:dt_row] = given
            dt = t - b[last_time]
            b[dt_row] = dt if dt == dt else 0.0
            before = b[:restored]
            step(b, 1)
            if shows:
                b[now] = b[:end]
            seen = True
            for z in given[:n_axes]:
                seen = seen and z == z
            if seen or not elapsed:
                b[last_time] = t
            else:
                b[:restored] = before

        return plain_step

    def _run_plain(
        self, after: Array, plots: Array, times: Array, sigmas: Array, outputs: dict[str, Array]
    ) -> None:
        if np.isinf(plots).any():
            raise InfinitePlotError
        step, rows = self._plain_step, self.rows
        n_steps, count, _ = plots.shape
        all_times = np.broadcast_to(times, (n_steps, count)).T.tolist()
        given = np.concatenate([plots, np.broadcast_to(sigmas, plots.shape)], axis=2)
        # Looked up once: this is the inner loop of a small job.
        n_kept, results = rows.kept, slice(rows.predicted, rows.last_time)
        scratch = [0.0] * (rows.total - n_kept)
        trace = np.empty((n_steps, count, rows.last_time - rows.predicted))
        outputs = dict(outputs)
        memories, memory = outputs.pop(MEMORY, None), slice(rows.memory, rows.state)
        for lane in range(count):
            b = after[:, lane].tolist() + scratch
            history, remembered = [], []
            for t, row in zip(all_times[lane], given[:, lane].tolist(), strict=True):
                step(b, t, row)
                history.append(b[results])
                if memories is not None:
                    remembered.append(b[memory])
            if history:
                trace[:, lane] = history
                after[:, lane] = b[:n_kept]
            if remembered and memories is not None:
                memories[:, lane] = remembered
        for name, output in outputs.items():
            column = rows.shown(name) - rows.predicted
            part = trace[:, :, column : column + rows.width(name)]
            output[...] = part.reshape(output.shape)

    def _run_compiled(
        self,
        after: Array,
        plots: NDArray[Any],
        times: Array,
        sigmas: Array,
        outputs: Mapping[str, NDArray[Any]],
        threads: int | None = None,
    ) -> None:
        from fuzzytrack.lanes import block_loop

        (n_steps, count, _), dtype = plots.shape, plots.dtype.type
        unwanted = np.empty(0, dtype)
        given = (
            _in_a_row(plots, dtype), _in_a_row(times, np.float64), _in_a_row(sigmas, dtype),
            _strides(times.shape, (n_steps, count)), _strides(sigmas.shape, plots.shape),
            after.reshape(-1),
            tuple(outputs[n].reshape(-1) if n in outputs else unwanted for n in OUTPUTS),
            outputs[MEMORY].reshape(-1) if MEMORY in outputs else unwanted,
        )  # fmt: skip
        results = self._writes_results(outputs)
        # A single step is never steady, so a stream of plots does not wait for its compilation.
        steady = [0, 0]
        if n_steps > 1:
            # A few lanes show whether they lack plots; the loop can do without their function.
            missing = self.elapsed and bool(np.isnan(plots[:, :_SAMPLE]).any())
            for k in range(1 + (missing or times.shape[1] > 1)):
                code = self.steady_code(results, k == 0, dtype)
                steady[k] = 0 if code is None else code.address
        step = self.step_code(dtype)
        run = block_loop.compiled_run()
        code = (step.address, *steady, results, self.elapsed)
        places = self.places

        def part(ends: tuple[int, int]) -> int:
            return run(*code, *places, *self.room(dtype), n_steps, count, *ends, *given)

        infinite = _in_parts(part, count, _threads(threads, plots.size))
        if infinite:
            raise InfinitePlotError

    @property
    def places(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Numbers and positions of the rows of a lane, and of its outputs, for the loops."""
        rows, keeps = self.rows, self.program.keeps_state
        places = (
            rows.n_axes, rows.gain_sets, rows.state, rows.results,
            rows.now if keeps else rows.position, rows.now, rows.last_time, self.restored,
            rows.plot, rows.sigma, rows.dt, rows.plots, rows.memory,
        )  # fmt: skip
        return places, tuple((rows.shown if keeps else rows.output)(name) for name in OUTPUTS)

    def _writes_results(self, keep: Iterable[str]) -> bool:
        """Whether the steady function has to write results into the buffer for some outputs."""
        in_state = () if self.program.keeps_state else ("filtered", "velocity", "acceleration")
        return bool({*keep} - {"predicted", MEMORY, *in_state})

    def room(self, dtype: type) -> tuple[NDArray[Any], ...]:
        """Arrays that the compiled loop works in, for one thread.

        They hold a block of lanes, predictions that nobody wants, times of the lanes, places of
        lanes without a plot, and their states.
        """
        return (
            aligned(self.rows.total * BLOCK, dtype), np.empty(self.rows.n_axes * BLOCK, dtype),
            np.empty(BLOCK), np.empty(BLOCK, np.int64),
            np.empty(self.rows.state * BLOCK, dtype),
        )  # fmt: skip

    @property
    def native(self) -> bool:
        """Whether there is a compiled step in double precision."""
        return ("step", np.float64) in self._code

    def compile(self) -> None:
        """Compile now all that double precision can need."""
        if self.own_step is not None:
            return

        n_axes = self.rows.n_axes
        lanes, one = self.fresh(1), np.ones((1, 1, n_axes))
        for results in (True, False):
            self.steady_code(results, True)
        self._run_compiled(lanes, one, one[:, :, 0], one[:, :, :1], {}, 1)
        self.common_step = self._one_step(1.0)
        self.own_step = self._one_step(np.ones(1))

    def _one_step(self, ones: float | Array) -> Callable[..., int]:
        """Compiled step of all lanes, for times and sigmas of the type of `ones`."""
        from fuzzytrack.lanes import block_loop

        rows, lanes, plots = self.rows, self.fresh(1), np.ones(self.rows.n_axes)
        one_step: Any = block_loop.compiled_one_step(isinstance(ones, np.ndarray))
        places = (self.step_code().address, self.elapsed, self.places[0])
        room = (aligned(rows.total * BLOCK), np.empty(BLOCK, np.int64))
        one_step(*places, *room, lanes, plots, ones, ones, self.fresh(1))
        # The one signature there is, without asking again which it is.
        return partial(one_step.overloads[one_step.signatures[0]].entry_point, *places)

    def step_code(self, dtype: type = np.float64) -> Any:
        """Compiled step of the program, see `fuzzytrack.kernels.compile.entry_point`."""
        return self._compiled_once(("step", dtype), lambda: self.program.step(BLOCK), "vpi")

    def steady_code(self, results: bool, common: bool, dtype: type = np.float64) -> Any:
        """Compiled steady function, with or without results, for one dt or for each lane its own.

        None if there is none.
        """
        steady = self.program.steady
        if steady is None:
            return None
        key = ((results, common), dtype)
        return self._compiled_once(key, lambda: steady(BLOCK, results, common), "vpixpp")

    def _compiled_once(
        self, key: tuple[object, type], make: Callable[[], Callable[..., Any]], arguments: str
    ) -> Any:
        if key not in self._code:
            # Two threads may compile at the same time; both must use the code that is kept.
            self._code.setdefault(key, self._compiler(make(), arguments, key[1]))
        return self._code[key]

    @contextmanager
    def compiled_by(self, compiler: Compiler) -> Iterator[None]:
        """Run jobs of any size through the code of another compiler, which is dropped at the end.

        Parameters
        ----------
        compiler : callable
            See `Compiler`. Its code need not be of use any longer than that.
        """
        before = self._code, self.horizon, self._compiler
        self._code, self.horizon, self._compiler = {}, COMPILE_ABOVE + 1, compiler
        try:
            yield
        finally:
            self._code, self.horizon, self._compiler = before


def _threads(wanted: int | None, coordinates: int) -> int:
    if wanted is not None:
        return wanted
    if coordinates < THREADS_ABOVE:
        return 1
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def _in_parts(part: Callable[[tuple[int, int]], int], count: int, threads: int) -> int:
    """Sum of what `part` returns over all lanes, cut at the ends of blocks."""
    blocks = -(-count // BLOCK)
    threads = min(threads, blocks)
    if threads < 2:
        return part((0, count))
    size = BLOCK * -(-blocks // min(blocks, PARTS * threads))
    ends = [(first, min(first + size, count)) for first in range(0, count, size)]
    with ThreadPoolExecutor(threads) as pool:
        return sum(pool.map(part, ends))


def _in_a_row(array: NDArray[Any], dtype: type) -> NDArray[Any]:
    """Its numbers as one type of array; the loops would be compiled anew for any other."""
    # A sigma may be too large for the type where its plot is missing.
    with np.errstate(over="ignore"):
        row: NDArray[Any] = np.ascontiguousarray(array, dtype).reshape(-1)
    row.flags.writeable = False
    return row


def _strides(shape: tuple[int, ...], full: tuple[int, ...]) -> tuple[int, ...]:
    """Strides, in elements, of a contiguous array that broadcasts to `full`."""
    strides, step = [], 1
    for length in reversed(shape):
        strides.append(step if length > 1 else 0)
        step *= length
    return (*(0,) * (len(full) - len(shape)), *reversed(strides))
