"""Tracks on which trackers are tuned: plots, maybe with the truth."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.ragged import batches
from fuzzytrack.recordings.used_plots import read_used_plots
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.noise import streams, truth_of_runs
from fuzzytrack.simulation.scenario import Scenario

__all__ = ["LEAST_PLOTS", "Batch", "TuningData", "TuningTrack", "joined", "recorded", "simulated"]

#: Plots that are scored, in all tracks together, below which nothing is tuned.
LEAST_PLOTS = 200
# Plots of a track that are not scored: a track starts with two, and predictions begin then.
_START = 2


@dataclass(frozen=True, eq=False)
class TuningTrack:
    """One track.

    Attributes
    ----------
    id : str
    time : ndarray, shape (n_steps,)
        Times (s), increasing.
    plots : ndarray, shape (n_steps, n_axes)
        Plots (m); NaN where missed.
    truth : ndarray or None, shape (n_steps, n_axes)
        True positions (m); NaN where unknown.
    sigma : ndarray or None, shape (n_steps, n_axes)
        Standard deviation of each plot (m).
    group : int
        Group of tracks to which it belongs; all groups count alike, however many tracks they have.
    start : int
        Number of its first plots that are not scored, at least 2.
    """

    id: str
    time: Array
    plots: Array
    truth: Array | None = None
    sigma: Array | None = None
    group: int = 0
    start: int = _START

    def __repr__(self) -> str:
        return summary(self, "id", "plots")

    @property
    def scored(self) -> NDArray[np.bool_]:
        """Whether the prediction of each plot is scored, shape (n_steps,)."""
        seen = ~np.isnan(self.plots).any(axis=1)
        known = seen if self.truth is None else seen & ~np.isnan(self.truth).any(axis=1)
        return known & (np.cumsum(seen) > self.start)


@dataclass(frozen=True, eq=False)
class Batch:
    """Tracks side by side, as a tracker runs them; padded with missed plots.

    Attributes
    ----------
    time : ndarray, shape (n_steps,) or (n_steps, n_tracks)
        The times that all tracks have in common, for which less is compiled, or those of each.
    plots, target : ndarray, shape (n_steps, n_tracks, n_axes)
        `target` is what a prediction is compared with: the truth, or the plot.
    sigma : ndarray or None, shape (n_steps, n_tracks, n_axes)
    members : ndarray of int, shape (n_tracks,)
        Which tracks.
    scored : ndarray of bool, shape (n_steps, n_tracks)
    """

    time: Array
    plots: Array
    target: Array
    sigma: Array | None
    members: NDArray[np.int64]
    scored: NDArray[np.bool_]

    def __repr__(self) -> str:
        return summary(self, "plots")


@dataclass(frozen=True, eq=False)
class TuningData:
    """Tracks on which trackers are tuned.

    Parameters
    ----------
    name : str
        Of the file or scenario.
    tracks : tuple of TuningTrack
        At least one; either all with truth or none.
    axes_differ : bool
        Whether the noise of the plots differs between axes.
    notes : tuple of str
        What was guessed, left out or put right when the plots were read, each in a sentence.

    Raises
    ------
    ValueError
        If there are too few plots, or they are all at one place.
    """

    name: str
    tracks: tuple[TuningTrack, ...]
    axes_differ: bool = False
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        count = sum(int(track.scored.sum()) for track in self.tracks)
        if count < LEAST_PLOTS:
            raise DataError(
                f"{self.name}: {counted(count, 'plot')} can be scored; tuning needs "
                f"{LEAST_PLOTS} at least"
            )
        plots = np.concatenate([track.plots for track in self.tracks])
        if (np.nanmax(plots, axis=0) == np.nanmin(plots, axis=0)).all():
            raise DataError(f"{self.name}: all plots are at one place; there is nothing to tune")

    def __repr__(self) -> str:
        return summary(self, "name", tracks=len(self.tracks))

    @property
    def has_truth(self) -> bool:
        """Whether predictions are compared with the truth; otherwise with the plots."""
        return self.tracks[0].truth is not None

    @property
    def has_sigma(self) -> bool:
        """Whether the standard deviations of the plots are known."""
        return self.tracks[0].sigma is not None

    @property
    def n_axes(self) -> int:
        """Axes of the plots."""
        return int(self.tracks[0].plots.shape[1])

    @property
    def coordinates(self) -> int:
        """Number of coordinates of all plots, missed ones included."""
        return sum(track.plots.size for track in self.tracks)

    @cached_property
    def noise(self) -> float:
        """Typical standard deviation of a plot (m): the known one, or an estimate.

        The estimate is the median size of the differences of second order between plots.
        """
        if self.has_sigma:
            known = np.concatenate([np.ravel(t.sigma) for t in self.tracks if t.sigma is not None])
            return float(np.sqrt(np.nanmean(known**2)))
        sizes = np.concatenate([np.abs(np.diff(t.plots, n=2, axis=0)).ravel() for t in self.tracks])
        # Of normal noise the median of |d| is 0.6745 standard deviations, and d has six times
        # the variance.
        typical = float(np.nanmedian(sizes)) / (0.6745 * math.sqrt(6))
        return typical if typical > 0 else float(np.nanmax(sizes)) / 10

    @cached_property
    def interval(self) -> float:
        """Typical time between plots (s)."""
        gaps = [np.diff(t.time[~np.isnan(t.plots).any(axis=1)]) for t in self.tracks]
        return float(np.median(np.concatenate(gaps)))

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """The tracks as they are run."""
        pads = [(t.plots, t.plots if t.truth is None else t.truth, t.sigma) for t in self.tracks]
        gap = np.full((1, self.n_axes), np.nan)
        plots, target = (np.concatenate([*(p[k] for p in pads), gap]) for k in (0, 1))
        scored = np.concatenate([*(t.scored for t in self.tracks), [False]])
        sigma = None
        if self.has_sigma:
            sigma = np.concatenate([*(p[2] for p in pads if p[2] is not None), gap])
            # Where there is no plot, there need not be one.
            sigma = np.where(np.isnan(sigma), 1.0, sigma)
        return tuple(
            Batch(
                _common(batch.times),
                plots[batch.places],
                target[batch.places],
                None if sigma is None else sigma[batch.places],
                batch.members,
                scored[batch.places],
            )
            for batch in batches([t.time for t in self.tracks])
        )


def _common(times: Array) -> Array:
    """Times of one track, if all have the same."""
    return times[:, 0] if (times == times[:, :1]).all() else times


def joined(parts: Sequence[TuningData]) -> TuningData:
    """Data of several sources as one, each a group that counts like the others.

    Raises
    ------
    ValueError
        If they differ in their axes, or in whether truth and sigma are known.
    """
    first = parts[0]
    if len(parts) == 1:
        return first
    for other in parts[1:]:
        for what in ("n_axes", "has_truth", "has_sigma"):
            if getattr(other, what) != getattr(first, what):
                raise ValueError(
                    f"data: {first.name} and {other.name} cannot be tuned on together; they differ "
                    f"in {_DIFFERENCES[what]}"
                )
    tracks = (replace(track, group=k) for k, part in enumerate(parts) for track in part.tracks)
    return TuningData(
        ", ".join(part.name for part in parts),
        tuple(tracks),
        axes_differ=any(part.axes_differ for part in parts),
        notes=tuple(f"{part.name}: {note}" for part in parts for note in part.notes),
    )


_DIFFERENCES = {
    "n_axes": "their number of axes",
    "has_truth": "whether the truth is known",
    "has_sigma": "whether the standard deviation of plots is known",
}


def simulated(scenario: Scenario, runs: int, seed: int) -> TuningData:
    """Runs of a scenario, each with its truth.

    Parameters
    ----------
    scenario : Scenario
    runs : int
        Number of runs, at least 1.
    seed : int
        Seed of the noise, not negative.
    """
    position, _ = scenario.truth(0, runs)
    plots = scenario.sensors.measure(position, streams(seed, runs))
    truth = np.broadcast_to(truth_of_runs(position, runs), plots.z.shape)
    times = scenario.times(0, runs)
    own = np.broadcast_to(times.reshape(len(times), -1), plots.z.shape[:2])
    tracks = tuple(
        TuningTrack(
            str(k + 1),
            own[:, k],
            plots.z[:, k],
            truth[:, k],
            plots.sigma[:, k],
            start=max(_START, scenario.first_scored),
        )
        for k in range(runs)
    )
    return TuningData(scenario.name, tracks)


def recorded(
    plots: Any,
    reading: Reading | None = None,
    *,
    truth: str | os.PathLike[str] | None = None,
    gate: GateWidth = "auto",
) -> TuningData:
    """Recorded plots, read as `fuzzytrack.track` reads them.

    Parameters
    ----------
    plots : path, data frame, mapping or tuple
        As for `fuzzytrack.track`.
    reading : Reading, optional
        How they are read. Without a standard deviation of the plots it is estimated from them.
    truth : str or path, optional
        True positions, see `fuzzytrack.recordings.truth.read_truth`. Where they are not known,
        plots are not scored. A lag between the clocks of two files is fitted, and taken off.
    gate : float, "auto" or None
        As for `fuzzytrack.track`: plots that its default tracker does not use are missed plots, so
        that they do not decide what is tuned.

    Raises
    ------
    DataError
        If a file does not hold such tracks, or the truth lacks a track; see also `TuningData`.
    OSError
        If a file cannot be read.
    """
    used = read_used_plots(plots, reading, truth=truth, gate=gate)
    found = tuple(
        TuningTrack(
            track.id,
            track.time,
            track.plots,
            used.truth_of(track),
            track.sigma,
        )
        for track in used.tracks
    )
    notes = used.notes if used.lag is None else (*used.notes, used.lag.sentence)
    return TuningData(used.name, found, axes_differ=used.axes_differ, notes=notes)
