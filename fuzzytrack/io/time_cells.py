"""Cells that hold times, as whole nanoseconds: numbers in a unit, dates with times, times of day.

Each form has a reader of one cell, which raises a ValueError that says what was expected, and a
fast one of many cells, which gives up (None) where the slow one has to look at each.
`fuzzytrack.io.times` puts them together.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date, timedelta
from decimal import Decimal
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.numerals import as_number

__all__ = [
    "SCALES",
    "Cells",
    "Form",
    "array_counts",
    "date_counts",
    "date_nanoseconds",
    "day_counts",
    "day_nanoseconds",
    "form_of",
    "number",
    "number_counts",
    "number_nanoseconds",
    "numbers",
    "same_time",
    "unit_in_name",
    "usable_cells",
]

#: How the cells of a column are written.
Form = Literal["number", "iso", "time of day"]
#: Times as a file or a user has them.
Cells = Sequence[str] | NDArray[Any]
Counts = NDArray[np.int64]

#: Nanoseconds in each unit of time.
SCALES = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
_WORDS = {
    "s": "s sec secs second seconds",
    "ms": "ms msec msecs milli millis millisec millisecond milliseconds",
    "us": "us µs μs usec usecs micro micros microsec microsecond microseconds",
    "ns": "ns nsec nsecs nano nanos nanosec nanosecond nanoseconds",
}
_UNITS = {word: unit for unit, words in _WORDS.items() for word in words.split()}

# Differences of counts below fit in 64 bits.
_LARGEST = 2**62
# The nanoseconds of any two numbers up to this differ by what double precision can hold; those
# below the other are none.
_LARGE, _SMALL = 1e290, 1e-290

_DATE = re.compile(
    r"([0-9]{4})([-/]?)([0-9]{2})\2([0-9]{2})"
    r"(?:[Tt ]([0-9]{2})(:?)([0-9]{2})(?:\6([0-9]{2})(?:[.,]([0-9]+))?)?"
    r" ?(Z|z|UTC|[+-][0-9]{2}(?::?[0-9]{2})?)?)?",
)
_DAY = re.compile(r"([0-9]{1,2}):([0-9]{2}):([0-9]{2})(?:[.,]([0-9]+))?")
# Years whose nanoseconds since 1970 fit in 64 bits, in the only form that NumPy reads alike.
_PLAIN_DATES = re.compile(
    r"(?:(?:1[7-9]|2[01])[0-9]{2}-[0-9]{2}-[0-9]{2}[T ][0-9]{2}:[0-9]{2}"
    r"(?::[0-9]{2}(?:\.[0-9]{1,9})?)?\n)*+"
)
_ZONE = re.compile(r"(?<=[0-9]) ?(?:Z|[+-][0-9]{2}:[0-9]{2})\Z")
_PLAIN_DAYS = re.compile(r"(?:[0-9]{2}:[0-9]{2}:[0-9]{2}(?:\.[0-9]{1,9})?\n)*+")

_DATE_WANTED = "a date and time as 2020-06-30T00:00:01.5Z"
_DAY_WANTED = "a time of day as 23:59:59.5"
_LEAP = "seconds below 60; a leap second has no place in a count of seconds, write 59 or 00"


# -------------------------------------------------------------------- forms and units


def form_of(cell: str) -> Form | None:
    """How a cell is written; None if it is no time."""
    text = cell.strip()
    if _DAY.fullmatch(text):
        return "time of day"
    if _is_number(text):
        return "number"
    return "iso" if _DATE.fullmatch(text) else None


def unit_in_name(name: str) -> str | None:
    """Unit that the name of a column ends with: "ms" of ``time_ms``, ``Time [ms]``, ``timeMs``."""
    bracket = re.search(r"[\[(]\s*(\w+)", name)
    words = re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name))
    word = bracket[1] if bracket else words[-1] if len(words) > 1 else ""
    if not word and words and words[0].lower() in _UNITS and len(words[0]) > 1:
        # A column "ms"; one that is called "s" may be anything.
        word = words[0]
    return _UNITS.get(word.lower())


def usable_cells(cells: Any) -> list[str] | NDArray[Any]:
    """Cells as texts, or as an array of integers, floats, datetime64 or timedelta64.

    Objects such as datetimes become texts, which have the same times. A time without a zone is UTC.
    """
    if getattr(getattr(cells, "dtype", None), "tz", None) is not None:
        # A column of pandas with a time zone.
        return np.asarray(cells, dtype="datetime64[ns]")
    if isinstance(cells, list) and (not cells or isinstance(cells[0], str)):
        return cells
    if isinstance(cells, tuple) and cells and isinstance(cells[0], str):
        return list(cells)
    values = np.asarray(cells)
    if values.dtype.kind in "iufMm":
        return values
    if values.dtype.kind == "S":
        return [cell.decode("ascii", "replace") for cell in values.tolist()]
    if values.size and isinstance(values.flat[0], timedelta):
        return values.astype("timedelta64[ns]")
    return ["" if cell is None else str(cell) for cell in values.tolist()]


def same_time(one: str, other: str) -> bool:
    """Whether two cells are one time, however they are written; cells of two forms are not."""
    form = form_of(one)
    if form is None or form != form_of(other):
        return one == other
    if form == "number":
        try:
            # Exact, unlike floats; 1.0 equals 1.00.
            return Decimal(one) == Decimal(other)
        except ArithmeticError:
            # Decimals have a greatest and a least exponent.
            return float(one) == float(other)
    reader = date_nanoseconds if form == "iso" else day_nanoseconds
    return reader(one.strip()) == reader(other.strip())


# -------------------------------------------------------------------- one cell


def number(text: str) -> float:
    """Number in a cell.

    Raises
    ------
    ValueError
        If it is no finite number.
    """
    if _is_number(text):
        return float(text)
    # What is no time at all may have been meant as any of them.
    other = form_of(text)
    choice = f", {_DATE_WANTED}, or {_DAY_WANTED}" if text and other is None else ""
    raise ValueError(f"a finite number{choice}" if other is None else "a finite number, as before")


def number_nanoseconds(text: str, scale: int) -> int:
    """Nanoseconds of a number, to the nearest one.

    Parameters
    ----------
    text : str
    scale : int
        Nanoseconds in its unit.
    """
    size = abs(number(text))
    if size > _LARGE:
        raise ValueError("a number below 1e290")
    if size < _SMALL:
        # Decimals have a least exponent.
        return 0
    return int((Decimal(text) * scale).to_integral_value())


def date_nanoseconds(text: str) -> int:
    """Nanoseconds from 1970 to a date and time in the forms of ISO 8601; UTC without a zone."""
    found = _DATE.fullmatch(text)
    if not found:
        raise ValueError(_DATE_WANTED)
    year, _, month, day, hour, _, minute, second, fraction, zone = found.groups()
    try:
        days = date(int(year), int(month), int(day)).toordinal() - date(1970, 1, 1).toordinal()
    except ValueError as error:
        raise ValueError(f"{_DATE_WANTED}; {error}") from None
    clock = _clock(hour or "0", minute or "0", second or "0", fraction or "", _DATE_WANTED)
    return days * 86_400 * SCALES["s"] + clock - _offset(zone)


def day_nanoseconds(text: str) -> int:
    """Nanoseconds from midnight to a time of day."""
    found = _DAY.fullmatch(text)
    if not found:
        raise ValueError(_DAY_WANTED)
    return _clock(found[1], found[2], found[3], found[4] or "", _DAY_WANTED)


def _clock(hour: str, minute: str, second: str, fraction: str, wanted: str) -> int:
    if int(second) == 60:
        raise ValueError(_LEAP)
    if int(hour) > 23 or int(minute) > 59 or int(second) > 59:
        raise ValueError(f"{wanted}, from 00:00:00 to 23:59:59")
    whole = (int(hour) * 60 + int(minute)) * 60 + int(second)
    return whole * SCALES["s"] + int(fraction[:9].ljust(9, "0"))


def _offset(zone: str | None) -> int:
    """Nanoseconds by which a zone is ahead of UTC."""
    if zone is None or zone[0] not in "+-":
        return 0
    digits = zone[1:].replace(":", "")
    hours, minutes = int(digits[:2]), int(digits[2:] or "0")
    if hours > 23 or minutes > 59:
        raise ValueError(f"{_DATE_WANTED}, with a zone from -23:59 to +23:59")
    size = (hours * 60 + minutes) * 60 * SCALES["s"]
    return -size if zone[0] == "-" else size


def _is_number(text: str) -> bool:
    return as_number(text) is not None


# -------------------------------------------------------------------- many cells


def numbers(cells: list[str]) -> Array | None:
    """Numbers of cells of text; None if one is no finite number."""
    text = "".join(cells)
    if not text.isascii() or "_" in text:
        return None
    try:
        values = np.array(list(map(float, cells)))
    except ValueError:
        return None
    return values if np.isfinite(values).all() else None


def number_counts(cells: list[str], scale: int) -> Counts | None:
    """Nanoseconds of numbers in a unit of `scale` ns: of their digits, with the point left out."""
    text = _lines(cells)
    if text is None or text.strip("0123456789+-.\n"):
        return None
    decimals, places = _decimals(cells, text), len(str(scale)) - 1
    if decimals is None or decimals.max() > places:
        return None
    try:
        digits = np.array(list(map(int, text.replace(".", "").split("\n")[:-1])), dtype=np.int64)
    except (ValueError, OverflowError):
        return None
    factors = np.array([10**place for place in range(places, -1, -1)])[decimals]
    if (np.abs(digits) > _LARGEST // factors).any():
        return None
    return np.asarray(digits * factors)


def _decimals(cells: list[str], text: str) -> Counts | None:
    """How many digits each cell has after its point; None if one has two points."""
    if "." not in text:
        return np.zeros(len(cells), dtype=np.int64)
    points = np.array([cell.find(".") for cell in cells])
    there = points >= 0
    if text.count(".") != there.sum():
        return None
    return np.where(there, np.array(list(map(len, cells))) - 1 - points, 0)


def _lines(cells: list[str]) -> str | None:
    """Cells as lines; None if one is not ASCII, or of several lines."""
    text = "\n".join(cells) + "\n"
    return text if text.isascii() and text.count("\n") == len(cells) else None


def date_counts(cells: list[str]) -> Counts | None:
    """Nanoseconds from 1970 to dates and times that have one zone, or none."""
    text, zone = _lines(cells), _ZONE.search(cells[0])
    if text is None:
        return None
    if zone is None:
        return _dates(cells, text)
    ending = f"{zone[0]}\n"
    if text.count(ending) != len(cells):
        return None
    text = text.replace(ending, "\n")
    counts = _dates(text.splitlines(), text)
    return None if counts is None else counts - _offset(zone[0].strip())


def day_counts(cells: list[str]) -> Counts | None:
    """Nanoseconds from midnight to times of day."""
    text = _lines(cells)
    if text is None or not _PLAIN_DAYS.fullmatch(text):
        return None
    text = "1970-01-01T" + text[:-1].replace("\n", "\n1970-01-01T") + "\n"
    return _dates(text.splitlines(), text)


def _dates(cells: list[str], text: str) -> Counts | None:
    """Nanoseconds from 1970 to dates without zones, which are also the lines of a text."""
    if not _PLAIN_DATES.fullmatch(text):
        return None
    try:
        counts = np.array(cells, dtype="datetime64[ns]").astype(np.int64)
    except ValueError:
        return None
    return counts if np.abs(counts).max() <= _LARGEST else None


def array_counts(values: NDArray[Any], scale: int) -> Counts | None:
    """Nanoseconds of an array of integers, finite floats, datetime64 or timedelta64.

    Parameters
    ----------
    values : ndarray
    scale : int
        Nanoseconds in the unit of numbers.

    Returns
    -------
    ndarray of int or None
        None if they do not fit in 64 bits.
    """
    kind = values.dtype.kind
    if kind in "Mm":
        times = values.astype(f"{kind}8[ns]")
        counts = times.astype(np.int64)
        fits = (times.astype(values.dtype) == values) & (np.abs(counts) <= _LARGEST)
        return counts if fits.all() else None
    if max(abs(int(values.max())), abs(int(values.min()))) * scale > _LARGEST:
        return None
    if kind in "iu":
        return np.asarray(values.astype(np.int64) * scale)
    whole = np.floor(values)
    seconds = whole.astype(np.int64) * scale
    counts = seconds + np.rint((values - whole) * scale).astype(np.int64)
    if scale == SCALES["s"]:
        # The double that is the nearest to a time in microseconds has been written as that time.
        rounded = seconds + np.rint((values - whole) * 1e6).astype(np.int64) * 1000
        counts = np.where(whole + (rounded - seconds) / 1e9 == values, rounded, counts)
    return np.asarray(counts)
