"""The types of numbers that C source may use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.variable import Universe
from fuzzytrack.interop.c99.q15_lookup import q15_place, q15_value

__all__ = ["NUMBERS", "NumberType", "number_type"]


@dataclass(frozen=True)
class NumberType:
    """A type of numbers.

    Attributes
    ----------
    name : str
        ``double``, ``float`` or ``q15``.
    c_type : str
        Type of an input and an output.
    dtype : numpy type, or None
        None for integers.
    """

    name: str
    c_type: str
    dtype: Any

    @property
    def whole(self) -> bool:
        """Whether they are integers."""
        return self.dtype is None

    def given(self, values: Array, universe: Universe) -> NDArray[Any]:
        """Inputs as numbers of this type: rounded, and saturated if they are integers."""
        if self.whole:
            places = np.rint(q15_place(values, universe))
            return np.clip(places, -32_768, 32_767).astype(np.int64)
        return values.astype(self.dtype)

    def meant(self, numbers: NDArray[Any], universe: Universe) -> Array:
        """Values that inputs of this type stand for."""
        return q15_value(numbers, universe) if self.whole else numbers.astype(np.float64)

    def wanted(self, values: Array, universe: Universe) -> Array:
        """Outputs in the unit in which errors are measured: steps of an integer, or as they are."""
        return q15_place(values, universe) if self.whole else values

    def random(
        self, universe: Universe, count: int, generator: np.random.Generator
    ) -> NDArray[Any]:
        """Random inputs over a universe, each number of this type in it as likely as its width."""
        if self.whole:
            return generator.integers(-32_768, 32_768, count)
        return generator.uniform(universe.low, universe.high, count).astype(self.dtype)


_TYPES = (
    NumberType("double", "double", np.float64),
    NumberType("float", "float", np.float32),
    NumberType("q15", "int16_t", None),
)

#: Names of the types.
NUMBERS = tuple(t.name for t in _TYPES)


def number_type(name: str) -> NumberType:
    """Type by name.

    Raises
    ------
    ValueError
        If there is none of this name; names the allowed ones.
    """
    for each in _TYPES:
        if each.name == name:
            return each
    raise ValueError(f"number: unknown {name!r}; one of {', '.join(NUMBERS)}")
