"""The last stage of a scan: what is reported of its tracks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzytrack.scan.clock import HAS_DUE, REPORTS, ROWS, SCAN, SCAN_TIME, TENTATIVE_TOO
from fuzzytrack.scan.kind.base import KindKernels
from fuzzytrack.scan.quality.base import QualityKernels
from fuzzytrack.scan.report.base import ReportKernels
from fuzzytrack.scan.report_columns import (
    REPORT_DEVIATION,
    REPORT_EXISTENCE,
    REPORT_ID,
    REPORT_KIND,
    REPORT_PLOT,
    REPORT_POSITION,
    REPORT_SCAN,
    REPORT_SINCE,
    REPORT_STATUS,
    REPORT_TIME,
    REPORT_VELOCITY,
)
from fuzzytrack.scan.stages.lookahead import AHEAD, fetch_row
from fuzzytrack.scan.stages.plots import DONE
from fuzzytrack.scan.stages.tracks import CONFIRMED
from fuzzytrack.scan.track_columns import FIXED, ID, MISSES, PLOT, STATUS, TIME
from fuzzytrack.scan.update.base import UpdateKernels

__all__ = ["report_stage"]

#: Values of a digit by which identities are put in order; the scratch of parts has room for them.
_DIGITS = 256


def find_places(tracks: Any, order: Any, n: int, place: Any, spare: Any, counters: Any) -> None:
    """Find the place of each track in the order of identities, digit by digit of these.

    Parameters
    ----------
    tracks : ndarray
    order : ndarray of int
        Rows of `n` tracks, 1 at least.
    place : ndarray of int
        The place of each of them, written here.
    spare, counters : ndarray of int
        Scratch, of `n` and `_DIGITS` numbers.
    """
    least = most = int(tracks[order[0], ID])
    for k in range(n):
        identity = int(tracks[order[k], ID])
        least, most = min(least, identity), max(most, identity)
        place[k] = identity
    shift = 0
    while n >> shift > 0:
        shift += 1
    numbers = (1 << shift) - 1
    for k in range(n):
        # Both in one number, so that they move together.
        place[k] = ((place[k] - least) << shift) + k
    left = most - least
    while left > 0:
        for digit in range(_DIGITS):
            counters[digit] = 0
        for k in range(n):
            counters[(place[k] >> shift) & (_DIGITS - 1)] += 1
        begin = 0
        for digit in range(_DIGITS):
            here = counters[digit]
            counters[digit] = begin
            begin += here
        for k in range(n):
            digit = (place[k] >> shift) & (_DIGITS - 1)
            spare[counters[digit]] = place[k]
            counters[digit] += 1
        for k in range(n):
            place[k] = spare[k]
        shift, left = shift + 8, left >> 8
    for k in range(n):
        spare[place[k] & numbers] = k
    for k in range(n):
        place[k] = spare[k]


def report_stage(
    update: UpdateKernels, quality: QualityKernels, kind: KindKernels, report: ReportKernels
) -> Callable[..., int]:
    """Stage that writes what is reported."""
    predict, velocity_variance = update.predict, update.velocity_variance
    existence, reported_kind, shown = quality.existence, kind.reported, report.shown

    def write(tracks: Any, i: int, work: Any, n: int, now: float) -> None:
        numbers, whole, words = work.report, work.report_whole, work.report_words
        coasts = tracks[i, MISSES] > 0.0
        time = now if coasts else tracks[i, TIME]
        dt = time - tracks[i, TIME]
        x, y, vx, vy, p11, _, p22 = predict(tracks, i, dt)
        v11, v22 = velocity_variance(tracks, i, dt)
        numbers[n, REPORT_TIME], numbers[n, REPORT_SINCE] = time, dt
        numbers[n, REPORT_POSITION], numbers[n, REPORT_POSITION + 1] = x, y
        numbers[n, REPORT_VELOCITY], numbers[n, REPORT_VELOCITY + 1] = vx, vy
        numbers[n, REPORT_DEVIATION] = math.sqrt(p11)
        numbers[n, REPORT_DEVIATION + 1] = math.sqrt(p22)
        numbers[n, REPORT_DEVIATION + 2] = math.sqrt(v11)
        numbers[n, REPORT_DEVIATION + 3] = math.sqrt(v22)
        numbers[n, REPORT_EXISTENCE] = existence(tracks, i)
        whole[n, REPORT_SCAN], whole[n, REPORT_ID] = int(work.clock[SCAN]), int(tracks[i, ID])
        whole[n, REPORT_PLOT] = int(tracks[i, PLOT])
        status = 0
        if tracks[i, STATUS] == CONFIRMED:
            status = 2 if coasts else 1
        words[n, REPORT_STATUS], words[n, REPORT_KIND] = status, int(reported_kind(tracks, i))

    def report_stage(work: Any) -> int:
        tracks, clock, counts, due = work.tracks, work.clock, work.counts, work.due
        # Plots of tracks are no longer needed.
        order = work.plot_of
        some_due, tentative_too = counts[HAS_DUE] > 0, counts[TENTATIVE_TOO] > 0
        n, last, in_order = 0, 0.0, True
        for i in range(counts[ROWS]):
            fetch_row(tracks, i + AHEAD, STATUS + 1)
            status = tracks[i, STATUS]
            if status == 0.0 or (some_due and due[i] == 0):
                continue
            if tentative_too or (status == CONFIRMED and shown(tracks, i, clock)):
                order[n] = i
                n += 1
                in_order = in_order and tracks[i, ID] > last
                last = tracks[i, ID]
        # As are edges, free rows, and what the association has written.
        place = work.first
        if in_order:
            for k in range(n):
                place[k] = k
        else:
            find_places(tracks, order, n, place, work.free, work.integers)
        for k in range(n):
            fetch_row(tracks, order[min(k + AHEAD, n - 1)], FIXED)
            write(tracks, order[k], work, place[k], clock[SCAN_TIME])
        counts[REPORTS] = n
        return DONE

    return report_stage
