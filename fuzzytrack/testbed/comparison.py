"""Trackers compared on the same simulated noise (Monte Carlo)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.ragged import Batch, batches
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.noise import check_runs
from fuzzytrack.tasks import Progress
from fuzzytrack.testbed.marks import best_of, marks_of
from fuzzytrack.testbed.metrics import squared_distance
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import Trackers, as_trackers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Comparison", "compare", "compare_tracks"]

# Coordinates a batch may hold: a tracker makes about ten arrays of this many floats (8 MB each).
_BATCH = 1_000_000


@dataclass(frozen=True, eq=False)
class Comparison:
    """Errors of trackers over Monte Carlo runs.

    Errors are distances over all axes (m), over the scans in which every tracker has a prediction
    and the truth is known, pooled over tracks.

    Attributes
    ----------
    names : tuple of str
        The trackers.
    scans : ndarray of int, shape (runs,)
        Scans of each run that were scored.
    sigma : float
        Standard deviation of the noise on each axis (m).
    seed : int
        Seed of the noise.
    predicted_mse, filtered_mse : ndarray, shape (n_trackers, runs)
        Mean squared error of predicted and filtered positions, run by run (m²).
    measured_mse : ndarray, shape (runs,)
        That of the plots themselves (m²).
    """

    names: tuple[str, ...]
    scans: NDArray[np.int64]
    sigma: float
    seed: int
    predicted_mse: Array
    filtered_mse: Array
    measured_mse: Array

    def __repr__(self) -> str:
        return summary(self, "names", "runs", "seed", "sigma")

    def plot(self) -> Figure:
        """Picture of the errors of prediction, see `fuzzytrack.plotting.plot_comparison`."""
        from fuzzytrack.plotting.comparison import plot_estimates

        plots = {"plots": self.measured_rmse}
        return plot_estimates(
            self.names, self.predicted_rmse, self.predicted_error, reference=plots
        )[0]

    def _repr_html_(self) -> str:
        """Table of errors, for notebooks."""
        changes = ["", *(f"{100 * change:+.1f} %" for change in self.predicted_change[1:])]
        numbers = map(as_text, self.predicted_rmse, self.predicted_error)
        filtered = map(as_text, self.filtered_rmse, self.filtered_error)
        rows = list(zip(self.names, numbers, filtered, changes, self.marks, strict=True))
        rows.append(("the plots themselves", "", as_text(self.measured_rmse), "", ""))
        heads = ["RMSE of position (m)", "predicted", "filtered", f"vs {self.names[0]}", ""]
        told = f"{counted(self.runs, 'run')}, noise {self.sigma:g} m on each axis, seed {self.seed}"
        best = best_of(self.predicted_rmse)
        return block("Trackers on the same noise", table(heads, rows, best=best), paragraph(told))

    @property
    def runs(self) -> int:
        """Number of Monte Carlo runs."""
        return len(self.measured_mse)

    @property
    def predicted_rmse(self) -> Array:
        """Root mean square error of predicted positions (m), shape (n_trackers,)."""
        return _root(self.predicted_mse)

    @property
    def filtered_rmse(self) -> Array:
        """Root mean square error of filtered positions (m), shape (n_trackers,)."""
        return _root(self.filtered_mse)

    @property
    def measured_rmse(self) -> float:
        """Root mean square error of the plots themselves (m)."""
        return float(_root(self.measured_mse))

    @property
    def predicted_error(self) -> Array:
        """Standard error of `predicted_rmse` (m); NaN for a single run."""
        return _standard_error(self.predicted_mse)

    @property
    def filtered_error(self) -> Array:
        """Standard error of `filtered_rmse` (m); NaN for a single run."""
        return _standard_error(self.filtered_mse)

    @property
    def predicted_change(self) -> Array:
        """Relative change of `predicted_rmse` against the first tracker, shape (n_trackers,)."""
        return np.asarray(self.predicted_rmse / self.predicted_rmse[0] - 1)

    @property
    def marks(self) -> list[str]:
        """Which tracker predicts best, and whose filtered positions are worse than the plots."""
        return marks_of(self.predicted_rmse, self.filtered_rmse, self.measured_rmse)

    def errors(self) -> dict[str, Array]:
        """Errors with their standard errors (m), by name, each of shape (n_trackers,)."""
        names = ("predicted_rmse", "predicted_error", "filtered_rmse", "filtered_error")
        return {name: getattr(self, name) for name in names}

    def to_json_dict(self) -> dict[str, Any]:
        """Summary in plain types, for JSON; NaN for the standard errors of a single run."""
        errors = self.errors()
        best = best_of(self.predicted_rmse)
        worse = self.filtered_rmse > self.measured_rmse
        return {
            "noise": self.sigma,
            "runs": self.runs,
            "seed": self.seed,
            "scans": round(self.scans.mean()),
            "measured_rmse": self.measured_rmse,
            "best": None if best is None else self.names[best],
            "trackers": [
                {
                    "name": name,
                    **{key: float(values[k]) for key, values in errors.items()},
                    "worse_than_plots": bool(worse[k]),
                }
                for k, name in enumerate(self.names)
            ],
        }


def compare(
    trackers: Trackers,
    t: ArrayLike,
    truth: ArrayLike,
    sigma: float,
    runs: int,
    seed: int,
    progress: Progress | None = None,
) -> Comparison:
    """Compare trackers on one track with simulated noise.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str, or sequence of str
        The trackers by name, at least one; or what names them, see
        `fuzzytrack.trackers.catalog.as_trackers`.
    t : array_like, shape (n_steps,)
        Times (s), increasing.
    truth : array_like, shape (n_steps, n_axes)
        True positions (m); NaN where there is no plot.
    sigma : float
        Standard deviation of the Gaussian noise on each axis (m), also given to the trackers.
    runs : int
        Number of Monte Carlo runs.
    seed : int
        Seed, not negative; the same seed gives the same numbers.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Comparison

    Raises
    ------
    TypeError
        If a tracker is something else.
    ValueError
        If there is no tracker, `sigma`, `runs` or `seed` is out of range, shapes do not fit, or
        the track is too short for a prediction.

    Notes
    -----
    Comparisons are paired: every tracker sees the same plots. Each run has a random stream of its
    own, spawned from the seed, so the numbers of a run depend neither on how many runs there are
    nor on how they are batched.
    """
    return compare_tracks(trackers, [(t, truth)], sigma, runs, seed, progress)


def compare_tracks(
    trackers: Trackers,
    tracks: Sequence[tuple[ArrayLike, ArrayLike]],
    sigma: float,
    runs: int,
    seed: int,
    progress: Progress | None = None,
) -> Comparison:
    """Compare trackers on several tracks with simulated noise, pooled.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str, or sequence of str
        As for `compare`.
    tracks : sequence of (t, truth)
        Times and true positions of each track, as for `compare`; all with the same axes.
    sigma, runs, seed, progress
        As for `compare`.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError
        As for `compare`.
    """
    _check(sigma, runs, seed)
    made = as_trackers(trackers)
    sums = _Sums(made, tracks, sigma)
    streams = np.random.SeedSequence(seed).spawn(runs)
    size = max(1, min(runs, _BATCH // sums.truth.size))
    starts = range(0, runs, size)
    for batch, start in enumerate(starts):
        for number in sums.add(streams[start : start + size]):
            if progress is not None:
                progress((batch + number / len(made)) / len(starts))
    return sums.comparison(seed)


def _check(sigma: float, runs: int, seed: int) -> None:
    if not (math.isfinite(sigma) and sigma > 0):
        raise ValueError(f"sigma must be positive, got {sigma}")
    check_runs(runs, seed)


def _pool(tracks: Sequence[tuple[ArrayLike, ArrayLike]]) -> tuple[Array, tuple[Batch, ...]]:
    """True positions of all tracks in one array, a NaN row at its end, and batches of tracks."""
    pairs = [(np.asarray(t, float), np.asarray(truth, float)) for t, truth in tracks]
    for t, truth in pairs:
        if truth.ndim != 2 or t.shape != truth.shape[:1]:
            raise ValueError(
                "truth: needs shape (n_steps, n_axes) and as many times; got shapes "
                f"{truth.shape} and {t.shape}"
            )
    widths = {truth.shape[1] for _, truth in pairs}
    if len(widths) != 1:
        raise ValueError("tracks: at least one is needed, and all need the same axes")
    gap = np.full((1, *widths), np.nan)
    return np.concatenate([*(truth for _, truth in pairs), gap]), batches([t for t, _ in pairs])


class _Sums:
    """Mean squared errors, collected over batches of runs."""

    def __init__(
        self,
        trackers: Mapping[str, Tracker],
        tracks: Sequence[tuple[ArrayLike, ArrayLike]],
        sigma: float,
    ) -> None:
        self.trackers, self.sigma = trackers, float(sigma)
        self.truth, self.batches = _pool(tracks)
        self.scans: list[NDArray[np.int64]] = []
        self.means: list[Array] = []

    def add(self, streams: Sequence[np.random.SeedSequence]) -> Iterator[int]:
        """Run a batch of runs, one for each random stream; yields after each tracker."""
        noise = [np.random.default_rng(s).standard_normal(self.truth.shape) for s in streams]
        plots = self.truth + self.sigma * np.stack(noise)
        del noise
        errors = [squared_distance(plots - self.truth)]
        for number, tracker in enumerate(self.trackers.values(), 1):
            errors.extend(self._errors(tracker, plots))
            yield number
        # NaN where the truth is unknown, or any tracker has no prediction yet.
        scored = ~np.isnan(np.sum(errors, axis=0))
        counts = scored.sum(axis=1)
        if not counts.all():
            raise ValueError(
                "truth: too short, no scan has a prediction of every tracker; "
                "most trackers need three plots"
            )
        self.scans.append(counts)
        # Summed along rows, run by run, so that batches of any size give the same bits.
        rows = [np.ascontiguousarray(np.where(scored, e, 0.0)) for e in errors]
        self.means.append(np.stack([row.sum(axis=1) / counts for row in rows]))

    def _errors(self, tracker: Tracker, plots: Array) -> tuple[Array, Array]:
        """Squared errors, predicted and filtered, each of shape (runs, n_scans)."""
        predicted, filtered = (np.empty(plots.shape[:2]) for _ in range(2))
        for batch in self.batches:
            # From (runs, n_steps, n_tracks, n_axes) to time first
            z = np.ascontiguousarray(plots[:, batch.places].swapaxes(0, 1))
            if batch.times.shape[1] == 1:
                result = tracker.run(batch.times[:, 0], z[:, :, 0], self.sigma)
            else:
                times = np.repeat(batch.times[:, None, :], len(plots), axis=1)
                result = tracker.run(times, z, self.sigma)
            truth = self.truth[batch.places][:, None]
            for errors, positions in ((predicted, result.predicted), (filtered, result.filtered)):
                square = squared_distance(positions.reshape(z.shape) - truth)
                errors[:, batch.places] = square.swapaxes(0, 1)
        # The row at the end belongs to no track.
        predicted[:, -1] = filtered[:, -1] = np.nan
        return predicted, filtered

    def comparison(self, seed: int) -> Comparison:
        """Comparison of all runs so far."""
        means = np.concatenate(self.means, axis=1)
        return Comparison(
            names=tuple(self.trackers),
            scans=np.concatenate(self.scans),
            sigma=self.sigma,
            seed=seed,
            predicted_mse=means[1::2],
            filtered_mse=means[2::2],
            measured_mse=means[0],
        )


def _root(mse: Array) -> Array:
    return np.asarray(np.sqrt(mse.mean(axis=-1)))


def _standard_error(mse: Array) -> Array:
    """Standard error of the root of the mean over runs, by the delta method."""
    runs = mse.shape[-1]
    if runs < 2:
        return np.full(mse.shape[:-1], np.nan)
    spread = mse.std(axis=-1, ddof=1) / math.sqrt(runs)
    return np.asarray(spread / (2.0 * _root(mse)))
