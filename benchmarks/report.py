"""Rows of the report: what was measured, against what, and whether the target is reached."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.timing import Ratio

__all__ = ["NotMeasured", "Row", "Target", "as_dict", "collect", "markdown", "show"]


class NotMeasured(Exception):  # noqa: N818
    """A feature or a peer is missing; the message says which."""


@dataclass(frozen=True)
class Target:
    """What a row should reach: its ratio if it has one, else its value."""

    sign: str
    limit: float

    def reached(self, figure: float) -> bool:
        return figure >= self.limit if self.sign == ">=" else figure <= self.limit

    def __str__(self) -> str:
        return f"{'≥' if self.sign == '>=' else '≤'} {self.limit:g}"


@dataclass(frozen=True)
class Row:
    """One line of the report.

    Attributes
    ----------
    section, what : str
    value : float, optional
        Median, in `unit`.
    against : str
        What it was compared with in the same rounds, with the value `base` in the same unit.
    ratio : Ratio, optional
        How many times better than that.
    note : str
        What is, and is not, the same work.
    why : str
        Why it was not measured.
    broken : bool
        Whether it was not measured because something failed, and not for want of anything.
    """

    section: str
    what: str
    value: float | None = None
    unit: str = ""
    against: str = ""
    base: float | None = None
    ratio: Ratio | None = None
    target: Target | None = None
    note: str = ""
    why: str = ""
    broken: bool = False

    @property
    def reached(self) -> bool | None:
        figure = self.value if self.ratio is None else self.ratio.median
        if self.target is None or figure is None:
            return None
        return self.target.reached(figure)


def collect(section: str, what: str, job: Callable[[], Iterable[Row]]) -> list[Row]:
    """Rows of a job; one that says why if it cannot be done. A long run must not end half way."""
    try:
        return list(job())
    except NotMeasured as missing:
        return [Row(section, what, why=str(missing))]
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        return [Row(section, what, why=why, broken=True)]


def as_dict(row: Row) -> dict[str, Any]:
    """The row as plain data."""
    return {**asdict(row), "reached": row.reached}


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def _cells(row: Row) -> tuple[str, ...]:
    if row.why:
        return row.what, f"not measured: {row.why}", "", "", "", ""
    ratio = "" if row.ratio is None else f"{_number(row.ratio.median)}"
    if row.ratio is not None and row.ratio.high > row.ratio.low:
        ratio += f" ({_number(row.ratio.low)} to {_number(row.ratio.high)})"
    against = row.against
    if row.base is not None:
        against += f": {_number(row.base)}"
    verdict = {None: "", True: "reached", False: "missed"}[row.reached]
    return (
        row.what,
        f"{_number(row.value)} {row.unit}".strip(),
        against,
        ratio,
        "" if row.target is None else str(row.target),
        verdict,
    )


HEADERS = ("what", "fuzzytrack", "against", "ratio (quartiles)", "target", "")


def show(rows: Iterable[Row]) -> None:
    """Print for people."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    for section, members in _sections(rows):
        table = Table(title=section, title_justify="left")
        for column in HEADERS:
            table.add_column(column, overflow="fold")
        for row in members:
            table.add_row(*_cells(row))
        console.print(table)
        for row in members:
            if row.note:
                console.print(f"[dim]{row.what}:[/dim] {row.note}", highlight=False)


def markdown(rows: Iterable[Row]) -> str:
    """Tables for the documentation."""
    parts = []
    for section, members in _sections(rows):
        parts += [f"**{section}**", ""]
        parts += ["| " + " | ".join(HEADERS) + " |", "|" + "---|" * len(HEADERS)]
        cells = [[cell.replace("|", "\\|") for cell in _cells(row)] for row in members]
        parts += ["| " + " | ".join(line) + " |" for line in cells]
        notes = [f"- *{row.what}*: {row.note}" for row in members if row.note]
        parts += ["", *notes, ""]
    return "\n".join(parts)


def _sections(rows: Iterable[Row]) -> list[tuple[str, list[Row]]]:
    sections: dict[str, list[Row]] = {}
    for row in rows:
        sections.setdefault(row.section, []).append(row)
    return list(sections.items())
