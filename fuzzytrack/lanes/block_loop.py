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
from fuzzytrack.lanes.layout import BLOCK

__all__ = ["compiled_one_step", "compiled_run"]


# Of a view the compiler sees that indices are not negative, so it copies whole vectors; where they
# are side by side it must be told, or it copies one by one.
def _copy_in(b: Any, row: int, source: Any, start: int, stride: int, count: int) -> None:
    into = b[row * BLOCK : row * BLOCK + count]
    if stride == 0:
        value = source[start]
        for i in range(count):
            into[i] = value
    elif stride == 1:
        out_of = source[start : start + count]
        for i in range(count):
            into[i] = out_of[i]
    else:
        out_of = source[start:]
        for i in range(count):
            into[i] = out_of[i * stride]


def _unusual(numbers: Any, start: int, count: int) -> int:
    """How many of some numbers are infinite or NaN."""
    some, found = numbers[start : start + count], 0
    for i in range(count):
        found += some[i] - some[i] != 0.0
    return found


def _infinite(numbers: Any, start: int, count: int) -> int:
    """How many of some numbers are infinite."""
    some, found = numbers[start : start + count], 0
    for i in range(count):
        found += abs(some[i]) == math.inf
    return found


def _lost(b: Any, row: int, plots_row: int, count: int) -> int:
    """How many lanes that have a plot have no finite number in a row."""
    some, plots = b[row * BLOCK : row * BLOCK + count], b[plots_row * BLOCK :]
    found = 0
    for i in range(count):
        found += (some[i] - some[i] != 0.0) & (plots[i] > 0.0)
    return found


def _find_missed(plots: Any, start: int, n_axes: int, count: int, missed: Any) -> int:
    """Write the lanes without a whole plot into `missed`, and return how many there are."""
    found = 0
    for i in range(count):
        gone = False
        for j in range(n_axes):
            z = plots[start + i * n_axes + j]
            gone = gone | (z != z)
        missed[found] = i
        found += gone
    return found


def _save(b: Any, restored: int, missed: Any, found: int, saved: Any) -> None:
    """Keep the first rows of the lanes without a plot."""
    for r in range(restored):
        for k in range(found):
            saved[r * BLOCK + k] = b[r * BLOCK + missed[k]]


def _restore(b: Any, restored: int, missed: Any, found: int, saved: Any) -> None:
    """Give the lanes without a plot back what `_save` kept."""
    for r in range(restored):
        for k in range(found):
            b[r * BLOCK + missed[k]] = saved[r * BLOCK + k]


def _copy_out(b: Any, row: int, target: Any, start: int, stride: int, count: int) -> None:
    out_of, into = b[row * BLOCK : row * BLOCK + count], target[start:]
    if stride == 1:
        for i in range(count):
            into[i] = out_of[i]
    else:
        for i in range(count):
            into[i * stride] = out_of[i]


def _all_have(b: Any, row: int, count: int, least: float) -> bool:
    values, lacking = b[row * BLOCK : row * BLOCK + count], 0
    for i in range(count):
        lacking += values[i] < least
    return lacking == 0


def _elapsed(
    b: Any, dt_row: int, times: Any, start: int, stride: int, since: Any, count: int
) -> None:
    """Fill in the time from that of each lane's state to the step, 0 where there is no state.

    The difference is taken in double precision, whatever that of the buffer is.
    """
    into, before = b[dt_row * BLOCK : dt_row * BLOCK + count], since[:count]
    if stride == 0:
        t = times[start]
        for i in range(count):
            dt = t - before[i]
            into[i] = dt if dt == dt else 0.0
    else:
        now = times[start : start + count]
        for i in range(count):
            dt = now[i] - before[i]
            into[i] = dt if dt == dt else 0.0


def _pass_time(since: Any, times: Any, start: int, stride: int, count: int) -> None:
    """Set the times of all states to that of a step."""
    for i in range(count):
        since[i] = times[start + i * stride]


