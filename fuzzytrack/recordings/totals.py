"""Sums over tracks, from which a summary follows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.recordings.streaming import OpenTracks, TrackedPiece

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
    """

    tracks: int = 0
    plots: int = 0
    missed: int = 0
    duration: float = 0.0
    squares: tuple[float, int] = (0.0, 0)
    alpha: tuple[float, int] = (0.0, 0)
    beta: tuple[float, int] = (0.0, 0)

    def add(self, tracked: TrackedPiece) -> None:
        """Count a piece; its tracks and their duration are counted by `close`."""
        seen = int((~np.isnan(tracked.piece.plots).any(axis=1)).sum())
        self.plots += seen
        self.missed += len(tracked.piece.time) - seen
        outputs = tracked.outputs
        squares = np.square(outputs["innovation"]).sum(axis=1)
        self.squares = _more(self.squares, _known(squares))
        self.alpha = _more(self.alpha, _known(outputs["alpha"]))
        self.beta = _more(self.beta, _known(outputs["beta"]))

    def close(self, tracks: OpenTracks) -> None:
        """Count the tracks, after the last piece."""
        self.tracks += len(tracks)
        self.duration += tracks.duration

    def merge(self, other: Totals) -> None:
        """Add those of other tracks."""
        self.tracks += other.tracks
        self.plots += other.plots
        self.missed += other.missed
        self.duration += other.duration
        self.squares = _more(self.squares, other.squares)
        self.alpha = _more(self.alpha, other.alpha)
        self.beta = _more(self.beta, other.beta)

    @property
    def summary(self) -> dict[str, float]:
        """Numbers for people: plots, missed, duration, innovation_rms, and mean alpha and beta."""
        return {
            "plots": self.plots,
            "missed": self.missed,
            "duration": self.duration,
            "innovation_rms": math.sqrt(_mean(self.squares)),
            "alpha": _mean(self.alpha),
            "beta": _mean(self.beta),
        }


def _known(values: Array) -> tuple[float, int]:
    known = values[~np.isnan(values)]
    return float(known.sum()), known.size


def _more(one: tuple[float, int], other: tuple[float, int]) -> tuple[float, int]:
    return one[0] + other[0], one[1] + other[1]


def _mean(sum_and_number: tuple[float, int]) -> float:
    total, number = sum_and_number
    return total / number if number else math.nan
