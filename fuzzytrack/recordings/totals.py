"""The summary of a run: sums over its tracks, and means for printing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.io.findings import Findings
from fuzzytrack.recordings.streaming import TrackedPiece
from fuzzytrack.trackers.result import TrackResult

__all__ = ["Totals"]


@dataclass
class Totals:
    """Sums over the tracks of a recording, or of a part of it.

    Attributes
    ----------
    tracks, plots, missed : int
        Tracks; plots that are complete; plots that were missed in whole or in part.
    duration : float
        Sum of the durations of the tracks (s).
    squares, alpha, beta : tuple of float and int
        Sum and number of the squared lengths of innovations (m²), and of the gains.
    findings : Findings
        Faults of the plots, and notes about them.
    """

    tracks: int = 0
    plots: int = 0
    missed: int = 0
    duration: float = 0.0
    squares: tuple[float, int] = (0.0, 0)
    alpha: tuple[float, int] = (0.0, 0)
    beta: tuple[float, int] = (0.0, 0)
    findings: Findings = field(default_factory=Findings)

    @classmethod
    def of(cls, results: Sequence[TrackResult]) -> Totals:
        """Totals of tracks that were run as a whole."""
        totals = cls()
        totals._count(
            np.concatenate([_seen(r.measured) for r in results]),
            np.concatenate([_squares(r.innovation) for r in results]),
            np.concatenate([r.gains.alpha for r in results]),
            np.concatenate([r.gains.beta for r in results]),
        )
        totals.close(len(results), float(sum(r.time[-1] - r.time[0] for r in results)))
        return totals

    def add(self, tracked: TrackedPiece) -> None:
        """Count the plots of a piece; tracks are counted by `close`."""
        outputs = tracked.outputs
        if tracked.rejected is not None and tracked.begins is not None:
            self.findings.rejected += int(tracked.rejected.sum())
            self.findings.restarts += int(tracked.begins.sum())
        self._count(
            _seen(tracked.piece.plots),
            _squares(outputs["innovation"]),
            outputs["alpha"],
            outputs["beta"],
        )

    def _count(self, seen: Mask, squares: Array, alpha: Array, beta: Array) -> None:
        plots = int(seen.sum())
        self.plots += plots
        self.missed += len(seen) - plots
        self.squares = _more(self.squares, _known(squares))
        self.alpha = _more(self.alpha, _known(alpha))
        self.beta = _more(self.beta, _known(beta))

    def close(self, tracks: int, duration: float) -> None:
        """Count the tracks, after the last piece, and the sum of their durations (s)."""
        self.tracks += tracks
        self.duration += duration

    def merge(self, other: Totals) -> None:
        """Add the totals of other tracks."""
        self.tracks += other.tracks
        self.plots += other.plots
        self.missed += other.missed
        self.duration += other.duration
        self.squares = _more(self.squares, other.squares)
        self.alpha = _more(self.alpha, other.alpha)
        self.beta = _more(self.beta, other.beta)
        self.findings.merge(other.findings)

    @property
    def summary(self) -> dict[str, float]:
        """For printing: plots, missed, duration, innovation_rms, and mean alpha and beta."""
        return {
            "plots": self.plots,
            "missed": self.missed,
            "duration": self.duration,
            "innovation_rms": math.sqrt(_mean(self.squares)),
            "alpha": _mean(self.alpha),
            "beta": _mean(self.beta),
        }


def _seen(plots: Array) -> Mask:
    """Which plots are complete."""
    found: Mask = np.logical_not(np.isnan(plots).any(axis=1))
    return found


def _squares(innovation: Array) -> Array:
    """Squared length of each innovation (m²)."""
    found: Array = np.square(innovation).sum(axis=1)
    return found


def _known(values: Array) -> tuple[float, int]:
    known = values[~np.isnan(values)]
    return float(known.sum()), known.size


def _more(one: tuple[float, int], other: tuple[float, int]) -> tuple[float, int]:
    return one[0] + other[0], one[1] + other[1]


def _mean(sum_and_number: tuple[float, int]) -> float:
    total, number = sum_and_number
    return total / number if number else math.nan
