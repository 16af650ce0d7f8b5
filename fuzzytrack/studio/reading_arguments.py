"""What a page says of the columns of a recording, and of its faults: arguments of commands."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from fuzzytrack.io.reading import option_names
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.yamltree import suggestion

__all__ = ["READING", "check_truth", "reading_options"]

_FLAGS = ("cartesian", "sort")

#: Names of the arguments.
READING = (*option_names(), "truth")


def reading_options(given: Arguments) -> dict[str, Any]:
    """Options of a recording that are given, as `fuzzytrack.io.reading.Reading.of` takes them.

    Besides them, ``truth``: columns with true positions, or the name of one file.

    Raises
    ------
    ValueError
        If one is of a type that no option has. Other values are refused when the file is read, so
        that the page is told of its columns, of which another one may be all that is needed.
    """
    found = {
        **{name: given.simple(name, None) for name in option_names() if name not in _FLAGS},
        **{name: given.flag(name) or None for name in _FLAGS},
        "truth": given.texts("truth", None),
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
