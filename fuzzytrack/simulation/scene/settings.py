"""Settings of the parts of a scene: declared once, for checks, files, the schema and its tables."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any

from fuzzytrack.reprs import call
from fuzzytrack.scan.part import Parameter

__all__ = ["FORMS", "Setting", "Settings", "setting", "settings_of"]

#: What a setting can be: a number, a whole number, a number or its limits, numbers in a row, rows
#: of numbers, a number or a curve of pairs, a word, or a part with settings of its own.
FORMS = ("number", "whole", "interval", "point", "points", "curve", "word", "part")


@dataclass(frozen=True)
class Setting:
    """What a setting means, and which values it can have.

    Attributes
    ----------
    meaning : str
        In words, for the schema and the documentation.
    unit : str
        ``m``, ``m/s``, ``rad`` …; empty for a pure number. Files have degrees for ``rad``.
    form : str
        One of `FORMS`.
    limits : Parameter
        Limits of its numbers; of a curve those of its second column.
    words : tuple of str
        Allowed words.
    columns : tuple of int
        Allowed lengths of a point, or of each of the points.
    """

    meaning: str
    unit: str = ""
    form: str = "number"
    limits: Parameter = field(default_factory=lambda: Parameter(""))
    words: tuple[str, ...] = ()
    columns: tuple[int, ...] = (2,)

    @property
    def file_unit(self) -> str:
        """Its unit in files."""
        return self.unit.replace("rad", "degrees")

    @property
    def in_file(self) -> float:
        """What a number in a file is multiplied with."""
        return math.radians(1) if "rad" in self.unit else 1.0

    def checked(self, name: str, value: Any) -> Any:
        """The value in its canonical form; ValueError that begins with `name` if it has none."""
        if self.form == "part":
            return value
        if self.form == "word":
            if value not in self.words:
                raise ValueError(f"{name} must be one of {', '.join(self.words)}, got {value!r}")
            return value
        if self.form in ("number", "whole"):
            number = self.number(name, value)
            return int(number) if self.form == "whole" else number
        if self.form == "interval":
            return self._interval(name, value)
        if self.form == "curve":
            return self._curve(name, value)
        if self.form == "point":
            return self._row(name, value)
        rows = tuple(self._row(name, row) for row in _listed(name, value))
        if len({len(row) for row in rows}) != 1:
            raise ValueError(f"{name} must be rows of equal length, got {value!r}")
        return rows

    def number(self, name: str, value: Any) -> float:
        """One of its numbers; ValueError that begins with `name` if it is not allowed."""
        if value == math.inf and self.limits.most == math.inf and not self.limits.whole:
            return math.inf
        number = value.item() if hasattr(value, "item") else value
        if not self.limits.allows(number):
            raise ValueError(f"{name} must be {self._allowed()}, got {self._shown(value)}")
        return float(number)

    def limits_in_file(self) -> Parameter:
        """Limits of its numbers in files."""
        factor = self.in_file
        if factor == 1:
            return self.limits
        least, most = (round(end / factor, 9) for end in (self.limits.least, self.limits.most))
        return replace(self.limits, least=least, most=most)

    def _allowed(self) -> str:
        """Allowed values, in the unit of files."""
        unit = f" ({self.file_unit})" if self.in_file != 1 else ""
        return f"{self.limits_in_file().allowed}{unit}"

    def _shown(self, value: Any) -> str:
        plain = isinstance(value, int | float) and not isinstance(value, bool)
        return f"{value / self.in_file:g}" if plain else repr(value)

    def _interval(self, name: str, value: Any) -> tuple[float, float]:
        ends = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else None
        if ends is None:
            ends = [value, value]
        if len(ends) != 2:
            raise ValueError(
                f"{name} must be a number or two, the least and the largest, got {len(ends)}"
            )
        low, high = (self.number(name, end) for end in ends)
        if low > high:
            raise ValueError(
                f"{name} must be the least number and the largest, got {self._shown(low)} and "
                f"{self._shown(high)}"
            )
        return low, high

    def _row(self, name: str, value: Any) -> tuple[float, ...]:
        row = tuple(self.number(name, each) for each in _listed(name, value))
        if len(row) not in self.columns:
            lengths = " or ".join(map(str, self.columns))
            raise ValueError(f"{name} must have {lengths} numbers in a row, got {len(row)}")
        return row

    def _curve(self, name: str, value: Any) -> tuple[tuple[float, float], ...]:
        if not isinstance(value, Sequence) or isinstance(value, str):
            return ((0.0, self.number(name, value)),)
        rows = []
        for row in _listed(name, value):
            pair = _listed(name, row)
            if len(pair) != 2:
                raise ValueError(f"{name} must be pairs of numbers, got {len(pair)} in a row")
            rows.append((float(pair[0]), self.number(name, pair[1])))
        if any(not a[0] < b[0] for a, b in itertools.pairwise(rows)):
            raise ValueError(f"{name} must be pairs whose first numbers increase, got {value!r}")
        return tuple(rows)


def _listed(name: str, value: Any) -> list[Any]:
    if isinstance(value, str) or not hasattr(value, "__len__") or not len(value):
        raise ValueError(f"{name} must be a list, got {value!r}")
    return list(value)


def setting(
    default: Any,
    meaning: str,
    unit: str = "",
    form: str = "number",
    words: tuple[str, ...] = (),
    columns: tuple[int, ...] = (2,),
    **limits: Any,
) -> Any:
    """Field of a dataclass of settings; `limits` are those of `fuzzytrack.scan.Parameter`.

    A default of ``...`` says that it has to be given.
    """
    limits.setdefault("whole", form == "whole")
    declared = Setting(meaning, unit, form, Parameter("", **limits), words, columns)
    given = MISSING if default is ... else default
    return field(default=given, metadata={"setting": declared}, kw_only=True)


@dataclass(frozen=True, repr=False)
class Settings:
    """A part of a scene: a frozen dataclass whose values are declared by `setting`.

    Raises
    ------
    ValueError
        If a value is not allowed; names it, the value and what is allowed.
    """

    def __post_init__(self) -> None:
        for name, declared in settings_of(type(self)).items():
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, declared.checked(name, value))
            elif _required(type(self), name):
                raise ValueError(f"{name} must be given")

    def __repr__(self) -> str:
        shown = {each.name: (getattr(self, each.name), each.default) for each in fields(self)}
        given = {name: value for name, (value, default) in shown.items() if value != default}
        return call(type(self).__name__, [], given)


def settings_of(part: type[Settings]) -> dict[str, Setting]:
    """Declared settings of a kind of part, by name."""
    return {each.name: each.metadata["setting"] for each in fields(part)}


def _required(part: type[Settings], name: str) -> bool:
    return any(each.name == name and each.default is MISSING for each in fields(part))
