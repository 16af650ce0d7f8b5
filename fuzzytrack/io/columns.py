"""Which columns of a table are time, identity and position."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from fuzzytrack.errors import DataError
from fuzzytrack.io.table import Kind
from fuzzytrack.yamltree import suggestion

__all__ = ["Columns", "choose_columns"]

# Names that columns usually have.
TIMES = ("t", "t_s", "time", "time_s")
AXES = (("x", "y", "z"), ("x_m", "y_m", "z_m"))


@dataclass(frozen=True)
class Columns:
    """Which columns of a file are what.

    Attributes
    ----------
    time, id : str
        Names of the columns of time and of identity; the latter empty if there is none.
    axes : tuple of str
        Names of the columns of position.
    """

    time: str
    id: str
    axes: tuple[str, ...]

    @property
    def kinds(self) -> dict[str, Kind]:
        """What the columns must hold."""
        words: dict[str, Kind] = {self.id: "word"} if self.id else {}
        gaps: dict[str, Kind] = dict.fromkeys(self.axes, "gaps")
        return {self.time: "number", **words, **gaps}


def choose_columns(
    names: tuple[str, ...],
    file: str,
    time: str | None,
    id: str | None,
    axes: Sequence[str] | None,
) -> Columns:
    """Find the columns of a recording, by the names given or by their usual names.

    Parameters
    ----------
    names : tuple of str
        Columns of the file.
    file : str
        Its name, for messages.
    time, id : str or None
        Column of time, and of identity; without the latter the file holds one track.
    axes : sequence of str or None
        Columns of position.

    Raises
    ------
    DataError
        If there are no such columns, or one would serve twice.
    """
    _check_header(names, file)
    columns = Columns(
        _time_column(names, time, file),
        "" if id is None else _known(names, id, "id", file),
        _axes_columns(names, axes, file),
    )
    every = [columns.time, *filter(None, [columns.id]), *columns.axes]
    doubled = [name for name in every if every.count(name) > 1]
    if doubled:
        raise DataError(f"{file}: column {doubled[0]!r} cannot serve twice")
    return columns


def _check_header(names: tuple[str, ...], file: str) -> None:
    """Refuse a first row that is not separated by commas."""
    if len(names) == 1:
        for mark, word in ((";", "semicolons"), ("\t", "tabs")):
            if mark in names[0]:
                raise DataError(f"{file}: row 1: separated by {word}; expected commas")


def _known(names: tuple[str, ...], name: str, argument: str, file: str) -> str:
    if name not in names:
        raise DataError(f"{file}: `{argument}`: no column {name!r}{suggestion(name, names)}")
    return name


def _time_column(names: tuple[str, ...], time: str | None, file: str) -> str:
    if time is not None:
        return _known(names, time, "time", file)
    for name in TIMES:
        if name in names:
            return name
    raise DataError(
        f"{file}: no column {_either(TIMES)}; name the column of time with `time`; "
        f"there are {', '.join(names)}"
    )


def _axes_columns(names: tuple[str, ...], axes: Sequence[str] | None, file: str) -> tuple[str, ...]:
    if axes is not None:
        if not axes:
            raise DataError(f"{file}: `axes`: needs at least one column")
        return tuple(_known(names, name, "axes", file) for name in axes)
    for group in AXES:
        found = tuple(name for name in group if name in names)
        if found:
            return found
    raise DataError(
        f"{file}: no columns x, y or x_m, y_m; name those of position with `axes`; "
        f"there are {', '.join(names)}"
    )


def _either(words: Collection[str]) -> str:
    *most, last = words
    return f"{', '.join(most)} or {last}"
