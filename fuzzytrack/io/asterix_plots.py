"""What a record of ASTERIX says of a plot, for each of its categories."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fuzzytrack.io.description import PlotDescription

__all__ = ["CATEGORIES", "IDENTITIES", "TEXTS", "Category", "Cells"]

#: Cells of a plot by the names of their columns: number, text or None.
Cells = dict[str, float | str | None]

#: Columns that can distinguish tracks, the best first.
IDENTITIES = ("address", "track", "mode_3a")
#: Columns of text.
TEXTS = ("id", "source", "callsign", *IDENTITIES)

_NAUTICAL_MILE = 1852.0
_FOOT = 0.3048
_FLIGHT_LEVEL = 100.0 * _FOOT
_DAY = 86_400.0
# The time of category 001 has 16 bits of 1/128 s.
_TRUNCATED = 512.0
# Radius (m) that holds 95 % of positions for each navigation accuracy category (NACp), and the
# radius that holds as many for a standard deviation of 1 in each axis.
_RADIUS_95 = (math.nan, 18520.0, 7408.0, 3704.0, 1852.0, 926.0, 555.6, 185.2, 92.6, 30.0, 10.0, 3.0)
_DEVIATIONS_95 = math.sqrt(-2.0 * math.log(0.05))


@dataclass(frozen=True)
class Category:
    """How the records of a category are read.

    Attributes
    ----------
    cells : callable
        From a record of libasterix to the cells of its plot, without the identity. A record
        without a position has no cells of position.
    wrap : float
        When its clock falls back to zero (s).
    identities : tuple of str
        Columns of which the first that a record has is its identity.
    notes : tuple of str
        What the user of its plots should know.
    """

    cells: Callable[[Any], Cells]
    wrap: float
    identities: tuple[str, ...] = IDENTITIES
    notes: tuple[str, ...] = ()

    def description(self, names: Mapping[str, object], identified: bool) -> PlotDescription:
        """What the columns are, of those that there are."""
        id = "id" if identified else None
        if "range" in names:
            return PlotDescription(time="time", wrap=self.wrap, id=id, polar=("range", "azimuth"))
        if "lat" in names:
            return PlotDescription(time="time", wrap=self.wrap, id=id, geodetic=("lat", "lon"))
        return PlotDescription(time="time", wrap=self.wrap, id=id, axes=("x", "y"))


# -------------------------------------------------------------------- items


def _part(record: Any, *path: str) -> Any:
    """Data item, or a part of it; None if the record has none."""
    found = record.get_item(path[0])
    for name in path[1:]:
        found = None if found is None else found.variation.get_item(name)
    return found


def _quantity(unit: str, record: Any, *path: str) -> float:
    """Number in a unit as ASTERIX writes it; NaN if the record has none."""
    found = _part(record, *path)
    return math.nan if found is None else float(found.variation.content.as_quantity(unit))


def _whole(record: Any, *path: str) -> int | None:
    found = _part(record, *path)
    return None if found is None else int(found.as_uint())


def _text(record: Any, *path: str) -> str | None:
    found = _part(record, *path)
    return None if found is None else str(found.variation.content.as_string()).strip() or None


def _source(record: Any) -> str | None:
    area, code = _whole(record, "010", "SAC"), _whole(record, "010", "SIC")
    return None if area is None else f"{area}/{code}"


def _address(record: Any, *path: str) -> str | None:
    found = _whole(record, *path)
    return None if found is None else f"{found:06X}"


def _track(record: Any, *path: str) -> str | None:
    found = _whole(record, *path)
    return None if found is None else str(found)


def _valid(record: Any, item: str) -> bool:
    """Whether an item that a transponder sent is marked as neither doubtful nor garbled."""
    return not _whole(record, item, "V") and not _whole(record, item, "G")


def _code(record: Any, item: str) -> str | None:
    """Mode 3/A code, four octal digits."""
    found = _whole(record, item, "MODE3A")
    return None if found is None or not _valid(record, item) else f"{found:04o}"


def _level(record: Any, item: str, *path: str) -> float:
    """Flight level, as height above 1013.25 hPa (m)."""
    return _quantity("FL", record, item, *path) * _FLIGHT_LEVEL


def _place(record: Any, *items: str) -> Cells:
    """Latitude and longitude (deg) from the first of the items that a record has."""
    for item in items:
        if record.get_item(item) is not None:
            return {name.lower(): _quantity("°", record, item, name) for name in ("LAT", "LON")}
    return {}


# -------------------------------------------------------------------- categories


def _radar(record: Any, clock: str, level: str, detected: bool) -> Cells:
    """Cells that plots of a radar have in both categories."""
    # A track of the radar that was carried on without a plot has a place, but none was measured.
    distance = _quantity("NM", record, "040", "RHO") if detected else math.nan
    azimuth = _quantity("°", record, "040", "THETA") if detected else math.nan
    valid = record.get_item("090") is not None and _valid(record, "090")
    return {
        "time": _quantity("s", record, clock),
        "source": _source(record),
        "range": distance * _NAUTICAL_MILE,
        "azimuth": azimuth,
        "height": _level(record, "090", level) if valid else math.nan,
        "mode_3a": _code(record, "070"),
    }


def _cells_001(record: Any) -> Cells:
    detected = _whole(record, "020", "SSRPSR") != 0
    # Plots and tracks have different items.
    is_track = _whole(record, "020", "TYP") == 1
    track = _track(record, "161") if is_track else None
    return {**_radar(record, "141", "HGT", detected), "track": track}


def _cells_048(record: Any) -> Cells:
    return {
        **_radar(record, "140", "FL", _whole(record, "020", "TYP") != 0),
        "track": _track(record, "161", "TRN"),
        "address": _address(record, "220"),
        "callsign": _text(record, "240"),
    }


def _cells_021(record: Any) -> Cells:
    # Of the position: its reception, then when it holds, then when it was sent on.
    times = (_quantity("s", record, item) for item in ("073", "071", "077"))
    accuracy = _whole(record, "090", "NACP") or 0
    radius = _RADIUS_95[accuracy] if accuracy < len(_RADIUS_95) else math.nan
    return {
        "time": next((time for time in times if not math.isnan(time)), math.nan),
        "source": _source(record),
        **_place(record, "131", "130"),
        "height": _quantity("ft", record, "140") * _FOOT,
        "pressure_height": _level(record, "145"),
        "sigma": radius / _DEVIATIONS_95,
        "mode_3a": None
        if record.get_item("070") is None
        else f"{_whole(record, '070', 'MODE3A'):04o}",
        "track": _track(record, "161", "TRNUM"),
        "address": _address(record, "080"),
        "callsign": _text(record, "170"),
    }


def _cells_062(record: Any) -> Cells:
    place = _place(record, "105")
    if not place and record.get_item("100") is not None:
        place = {name.lower(): _quantity("m", record, "100", name) for name in ("X", "Y")}
    return {
        "time": _quantity("s", record, "070"),
        "source": _source(record),
        **place,
        "height": _quantity("ft", record, "130") * _FOOT,
        "pressure_height": _level(record, "136"),
        "vx": _quantity("m/s", record, "185", "VX"),
        "vy": _quantity("m/s", record, "185", "VY"),
        "sigma_x": _quantity("m", record, "500", "APC", "X"),
        "sigma_y": _quantity("m", record, "500", "APC", "Y"),
        "mode_3a": _code(record, "060"),
        "track": _track(record, "040"),
        "address": _address(record, "380", "ADR"),
        "callsign": _text(record, "380", "ID"),
    }


#: Categories by their numbers.
CATEGORIES = {
    1: Category(
        _cells_001,
        _TRUNCATED,
        notes=("times of category 001 are truncated: silences of 512 s or more look shorter",),
    ),
    21: Category(_cells_021, _DAY),
    48: Category(_cells_048, _DAY),
    # A system track has a number in any case, and an address in some of its records only.
    62: Category(_cells_062, _DAY, ("track",)),
}
