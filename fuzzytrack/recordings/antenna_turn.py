"""The turning of an antenna, recognized by the bearings of its plots.

The plots of a turning antenna come one by one: their bearings grow with time, a circle in a period.
The period is the one at which the bearings, turned back by the antenna, agree best: the largest
length of the mean of exp(i (bearing - 2 pi time / period)), the periodogram of directions (Lomb's
for a circle).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.recordings.scan_rows import ScanRows

__all__ = ["AntennaTurn", "antenna_of", "bearings_of", "turn_of_antenna"]

# Periods of antennas that are looked for (s), from fast ship radars to slow early warning.
SHORTEST, LONGEST = 0.5, 60.0
# Rows whose bearings are looked at: fewer where more show nothing, since the period may change; and
# the fewest that say anything.
_ROWS, FEWEST = (2_000, 400, 100), 12
# Mean length of the directions from which on the bearings follow the antenna: of 12 independent
# bearings and 10,000 periods, chance reaches .9 in about one of 1,000 recordings.
_AGREE = 0.9
# Another rate whose directions spread less than so many times as much is as likely.
_RIVAL = 3.0
# The most products of rows and periods: a recording with so few plots in a turn that there are more
# is tried by fewer rows.
_MOST_PRODUCTS = 40_000_000
# Over a longer time without a plot (s) turns cannot be counted on.
_GAP = 5 * LONGEST


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
    bearing = bearings_of(rows)
    good = np.flatnonzero(~np.isnan(bearing))
    good = good[_longest_stretch(rows.time[good])]
    time, bearing = rows.time[good], bearing[good]
    for few in dict.fromkeys(min(count, len(good)) for count in _ROWS):
        found = _turn_of(time[:few], bearing[:few], period) if few >= FEWEST else None
        if found is not None:
            return found
    return None


def _longest_stretch(time: Array) -> slice:
    """The most times (s) that follow each other without a gap."""
    ends = np.flatnonzero(np.append(np.diff(time) > _GAP, True)) + 1
    longest = int(np.argmax(np.diff(ends, prepend=0)))
    return slice(int(ends[longest - 1]) if longest else 0, int(ends[longest]))


def bearings_of(rows: ScanRows) -> Array:
    """Bearings of plots from the radar (rad), the origin where it is not known; NaN without one."""
    offset = rows.positions - np.where(np.isnan(rows.own), 0.0, rows.own)
    return np.asarray(np.arctan2(offset[:, 0], offset[:, 1]))


def _turn_of(time: Array, bearing: Array, period: float | None) -> AntennaTurn | None:
    """The turning of the antenna by bearings (rad) at some times."""
    since = time - time[0]
    span = float(since[-1])
    if span < 2 * SHORTEST:
        return None
    # Four times as dense as frequencies can be told apart; a turn must be seen twice.
    lowest, highest, step = max(1 / LONGEST, 2 / span), 1 / SHORTEST, 1 / (4 * span)
    if period is not None:
        lowest, highest = 0.95 / period, 1.05 / period
    least = 0.0 if period is None else lowest
    if (highest - least) / step * 2 * len(since) > _MOST_PRODUCTS:
        return None
    rates = np.arange(least, highest, step)
    sides = (_on_grid(first, step, len(rates), since, bearing) for first in (-rates[-1], least))
    lengths = np.concatenate(list(sides))
    rates = np.append(-rates[::-1], rates)
    turning = np.abs(rates) >= lowest
    if not turning.any() or lengths[turning].max() < _AGREE / 2:
        return None
    rate, agreement = _refined(rates, lengths, turning, since, bearing)
    if agreement < _AGREE:
        return None
    # Plots in one direction, or at equal steps of time, fit several rates: they show no turn.
    others = np.abs(rates - rate) > 1 / span
    if others.any():
        _, rival = _refined(rates, lengths, others, since, bearing)
        if 1 - rival < _RIVAL * (1 - agreement) + 1e-9:
            return None
    # The antenna points to bearing 0 when the mean direction and the turned angle add up to 0.
    mean = np.mean(np.exp(1j * (bearing - 2 * math.pi * rate * since)))
    start = float(time[0]) - float(np.angle(mean)) / (2 * math.pi * rate)
    return AntennaTurn(1 / abs(rate), rate > 0, start, agreement)


def _on_grid(first: float, step: float, count: int, since: Array, bearing: Array) -> Array:
    """`_agreement` for rates at equal steps from the first one on."""
    # A rate is a coarse one plus a fine one, so the sums over rows are a product of two matrices.
    fine = math.isqrt(count) + 1
    coarse = first + step * fine * np.arange(-(-count // fine))
    turned = np.exp(1j * (bearing - 2 * math.pi * coarse[:, None] * since))
    further = np.exp(-2j * math.pi * step * since[:, None] * np.arange(fine))
    return np.asarray(np.abs(turned @ further).ravel()[:count] / len(since))


def _agreement(rates: Array, since: Array, bearing: Array) -> Array:
    """Length of the mean direction for each rate (turns a second)."""
    angles = bearing - 2 * math.pi * rates[:, None] * since
    return np.asarray(np.hypot(np.cos(angles).mean(axis=1), np.sin(angles).mean(axis=1)))


def _refined(
    rates: Array, lengths: Array, chosen: Mask, since: Array, bearing: Array
) -> tuple[float, float]:
    """Rate of best agreement near the best one of those chosen, by finer and finer grids."""
    rate = float(rates[chosen][np.argmax(lengths[chosen])])
    width = 1 / (4 * float(since[-1]))
    for _ in range(12):
        some = rate + np.linspace(-width, width, 9)
        found = _agreement(some, since, bearing)
        rate = float(some[np.argmax(found)])
        width /= 3
    return rate, float(found.max())
