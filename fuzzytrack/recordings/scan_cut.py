"""Where one scan ends and the next begins, in the rows of a recording."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.recordings.scan_rows import ScanRows

__all__ = ["Cutter", "ScanCut"]

Rule = Literal["column", "times", "gaps", "period"]

# A time without a plot that is longer than this part of the period ends a scan.
_PAUSE = 0.5


@dataclass(frozen=True)
class ScanCut:
    """The rule by which rows are scans.

    Attributes
    ----------
    rule : {"column", "times", "gaps", "period"}
        A scan is rows that follow each other and have one word in a column; or one time; or no
        longer time between them than `gap`; or a turn of the antenna.
    period : float
        Usual time from scan to scan (s); NaN if it is not known.
    gap : float
        Time between scans (s), of the rule "gaps".

    Raises
    ------
    ValueError
        If a value is none that is allowed.

    Notes
    -----
    By the rule "period" a scan begins when a period has passed since the last one began, and
    also after half a period without a plot. So plots that come all at once are one scan although
    the period varies, and those of a turning antenna are divided at its turns.
    """

    rule: Rule = "column"
    period: float = math.nan
    gap: float = math.nan

    def __post_init__(self) -> None:
        if self.rule not in get_args(Rule):
            raise ValueError(f"rule: {self.rule!r}; expected one of {', '.join(get_args(Rule))}")
        for name, rule in (("period", "period"), ("gap", "gaps")):
            value = getattr(self, name)
            if self.rule == rule and not 0 < value < math.inf:
                raise ValueError(f"{name}: must be a number of seconds > 0, got {value!r}")


class Cutter:
    """Divides rows into scans, piece by piece.

    Parameters
    ----------
    cut : ScanCut
        The rule.
    """

    def __init__(self, cut: ScanCut) -> None:
        self._cut = cut
        self._word = ""
        self._last = self._start = math.nan

    def starts(self, rows: ScanRows) -> Mask:
        """Which rows begin a scan; the first of all does.

        Parameters
        ----------
        rows : ScanRows
            In order of time, but for the rule "column".
        """
        if not len(rows):
            return np.zeros(0, dtype=bool)
        first = math.isnan(self._last)
        if self._cut.rule == "column":
            found = rows.scans != np.append(self._word, rows.scans[:-1])
            self._word = str(rows.scans[-1])
        elif self._cut.rule == "period":
            found = self._turns(rows.time)
        else:
            pause = self._cut.gap if self._cut.rule == "gaps" else 0.0
            found = np.diff(rows.time, prepend=self._last) > pause
        self._last = float(rows.time[-1])
        found[0] |= first
        return np.asarray(found)

    def _turns(self, time: Array) -> Mask:
        """Rows at which a turn begins."""
        period, found = self._cut.period, np.zeros(len(time), dtype=bool)
        pauses = np.flatnonzero(np.diff(time, prepend=self._last) > _PAUSE * period)
        place = 0
        if math.isnan(self._start):
            self._start, found[0], place = float(time[0]), True, 1
        while True:
            turn = int(np.searchsorted(time[place:], self._start + period)) + place
            pause = int(np.searchsorted(pauses, place))
            at = int(pauses[pause]) if pause < len(pauses) else len(time)
            if min(turn, at) >= len(time):
                return found
            if turn < at:
                self._start, place = self._start + period, turn
            else:
                self._start, place = float(time[at]), at
            found[place] = True
            place += 1
