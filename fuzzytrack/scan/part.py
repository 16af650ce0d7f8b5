"""What all parts of a scan tracker have in common: declared parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

from fuzzytrack.reprs import constructor_code

__all__ = ["Parameter", "Part", "Word", "declared", "parameter", "parameters", "word"]


@dataclass(frozen=True)
class Parameter:
    """What a number of a part means, and which values it can have.

    Attributes
    ----------
    meaning : str
        In words, for the schema and the documentation.
    unit : str
        ``m``, ``m/s``, ``rad``, ``scans``, ``nats`` …; empty for a pure number.
    least, most : float
        Limits.
    above, below : bool
        Whether the limits themselves are excluded.
    whole : bool
        Whether it is a whole number.
    """

    meaning: str
    unit: str = ""
    least: float = -math.inf
    most: float = math.inf
    above: bool = False
    below: bool = False
    whole: bool = False

    @property
    def allowed(self) -> str:
        """Allowed values in words."""
        kind = "a whole number" if self.whole else "a number"
        low = f" {'>' if self.above else '>='} {self.least:g}" if self.least > -math.inf else ""
        high = f" {'<' if self.below else '<='} {self.most:g}" if self.most < math.inf else ""
        return f"{kind}{low}{' and' if low and high else ''}{high}"

    def allows(self, value: object) -> bool:
        """Whether a value is allowed."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        if not math.isfinite(value) or (self.whole and value != int(value)):
            return False
        low = value > self.least if self.above else value >= self.least
        high = value < self.most if self.below else value <= self.most
        return low and high


@dataclass(frozen=True)
class Word:
    """What a word of a part means: which of several ways it takes, or the text of a tracker.

    Attributes
    ----------
    meaning : str
        In words, for the schema and the documentation.
    choices : tuple of str
        Words that are allowed; empty if it is a text.
    """

    meaning: str
    choices: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """Allowed values in words."""
        return f"one of {', '.join(self.choices)}" if self.choices else "a text"

    def allows(self, value: object) -> bool:
        """Whether a value is allowed."""
        return isinstance(value, str) and bool(value) and value in (self.choices or (value,))


def parameter(default: float, meaning: str, unit: str = "", **limits: Any) -> Any:
    """Field of a part's dataclass; the arguments after `default` are those of `Parameter`."""
    return field(default=default, metadata={"parameter": Parameter(meaning, unit, **limits)})


def word(default: str, meaning: str, *choices: str) -> Any:
    """Field of a part's dataclass that is a word: one of the choices, or any text without them."""
    return field(default=default, metadata={"word": Word(meaning, choices)})


@dataclass(frozen=True, repr=False)
class Part:
    """A part of a scan tracker: a frozen dataclass with numbers and words that are declared.

    Each of its fields is made by `parameter` or `word`, so that files, their schema, the
    documentation and a search know what it is.

    Raises
    ------
    ValueError
        If a parameter is out of range; names it, its value and what is allowed.
    """

    #: Where it comes from: a paper with its equation, or what was measured.
    source: ClassVar[str] = ""
    #: Whether it needs the position of the radar.
    needs_own: ClassVar[bool] = False
    #: Whether its kernels are plain Python that cannot be compiled; then all stages of a scan that
    #: call them run in plain Python, too.
    plain: ClassVar[bool] = False

    @property
    def memory(self) -> int:
        """How many numbers of each track belong to this part alone."""
        return 0

    def __post_init__(self) -> None:
        for name, meant in declared(type(self)).items():
            value = getattr(self, name)
            if not meant.allows(value):
                raise ValueError(f"{name} must be {meant.allowed}, got {value!r}")
            if isinstance(meant, Parameter):
                object.__setattr__(self, name, int(value) if meant.whole else float(value))

    def __repr__(self) -> str:
        return constructor_code(self)


def declared(part: type[Part]) -> dict[str, Parameter | Word]:
    """Declared numbers and words of a kind of part, by name, in the order of its fields."""
    found = {}
    for each in fields(part):
        meant = each.metadata.get("parameter") or each.metadata.get("word")
        if meant is not None:
            found[each.name] = meant
    return found


def parameters(part: type[Part]) -> dict[str, Parameter]:
    """Declared numbers of a kind of part, by name."""
    return {k: meant for k, meant in declared(part).items() if isinstance(meant, Parameter)}
