"""How the times of a recording are read: numbers, dates or times of day, as seconds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.time_cells import (
    SCALES,
    Form,
    array_counts,
    date_counts,
    date_nanoseconds,
    day_counts,
    day_nanoseconds,
    form_of,
    number,
    number_counts,
    number_nanoseconds,
    numbers,
    unit_in_name,
    usable_cells,
)

__all__ = ["Clock"]

# Rows that decide how a column is read.
_FIRST = 1000
# Seconds that are used as they are: in double precision, differences below are exact to 1 ns.
_NEAR = 2.0**22
# From these sizes on, numbers are taken as times since 1970 in a unit below seconds.
_GUESSES = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))
_UNIT_NAMES = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}
# Counts (s) that are taken for times since 1970, from 1973 to 2242; counters begin at less.
_DATES = (1e8, 2.0**33)
_DAY = 86_400
# Dates whose numbers differ by this factor are in different units, which differ by 1000.
_OTHER_UNIT = 500


@dataclass(frozen=True)
class Clock:
    """How the cells of a column of time become seconds.

    Numbers of seconds that are below 2²² at the beginning are used as they are. Larger numbers, and
    dates, count from the first time of the recording; that is subtracted in whole nanoseconds, so
    that differences are exact to 1 ns whatever the epoch.

    Attributes
    ----------
    form : {"number", "iso", "time of day"}
        What the cells are: numbers; dates with times (ISO 8601; UTC unless they name a zone); times
        of day, which start again at midnight.
    unit : {"s", "ms", "us", "ns"}
        Unit of numbers.
    origin : int
        Time that is 0 s (ns): since 1970 of dates, of numbers since their own beginning.
    counted : bool
        Whether times are counted from `origin` in whole nanoseconds.
    note : str
        What was guessed, to be printed; empty if nothing was.
    """

    form: Form = "number"
    unit: str = "s"
    origin: int = 0
    counted: bool = False
    note: str = ""

    @classmethod
    def of(
        cls,
        cells: Any,
        *,
        unit: str | None = None,
        name: str = "",
        unit_of_name: str | None = None,
    ) -> Clock:
        """Decide by the first cells of a column how it is read.

        Parameters
        ----------
        cells : sequence of str or array_like
            First cells of the column: texts, numbers, datetime64, or objects such as datetimes. At
            most a thousand are looked at.
        unit : {"s", "ms", "us", "ns"}, optional
            Unit of numbers. Without it: the one in the name of the column (``time_ms``,
            ``time [us]``); else ns from 1e17 on, µs from 1e14, ms from 1e11, and s below.
        name : str
            Name of the column.
        unit_of_name : str, optional
            Unit that the name says, where the name given is not the column's own.

        Returns
        -------
        Clock

        Raises
        ------
        ValueError
            If `unit` is none of these, or the cells are no numbers.
        """
        if unit is not None and unit not in SCALES:
            raise ValueError(f"time_unit: {unit!r}; expected one of {', '.join(SCALES)}")
        first = usable_cells(cells[:_FIRST])
        form = _form(first)
        if form != "number" and unit is not None:
            raise ValueError(
                f"time_unit: column {name} holds {_HOLDS[form]}, such as {first[0]}; "
                "only numbers have a unit"
            )
        if form == "time of day":
            return cls(form, counted=True)
        if form == "iso":
            return cls(form, origin=_origin(first, form, 1), counted=True)
        return cls._of_numbers(first, unit or unit_of_name or unit_in_name(name), name)

    @classmethod
    def _of_numbers(cls, first: Any, unit: str | None, name: str) -> Clock:
        if not isinstance(first, list) and first.dtype.kind == "m":
            first, unit = first.astype("timedelta64[ns]").astype(np.int64), "ns"
        size, note = _size(first), ""
        if unit is None:
            unit = next((word for least, word in _GUESSES if size >= least), "s")
            if unit != "s":
                _check_one_unit(_first_number(first), size, name)
                note = (
                    f"column {name or 'of time'}: numbers such as {first[0]} are taken as "
                    f"{_UNIT_NAMES[unit]} (`time_unit`)"
                )
        scale = SCALES[unit]
        counted = _first_number(first) * (scale / SCALES["s"]) >= _NEAR
        origin = _origin(first, "number", scale) if counted else 0
        return cls("number", unit, origin, counted, note)

    @property
    def scale(self) -> int:
        """Nanoseconds in a unit of the cells."""
        return SCALES[self.unit]

    @property
    def period(self) -> float | None:
        """Time after which the clock starts again (s): a day, of times of day; else None."""
        return float(_DAY) if self.form == "time of day" else None

    @property
    def dated(self) -> bool:
        """Whether times are dates: as such, or as numbers that are those of times since 1970."""
        if self.form == "number":
            low, high = _DATES
            return self.counted and low <= self.origin / SCALES["s"] < high
        return self.form == "iso"

    def seconds(
        self, cells: Any, rows: Sequence[int] | NDArray[Any], file: str, column: str
    ) -> Array:
        """Seconds of cells, from the origin.

        Parameters
        ----------
        cells : sequence of str or array_like
            As for `of`.
        rows : sequence of int
            Where they stand in the file, for messages.
        file, column : str
            Names, for messages.

        Returns
        -------
        ndarray, shape (n_rows,)

        Raises
        ------
        DataError
            If a cell is no such time; names row, column and value.
        """
        usable = usable_cells(cells)
        if not len(usable):
            return np.empty(0)
        if isinstance(usable, list):
            found = self._fast(usable)
            if found is not None:
                return found
        else:
            usable = self._checked(usable, rows, file, column)
            found = self._of_array(usable)
            if found is not None:
                return found
            usable = list(map(str, usable))
        return self._slow(usable, rows, file, column)

    def show(self, seconds: float) -> str:
        """A time as text, in UTC as 2020-06-30T00:00:01.5Z if times are dates; else as its cell.

        Parameters
        ----------
        seconds : float
            Time of this clock (s).
        """
        if not self.dated:
            return self.as_cell(seconds)
        days, clock = self._day_and_clock(seconds)
        return f"{np.datetime64(days, 'D')}T{clock}Z"

    def as_cell(self, seconds: float) -> str:
        """A time as text in the form of the cells: a number in their unit, a date, a time of day.

        Parameters
        ----------
        seconds : float
            Time of this clock (s).
        """
        if self.form == "iso":
            return self.show(seconds)
        if self.form == "time of day":
            return self._day_and_clock(seconds)[1]
        if not self.counted:
            return f"{seconds * SCALES['s'] / self.scale:.15g}"
        whole, part = divmod(self.origin + round(seconds * SCALES["s"]), self.scale)
        return f"{whole}{_fraction(part, len(str(self.scale)) - 1)}"

    def _day_and_clock(self, seconds: float) -> tuple[int, str]:
        """Days since 1970, and time of day, of a time."""
        whole, part = divmod(self.origin + round(seconds * SCALES["s"]), SCALES["s"])
        days, rest = divmod(whole, _DAY)
        clock = f"{rest // 3600:02d}:{rest // 60 % 60:02d}:{rest % 60:02d}{_fraction(part, 9)}"
        return days, clock

    # ---------------------------------------------------------------- reading

    def _fast(self, cells: list[str]) -> Array | None:
        """Seconds of cells of the usual kind; None if each has to be looked at."""
        if not self.counted:
            values = numbers(cells)
            return None if values is None else self._divided(values)
        if self.form == "number":
            counts = number_counts(cells, self.scale)
        else:
            counts = date_counts(cells) if self.form == "iso" else day_counts(cells)
        return None if counts is None else self._since(counts)

    def _of_array(self, values: NDArray[Any]) -> Array | None:
        if not self.counted and values.dtype.kind in "iuf":
            return self._divided(values.astype(np.float64))
        counts = array_counts(values, self.scale)
        return None if counts is None else self._since(counts)

    def _slow(
        self, cells: list[str], rows: Sequence[int] | NDArray[Any], file: str, column: str
    ) -> Array:
        read, seconds = self._reader(), np.empty(len(cells))
        for place, cell in enumerate(cells):
            try:
                seconds[place] = read(cell.strip())
            except ValueError as error:
                raise _error(cell, int(rows[place]), file, column, str(error)) from None
        return seconds

    def _reader(self) -> Callable[[str], float]:
        """Reader of one cell, which gives the same bits as the fast ones."""
        if not self.counted:
            divisor = SCALES["s"] / self.scale
            return lambda text: number(text) / divisor
        scale, origin = self.scale, self.origin
        count: Callable[[str], int] = {
            "number": lambda text: number_nanoseconds(text, scale),
            "iso": date_nanoseconds,
            "time of day": day_nanoseconds,
        }[self.form]
        return lambda text: float(count(text) - origin) / SCALES["s"]

    def _divided(self, values: Array) -> Array:
        return values if self.unit == "s" else values / (SCALES["s"] / self.scale)

    def _since(self, counts: NDArray[np.int64]) -> Array | None:
        if abs(self.origin) > 2**62:
            return None
        return np.asarray((counts - self.origin).astype(np.float64) / SCALES["s"])

    def _checked(
        self, values: NDArray[Any], rows: Sequence[int] | NDArray[Any], file: str, column: str
    ) -> NDArray[Any]:
        """Array of the kind that this clock reads, without gaps."""
        kind = values.dtype.kind
        bad = np.isnat(values) if kind in "Mm" else ~np.isfinite(values)
        other = self.form != ("iso" if kind == "M" else "number")
        if other or (kind == "m" and self.unit != "ns"):
            bad = np.ones(len(values), dtype=bool)
        if bad.any():
            place = int(np.argmax(bad))
            wanted = {"number": "a finite number", "iso": "a date and time"}.get(
                self.form, "a time of day"
            )
            raise _error(str(values[place]), int(rows[place]), file, column, wanted)
        if kind == "m":
            return values.astype("timedelta64[ns]").astype(np.int64)
        return values.astype(np.float64) if kind == "f" else values


# -------------------------------------------------------------------- first cells

_HOLDS = {"number": "numbers", "iso": "dates", "time of day": "times of day"}


def _form(first: Any) -> Form:
    """Form of the first cell that is a time."""
    if not isinstance(first, list):
        return "iso" if first.dtype.kind == "M" else "number"
    return next(filter(None, map(form_of, first)), "number")


def _origin(first: Any, form: Form, scale: int) -> int:
    """The first time in nanoseconds."""
    if not isinstance(first, list):
        known = first[~np.isnat(first)] if first.dtype.kind == "M" else first[np.isfinite(first)]
        counts = array_counts(known[:1], scale) if len(known) else np.zeros(1, dtype=np.int64)
        if counts is not None:
            return int(counts[0])
        first = [str(known[0])]
    for cell in first:
        if form_of(cell) == form:
            try:
                text = cell.strip()
                return date_nanoseconds(text) if form == "iso" else number_nanoseconds(text, scale)
            except ValueError:
                # The reader will complain, with the place.
                continue
    return 0


def _numbers_in(first: Any) -> list[float]:
    if isinstance(first, list):
        return [float(cell) for cell in first if form_of(cell) == "number"]
    return [float(value) for value in first[np.isfinite(first)].tolist()]


def _size(first: Any) -> float:
    """The usual magnitude of numbers; a few wrong ones do not change it."""
    sizes = sorted(map(abs, _numbers_in(first)))
    return sizes[len(sizes) // 2] if sizes else 0.0


def _check_one_unit(first: float, usual: float, name: str) -> None:
    """Check that the first number is not a date in another unit than most."""
    if first >= _DATES[0] and usual > _OTHER_UNIT * first:
        raise ValueError(
            f"time_unit: column {name}: {first:.15g} and {usual:.15g} look like dates in different "
            "units; convert one of them, or give the unit of all"
        )


def _first_number(first: Any) -> float:
    return abs(next(islice(_numbers_in(first), 1), 0.0))


def _fraction(part: int, places: int) -> str:
    """Digits after the point, without zeros at the end."""
    return f".{part:0{places}d}".rstrip("0") if part else ""


def _error(cell: str, row: int, file: str, column: str, wanted: str) -> DataError:
    shown = repr(cell if len(cell) <= 40 else cell[:40] + "…") if cell else "an empty cell"
    return DataError(f"{file}: row {row}, column {column}: {shown}; expected {wanted}")
