"""Tables of a report as HTML: cells, marks of the best, and numbers with their errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.testbed.metrics import PairedDifference

__all__ = [
    "Column",
    "column_of_least",
    "column_of_numbers",
    "difference",
    "estimates",
    "html_table",
    "interval",
    "number",
]

# Numbers from here on are written as powers of ten.
LARGE = 1e7


@dataclass(frozen=True)
class Column:
    """Cells of a column, and which of them are marked; none unless given."""

    cells: Sequence[str]
    marked: Sequence[bool] | None = None


def column_of_least(cells: Sequence[str], numbers: ArrayLike) -> Column:
    """Column in which the least number is marked, and cells that read as it does.

    One cell is not marked, nor is any if no number is finite.
    """
    values = np.asarray(numbers, dtype=np.float64)
    known = np.where(np.isfinite(values), values, np.inf)
    if len(cells) < 2 or not np.isfinite(known).any():
        return Column(cells)
    best = cells[int(known.argmin())]
    return Column(cells, [cell == best for cell in cells])


def column_of_numbers(values: Array, errors: Array | None = None) -> Column:
    """Column of numbers, small ones good, with standard errors if they are known."""
    cells = [number(v) for v in values] if errors is None else estimates(values, errors)
    return column_of_least(cells, values)


def html_table(
    names: Sequence[str], columns: Mapping[str, Column], notes: Sequence[str] | None = None
) -> str:
    """Table with a row for each name, and maybe a note under the name; it scrolls in its box."""
    head = "".join(f'<th scope="col">{escape(column)}</th>' for column in columns)
    rows = "\n".join(
        f'<tr><th scope="row">{_breakable(name)}{_small(note)}</th>{"".join(cells)}</tr>'
        for name, note, *cells in zip(
            names, notes or [""] * len(names), *map(_cells, columns.values()), strict=True
        )
    )
    return (
        '<div class="wide">\n<table>\n<thead>\n'
        f'<tr><th scope="col" class="name">Tracker</th>{head}</tr>\n'
        f"</thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</div>"
    )


def _cells(column: Column) -> list[str]:
    marked = column.marked or [False] * len(column.cells)
    return [
        f'<td class="best">{escape(cell)}</td>' if mark else f"<td>{escape(cell)}</td>"
        for cell, mark in zip(column.cells, marked, strict=True)
    ]


def _breakable(name: str) -> str:
    """Name that may break after a colon, and never inside a number."""
    return escape(name).replace(":", ":<wbr>")


def _small(note: str) -> str:
    return f'<span class="worse">{escape(note)}</span>' if note else ""


def estimates(values: Array, errors: Array) -> list[str]:
    """Estimates with their standard errors, rounded to two digits of these."""
    return [_estimate(*pair) for pair in zip(values.tolist(), errors.tolist(), strict=True)]


def _estimate(value: float, error: float) -> str:
    if not (math.isfinite(value) and math.isfinite(error)):
        return number(value)
    if abs(value) >= LARGE or not error:
        return f"{number(value)} ± {error:.2g}"
    digits = _digits(error)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def difference(found: PairedDifference) -> str:
    """Difference with its interval, rounded to two digits of its standard error."""
    if not math.isfinite(found.standard_error) or abs(found.difference) >= LARGE:
        return f"{number(found.difference)} {interval(found.low, found.high)}".strip()
    digits = _digits(found.standard_error)
    low, high = (f"{side:+.{digits}f}" for side in (found.low, found.high))
    return f"{found.difference:+.{digits}f} [{low}, {high}]".replace("-", "−")


def _digits(error: float) -> int:
    """Decimal places that show two digits of a standard error."""
    return min(12, max(0, 1 - math.floor(math.log10(error)))) if error > 0 else 3


def interval(low: float, high: float) -> str:
    """Interval, or nothing where it is not known."""
    known = math.isfinite(low) and math.isfinite(high)
    return f"[{number(low)}, {number(high)}]" if known else ""


def number(value: float) -> str:
    """Number to four digits, or to all before the point; a dash for NaN."""
    if not math.isfinite(value):
        return "–"
    text = f"{value:.0f}" if 1e4 <= abs(value) < LARGE else f"{value:.4g}"
    return text.replace("-", "−")
