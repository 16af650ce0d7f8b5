"""What was found while plots were read as scans: how many, and what was left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.io.findings import Findings
from fuzzytrack.plurals import counted

__all__ = ["ScanFindings"]


@dataclass
class ScanFindings(Findings):
    """Counts of scans and plots, and of faults; it grows while scans are read.

    Attributes
    ----------
    scans, empty : int
        Scans, and those of them without a plot.
    plots : int
        Plots in scans.
    missed : int
        Rows without a position.
    copies : int
        Plots that repeated another one of their scan to the last digit.
    fills : int
        Rows with values beyond any use.
    late : int
        Plots that came too late, and were left out.
    wraps : int
        Times that the clock has started again.
    """

    scans: int = 0
    empty: int = 0
    plots: int = 0
    missed: int = 0
    copies: int = 0
    fills: int = 0
    late: int = 0
    wraps: int = 0

    _FAULTS = ("missed", "copies", "fills", "late", "wraps")

    def sentences(self) -> tuple[str, ...]:
        """What was left out or put right, a phrase for each kind of fault."""
        said = [
            f"{counted(count, 'plot')} with {reason}, left out"
            for reason, count in self.impossible.items()
        ]
        for count, one, several in (
            (self.missed, "row without a position left out", "rows without a position left out"),
            (self.fills, "of these with a value beyond any use", "of these with values beyond use"),
            (self.copies, "exact copy of a plot dropped", "exact copies of plots dropped"),
            (self.late, "plot came too late, left out", "plots came too late, left out"),
            (self.wraps, "time that the clock started again", "times that the clock started again"),
        ):
            if count:
                said.append(counted(count, one, several))
        return tuple(said)

    def to_json_dict(self) -> dict[str, Any]:
        """The same in the types of JSON."""
        faults = {name: getattr(self, name) for name in self._FAULTS}
        return {
            "scans": self.scans,
            "empty_scans": self.empty,
            "plots": self.plots,
            "faults": {**self.impossible, **faults},
            "notes": list(self.notes),
        }
