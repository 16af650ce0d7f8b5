"""What the first rows of a recording say: clock, frame, noise, and what is odd about them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, get_args

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.decoder import Noise, PlotDecoder, is_latitude, joined_cells
from fuzzytrack.io.description import PlotDescription, TimeUnit
from fuzzytrack.io.table import Table
from fuzzytrack.io.times import Clock

if TYPE_CHECKING:
    from fuzzytrack.io.geodetic import LocalFrame

__all__ = ["decoder_of", "frame_of", "notes_of"]


def decoder_of(
    columns: Columns, description: PlotDescription, table: Table, units: Mapping[str, str]
) -> PlotDecoder:
    """How rows of a file become plots, by its first rows.

    Parameters
    ----------
    columns : Columns
    description : PlotDescription
    table : Table
        The first rows.
    units : mapping of str to str
        Units that the file names, by the names of columns.

    Raises
    ------
    DataError
        If the unit of the times is none, there is no place on earth, or noise is not given for
        each axis.
    ValueError
        If a standard deviation is not above 0.
    """
    cells = joined_cells(table, columns)
    unit = units.get(columns.time)
    if unit is not None and unit not in get_args(TimeUnit) and description.time_unit is None:
        raise DataError(
            f"{table.file}: column {columns.time}: its unit is {unit!r}; expected one of "
            f"{', '.join(get_args(TimeUnit))}; `time_unit` says which it is"
        )
    clock = Clock.of(cells, unit=description.time_unit, name=columns.time, unit_of_name=unit)
    frame = frame_of(columns, description, table)
    return PlotDecoder(columns, description, clock, frame, _given_noise(columns, description))


def frame_of(columns: Columns, description: PlotDescription, table: Table) -> LocalFrame | None:
    """Frame of the positions: about the site, or about the first place on earth in a table.

    Raises
    ------
    DataError
        If there must be a place and there is none.
    """
    if description.site is not None:
        from fuzzytrack.io.geodetic import LocalFrame

        return LocalFrame(*description.site)
    if columns.own_ship and is_latitude(columns.own_ship[0]):
        return _frame_at_first(table, columns, columns.own_ship)
    return _frame_at_first(table, columns, columns.read) if columns.position == "geodetic" else None


def _frame_at_first(table: Table, columns: Columns, names: Sequence[str]) -> LocalFrame:
    """Frame about the first position that is one."""
    from fuzzytrack.io.geodetic import LocalFrame

    places = np.stack([table.numbers[name] * columns.meters(name) for name in names], axis=1)
    longitudes = np.abs(places[:, 1])
    good = (np.abs(places[:, 0]) <= 90) & (longitudes <= 360)
    if not good.any():
        raise DataError(
            f"{table.file}: columns {', '.join(names)}: no latitude and longitude within "
            "-90 to 90 and -180 to 360"
        )
    # Where longitudes count from -180 to 180, more is what stands for none.
    usual = good & (longitudes <= 180)
    good = usual if usual.any() else good
    first = places[int(np.argmax(good))]
    altitude = first[2] if len(first) == 3 and math.isfinite(first[2]) else 0.0
    return LocalFrame(float(first[0]), float(first[1]), float(altitude))


def _given_noise(columns: Columns, said: PlotDescription) -> Noise:
    n_axes = len(columns.axes)
    if said.sigma not in (None, "auto"):
        given = said.sigma if isinstance(said.sigma, tuple) else (said.sigma,) * n_axes
        if len(given) != n_axes:
            raise DataError(f"sigma: {len(given)} given for {n_axes} axes; give one, or one each")
        return tuple(_checked("sigma", value) for value in given)
    if columns.position != "polar":
        return ()
    polar = (said.sigma_range, said.sigma_azimuth, said.sigma_elevation)[:n_axes]
    names = ("sigma_range", "sigma_azimuth", "sigma_elevation")
    return tuple(_checked(name, value) for name, value in zip(names, polar, strict=False))


def _checked(name: str, value: float | str | None) -> float | str | None:
    if value is None or isinstance(value, str):
        return value
    if not 0 < value < math.inf:
        raise ValueError(f"{name}: must be > 0, got {value:g}")
    return float(value)


def notes_of(
    columns: Columns, clock: Clock, table: Table, unused: str, *, identified: bool
) -> tuple[str, ...]:
    """What the user should know of the first rows; `unused` is a column that is an identity."""
    notes = [clock.note] if clock.note else []
    notes += filter(None, (_constant(table.numbers[name], name) for name in columns.read))
    if unused and identified:
        notes.append(
            f"column {unused!r} looks like an identity and is not used; `id`={unused} makes a "
            "track of each"
        )
    elif unused:
        notes.append(f"column {unused!r}: identities of plots are not used")
    return tuple(notes)


# A column of position with fewer numbers than this may be constant by chance.
_CONSTANT_FROM = 4


def _constant(values: Array, name: str) -> str:
    """Remark about a column of position that never changes: it may hold no position at all."""
    known = values[np.isfinite(values)]
    if len(known) < _CONSTANT_FROM or not (known == known[0]).all():
        return ""
    return f"column {name} is {known[0]:.15g} in all of the first {len(known)} plots that have it"
