"""A reproduced experiment: rows of published and own numbers, with a verdict each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from fuzzytrack.reprs import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Reproduction", "Row", "row"]

MATCHES, DIFFERS, NOT_STATED = "matches", "differs", "not stated"


@dataclass(frozen=True)
class Row:
    """One number of a paper, and ours.

    Attributes
    ----------
    table : str
        Table, figure or equation of the paper.
    quantity : str
        What the number is, with its unit.
    published : float or None
        The paper's number; None where it gives none.
    ours : float
        Ours.
    se : float or None
        Standard error of ours over Monte Carlo runs; None if it is not an average.
    runs : int or None
        Number of these runs.
    verdict : {"matches", "differs", "not stated"}
        Whether ours agrees with the paper's number.
    why : str
        Why it differs, or how the paper is read.
    """

    table: str
    quantity: str
    published: float | None
    ours: float
    se: float | None
    runs: int | None
    verdict: str
    why: str = ""


def row(
    table: str,
    quantity: str,
    ours: float,
    *,
    published: float | None = None,
    within: float = 0.0,
    se: float | None = None,
    runs: int | None = None,
    why: str = "",
) -> Row:
    """Row with its verdict.

    Parameters
    ----------
    table, quantity, ours, published, se, runs, why
        As for `Row`.
    within : float
        Difference that rounding or the paper's own Monte Carlo error explains. Two of our own
        standard errors are added to it.
    """
    if published is None:
        verdict = NOT_STATED
    else:
        allowed = within + 2 * (se or 0.0)
        verdict = MATCHES if abs(ours - published) <= allowed else DIFFERS
    own_se = None if se is None or math.isnan(se) else float(se)
    return Row(table, quantity, published, float(ours), own_se, runs, verdict, why)


@dataclass(frozen=True, eq=False)
class Reproduction:
    """A paper's experiments, rebuilt.

    Attributes
    ----------
    paper : str
        Name, one of `fuzzytrack.papers.PAPERS`.
    title : str
        Authors, year and subject.
    rows : tuple of Row
        Numbers, in the order of the paper.
    notes : tuple of str
        Remarks on the paper as a whole: how it is read, what is not reproducible.
    pictures : mapping of str to callable
        By name: functions that draw a figure of the paper.
    """

    paper: str
    title: str
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()
    pictures: Mapping[str, Callable[[], Figure]] = field(default_factory=dict)

    def __repr__(self) -> str:
        return summary(self, "paper", "title", rows=len(self.rows))

    def ours(self, quantity: str, table: str | None = None) -> float:
        """Our number of a quantity.

        Parameters
        ----------
        quantity : str
            As in its row.
        table : str, optional
            Table of that row; the only one with the quantity unless given.

        Raises
        ------
        KeyError
            If there is not exactly one such row.
        """
        found = [r for r in self.rows if r.quantity == quantity and table in (None, r.table)]
        if len(found) != 1:
            raise KeyError(f"{len(found)} rows of {self.paper} have the quantity {quantity!r}")
        return found[0].ours

    def __str__(self) -> str:
        """Rows with a published number, as a table of text; all rows if there is none."""
        shown = [r for r in self.rows if r.published is not None] or self.rows
        lines = [("", "", "published", "ours", "")]
        for r in shown:
            published = "" if r.published is None else f"{r.published:.6g}"
            error = "" if r.se is None else f" ± {r.se:.2g}"
            lines.append((r.table, r.quantity, published, f"{r.ours:.6g}{error}", r.verdict))
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join(
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
            for line in lines
        )

    def to_json_dict(self) -> dict[str, Any]:
        """Paper, rows and notes as plain types."""
        return {
            "paper": self.paper,
            "title": self.title,
            "notes": list(self.notes),
            "rows": [asdict(r) for r in self.rows],
        }
