"""The rules for faults of recordings, row by row, as one scalar function for all tracks.

It runs over lists in plain Python and compiled over arrays, to the same bits: all that it knows of
a track stands in a few numbers, and each row is judged by what came before it. So pieces of any
size give the same answers. `fuzzytrack.io.cleaning` uses it.
"""

from __future__ import annotations

import math
from typing import Any

__all__ = ["COPY", "OWN", "WAITS", "clean_rows"]

# Numbers of a track: the first and then two positions, of its last row and of its last plot.
STARTED, TIME, TURNS, ROW, FILE = 0, 1, 2, 3, 4
PLOT, PLOTS, SEGMENT, INTERVALS, SUM = 5, 6, 7, 8, 9
# What has been counted in it, and whether it has stopped at a row that is out of order.
COPIES, STALES, DELAYED, SEGMENTS, COASTED, WRAPS = range(10, 16)
STOPPED = 16
# Time of the row before the last one.
BEFORE = 17
OWN = 18

# Rules.
STALE, LEAST_STEP, MAX_GAP, MAX_COAST, RECOGNIZE, GAP_FACTOR, GAP_INTERVALS = range(7)
# The clock: its period, 0 where unknown, and the time of the row before in the file.
PERIOD, NOW = 0, 1
#: What stands for the segment of a row that was dropped as a copy, and of one that waits.
COPY, WAITS = -1, -2

# Periods of clocks (s): a day, a week, and counters of 32 bits in milliseconds and microseconds.
PERIODS = (86_400.0, 604_800.0, 2**32 / 1e3, 2**32 / 1e6)
# A clock that has started again goes on within so many mean intervals.
_PLAUSIBLE = 20.0
# Times that are earlier by less than this part of the period are out of order.
_DISORDER = 0.25


def clean_rows(
    slots: Any,
    time: Any,
    rows: Any,
    plots: Any,
    n_axes: int,
    file: int,
    rules: Any,
    clock: Any,
    state: Any,
    kept: Any,
    segments: Any,
) -> int:
    """Judge rows, in the order of the file.

    A track stops at the first row whose time is not later than that of the row before: this row and
    all later ones of the track wait, and its numbers are those before it.

    Parameters
    ----------
    slots : sequence of int, length n_rows
        Place of the track of each row in `state`.
    time : sequence of float, length n_rows
        Times; overwritten where the clock has started again.
    rows : sequence of int, length n_rows
        Where the rows stand in the file.
    plots : sequence of float, length n_rows * n_axes
        Positions; overwritten with NaN where a plot is taken as missed.
    n_axes, file : int
        Number of axes, and number of the file.
    rules, clock, state : sequence of float
        The rules; the clock and the tracks so far, which are brought up to date.
    kept : sequence of bool, length n_rows
        Set to false where a row is dropped or waits.
    segments : sequence of int, length n_rows
        Overwritten with the part of its track that a row belongs to, or with `COPY` or `WAITS`.

    Returns
    -------
    int
        Place of the first row at which a track has stopped; -1 if there is none.
    """
    width, wrong = OWN + 2 * n_axes, -1
    for i in range(len(slots)):
        track, here = slots[i] * width, i * n_axes
        last, held = track + OWN, track + OWN + n_axes
        if state[track + STOPPED] != 0.0:
            kept[i], segments[i] = False, WAITS
            continue
        turns = state[track + TURNS]
        now = _unwrapped(time[i], track, rules, clock, state)
        time[i] = now
        if state[track + STARTED] != 0.0 and now <= state[track + TIME]:
            kept[i] = False
            if now == state[track + TIME] and _same(plots, here, state, last, n_axes):
                state[track + COPIES] += 1.0
                segments[i] = COPY
                continue
            # It may be from before the clock started again.
            state[track + STOPPED], state[track + TURNS] = 1.0, turns
            segments[i] = WAITS
            if wrong < 0:
                wrong = i
            continue
        started = state[track + STARTED] != 0.0
        state[track + BEFORE] = state[track + TIME] if started else -math.inf
        state[track + STARTED], state[track + TIME] = 1.0, now
        state[track + ROW], state[track + FILE] = float(rows[i]), float(file)
        plot = False
        for axis in range(n_axes):
            value = plots[here + axis]
            state[last + axis] = value
            plot = plot or value == value
        # NaN before the first plot: then none of the comparisons holds.
        since = now - state[track + PLOT]
        if plot and since <= rules[STALE] and _same(plots, here, state, held, n_axes):
            plot = False
            _miss(plots, here, n_axes)
            state[track + STALES] += 1.0
        if state[track + PLOTS] > 0.0 and since > _longest(track, rules, state):
            state[track + PLOTS] = 0.0
            state[track + SEGMENT] += 1.0
        segments[i] = int(state[track + SEGMENT])
        if not plot:
            if since > rules[MAX_COAST]:
                kept[i] = False
                state[track + COASTED] += 1.0
        elif state[track + PLOTS] == 1.0 and since < rules[LEAST_STEP]:
            _miss(plots, here, n_axes)
            state[track + DELAYED] += 1.0
        else:
            _accept(plots, here, n_axes, now, track, state)
    return wrong


