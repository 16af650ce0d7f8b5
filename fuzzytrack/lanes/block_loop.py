"""The compiled loops of a job: over blocks of lanes, and within a block over all time steps.

They are compiled once for all trackers, and call the step of a tracker by the address of its
compiled code. Importing this module needs Numba.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

from fuzzytrack.kernels.compile import compiled
from fuzzytrack.kernels.language import use_wide_vectors
from fuzzytrack.kernels.llvm import call, pointer
from fuzzytrack.lanes.layout import BLOCK, OUTPUTS, Rows

__all__ = ["compiled_one_step", "compiled_run", "layout"]


def layout(rows: Rows) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Numbers and positions of the rows of a lane, and of its outputs, for the loops."""
    places = (rows.n_axes, rows.state, rows.kept, rows.plot, rows.sigma, rows.dt, rows.plots)
    return places, tuple(rows.output(name) for name in OUTPUTS)


# Of a view the compiler sees that indices are not negative, so it copies whole vectors.
def _copy_in(b: Any, row: int, source: Any, start: int, stride: int, count: int) -> None:
    into = b[row * BLOCK : row * BLOCK + count]
    if stride == 0:
        value = source[start]
        for i in range(count):
            into[i] = value
    else:
        out_of = source[start:]
        for i in range(count):
            into[i] = out_of[i * stride]


def _infinite(numbers: Any, start: int, count: int) -> int:
    """How many of some numbers are infinite."""
    some, found = numbers[start : start + count], 0
    for i in range(count):
        found += abs(some[i]) == math.inf
    return found


