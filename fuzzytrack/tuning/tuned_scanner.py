"""A tuned configuration of a scan tracker, with its values before and after."""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.io.files import whole_file
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan_tracker import ScanTracker

__all__ = ["GroupRow", "TunedScanner"]


@dataclass(frozen=True)
class GroupRow:
    """A group of recordings.

    Attributes
    ----------
    group : str
    start, tuned : float
        Criterion of the configuration where the search began, and of the tuned one.
    held_out : float or None
        Criterion of a configuration that was tuned on all other groups.
    """

    group: str
    start: float
    tuned: float
    held_out: float | None


@dataclass(frozen=True, eq=False)
class TunedScanner:
    """Result of `fuzzytrack.tuning.scanner_tuner.tune_scanner`.

    Attributes
    ----------
    tracker : ScanTracker
        The tuned scan tracker.
    text : str
        Its configuration in YAML.
    start_name : str
        Name of the configuration where the search began.
    numbers, start : dict of str to float
        Its free numbers, and those where the search began.
    rows : tuple of GroupRow
        The groups of recordings.
    metric, objective : str
        What was minimized, by name and in words.
    recordings, trials, seed : int
        Number of recordings, of configurations tried in all searches, and the seed.
    """

    tracker: ScanTracker
    text: str
    start_name: str
    numbers: dict[str, float]
    start: dict[str, float]
    rows: tuple[GroupRow, ...]
    metric: str
    objective: str
    recordings: int
    trials: int
    seed: int

    def __repr__(self) -> str:
        return summary(self, "metric", "numbers", "verdict")

    @property
    def means(self) -> GroupRow:
        """Means over the groups."""
        held = [row.held_out for row in self.rows]
        return GroupRow(
            "mean",
            float(np.mean([row.start for row in self.rows])),
            float(np.mean([row.tuned for row in self.rows])),
            None if None in held else float(np.mean([h for h in held if h is not None])),
        )

    @property
    def change(self) -> tuple[float, float, float] | None:
        """Mean change on held-out groups, and the ends of its 95 % interval.

        By Student's t over the differences of the groups; NaN ends for fewer than three of them.
        None if no group was left out.
        """
        held = [row.held_out - row.start for row in self.rows if row.held_out is not None]
        if not held:
            return None
        middle, count = float(np.mean(held)), len(held)
        if count < 3:
            return middle, math.nan, math.nan
        from scipy.stats import t

        reach = float(t.ppf(0.975, count - 1)) * float(np.std(held, ddof=1)) / math.sqrt(count)
        return middle, middle - reach, middle + reach

    @property
    def verdict(self) -> str:
        """In words: what tuning has changed, and whether it is better where it was not tuned."""
        mean, change = self.means, self.change
        text = f"from {mean.start:.4g} to {mean.tuned:.4g} on what it was tuned on"
        if change is None or mean.held_out is None:
            return f"{text}; not judged on anything else"
        text += f", {mean.held_out:.4g} on groups that were left out"
        middle, low, high = change
        if math.isnan(low):
            return f"{text}; too few groups for an interval"
        sure = "better" if high < 0 else "worse" if low > 0 else "no sure change"
        return f"{text}: {sure} ({middle:+.3g}, {low:+.3g} to {high:+.3g})"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the configuration to a file, whole or not at all.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        with whole_file(path) as draft:
            draft.write_text(self.text, encoding="utf-8")

    def _repr_html_(self) -> str:
        """The values and the numbers, for notebooks."""
        return block(
            self.objective,
            table(["group", self.start_name, "tuned", "held out"], self.cells),
            paragraph(self.verdict),
            table(
                ["free number", "start", "tuned"],
                [[k, f"{self.start[k]:.5g}", f"{v:.5g}"] for k, v in self.numbers.items()],
                what="numbers",
            ),
        )

    @property
    def cells(self) -> list[list[str]]:
        """Rows of the table of groups, the means last."""
        return [
            [
                row.group,
                as_text(row.start),
                as_text(row.tuned),
                "–" if row.held_out is None else as_text(row.held_out),
            ]
            for row in (*self.rows, self.means)
        ]

    def to_json_dict(self) -> dict[str, Any]:
        """All but the tracker as values for JSON."""
        return {
            "from": self.start_name,
            "metric": self.metric,
            "objective": self.objective,
            "recordings": self.recordings,
            "trials": self.trials,
            "seed": self.seed,
            "numbers": self.numbers,
            "start": self.start,
            "groups": [asdict(row) for row in self.rows],
            "mean": asdict(self.means),
            "change": self.change,
            "verdict": self.verdict,
            "configuration": self.text,
        }