def _accept(plots: Any, here: int, n_axes: int, now: float, track: int, state: Any) -> None:
    """Remember a plot."""
    if state[track + PLOTS] > 0.0:
        state[track + INTERVALS] += 1.0
        state[track + SUM] += now - state[track + PLOT]
        state[track + PLOTS] = 2.0
    else:
        if state[track + SEGMENT] > 0.0:
            state[track + SEGMENTS] += 1.0
        state[track + PLOTS] = 1.0
    state[track + PLOT] = now
    for axis in range(n_axes):
        state[track + OWN + n_axes + axis] = plots[here + axis]


def _longest(track: int, rules: Any, state: Any) -> float:
    """The longest time between plots that does not end the track."""
    longest: float = rules[MAX_GAP]
    if longest < 0.0:
        # By the mean of the intervals so far; a gap that has ended the track is none of them.
        intervals = state[track + INTERVALS]
        longest = math.inf
        if intervals >= rules[GAP_INTERVALS]:
            longest = rules[GAP_FACTOR] * state[track + SUM] / intervals
    return longest


def _unwrapped(time: float, track: int, rules: Any, clock: Any, state: Any) -> float:
    """Time of a row, with the periods after which the clock has started again."""
    period, turns, before = clock[PERIOD], state[track + TURNS], clock[NOW]
    if state[track + STARTED] == 0.0:
        if period > 0.0 and before == before:
            turns = _nearest(time, period, before)
    else:
        last, mean = state[track + TIME], 0.0
        if state[track + INTERVALS] > 0.0:
            mean = state[track + SUM] / state[track + INTERVALS]
        later = time + turns * period - last
        if later < 0.0 and period == 0.0 and rules[RECOGNIZE] != 0.0:
            period = _recognized(-later, mean)
            clock[PERIOD] = period
        if later < 0.0 and period > 0.0:
            after = turns + 1.0
            if -later < _DISORDER * period:
                # Out of order, unless other tracks show that the clock has started again.
                after = max(turns, _nearest(time, period, before))
            if time + after * period > last and after > turns:
                state[track + WRAPS] += 1.0
                turns = after
        elif turns > 0.0 and period - later <= min(_PLAUSIBLE * mean, _DISORDER * period):
            # A row from before midnight among those from after it.
            turns -= 1.0
    state[track + TURNS] = turns
    now: float = time + turns * period
    clock[NOW] = now
    return now


def _nearest(time: float, period: float, before: float) -> float:
    """Periods that bring a time nearest to another."""
    return float(math.floor((before - time) / period + 0.5))


def _recognized(fall: float, mean: float) -> float:
    """Period of a clock that falls by less, and then goes on as before; 0 if it is none."""
    for period in PERIODS:
        if 0.0 < period - fall <= _PLAUSIBLE * mean:
            return period
    return 0.0


def _same(plots: Any, here: int, state: Any, there: int, n_axes: int) -> bool:
    """Whether two positions are equal, with NaN in the same axes."""
    for axis in range(n_axes):
        one, other = plots[here + axis], state[there + axis]
        if one != other and (one == one or other == other):
            return False
    return True


def _miss(plots: Any, here: int, n_axes: int) -> None:
    for axis in range(n_axes):
        plots[here + axis] = math.nan
