"""The rules for faults of real recordings, and the counts of what they have changed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from numbers import Real
from typing import Literal, get_args

from fuzzytrack.plurals import counted
from fuzzytrack.reprs import constructor_code

__all__ = ["Cleaning", "CleaningCounts", "Duplicates"]

#: What is done about plots of a track at equal times.
Duplicates = Literal["error", "first", "last", "mean"]


@dataclass(frozen=True, kw_only=True)
class Cleaning:
    """Rules for the faults of a recording. Exact copies of a row are always dropped.

    Parameters
    ----------
    duplicates : {"error", "first", "last", "mean"}
        Plots of one track at equal times: an error, or which one stands for them. A row without a
        plot does not count beside one with a plot.
    stale : float, optional
        A position that equals the one before to the last digit is repeated by the sensor, and a
        missed plot, for so long after it was first seen (s); may be infinite.
    least_step : float, optional
        Plots that follow the first one of a track within this time (s) are missed plots: a velocity
        from two plots needs a baseline.
    max_gap : float, "auto" or None
        A longer time without a plot (s) ends the track, and the next plot begins a new segment of
        it; None never does. "auto" is 100 times the mean of the intervals of the track so far, from
        the eighth on.
    max_coast : float, optional
        Rows without a plot that are later than this after the last plot (s) are dropped.
    wrap : float, "auto" or None
        Period after which the clock starts again (s). "auto" recognizes midnight, the end of the
        week, and counters of 32 bits in milliseconds or microseconds, but not the hour: recordings
        of an hour each, one after the other, look alike. With None a time that falls is an error.
    fill_limit : float
        Greater magnitudes than this stand for no position, as 9.97e36 does, and are missed plots.

    Raises
    ------
    ValueError
        If a value is none of those allowed.
    """

    duplicates: Duplicates = "error"
    stale: float | None = None
    least_step: float | None = None
    max_gap: float | Literal["auto"] | None = "auto"
    max_coast: float | None = None
    wrap: float | Literal["auto"] | None = "auto"
    fill_limit: float = 1e15

    def __post_init__(self) -> None:
        if self.duplicates not in get_args(Duplicates):
            words = ", ".join(get_args(Duplicates))
            raise ValueError(f"duplicates: {self.duplicates!r}; expected one of {words}")
        positive = "a number of seconds above 0"
        for name in ("stale", "least_step"):
            self._check(name, positive, lambda value: value > 0)
        for name in ("max_gap", "wrap"):
            self._check(name, f"{positive}, or auto", lambda value: value > 0, "auto")
        self._check("max_coast", "a number of seconds, at least 0", lambda value: value >= 0)
        self._check("fill_limit", "a number above 0", lambda value: value > 0)
        if self.wrap not in (None, "auto") and math.isinf(float(self.wrap)):
            raise ValueError(f"wrap: {self.wrap}; expected {positive}, finite, or auto")

    def __repr__(self) -> str:
        return constructor_code(self)

    def _check(
        self, name: str, wanted: str, fits: Callable[[float], bool], word: str | None = None
    ) -> None:
        value = getattr(self, name)
        if value is None or value == word:
            return
        if not isinstance(value, Real) or isinstance(value, bool) or not fits(float(value)):
            raise ValueError(f"{name}: {value!r}; expected {wanted}")


@dataclass(frozen=True, kw_only=True)
class CleaningCounts:
    """What the rules have changed so far; counts of several cleaners are added with ``+``.

    Attributes
    ----------
    copies : int
        Exact copies of rows that were dropped.
    merged : int
        Rows that were merged into another one of equal time.
    fills : int
        Rows with values beyond any use, which are missed plots.
    stale : int
        Plots that repeated the position before, which are missed plots.
    delayed : int
        Plots too soon after the first one of a track, which are missed plots.
    segments : int
        Tracks that began again after a long time without a plot.
    coasted : int
        Rows without a plot, long after the last one, that were dropped.
    wraps : int
        Times that a clock has started again, in any track.
    period : float or None
        Period of the clock (s), if it is known.
    """

    copies: int = 0
    merged: int = 0
    fills: int = 0
    stale: int = 0
    delayed: int = 0
    segments: int = 0
    coasted: int = 0
    wraps: int = 0
    period: float | None = None

    def __add__(self, other: CleaningCounts) -> CleaningCounts:
        names = [field.name for field in fields(self) if field.name != "period"]
        sums = {name: getattr(self, name) + getattr(other, name) for name in names}
        return CleaningCounts(**sums, period=self.period or other.period)

    def sentences(self) -> tuple[str, ...]:
        """What was changed, a phrase for each kind of fault that there was."""
        said = []
        for count, one, several in (
            (self.copies, "exact copy of a row dropped", "exact copies of rows dropped"),
            (self.merged, "row merged with another one of equal time",
             "rows merged with others of equal time"),
            (self.fills, "row with a value beyond any use, taken as missed",
             "rows with values beyond any use, taken as missed"),
            (self.stale, "repeated position taken as missed", "repeated positions taken as missed"),
            (self.delayed, "plot too soon after the first of a track, taken as missed",
             "plots too soon after the first of a track, taken as missed"),
            (self.segments, "new segment after a long time without a plot",
             "new segments after a long time without a plot"),
            (self.coasted, "row long after the last plot dropped",
             "rows long after the last plot dropped"),
        ):  # fmt: skip
            if count:
                said.append(counted(count, one, several))
        if self.wraps:
            times = counted(self.wraps, "time")
            said.append(f"the clock starts again after {self.period:.15g} s, {times}")
        return tuple(said)
