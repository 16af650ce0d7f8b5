"""A tuned tracker, with its errors on data that it was not tuned on."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.io.files import whole_file
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.tuning.criteria import Change

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Row", "Tuned", "with_head"]


@dataclass(frozen=True)
class Row:
    """One tracker.

    Attributes
    ----------
    name : str
    training : float
        Value of the criterion on the data that it was tuned on, over all folds.
    held_out : float
        The same on the data that it was not tuned on.
    change : tuple of float, or None
        Change of the held-out value from this tracker to the tuned one, and the ends of its 95 %
        interval: relative for an RMS error, a difference for a likelihood. None for the tuned one
        itself.
    change_text : str
        The same as text; empty for the tuned one.
    numbers : dict of str to float
        Its free numbers, tuned on all data.
    """

    name: str
    training: float
    held_out: float
    change: Change | None
    change_text: str
    numbers: dict[str, float]

    @property
    def is_worse(self) -> bool:
        """Whether the tuned tracker is better, with an interval that excludes 0."""
        return self.change is not None and self.change[2] < 0


@dataclass(frozen=True, eq=False)
class Tuned:
    """Result of `fuzzytrack.tune`.

    Attributes
    ----------
    tracker : Tracker
        The tuned tracker.
    text : str
        What makes it again: a specification, or a rule base in YAML.
    is_rulebase : bool
        Which of them.
    parameters : str
        Parameters that were given after the name of the rule base, as in ``level=5``. The file
        does not hold them: give them after its name too.
    numbers, start : dict of str to float
        Its free numbers, and those where the search began.
    unused : tuple of str
        Free numbers without an effect on these data; they are left as they were.
    rows : tuple of Row
        The start, the rivals, and the tuned tracker last.
    data, objective : str
        What it was tuned on, and what was minimized.
    folds : int
        Number of folds.
    units : str
        What was held out: tracks, or blocks of time.
    plots : int
        Number of plots that were scored.
    trials : int
        Trackers that were tried, in all searches.
    seed : int
    notes : tuple of str
        What was guessed, left out or put right when the plots were read.
    """

    tracker: Tracker
    text: str
    is_rulebase: bool
    parameters: str
    numbers: dict[str, float]
    start: dict[str, float]
    unused: tuple[str, ...]
    rows: tuple[Row, ...]
    data: str
    objective: str
    folds: int
    units: str
    plots: int
    trials: int
    seed: int
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return summary(self, "data", "numbers", "verdict")

    @property
    def worth_it(self) -> bool:
        """Whether it is better than the start on data that it was not tuned on, significantly.

        Not if it is the start: then the search on all data has found nothing better, whatever those
        on the folds have found.
        """
        return self.rows[0].is_worse and self.numbers != self.start

    @property
    def verdict(self) -> str:
        """In words: whether tuning is worth it, and what is as good."""
        if self.numbers == self.start:
            return (
                "not worth it: the search on all data found nothing better than the start, which "
                "stays; give more trials"
            )
        if not self.worth_it:
            return f"not worth it: held-out change against the start {self.rows[0].change_text}"
        found = f"worth it: held-out change against the start {self.rows[0].change_text}"
        as_good = [row.name for row in self.rows[1:-1] if not row.is_worse]
        others = " or ".join(f"the {name}" for name in as_good)
        return f"{found}; but not better than {others}" if as_good else found

    def plot(self) -> Figure:
        """Picture of the held-out values, see `fuzzytrack.plotting.plot_comparison`."""
        from fuzzytrack.plotting import plot_comparison

        held_out = {row.name: row.held_out for row in self.rows}
        return plot_comparison(held_out, what=f"{self.objective}, held out", unit="")[0]

    def _repr_html_(self) -> str:
        """The report and the numbers, for notebooks."""
        rows = [
            [row.name, as_text(row.training), as_text(row.held_out), row.change_text]
            for row in self.rows
        ]
        heads = ["", "training", "held out", "tuned against it (95 %)"]
        free = [
            [name, f"{self.start[name]:.5g}", f"{value:.5g}"]
            for name, value in self.numbers.items()
        ]
        return block(
            f"{self.data}: {self.objective}",
            table(heads, rows, best=len(rows) - 1 if self.worth_it else None),
            paragraph(self.verdict),
            table(["free number", "start", "tuned"], free, what="numbers"),
            *(paragraph(note, note=True) for note in self.notes),
        )

    @property
    def report(self) -> str:
        """Table of training and held-out values, and the verdict."""
        heads = ("", "training", "held out", "tuned against it (95 %)")
        table = [heads]
        for row in self.rows:
            table.append((row.name, f"{row.training:.5g}", f"{row.held_out:.5g}", row.change_text))
        widths = [max(len(line[k]) for line in table) for k in range(len(heads))]
        lines = [
            "  ".join(
                cell.ljust(width) if k == 0 else cell.rjust(width)
                for k, (cell, width) in enumerate(zip(line, widths, strict=True))
            ).rstrip()
            for line in table
        ]
        return "\n".join([self.objective, *lines, self.verdict])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the tuned rule base to a file, whole or not at all.

        Raises
        ------
        ValueError
            If it is no rule base; the message has the specification.
        OSError
            If the file cannot be written.
        """
        if not self.is_rulebase:
            raise ValueError(f"output: a tuned tracker of this kind has no file; type {self.text}")
        with whole_file(path) as draft:
            draft.write_text(self.text, encoding="utf-8", newline="")

    def to_json_dict(self) -> dict[str, Any]:
        """All but the tracker as values for JSON."""
        return {
            "data": self.data,
            "objective": self.objective,
            "units": self.units,
            "folds": self.folds,
            "plots": self.plots,
            "trials": self.trials,
            "seed": self.seed,
            "notes": list(self.notes),
            "numbers": self.numbers,
            "start": self.start,
            "without_effect": list(self.unused),
            "specification": None if self.is_rulebase else self.text,
            "parameters": self.parameters,
            "errors": [
                {
                    "name": row.name,
                    "training": row.training,
                    "held_out": row.held_out,
                    "numbers": row.numbers,
                    **dict(
                        zip(
                            ("change", "change_low", "change_high"),
                            row.change or (None, None, None),
                            strict=True,
                        )
                    ),
                }
                for row in self.rows
            ],
            "worth_it": self.worth_it,
            "verdict": self.verdict,
        }


def with_head(text: str, lines: Sequence[str]) -> str:
    """Text of a rule base with comments at its head, after the one that names its schema."""
    end = "\r\n" if "\r\n" in text else "\n"
    first, newline, rest = text.partition(end)
    comments = "".join(f"# {_printable(line)}{end}" for line in lines)
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    if newline and first.removeprefix(mark).startswith("# yaml-language-server"):
        return first + newline + comments + rest
    return mark + comments + text.removeprefix(mark)


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text)