def _pass_time_of_seen(
    since: Any, times: Any, start: int, stride: int, plots: Any, at: int, n_axes: int, count: int
) -> None:
    """As `_pass_time`, for lanes that have a whole plot."""
    last, some, t = since[:count], plots[at : at + count * n_axes], times[start]
    if n_axes == 1:
        for i in range(count):
            now = t if stride == 0 else times[start + i]
            last[i] = now if some[i] == some[i] else last[i]
        return
    for i in range(count):
        # The sum is NaN if one of them is.
        z = some[i * n_axes]
        for j in range(1, n_axes):
            z = z + some[i * n_axes + j]
        now = t if stride == 0 else times[start + i]
        last[i] = now if z == z else last[i]


def _run(
    step: int, steady: int, apart: int, results: bool, elapsed: bool, places: Any,
    output_rows: Any, b: Any, unwanted: Any, since: Any, missed: Any, saved: Any, n_steps: int,
    lanes: int, first: int, last: int, plots: Any, times: Any, sigmas: Any, time_strides: Any,
    sigma_strides: Any, states: Any, outputs: Any, memories: Any,
) -> int:  # fmt: skip
    """Run the lanes from `first` to before `last` of a job over all time steps.

    `step`, `steady` and `apart` are addresses: of the step, and for lanes that have all started,
    with one dt and with one of each lane; 0 if there is none. `results` says whether the latter two
    leave results in the buffer; the last step always does, for the state. `elapsed` says whether
    time counts from plot to plot. `since` is room for a number a lane, `missed` for an index, and
    `saved` for the state. Returned is how many plots were infinite.
    """
    (
        n_axes, gain_sets, state, end, shown, now, last_time, restored, plot_row, sigma_row, dt_row,
        plots_row, memory_row,
    ) = places  # fmt: skip
    use_wide_vectors()
    predicted, infinite, common = outputs[0], 0, time_strides[1] == 0
    for begin in range(first, last, BLOCK):
        count = min(BLOCK, last - begin)
        for r in range(state):
            _copy_in(b, r, states, r * lanes + begin, 1, count)
        for i in range(count):
            since[i] = states[last_time * lanes + begin + i]
        # Whether all lanes have started, and the step to whose time all states belong: what is in
        # `since` then is older.
        settled, together = False, -1
        for k in range(n_steps):
            if (k == 0) | (sigma_strides[0] > 0):
                start = k * sigma_strides[0] + begin * sigma_strides[1]
                for j in range(n_axes):
                    place = start + j * sigma_strides[2]
                    _copy_in(b, sigma_row + j, sigmas, place, sigma_strides[1], count)
            at, start = (k * lanes + begin) * n_axes, k * time_strides[0] + begin * time_strides[1]
            whole, found = True, 0
            if _unusual(plots, at, count * n_axes):
                infinite += _infinite(plots, at, count * n_axes)
                whole = not elapsed
                if restored:
                    found = _find_missed(plots, at, n_axes, count, missed)
                    _save(b, restored, missed, found, saved)

            code = 0
            if settled & (results | (k < n_steps - 1)):
                code = steady if together >= 0 else apart
            if (together >= 0) & (code != 0):
                b[dt_row * BLOCK] = times[start] - times[together * time_strides[0]]
            else:
                if together >= 0:
                    _pass_time(since, times, together * time_strides[0], 0, count)
                    together = -1
                _elapsed(b, dt_row, times, start, time_strides[1], since, count)
            if code != 0:
                target, place = (predicted, at) if len(predicted) else (unwanted, 0)
                block, read, write = pointer(b, 0), pointer(plots, at), pointer(target, place)
                call(code, (block, count, b[dt_row * BLOCK], read, write))
            else:
                for j in range(n_axes):
                    _copy_in(b, plot_row + j, plots, at + j, n_axes, count)
                call(step, (pointer(b, 0), count))
                settled = (steady != 0) and _all_have(b, plots_row, count, 2.0)
            # A lane has one of each gain, and one of every other output for each axis.
            for o in range(1 if code != 0 else 0, len(outputs)):
                if len(outputs[o]):
                    width = n_axes if o < len(outputs) - 3 else gain_sets
                    for j in range(width):
                        place = (k * lanes + begin) * width + j
                        _copy_out(b, output_rows[o] + j, outputs[o], place, width, count)
            if k == n_steps - 1:
                for r in range(3 * n_axes):
                    _copy_out(b, shown + r, states, (now + r) * lanes + begin, 1, count)
            _restore(b, restored, missed, found, saved)
            if len(memories):
                width = state - memory_row
                for r in range(width):
                    place = (k * lanes + begin) * width + r
                    _copy_out(b, memory_row + r, memories, place, width, count)

            if whole & common:
                together = k
            else:
                if together >= 0:
                    _pass_time(since, times, together * time_strides[0], 0, count)
                    together = -1
                if whole:
                    _pass_time(since, times, start, time_strides[1], count)
                else:
                    _pass_time_of_seen(
                        since, times, start, time_strides[1], plots, at, n_axes, count
                    )
        if together >= 0:
            _pass_time(since, times, together * time_strides[0], 0, count)
        for r in range(end):
            _copy_out(b, r, states, r * lanes + begin, 1, count)
        for i in range(count):
            states[last_time * lanes + begin + i] = since[i]
    return infinite


