"""Axes of position in pictures: names, units, scale, and which panels show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["PositionAxes", "spread", "time_unit"]

# Meters beyond which positions are shown in kilometers.
_FAR = 5000.0
# Seconds beyond which times are shown in hours.
_LONG = 7200.0
_ANGLES = ("deg", "rad")


@dataclass(frozen=True)
class PositionAxes:
    """Axes of the positions in a picture.

    Attributes
    ----------
    names, units : tuple of str
        One each for every axis; the unit may be empty.
    scale : float
        By what positions are divided to be shown.
    aspect : float or None
        Length of a unit of the second axis over that of the first; None where the two cannot be
        compared.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    scale: float
    aspect: float | None

    @classmethod
    def of(
        cls,
        n_axes: int,
        names: Sequence[str] | None,
        unit: str | Sequence[str] | None,
        aspect: float | None,
        extent: float,
    ) -> PositionAxes:
        """Axes with the usual names and units where none are given.

        Parameters
        ----------
        extent : float
            Length of the longest axis that is shown.

        Raises
        ------
        ValueError
            If there are more or fewer names or units than axes.
        """
        usual = tuple("xyz"[:n_axes]) if n_axes <= 3 else tuple(f"x{k + 1}" for k in range(n_axes))
        given = usual if names is None else tuple(names)
        if len(given) != n_axes:
            raise ValueError(
                f"axes_names: needs {n_axes} names, got {len(given)}: {', '.join(given)}"
            )
        far = unit is None and extent > _FAR
        word = "km" if far else "m" if unit is None else unit
        units = (word,) * n_axes if isinstance(word, str) else tuple(word)
        if len(units) != n_axes:
            raise ValueError(f"unit: needs 1 or {n_axes} units, got {len(units)}")
        alike = n_axes > 1 and units[0] == units[1] and units[0] not in _ANGLES
        if aspect is None and alike:
            aspect = 1.0
        return cls(given, units, 1000.0 if far else 1.0, aspect)

    @property
    def labels(self) -> list[str]:
        """What is written at each axis."""
        pairs = zip(self.names, self.units, strict=True)
        return [f"{name} ({unit})" if unit else name for name, unit in pairs]

    @property
    def panels(self) -> list[tuple[int | None, int]]:
        """Axes of each panel, the horizontal one first; None is time.

        Two axes are a plane, a third one is over time below it; one or more than three are over
        time.
        """
        count = len(self.names)
        if count in (2, 3):
            return [(0, 1), *((None, k) for k in range(2, count))]
        return [(None, k) for k in range(count)]


def spread(positions: Array) -> float:
    """Length of the longest axis of positions of shape (n, n_axes); 0 where there are none."""
    known = positions[np.isfinite(positions).all(axis=1)]
    return float(np.ptp(known, axis=0).max()) if len(known) else 0.0


def time_unit(time: Array) -> tuple[str, float]:
    """Unit in which times are shown, and its length in seconds."""
    known = time[np.isfinite(time)]
    return ("h", 3600.0) if len(known) and np.ptp(known) > _LONG else ("s", 1.0)
