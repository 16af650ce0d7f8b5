"""Which columns of a table are time, identity, position and noise."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import meters_of, plain_name
from fuzzytrack.io.description import PlotDescription, texts
from fuzzytrack.io.table import Kind
from fuzzytrack.yamltree import suggestion

__all__ = [
    "Columns",
    "PositionKind",
    "choose_columns",
    "looks_like_angle",
    "looks_like_identity",
    "time_columns",
]

PositionKind = Literal["cartesian", "polar", "geodetic", "angle"]

# Names that columns usually have, without units and in lower case.
_TIMES = ("t", "time", "timestamp", "datetime", "date_time", "basedatetime", "epoch", "utc")
_TIME_UNITS = ("", "s", "ms", "us", "ns")
_AXES = ("x", "y", "z")
_METERS = ("", "m")
_IDENTITIES = [
    "id",
    "track",
    "trackid",
    "track_id",
    "track_number",
    "target",
    "targetid",
    "target_id",
    "object_id",
    "vehicle_id",
    "vessel_id",
    "mmsi",
    "icao",
    "icao24",
    "callsign",
    "imei",
    "device_id",
    "tail",
]
# Names of angles, and which argument takes them.
_POLAR = ("azimuth", "azi", "az", "bearing", "brg", "theta")
_HEADING = ("heading", "hdg", "course", "cog")
_LATITUDE, _LONGITUDE = ("latitude", "lat"), ("longitude", "lon", "lng", "long")
_RANGE = ("range", "rng", "rho", "distance", "slant_range")

_NAMES: dict[PositionKind, tuple[str, ...]] = {
    "polar": ("x", "y", "z"),
    "geodetic": ("east", "north", "up"),
}


@dataclass(frozen=True)
class Columns:
    """Which columns of a file are what.

    Attributes
    ----------
    time, id : str
        Names of the columns of time and of identity; the latter empty if there is none.
    axes : tuple of str
        Names of the coordinates of a plot: the columns of position, where these are Cartesian or a
        bare angle, otherwise x, y, z of polar ones and east, north, up of geodetic ones.
    position : {"cartesian", "polar", "geodetic", "angle"}
        What the columns of position hold.
    read : tuple of str
        Columns of position; unless given, `axes`.
    date : str
        Column of the date of a time of day; empty if there is none.
    own_ship : tuple of str
        Columns of the position of the sensor.
    own_heading : str
        Column of its heading.
    noise : tuple of str
        Columns of standard deviations.
    units : tuple of (str, str)
        Columns whose unit the file gives apart from their names, and the unit.
    """

    time: str
    id: str
    axes: tuple[str, ...]
    position: PositionKind = "cartesian"
    read: tuple[str, ...] = ()
    date: str = ""
    own_ship: tuple[str, ...] = ()
    own_heading: str = ""
    noise: tuple[str, ...] = ()
    units: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        if not self.read:
            object.__setattr__(self, "read", self.axes)

    @property
    def kinds(self) -> dict[str, Kind]:
        """What the columns must hold."""
        kinds: dict[str, Kind] = {self.id: "word"} if self.id else {}
        kinds |= dict.fromkeys(filter(None, [self.date, self.time]), "time")
        own = [*self.own_ship, *filter(None, [self.own_heading])]
        kinds |= dict.fromkeys([*self.read, *own, *self.noise], "gaps")
        return kinds

    def unit(self, name: str) -> str:
        """Unit of a column, by the file or else by its name; empty if none is given."""
        return dict(self.units).get(name) or plain_name(name)[1]

    def meters(self, name: str) -> float:
        """What the numbers of a column are multiplied by to be in meters; 1 if they are not."""
        return meters_of(self.unit(name)) if name in self._lengths else 1.0

    @property
    def _lengths(self) -> tuple[str, ...]:
        """Columns that are converted to meters. Cartesian positions are taken as they are."""
        if self.position not in ("polar", "geodetic"):
            return ()
        place = self.read[:1] if self.position == "polar" else self.read[2:]
        return (*place, *self.own_ship, *self.noise)

    @property
    def sentence(self) -> str:
        """Which columns are used, in words."""
        time = f"{self.date} and {self.time}" if self.date else self.time
        parts = [f"time {time}", f"id {self.id}" if self.id else "no id: one track"]
        kind = "" if self.position == "cartesian" else f" ({self.position})"
        parts.append(f"position {', '.join(self.read)}{kind}")
        if self.own_ship:
            parts.append(f"own ship {', '.join(self.own_ship)}")
        if self.own_heading:
            parts.append(f"own heading {self.own_heading}")
        if self.noise:
            parts.append(f"sigma {', '.join(self.noise)}")
        parts += [
            f"{name} from {self.unit(name)} to m"
            for name in self._lengths
            if self.meters(name) != 1
        ]
        return "; ".join(parts)


def choose_columns(
    names: tuple[str, ...],
    file: str,
    description: PlotDescription | None = None,
    units: Mapping[str, str] | None = None,
) -> Columns:
    """Find the columns of a recording, by the names given or by their usual names.

    Parameters
    ----------
    names : tuple of str
        Columns of the file.
    file : str
        Its name, for messages.
    description : PlotDescription, optional
        What is known of them.
    units : mapping of str to str, optional
        Units of columns, where the file gives them apart from the names.

    Raises
    ------
    DataError
        If there are no such columns, two could be meant, or one would serve twice.
    """
    said = description or PlotDescription()
    date, time = time_columns(names, said, file)
    id = "" if said.id is None else known(names, said.id, "id", file)
    position, read = _position(names, said, file, units or {})
    axes = _NAMES.get(position, read)[: len(read)]
    own = tuple(known(names, name, "own_ship", file) for name in said.own_ship or ())
    turned = said.own_heading
    heading = "" if turned is None else known(names, turned, "own_heading", file)
    noise = _noise_columns(names, said, file)
    apart = tuple((name, unit) for name, unit in (units or {}).items() if name != time)
    columns = Columns(time, id, axes, position, read, date, own, heading, noise, apart)
    _check_used(said, columns)
    every = [*filter(None, [date, time, id, heading]), *read, *own, *noise]
    doubled = [name for name in every if every.count(name) > 1]
    if doubled:
        raise DataError(f"{file}: column {doubled[0]!r} cannot serve twice")
    return columns


def known(names: tuple[str, ...], name: str, argument: str, file: str) -> str:
    """Column of a name that a user gives, which may be in other letters than in the file."""
    if name in names:
        return name
    alike = [other for other in names if other.lower() == name.lower()]
    if len(alike) == 1:
        return alike[0]
    raise DataError(f"{file}: `{argument}`: no column {name!r}{suggestion(name, names)}")


# -------------------------------------------------------------------- time


def time_columns(names: tuple[str, ...], said: PlotDescription, file: str) -> tuple[str, str]:
    """Columns of the date, empty if there is none, and of the time; raises as `choose_columns`."""
    if isinstance(said.time, tuple):
        date, time = (known(names, name, "time", file) for name in said.time)
        return date, time
    if said.time is not None:
        return "", known(names, said.time, "time", file)
    found = [name for name in names if _is_time(name)]
    if len(found) > 1:
        raise DataError(
            f"{file}: columns {_list(found, 'and')} could all be the time; name one of them with "
            "`time`"
        )
    if found:
        return "", found[0]
    raise DataError(
        f"{file}: no column t, time or timestamp; name the column of time with `time`; "
        f"there are {', '.join(names)}"
    )


def _is_time(name: str) -> bool:
    plain, unit = plain_name(name)
    return plain in _TIMES and unit in _TIME_UNITS


# -------------------------------------------------------------------- position


def _position(
    names: tuple[str, ...], said: PlotDescription, file: str, units: Mapping[str, str]
) -> tuple[PositionKind, tuple[str, ...]]:
    if said.polar is not None:
        return "polar", tuple(known(names, name, "polar", file) for name in said.polar)
    if said.geodetic is not None:
        return "geodetic", tuple(known(names, name, "geodetic", file) for name in said.geodetic)
    if said.angle is not None:
        return "angle", (known(names, said.angle, "angle", file),)
    if said.axes is None:
        return "cartesian", _usual_axes(names, file, units)
    if not said.axes:
        raise DataError(f"{file}: `axes`: needs at least one column")
    axes = tuple(known(names, name, "axes", file) for name in said.axes)
    if not said.cartesian:
        _refuse_angles(names, axes, file)
    return "cartesian", axes


def _usual_axes(names: tuple[str, ...], file: str, units: Mapping[str, str]) -> tuple[str, ...]:
    axes = []
    for axis in _AXES:
        found = [name for name in names if plain_name(name)[0] == axis]
        if len(found) > 1:
            raise DataError(
                f"{file}: columns {_list(found, 'and')} could all be {axis}; name those of "
                "position with `axes`"
            )
        for name in found:
            unit = units.get(name) or plain_name(name)[1]
            if unit not in _METERS:
                raise DataError(
                    f"{file}: column {name!r} is in {unit}; expected meters. `axes` takes columns "
                    "as they are: tracks and standard deviations are then in that unit"
                )
            axes.append(name)
    if axes:
        return tuple(axes)
    remedy = _angles_there(names)
    if remedy:
        raise DataError(f"{file}: no columns x, y; {remedy}")
    raise DataError(
        f"{file}: no columns x, y or x_m, y_m; name those of position with `axes`; "
        f"there are {', '.join(names)}"
    )


def _refuse_angles(names: tuple[str, ...], axes: tuple[str, ...], file: str) -> None:
    """Refuse to take a bearing or a latitude as a distance."""
    for name in axes:
        if _plain_is(name, (*_POLAR, *_HEADING, *_LATITUDE, *_LONGITUDE)):
            if _plain_is(name, _HEADING) or len(axes) == 1:
                remedy = f"`angle`={name} takes it as an angle (degrees)"
            else:
                remedy = _angles_there(names)
            raise DataError(
                f"{file}: `axes`: column {name!r} is an angle by its name; "
                f"{remedy or f'`angle`={name} takes it as an angle'}; "
                "`cartesian` takes it as a position in any case"
            )


def _angles_there(names: tuple[str, ...]) -> str:
    """What would read the angles among the columns; empty if there are none."""

    def first(words: Collection[str]) -> str | None:
        return next((name for name in names if _plain_is(name, words)), None)

    pairs: tuple[tuple[str, str | None, str | None, str], ...] = (
        ("geodetic", first(_LATITUDE), first(_LONGITUDE), "latitude and longitude (degrees)"),
        ("polar", first(_RANGE), first(_POLAR), "range and azimuth (degrees)"),
    )
    for argument, one, other, what in pairs:
        if one is not None and other is not None:
            return f"`{argument}`={one},{other} takes {what}"
    single = first((*_POLAR, *_HEADING))
    return f"`angle`={single} takes a bare angle (degrees)" if single is not None else ""


def _plain_is(name: str, words: Collection[str]) -> bool:
    return plain_name(name)[0] in words


# -------------------------------------------------------------------- noise and identity


def _noise_column(names: tuple[str, ...], name: str, argument: str, file: str) -> str:
    if re.match(r"[-+]?\.?[0-9]", name) and name not in names:
        raise DataError(f"{file}: `{argument}`: {name!r} is no number; write it without a unit")
    return known(names, name, argument, file)


def _noise_columns(names: tuple[str, ...], said: PlotDescription, file: str) -> tuple[str, ...]:
    found: list[str] = []
    for argument in ("sigma", "sigma_range", "sigma_azimuth", "sigma_elevation"):
        value = getattr(said, argument)
        if value == "auto":
            continue
        found += [_noise_column(names, name, argument, file) for name in texts(value)]
    return tuple(dict.fromkeys(found))


# -------------------------------------------------------------------- what does not fit together

_POLAR_NOISE = ("sigma_range", "sigma_azimuth", "sigma_elevation")


def _check_used(said: PlotDescription, columns: Columns) -> None:
    """Refuse what would not be used: a word of the user's without an effect is a mistake."""
    position, count = columns.position, len(columns.read)
    for name in _POLAR_NOISE:
        value = getattr(said, name)
        if value is None:
            continue
        if position != "polar":
            raise DataError(
                f"`{name}`: is of polar plots; give `sigma`, or `polar` for the columns"
            )
        if said.sigma not in (None, "auto"):
            raise DataError(f"`{name}`: `sigma` is given as well; give one of them")
        if isinstance(value, tuple | list):
            raise DataError(f"`{name}`: {len(value)} given; expected one number or column")
    if said.sigma_elevation is not None and count < 3:
        raise DataError("`sigma_elevation`: there is no elevation; name its column in `polar`")
    if said.azimuth_from != "north" and position != "polar":
        raise DataError("`azimuth_from`: is of polar plots; give `polar` for the columns")
    if said.own_ship is not None:
        if position not in ("polar", "cartesian"):
            raise DataError(
                f"`own_ship`: cannot carry {position} positions; give `polar` or `axes`"
            )
        if len(said.own_ship) not in (2, 3):
            raise DataError(f"`own_ship`: {len(said.own_ship)} given; expected 2 or 3")
    if said.site is not None and position in ("cartesian", "angle") and count < 2:
        raise DataError("`site`: one coordinate has no place on earth; leave it out")
    if said.own_heading is not None and position == "geodetic":
        raise DataError("`own_heading`: cannot turn geodetic positions; give `polar`")
    for argument in ("geodetic", "own_ship"):
        names = getattr(said, argument) or ("",)
        if _plain_is(names[0], _LONGITUDE):
            raise DataError(
                f"`{argument}`: {names[0]!r} is a longitude by its name; latitude comes first"
            )
    if said.polar is not None and _plain_is(said.polar[0], _POLAR):
        raise DataError(f"`polar`: {said.polar[0]!r} is an angle by its name; range comes first")
    for name, *_ in said.valid:
        if name not in columns.read:
            raise DataError(
                f"`valid`: {name!r} is no column of position{suggestion(name, columns.read)}"
            )


def looks_like_angle(name: str) -> bool:
    """Whether a word in the name of a column is that of an azimuth."""
    return any(word in _POLAR for word in plain_name(name)[0].split("_"))


def looks_like_identity(names: Sequence[str], columns: Columns) -> str:
    """Column that by its name is an identity and is not used; empty if there is none."""
    if columns.id:
        return ""
    free = (name for name in names if name not in columns.kinds)
    return next((name for name in free if _plain_is(name, _IDENTITIES)), "")


def _list(words: Sequence[str], between: str) -> str:
    *most, last = map(repr, words)
    return f"{', '.join(most)} {between} {last}"