def _fill_common(
    b: Any, sigma_row: int, n_axes: int, t: float, sigma: float, into: Any, lanes: int, begin: int,
    count: int,
) -> None:  # fmt: skip
    """Fill in one sigma for all lanes, and one time."""
    for j in range(n_axes):
        for i in range(count):
            b[(sigma_row + j) * BLOCK + i] = sigma
    for i in range(count):
        into[i] = t


def _fill_own(
    b: Any, sigma_row: int, n_axes: int, t: Any, sigmas: Any, into: Any, lanes: int, begin: int,
    count: int,
) -> None:  # fmt: skip
    """Fill in the time of each track, and the sigma of each plot or one for all."""
    each = 1 if len(sigmas) > 1 else 0
    for j in range(n_axes):
        place = each * (begin * n_axes + j)
        _copy_in(b, sigma_row + j, sigmas, place, each * n_axes, count)
    # Lanes of a track lie side by side: one of each track, then the next of each.
    per_track = lanes // len(t)
    for first in range(min(per_track, count)):
        track = (begin + first) // per_track
        out_of, lane = t[track:], into[first:]
        for i in range((count - first + per_track - 1) // per_track):
            lane[i * per_track] = out_of[i]


def _one_step(fill: Callable[..., None]) -> Callable[..., int]:
    """Function that takes all lanes one step on, with times and sigmas that `fill` fills in.

    It is `_run` cut down to what tracks that come plot by plot need. It returns how many plots are
    infinite, or positions and velocities of tracks no numbers; `new` is of no use then.
    """

    def one_step(
        step: int, elapsed: bool, places: Any, b: Any, missed: Any, old: Any, plots: Any, t: Any,
        sigma: Any, new: Any,
    ) -> int:  # fmt: skip
        (
            n_axes, _, state, end, shown, now, last_time, restored, plot_row, sigma_row, dt_row,
            plots_row, _,
        ) = places  # fmt: skip
        lanes, lost = old.shape[1], 0
        before, after = old.reshape(-1), new.reshape(-1)
        for begin in range(0, lanes, BLOCK):
            count = min(BLOCK, lanes - begin)
            for r in range(state):
                _copy_in(b, r, before, r * lanes + begin, 1, count)
            for j in range(n_axes):
                _copy_in(b, plot_row + j, plots, begin * n_axes + j, n_axes, count)
            since, times = before[last_time * lanes + begin :], after[last_time * lanes + begin :]
            fill(b, sigma_row, n_axes, t, sigma, times, lanes, begin, count)
            _elapsed(b, dt_row, times, 0, 1, since, count)
            call(step, (pointer(b, 0), count))
            for r in range(3 * n_axes):
                lost += _lost(b, shown + r, plots_row, count)
            for r in range(end):
                _copy_out(b, r, after, r * lanes + begin, 1, count)
            for r in range(3 * n_axes):
                _copy_out(b, shown + r, after, (now + r) * lanes + begin, 1, count)
            if elapsed and _unusual(plots, begin * n_axes, count * n_axes):
                for k in range(_find_missed(plots, begin * n_axes, n_axes, count, missed)):
                    i = begin + missed[k]
                    for r in range(restored):
                        after[r * lanes + i] = before[r * lanes + i]
                    after[last_time * lanes + i] = before[last_time * lanes + i]
        return lost + _infinite(plots, 0, lanes * n_axes)

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
        Whether it is given the time of each track and the sigma of each plot, as arrays, or one
        number for all.
    """
    return compiled(_one_step(_fill_own if own else _fill_common))
