"""How a radar makes its scans, recognized by times and bearings of plots.

A radar that gives a whole scan at once gives its plots the same time, or nearly so. The plots of a
turning antenna come one by one, see `fuzzytrack.recordings.antenna_turn`; so do those of a single
target.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.recordings.antenna_turn import FEWEST, bearings_of, turn_of_antenna
from fuzzytrack.recordings.scan_cut import ScanCut
from fuzzytrack.recordings.scan_rows import ScanRows

__all__ = ["period_doubt", "recognize_scans"]

# Part of the rows that share their time with another one, where scans are made at once.
_SHARED = 0.3
# How many times longer a gap between scans is than one within.
_APART = 4.0
# Plots of one target: how far times between them may be from whole numbers of the usual one, in
# parts of it, and how nearly one plot is in the direction of the one before, as a mean cosine.
_UNEVEN, _SAME_WAY = 0.1, 0.9
# Ratios of a period that is given and one that is recognized from which on they differ; scans that
# are recognized by gaps can be parts of turns.
_OTHER, _OTHER_BY_GAPS = 1.1, 3.0


def recognize_scans(rows: ScanRows) -> tuple[ScanCut | None, str]:
    """Find out how rows are divided into scans.

    Parameters
    ----------
    rows : ScanRows
        First rows of one recording, in order of time.

    Returns
    -------
    cut : ScanCut or None
        None if nothing is recognized.
    said : str
        What was found, in a sentence.
    """
    steps = np.diff(rows.time)
    between = steps[steps > 0]
    if not len(between):
        return None, "all plots have one time"
    distinct = len(between) + 1
    if 1 - distinct / len(rows) >= _SHARED:
        period = float(np.median(between))
        return ScanCut("times", period), f"plots of equal time are a scan; one every {period:.4g} s"
    turn = turn_of_antenna(rows)
    if turn is not None:
        return ScanCut("period", turn.period), turn.said
    cut, said = _by_gaps(rows.time, steps)
    return (cut, said) if cut is not None else (_of_one_target(rows, steps) or (None, said))


def period_doubt(rows: ScanRows, period: float) -> str:
    """What plots say against a time of a turn that was given.

    Parameters
    ----------
    rows : ScanRows
        As for `recognize_scans`.
    period : float
        The time of a turn (s).

    Returns
    -------
    str
        A sentence; empty if they say nothing.
    """
    found, said = recognize_scans(rows) if len(rows) else (None, "")
    if found is None:
        return ""
    ratio = found.period / period
    if max(ratio, 1 / ratio) < (_OTHER_BY_GAPS if found.rule == "gaps" else _OTHER):
        return ""
    return f"`period` is {period:.4g} s, but {said}; leave `period` out, or give {found.period:.4g}"


def _by_gaps(time: Array, steps: Array) -> tuple[ScanCut | None, str]:
    """Scans between which there are longer times than within."""
    positive = np.sort(steps[steps > 0])
    if len(time) <= FEWEST:
        return None, f"{len(time)} plots are too few to recognize it"
    if len(positive) < FEWEST or positive[-1] < _APART * positive[0]:
        return None, "the times between plots have no two kinds, within scans and between them"
    # The widest step on a scale of ratios, where neither side is a handful of rows.
    few = max(2, len(positive) // 20)
    ratios = positive[1:] / positive[:-1]
    inner = ratios[few - 1 : len(ratios) - few + 1]
    place = int(np.argmax(inner)) + few - 1
    if ratios[place] < _APART:
        return None, "the times between plots have no two kinds, within scans and between them"
    gap = math.sqrt(positive[place] * positive[place + 1])
    starts = time[np.append(True, steps > gap)]
    period = float(np.median(np.diff(starts)))
    return ScanCut("gaps", period, gap), (
        f"plots with less than {gap:.3g} s between them are a scan; one every {period:.4g} s"
    )


def _of_one_target(rows: ScanRows, steps: Array) -> tuple[ScanCut, str] | None:
    """Scans of one plot each: equal times between them, and one direction."""
    bearing = bearings_of(rows)
    if len(rows) < FEWEST or not (steps > 0).all() or np.isnan(bearing).any():
        return None
    period = float(np.median(steps))
    turns = np.round(steps / period)
    even = (turns >= 1) & (np.abs(steps / period - turns) <= _UNEVEN)
    if even.mean() < _SAME_WAY or np.cos(np.diff(bearing)).mean() < _SAME_WAY:
        return None
    return ScanCut("times", period), f"each plot is a scan; one every {period:.4g} s"