def _copy_out(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
    out_of, into = b[row * BLOCK : row * BLOCK + count], target[start:]
    for i in range(count):
        into[i * stride] = out_of[i]


def _all_have(b: Any, row: int, count: int, least: float) -> bool:
    values, lacking = b[row * BLOCK : row * BLOCK + count], 0
    for i in range(count):
        lacking += values[i] < least
    return lacking == 0


def _run(
    step: int, steady: int, results: bool, places: Any, output_rows: Any, b: Any, unwanted: Any,
    n_steps: int, lanes: int, first: int, last: int, plots: Any, dts: Any, sigmas: Any,
    dt_strides: Any, sigma_strides: Any, states: Any, outputs: Any,
) -> int:  # fmt: skip
    """Run the lanes from `first` to before `last` of a job over all time steps.

    `step` and `steady` are addresses; `steady` is 0 if there is none. `results` says whether the
    latter leaves results in the buffer; the last step always does, for the state. Returned is how
    many plots were infinite.
    """
    n_axes, state, kept, plot_row, sigma_row, dt_row, plots_row = places
    use_wide_vectors()
    predicted, infinite = outputs[0], 0
    for begin in range(first, last, BLOCK):
        count = min(BLOCK, last - begin)
        for r in range(state):
            _copy_in(b, r, states, r * lanes + begin, 1, count)
        settled = False
        for k in range(n_steps):
            if (k == 0) | (sigma_strides[0] > 0):
                start = k * sigma_strides[0] + begin * sigma_strides[1]
                for j in range(n_axes):
                    place = start + j * sigma_strides[2]
                    _copy_in(b, sigma_row + j, sigmas, place, sigma_strides[1], count)
            at, start = (k * lanes + begin) * n_axes, k * dt_strides[0] + begin * dt_strides[1]
            infinite += _infinite(plots, at, count * n_axes)
            straight = settled & (results | (k < n_steps - 1))
            if straight:
                target, place = (predicted, at) if len(predicted) else (unwanted, 0)
                block, read, write = pointer(b, 0), pointer(plots, at), pointer(target, place)
                call(steady, (block, count, dts[start], read, write))
            else:
                for j in range(n_axes):
                    _copy_in(b, plot_row + j, plots, at + j, n_axes, count)
                _copy_in(b, dt_row, dts, start, dt_strides[1], count)
                call(step, (pointer(b, 0), count))
                settled = (steady != 0) & (dt_strides[1] == 0)
                settled = settled and _all_have(b, plots_row, count, 2.0)
            # A lane has one of each gain, and one of every other output for each axis.
            for o in range(1 if straight else 0, len(outputs)):
                if len(outputs[o]):
                    width = n_axes if o < len(outputs) - 3 else 1
                    for j in range(width):
                        place = (k * lanes + begin) * width + j
                        _copy_out(b, output_rows[o] + j, outputs[o], place, width, count)
        for r in range(kept):
            _copy_out(b, r, states, r * lanes + begin, 1, count)
    return infinite


def _fill_common(
    b: Any, dt_row: int, sigma_row: int, n_axes: int, dt: float, sigma: float, lanes: int,
    begin: int, count: int,
) -> int:  # fmt: skip
    """Fill in one time step and one sigma for all lanes."""
    for j in range(n_axes):
        for i in range(count):
            b[(sigma_row + j) * BLOCK + i] = sigma
    for i in range(count):
        b[dt_row * BLOCK + i] = dt
    return 0


def _fill_own(
    b: Any, dt_row: int, sigma_row: int, n_axes: int, dts: Any, sigmas: Any, lanes: int,
    begin: int, count: int,
) -> int:  # fmt: skip
    """Fill in the time step of each track, and the sigma of each plot or one for all.

    How many time steps are not positive and finite is returned.
    """
    each = 1 if len(sigmas) > 1 else 0
    for j in range(n_axes):
        place = each * (begin * n_axes + j)
        _copy_in(b, sigma_row + j, sigmas, place, each * n_axes, count)
    steps, good = b[dt_row * BLOCK : dt_row * BLOCK + count], 0
    # Lanes of a track lie side by side: one of each track, then the next of each.
    per_track = lanes // len(dts)
    for first in range(min(per_track, count)):
        track = (begin + first) // per_track
        out_of, into = dts[track:], steps[first:]
        for i in range((count - first + per_track - 1) // per_track):
            into[i * per_track] = out_of[i]
    for i in range(count):
        good += (steps[i] > 0.0) & (steps[i] < math.inf)
    return count - good


def _one_step(fill: Callable[..., int]) -> Callable[..., int]:
    """Function that takes all lanes one step on, with time steps and sigmas that `fill` fills in.

    It is `_run` cut down to what tracks that come plot by plot need. It returns how many plots are
    infinite, and what `fill` found bad; `new` is of no use then.
    """

    def one_step(
        step: int, n_axes: int, state: int, kept: int, plot_row: int, b: Any, old: Any, plots: Any,
        dt: Any, sigma: Any, new: Any,
    ) -> int:  # fmt: skip
        sigma_row, dt_row, lanes = plot_row + n_axes, plot_row + 2 * n_axes, old.shape[1]
        before, after, bad = old.reshape(-1), new.reshape(-1), 0
        for begin in range(0, lanes, BLOCK):
            count = min(BLOCK, lanes - begin)
            for r in range(state):
                _copy_in(b, r, before, r * lanes + begin, 1, count)
            for j in range(n_axes):
                _copy_in(b, plot_row + j, plots, begin * n_axes + j, n_axes, count)
            bad += fill(b, dt_row, sigma_row, n_axes, dt, sigma, lanes, begin, count)
            call(step, (pointer(b, 0), count))
            for r in range(kept):
                _copy_out(b, r, after, r * lanes + begin, 1, count)
        return bad + _infinite(plots, 0, lanes * n_axes)

    return one_step


@cache
def compiled_run() -> Callable[..., int]:
    """`_run`, compiled; other threads may run meanwhile."""
    return compiled(_run, nogil=True)


@cache
def compiled_one_step(own: bool) -> Callable[..., int]:
    """One step of all lanes, compiled; for the one type of arguments that it is first called with.

    Parameters
    ----------
    own : bool
        Whether it is given the time step of each track and the sigma of each plot, as arrays, or
        one number for all.
    """
    return compiled(_one_step(_fill_own if own else _fill_common))
