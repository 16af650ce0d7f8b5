"""What a page says of the columns of a recording, and of its faults: arguments of commands."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, get_args

from fuzzytrack.io.cleaning_rules import Duplicates
from fuzzytrack.io.description import Azimuth, TimeUnit
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.yamltree import suggestion

__all__ = ["READING", "check_truth", "reading_options"]

_CHOICES = {
    "time_unit": get_args(TimeUnit),
    "azimuth_from": get_args(Azimuth),
    "duplicates": get_args(Duplicates),
}
_LISTS = ("axes", "polar", "geodetic", "truth")
_NUMBERS = ("sigma", "sigma_range", "sigma_azimuth", "sigma_elevation", "max_gap")

#: Names of the arguments.
READING = ("time", "id", *_CHOICES, *_LISTS, *_NUMBERS, "site", "sort")


def reading_options(given: Arguments) -> dict[str, Any]:
    """Options of a recording that are given, as `fuzzytrack.io.reading.Reading.of` takes them.

    Besides them, ``truth``: columns with true positions, or the name of one file.

    Raises
    ------
    ValueError
        If one is of another type.
    """
    found = {
        "time": given.text("time", None),
        "id": given.text("id", None),
        **{name: given.choice(name, allowed, None) for name, allowed in _CHOICES.items()},
        **{name: given.texts(name, None) for name in _LISTS},
        **{name: given.number(name, None) for name in _NUMBERS},
        "site": given.numbers("site", None),
        "sort": given.flag("sort") or None,
    }
    return {name: value for name, value in found.items() if value is not None}


def check_truth(columns: Collection[str], truth: Collection[str]) -> None:
    """Refuse a truth that is not in columns of the recording: such a text would name a file.

    Raises
    ------
    ValueError
    """
    for name in truth:
        if name not in columns:
            raise ValueError(
                f"`truth`: no column {name!r}{suggestion(name, columns)}; it takes columns of the "
                "recording, or the name of a CSV file of the folder"
            )
