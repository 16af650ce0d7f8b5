"""How a radar makes its scans, recognized by times and bearings of plots.

A radar that gives a whole scan at once gives its plots the same time, or nearly so. The plots of a
turning antenna come one by one: their bearings grow with time, a circle in a period. The period is
the one at which the bearings, turned back by the antenna, agree best: the largest length of the
mean of exp(i (bearing - 2 pi time / period)), the periodogram of directions (Lomb's for a circle).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.recordings.scan_cut import ScanCut
from fuzzytrack.recordings.scan_rows import ScanRows

__all__ = ["AntennaTurn", "antenna_of", "recognize_scans", "turn_of_antenna"]

# Periods of antennas that are looked for (s), from fast ship radars to slow early warning.
SHORTEST, LONGEST = 0.5, 60.0
# Rows whose bearings are looked at: fewer where more show nothing, since the period may change; and
# the fewest that say anything.
_ROWS, _FEWEST = (2_000, 400, 100), 12
# Mean length of the directions from which on the bearings follow the antenna: of 12 independent
# bearings and 10,000 periods, chance reaches .9 in about one of 1,000 recordings.
_AGREE = 0.9
# Part of the rows that share their time with another one, where scans are made at once.
_SHARED = 0.3
# How many times longer a gap between scans is than one within.
_APART = 4.0
# Periods that are tried together, so that memory stays small.
_BLOCK = 256


@dataclass(frozen=True)
class AntennaTurn:
    """The turning of an antenna.

    Attributes
    ----------
    period : float
        Time of a turn (s).
    clockwise : bool
        Whether bearings, counted from the second axis to the first, grow with time.
    start : float
        A time at which the antenna points along the second axis (s).
    agreement : float
        Length of the mean direction, 1 where all bearings fit exactly.
    """

    period: float
    clockwise: bool
    start: float
    agreement: float

    @property
    def said(self) -> str:
        """What was found, in words."""
        sense = "clockwise" if self.clockwise else "counter-clockwise"
        return f"the antenna turns {sense} in {self.period:.4g} s, by the bearings of the plots"

    def phase(self, time: Array | float) -> Array:
        """Bearing of the antenna (rad, not wrapped) at times (s)."""
        turned = 2 * math.pi * (np.asarray(time) - self.start) / self.period
        return turned if self.clockwise else -turned


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
    return _by_gaps(rows.time, steps)


def _by_gaps(time: Array, steps: Array) -> tuple[ScanCut | None, str]:
    """Scans between which there are longer times than within."""
    positive = np.sort(steps[steps > 0])
    if len(positive) < _FEWEST or positive[-1] < _APART * positive[0]:
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


def antenna_of(rows: ScanRows, period: float | None, file: str) -> AntennaTurn:
    """The turning of the antenna, which the plots must show.

    Parameters
    ----------
    rows : ScanRows
        In order of time.
    period : float or None
        About the time of a turn (s), if it is known.
    file : str
        Name of the file, for the message.

    Raises
    ------
    DataError
        If the bearings do not follow a turning antenna.
    """
    found = turn_of_antenna(rows, period)
    if found is None:
        about = "" if period is None else f" that turns in {period:.4g} s"
        raise DataError(
            f"{file}: the bearings of the plots do not follow an antenna{about}; `sectors` needs "
            "plots with times and bearings of their own, about the position of the radar"
        )
    return found


def turn_of_antenna(rows: ScanRows, period: float | None = None) -> AntennaTurn | None:
    """The turning of the antenna by the bearings of the plots; None if they show none.

    Parameters
    ----------
    rows : ScanRows
        In order of time; bearings are seen from their `own`, the origin where that is NaN.
    period : float, optional
        About the time of a turn (s): only times within 5 % of it are looked for.
    """
    own = np.where(np.isnan(rows.own), 0.0, rows.own)
    offset = rows.positions - own
    good = np.flatnonzero(~np.isnan(offset).any(axis=1))
    time, bearing = rows.time[good], np.arctan2(offset[good, 0], offset[good, 1])
    for few in dict.fromkeys(min(count, len(good)) for count in _ROWS):
        found = _turn_of(time[:few], bearing[:few], period) if few >= _FEWEST else None
        if found is not None:
            return found
    return None


def _turn_of(time: Array, bearing: Array, period: float | None) -> AntennaTurn | None:
    """The turning of the antenna by bearings (rad) at some times."""
    since = time - time[0]
    span = float(since[-1])
    if span < 2 * SHORTEST:
        return None
    # Four times as dense as frequencies can be told apart; a turn must be seen twice.
    lowest = max(1 / LONGEST, 2 / span)
    highest = 1 / SHORTEST
    if period is not None:
        lowest, highest = 0.95 / period, 1.05 / period
    frequencies = np.arange(lowest, highest, 1 / (4 * span))
    best = (0.0, 0.0)
    for sign in (1.0, -1.0):
        for first in range(0, len(frequencies), _BLOCK):
            some = frequencies[first : first + _BLOCK]
            length = _agreement(sign * some, since, bearing)
            at = int(np.argmax(length))
            best = max(best, (float(length[at]), float(sign * some[at])))
    if best[0] < _AGREE / 2:
        return None
    rate = _refined(best[1], since, bearing, 1 / (4 * span))
    mean = np.mean(np.exp(1j * (bearing - 2 * math.pi * rate * since)))
    if abs(mean) < _AGREE:
        return None
    # The antenna points to bearing 0 when the mean direction and the turned angle add up to 0.
    start = float(time[0]) - float(np.angle(mean)) / (2 * math.pi * rate)
    return AntennaTurn(1 / abs(rate), rate > 0, start, float(abs(mean)))


def _agreement(rates: Array, since: Array, bearing: Array) -> Array:
    """Length of the mean direction for each rate (turns a second)."""
    angles = bearing - 2 * math.pi * rates[:, None] * since
    return np.asarray(np.hypot(np.cos(angles).mean(axis=1), np.sin(angles).mean(axis=1)))


def _refined(rate: float, since: Array, bearing: Array, width: float) -> float:
    """Rate of best agreement near one, by closer and closer grids."""
    for _ in range(12):
        some = rate + np.linspace(-width, width, 9)
        rate = float(some[np.argmax(_agreement(some, since, bearing))])
        width /= 3
    return rate
