"""What was found while plots were read as scans: how many, and what was left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.errors import DataError
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
    ahead : int
        Plots whose time was far ahead of all others, and which were left out.
    wraps : int
        Times that the clock has started again.
    own_known, own_missing, own_jumps : int
        Scans with the position of the radar; without it although they should have it; scans at
        which it jumps.
    doubt : str
        Why the time of a turn that was given does not suit the plots; empty if it does. It is a
        note, too.
    """

    scans: int = 0
    empty: int = 0
    plots: int = 0
    missed: int = 0
    copies: int = 0
    fills: int = 0
    late: int = 0
    ahead: int = 0
    wraps: int = 0
    own_known: int = 0
    own_missing: int = 0
    own_jumps: int = 0
    doubt: str = ""

    _FAULTS = ("missed", "copies", "fills", "late", "ahead", "wraps", "own_missing", "own_jumps")

    @property
    def counts(self) -> dict[str, int]:
        """The counts by their names."""
        names = ("scans", "empty", "plots", *self._FAULTS, "own_known")
        return {name: getattr(self, name) for name in names}

    def count(self, plots: int) -> None:
        """Count a scan with some plots."""
        self.scans += 1
        self.plots += plots
        self.empty += not plots

    def check(self, file: str) -> None:
        """Check that there was a plot at all.

        Parameters
        ----------
        file : str
            Name of the recording, for the message.

        Raises
        ------
        DataError
            If no row has a position that can be used.
        """
        if not self.plots:
            found = "; ".join(self.sentences()) or "no scan has a plot"
            raise DataError(f"{file}: no plot can be used: {found}")

    def sentences(self) -> tuple[str, ...]:
        """What was left out or put right, a phrase for each kind of fault."""
        said = [
            f"{counted(count, 'plot')} with {reason}, left out"
            for reason, count in self.impossible.items()
        ]
        settled = "that of the one before was taken" if self.own_known else "it is not known"
        for count, one, several in (
            (self.missed, "row without a position left out", "rows without a position left out"),
            (self.fills, "of these with a value beyond any use", "of these with values beyond use"),
            (self.copies, "exact copy of a plot dropped", "exact copies of plots dropped"),
            (self.late, "plot came too late, left out", "plots came too late, left out"),
            (
                self.ahead,
                "time far ahead of all others, left out",
                "times far ahead of all others, left out",
            ),
            (self.wraps, "time that the clock started again", "times that the clock started again"),
            (
                self.own_missing,
                f"scan without the position of the radar: {settled}",
                f"scans without the position of the radar: {settled}",
            ),
            (
                self.own_jumps,
                "jump of the position of the radar, taken as it is",
                "jumps of the position of the radar, taken as they are",
            ),
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
