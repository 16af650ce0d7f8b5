"""Trackers ranked on random tracks, at a constant period and under all other conditions."""

from __future__ import annotations

import math
import operator
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.published import ALL_SETS, TRACK_SETS
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.catalog import Trackers, as_trackers
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.tuning.scored_plots import scored_plots, squared_errors
from fuzzytrack.tuning.variants import VARIANTS
from fuzzytrack.version import __version__
from fuzzytrack.yamltree import suggestion

__all__ = ["Change", "Ranking", "rank"]


@dataclass(frozen=True)
class Change:
    """How much larger the error of one tracker is than that of another, on the same plots.

    Attributes
    ----------
    value : float
        Relative change of the geometric mean of the RMSE over the sets; negative is better.
    error : float
        Its standard error, from the spread over tracks of the paired difference.
    """

    value: float
    error: float


@dataclass(frozen=True, eq=False)
class Ranking:
    """Errors of trackers on the same plots.

    Attributes
    ----------
    names : tuple of str
        The trackers.
    variants : tuple of str
        The variants, see `fuzzytrack.tuning.VARIANTS`.
    sets : tuple of str
        The sets of tracks, see `fuzzytrack.simulation.published.track_set`.
    seed : int
        Seed of tracks and noise.
    squares : ndarray, shape (n_trackers, n_variants, n_sets, n_tracks)
        Squared errors of each track, summed over its scored plots, in units of the variance of the
        noise; infinite where a tracker diverged.
    plots : ndarray of int, shape (n_variants, n_sets, n_tracks)
        Number of scored plots.
    """

    names: tuple[str, ...]
    variants: tuple[str, ...]
    sets: tuple[str, ...]
    seed: int
    squares: Array
    plots: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "names", "variants", "sets", "tracks", "seed")

    @property
    def tracks(self) -> int:
        """Number of tracks in each set."""
        return int(self.plots.shape[-1])

    def rmse(self, name: str, variant: str) -> dict[str, float]:
        """RMSE of the predictions in each set, in standard deviations of the noise.

        Parameters
        ----------
        name, variant : str
            Of a tracker and of a variant.

        Raises
        ------
        ValueError
            If it was not ranked.
        """
        which = self._variant(variant)
        sums = self.squares[self._tracker(name), which].sum(axis=-1)
        roots = np.sqrt(sums / self.plots[which].sum(axis=-1))
        return dict(zip(self.sets, roots.tolist(), strict=True))

    def change(self, name: str, reference: str, variant: str) -> Change:
        """Error of a tracker against that of a reference.

        Parameters
        ----------
        name, reference, variant : str
            Of two trackers and of a variant.

        Returns
        -------
        Change
            Infinite if the tracker diverged, NaN if the reference did.

        Raises
        ------
        ValueError
            If one was not ranked.
        """
        which = self._variant(variant)
        mine, theirs = (self.squares[self._tracker(one), which] for one in (name, reference))
        with np.errstate(invalid="ignore", divide="ignore"):
            whole, of_theirs = mine.sum(axis=1), theirs.sum(axis=1)
            ratio = math.exp(np.log(whole / of_theirs).mean() / 2)
            # Delta method; both saw the same plots, so the spread is that of the differences.
            spread = mine / whole[:, None] - theirs / of_theirs[:, None]
            error = math.sqrt(self.tracks * spread.var(axis=1).sum()) / (2 * len(self.sets))
        return Change(ratio - 1, ratio * error)

    def to_json_dict(self, references: Sequence[str]) -> dict[str, Any]:
        """The ranking in plain types, for JSON.

        Parameters
        ----------
        references : sequence of str
            Trackers with which all are compared.

        Raises
        ------
        ValueError
            If one was not ranked.
        """
        return {
            "fuzzytrack": __version__,
            "seed": self.seed,
            "tracks": self.tracks,
            "sets": self.sets,
            "variants": {name: repr(VARIANTS[name]) for name in self.variants},
            "rmse": {
                name: {variant: self.rmse(name, variant) for variant in self.variants}
                for name in self.names
            },
            "changes": {
                reference: {name: self._changes(name, reference) for name in self.names}
                for reference in references
            },
        }

    def _changes(self, name: str, reference: str) -> dict[str, list[float]]:
        found = {variant: self.change(name, reference, variant) for variant in self.variants}
        return {variant: [each.value, each.error] for variant, each in found.items()}

    def _tracker(self, name: str) -> int:
        return _place(name, self.names, "tracker")

    def _variant(self, name: str) -> int:
        return _place(name, self.variants, "variant")


def rank(
    trackers: Trackers,
    tracks: int,
    seed: int,
    variants: Collection[str] = tuple(VARIANTS),
    sets: Collection[str] = TRACK_SETS,
    progress: Progress | None = None,
) -> Ranking:
    """Measure trackers on fresh random tracks.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str, or sequence of str
        The trackers by name, or what names them, see `fuzzytrack.trackers.catalog.as_trackers`. The
        noise has a standard deviation of 1, and the mean time between scans is 1.
    tracks : int
        Number of tracks in each set, at least 1.
    seed : int
        Seed, not negative; another one than that with which the trackers were tuned.
    variants : collection of str
        Names out of `fuzzytrack.tuning.VARIANTS`; all of them unless given.
    sets : collection of str
        Sets of tracks, see `fuzzytrack.simulation.published.track_set`.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Ranking

    Raises
    ------
    ValueError
        If there is no tracker or no such tracker, a variant or set is unknown, or a number is
        out of range.

    Notes
    -----
    Predictions are scored at the plots received, from the third of a track on and not before the
    first scored scan of its set. All variants have the same tracks, and all trackers the same
    plots.

    Examples
    --------
    >>> from fuzzytrack.tuning import rank
    >>> ranking = rank(["fixed:alpha=.5:beta=.4", "kalman-cv:sigma_v=.9"], 4, 1, ["constant T"])
    >>> list(ranking.rmse("kalman-cv:sigma_v=.9", "constant T"))
    ['report', 'mixed', 'strong']
    """
    if operator.index(tracks) < 1:
        raise ValueError(f"tracks must be at least 1, got {tracks}")
    if operator.index(seed) < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    made = as_trackers(trackers)
    chosen, of = tuple(variants), tuple(sets)
    for name in chosen:
        _place(name, tuple(VARIANTS), "variant")
    for name in of:
        _place(name, ALL_SETS, "set")
    squares = np.zeros((len(made), len(chosen), len(of), tracks))
    counts = np.zeros((len(chosen), len(of), tracks), dtype=np.int64)
    done, every = 0, len(made) * len(chosen) * len(of)
    for i, variant in enumerate(chosen):
        for j, name in enumerate(of):
            plots = scored_plots(name, VARIANTS[variant], tracks, seed)
            counts[i, j] = plots.scored.sum(axis=0)
            for k, tracker in enumerate(made.values()):
                announce(tracker, 2, plots.z.size * (every - done) // len(made))
                squares[k, i, j] = squared_errors(tracker, plots)
                done += 1
                if progress is not None:
                    progress(done / every)
    return Ranking(tuple(made), chosen, of, seed, squares, counts)


def _place(name: str, known: tuple[str, ...], what: str) -> int:
    if name not in known:
        raise ValueError(f"unknown {what} {name!r}{suggestion(name, known)}")
    return known.index(name)
