"""What the columns of a recording mean: times, identities, positions and noise of its plots."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np

from fuzzytrack.yamltree import suggestion

__all__ = ["Azimuth", "PlotDescription", "TimeUnit", "texts"]

TimeUnit = Literal["s", "ms", "us", "ns"]
#: Direction of azimuth 0, from which azimuths grow clockwise (north) or counter-clockwise (east).
Azimuth = Literal["north", "east"]

# Fields that say where the positions are; a recording has one of them.
_POSITIONS = ("axes", "polar", "geodetic", "angle")
_POLAR_NOISE = ("sigma_range", "sigma_azimuth", "sigma_elevation")


@dataclass(frozen=True, kw_only=True)
class PlotDescription:
    """What the columns of a recording mean, as far as a user or a format of files says so.

    What is None is found by the usual names of columns, or guessed and reported.

    Parameters
    ----------
    time : str or (str, str), optional
        Column of time, or columns of date and of time of day.
    time_unit : {"s", "ms", "us", "ns"}, optional
        Unit of times that are numbers.
    wrap : float or "auto", optional
        Period of a clock that falls back to zero (s); "auto" recognizes midnight and counters that
        overflow, None takes times as they are.
    id : str, optional
        Column of the identity of tracks; one track unless given.
    axes : sequence of str, optional
        Columns of Cartesian position (m).
    polar : sequence of str, optional
        Columns of range (m), azimuth (deg) and maybe elevation (deg). Ranges, and altitudes and
        standard deviations below, are converted where the name of their column, or a row of units,
        says km, nmi, ft, yd, cm or mm; angles where it says rad.
    azimuth_from : {"north", "east"}
        Direction of azimuth 0: azimuths grow clockwise from north, or counter-clockwise from east.
    geodetic : sequence of str, optional
        Columns of latitude (deg), longitude (deg) and maybe altitude (m), WGS 84.
    angle : str, optional
        Column of a bare angle (deg).
    cartesian : bool
        Whether columns that are named like angles are Cartesian positions nevertheless.
    site : sequence of float, optional
        Latitude (deg), longitude (deg) and maybe altitude (m) of the sensor, which is the origin.
    own_ship : sequence of str, optional
        Columns of the position of a moving sensor, to which positions are added: as `axes` (m), or
        latitude, longitude (deg) and maybe altitude (m) if their names say so.
    own_heading : str, optional
        Column of the heading of the sensor (deg), to which azimuths are added.
    sigma : float, str or sequence of either, optional
        Standard deviation of the plots (m), or the column that has it; one, or one for each axis.
        "auto" estimates it from the plots.
    sigma_range, sigma_azimuth, sigma_elevation : float or str, optional
        Standard deviations of polar plots (m, deg, deg), or the columns that have them.
    valid : tuple of (str, float, float)
        Columns and the least and greatest value that is a position; others are missed plots. A
        mapping from columns to pairs will do.

    Raises
    ------
    ValueError
        If two positions are given, or a word is none of those allowed; names it.
    """

    time: str | tuple[str, str] | None = None
    time_unit: TimeUnit | None = None
    wrap: float | Literal["auto"] | None = "auto"
    id: str | None = None
    axes: tuple[str, ...] | None = None
    polar: tuple[str, ...] | None = None
    azimuth_from: Azimuth = "north"
    geodetic: tuple[str, ...] | None = None
    angle: str | None = None
    cartesian: bool = False
    site: tuple[float, ...] | None = None
    own_ship: tuple[str, ...] | None = None
    own_heading: str | None = None
    sigma: float | str | tuple[float | str, ...] | None = None
    sigma_range: float | str | None = None
    sigma_azimuth: float | str | None = None
    sigma_elevation: float | str | None = None
    valid: tuple[tuple[str, float, float], ...] = ()

    def __post_init__(self) -> None:
        for name, normal in (
            *((name, _one_name) for name in ("id", "angle", "own_heading")),
            *((name, _names) for name in ("axes", "polar", "geodetic", "own_ship")),
            ("time", _time_names),
            ("site", _place),
            *((name, _noise) for name in ("sigma", *_POLAR_NOISE)),
            ("valid", _ranges),
        ):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, normal(name, value))
        for name, allowed in (("time_unit", TimeUnit), ("azimuth_from", Azimuth)):
            value = getattr(self, name)
            if value is not None and value not in get_args(allowed):
                words = ", ".join(get_args(allowed))
                raise ValueError(
                    f"{name}: {value!r}; expected one of {words}"
                    f"{suggestion(str(value), get_args(allowed))}"
                )
        given = [name for name in _POSITIONS if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(
                f"{given[0]} and {given[1]}: a plot has one position; give one of them"
            )
        for name, least, most in (("polar", 2, 3), ("geodetic", 2, 3), ("site", 2, 3)):
            value = getattr(self, name)
            if value is not None and not least <= len(value) <= most:
                raise ValueError(f"{name}: {len(value)} given; expected {least} or {most}")

    def over(self, other: PlotDescription | None) -> PlotDescription:
        """Description in which what `other` says holds where this one says nothing.

        Parameters
        ----------
        other : PlotDescription or None
            What a format of files says of its columns.
        """
        if other is None:
            return self
        known = {field.name: field.default for field in fields(self)}
        mine = {name: getattr(self, name) for name in known}
        said = {name: value for name, value in mine.items() if value != known[name]}
        if any(name in said for name in _POSITIONS):
            other = replace(other, axes=None, polar=None, geodetic=None, angle=None)
        return replace(other, **said)


def _one_name(argument: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    raise ValueError(f"{argument}: must be the name of a column, got {value!r}")


def _names(argument: str, value: Any) -> tuple[str, ...]:
    """Names of columns; one text is one name, and not its letters."""
    if isinstance(value, str):
        return (value,)
    if isinstance(value, Iterable):
        return tuple(_one_name(argument, name) for name in value)
    raise ValueError(f"{argument}: must be names of columns, got {value!r}")


def _time_names(argument: str, value: Any) -> str | tuple[str, ...]:
    names = _names(argument, value)
    if len(names) not in (1, 2):
        raise ValueError(
            f"{argument}: {len(names)} given; expected a column, or those of date, time"
        )
    return names[0] if len(names) == 1 else names


def _place(argument: str, value: Any) -> tuple[float, ...]:
    try:
        if not isinstance(value, str):
            return tuple(float(number) for number in value)
    except (TypeError, ValueError):
        pass
    raise ValueError(f"{argument}: must be latitude, longitude and maybe altitude, got {value!r}")


def _noise(argument: str, value: Any) -> float | str | tuple[float | str, ...]:
    """Numbers and names, also from arrays of numpy and their elements."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return tuple(_one_noise(argument, each) for each in value)
    return _one_noise(argument, value)


def _one_noise(argument: str, value: Any) -> float | str:
    if isinstance(value, str):
        return value
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        return float(value)
    raise ValueError(f"{argument}: must be numbers or names of columns, got {value!r}")


def _ranges(argument: str, value: Any) -> tuple[tuple[str, float, float], ...]:
    found = []
    pairs = [(k, *v) for k, v in value.items()] if isinstance(value, Mapping) else value
    try:
        for name, least, most in pairs:
            found.append((_one_name(argument, name), float(least), float(most)))
    except (TypeError, ValueError):
        raise ValueError(
            f"{argument}: must be columns, each with its least and greatest value, got {value!r}"
        ) from None
    for name, low, high in found:
        if not low <= high:
            raise ValueError(f"{argument}: {name} from {low:g} to {high:g}; expected low to high")
    return tuple(found)


def texts(value: float | str | Sequence[float | str] | None) -> tuple[str, ...]:
    """Names of columns in a description of noise."""
    if value is None or isinstance(value, int | float):
        return ()
    values = (value,) if isinstance(value, str) else tuple(value)
    return tuple(word for word in values if isinstance(word, str))
