"""Configurations of scan trackers with some of their numbers free: ``clutter.tau``."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

from fuzzytrack.scan.part import Parameter as Declared
from fuzzytrack.scan.scanners.numbers import declarations, values, with_values
from fuzzytrack.scan.scanners.reader import Configuration
from fuzzytrack.tuning.candidates import Choice, chosen
from fuzzytrack.tuning.parameters import Numbers, Parameter, Space

__all__ = ["ScannerNumbers", "scanner_numbers"]

# A positive number may become so many times smaller or larger; another one may move so far, in
# units of its own size or of 1.
_FACTOR, _REACH = 30.0, 2.0


@dataclass(frozen=True)
class ScannerNumbers:
    """Configurations that differ in some numbers.

    Attributes
    ----------
    start : Configuration
        Where the search begins.
    space : Space
        The free numbers.
    whole : tuple of bool
        Which of them are whole numbers.
    """

    start: Configuration
    space: Space
    whole: tuple[bool, ...]

    def named(self, numbers: Numbers) -> dict[str, float]:
        """Free numbers by name, whole ones rounded."""
        return {
            parameter.name: round(number) if whole else number
            for parameter, number, whole in zip(
                self.space.parameters, numbers, self.whole, strict=True
            )
        }

    def configuration(self, numbers: Numbers) -> Configuration:
        """Configuration with these numbers.

        Raises
        ------
        ValueError
            If the numbers make none.
        """
        return with_values(self.start, self.named(numbers))


def scanner_numbers(start: Configuration, free: Collection[str] | None) -> ScannerNumbers:
    """Configurations that differ in some numbers from one of them.

    Parameters
    ----------
    start : Configuration
    free : collection of str or None
        Which numbers are free: ``clutter.tau``, or ``clutter`` for all of a part; all of them
        unless given.

    Raises
    ------
    ValueError
        If there is no such number, or nothing is free; lists what is allowed.
    """
    known = {k: d for k, d in declarations(start).items() if isinstance(d, Declared)}
    now = values(start)
    found = []
    for name, declared in known.items():
        parameter = _parameter(name, float(now[name]), declared)
        if parameter is not None:
            found.append((Choice(parameter, frozenset({name.partition(".")[0]})), declared.whole))
    picked = chosen([choice for choice, _ in found], free, f"configuration {start.name!r}")
    return ScannerNumbers(
        start,
        Space(tuple(found[k][0].parameter for k in picked)),
        tuple(found[k][1] for k in picked),
    )


def _parameter(name: str, value: float, declared: Declared) -> Parameter | None:
    """How a number is searched, within the limits that its part declares; None if it is fixed."""
    least, most = declared.least, declared.most
    if least == 0.0 and most == 1.0:
        return Parameter(name, value, 0.0, 1.0, "probability")
    if least >= 0.0 and value > 0.0:
        low, high = max(least, value / _FACTOR), min(most, value * _FACTOR)
        return Parameter(name, value, low, high) if low < high else None
    reach = _REACH * max(abs(value), 1.0)
    low, high = max(least, value - reach), min(most, value + reach)
    # A limit that is excluded is not reached.
    low = math.nextafter(low, math.inf) if declared.above and low == least else low
    high = math.nextafter(high, -math.inf) if declared.below and high == most else high
    return Parameter(name, value, low, high, "linear") if low < high else None
