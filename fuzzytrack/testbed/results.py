"""Outcome of a Monte Carlo experiment: errors of every tracker, run and scan, and what they say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Results", "Sample"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sample:
    """One run in full, to look at.

    Attributes
    ----------
    truth, plots : ndarray, shape (n_steps, n_axes)
        True positions and plots (m); NaN where missed.
    predicted, filtered : ndarray, shape (n_trackers, n_steps, n_axes)
        Of each tracker (m).
    alpha, beta, gamma : ndarray, shape (n_trackers, n_steps, n_axes)
        Gains of each tracker.
    """

    truth: Array
    plots: Array
    predicted: Array
    filtered: Array
    alpha: Array
    beta: Array
    gamma: Array


@dataclass(frozen=True, eq=False)
class Results:
    """Errors of trackers over Monte Carlo runs; every tracker saw the same plots.

    Attributes
    ----------
    scenario : str
        Name of the scenario.
    names : tuple of str
        The trackers.
    seed : int
        Seed of the noise.
    first_scored : int
        First scan, from 0, whose errors count.
    time : ndarray, shape (n_steps,)
        Times of the scans (s).
    predicted : ndarray, shape (n_trackers, runs, n_steps, n_axes)
        Predicted minus true position (m); NaN where there is no prediction.
    filtered : ndarray, same shape
        Filtered minus true position (m).
    velocity : ndarray, same shape, or None
        Filtered minus true velocity (m/s), where the scenario knows it.
    measured : ndarray, shape (runs, n_steps, n_axes)
        Plot minus true position (m); NaN where missed.
    nis, nees : ndarray, shape (n_trackers, runs, n_steps), or None
        Normalised innovation squared, and normalised estimation error squared of position, summed
        over axes, where the scenario presumes a `process_sigma`.
    sample : Sample
        Run 0 in full.
    """

    scenario: str
    names: tuple[str, ...]
    seed: int
    first_scored: int
    time: Array
    predicted: Array
    filtered: Array
    velocity: Array | None
    measured: Array
    nis: Array | None
    nees: Array | None
    sample: Sample
