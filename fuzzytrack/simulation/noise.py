"""White, colored and heavy-tailed noise of unit variance, and plots with it.

Every Monte Carlo run draws from a random stream of its own, so its numbers depend neither on how
many runs there are nor on how they are put into batches.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import positive
from fuzzytrack.reprs import summary

# Numbers of the streams below that of a run, so that no draw depends on whether another is made.
DETECTION, SPREAD, OUTLIERS, TIMES = range(4)

__all__ = [
    "WHITE",
    "Noise",
    "Plots",
    "check_runs",
    "noisy_plots",
    "streams",
    "substream",
    "truth_of_runs",
]


@dataclass(frozen=True)
class Noise:
    """Kind of noise: mean 0, variance 1.

    Parameters
    ----------
    correlation : float
        Correlation of one scan with the next, -1 < correlation < 1; 0 is white. Anything else is an
        AR(1) sequence, stationary from its first scan on.
    freedom : float
        Degrees of freedom of a Student t distribution, > 2, scaled to unit variance; infinity, the
        default, is the normal distribution. With a correlation it is that of what drives the
        sequence.

    Raises
    ------
    ValueError
        If a parameter is out of its range.

    Examples
    --------
    >>> from fuzzytrack.simulation.noise import Noise
    >>> Noise(correlation=0.7)
    Noise(correlation=0.7, freedom=inf)
    """

    correlation: float = 0.0
    freedom: float = math.inf

    def __post_init__(self) -> None:
        if not -1 < self.correlation < 1:
            raise ValueError(f"correlation must be between -1 and 1, got {self.correlation}")
        if not self.freedom > 2:
            raise ValueError(f"freedom must be > 2, got {self.freedom}")

    def draw(self, rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
        """Noise, time along axis 0.

        Parameters
        ----------
        rng : numpy.random.Generator
            Random stream.
        shape : tuple of int
            (n_steps, ...); sequences beside each other are independent.

        Returns
        -------
        ndarray, shape `shape`
        """
        if math.isinf(self.freedom):
            noise = rng.standard_normal(shape)
        else:
            noise = rng.standard_t(self.freedom, shape) * math.sqrt(1 - 2 / self.freedom)
        if self.correlation:
            fresh = math.sqrt(1 - self.correlation**2)
            for k in range(1, len(noise)):
                noise[k] = self.correlation * noise[k - 1] + fresh * noise[k]
        return noise


#: White normal noise.
WHITE = Noise()


@dataclass(frozen=True, eq=False)
class Plots:
    """Simulated plots of many runs, as a tracker takes them.

    Attributes
    ----------
    z : ndarray, shape (n_steps, n_runs, n_axes)
        Plots (m); NaN where there is none.
    sigma : ndarray, shape (n_steps, n_runs, n_axes)
        Standard deviation of each plot on each axis that the tracker is told (m); NaN where there
        is none.
    """

    z: Array
    sigma: Array

    def __repr__(self) -> str:
        return summary(self, "z", "sigma")


def streams(seed: int, runs: int) -> list[np.random.SeedSequence]:
    """Random streams of Monte Carlo runs, one for each run.

    Parameters
    ----------
    seed : int
        Seed, not negative.
    runs : int
        Number of runs, at least 1.

    Raises
    ------
    ValueError
        If a number is out of range.
    """
    check_runs(runs, seed)
    return np.random.SeedSequence(seed).spawn(runs)


def substream(run: np.random.SeedSequence, number: int) -> np.random.Generator:
    """Random numbers from a stream below that of a run, which is left as it is.

    Parameters
    ----------
    run : SeedSequence
        Stream of a run, see `streams`.
    number : int
        Number of the stream below it, from 0.
    """
    below = np.random.SeedSequence(entropy=run.entropy, spawn_key=(*run.spawn_key, number))
    return np.random.default_rng(below)


def check_runs(runs: int, seed: int) -> None:
    """ValueError if `runs` is less than 1 or `seed` is negative; TypeError if not whole numbers."""
    if operator.index(runs) < 1:
        raise ValueError(f"runs must be at least 1, got {runs}")
    if operator.index(seed) < 0:
        raise ValueError(f"seed must not be negative, got {seed}")


def noisy_plots(
    truth: ArrayLike,
    sigma: ArrayLike,
    runs: Sequence[np.random.SeedSequence],
    noise: Noise = WHITE,
) -> Plots:
    """Plots of one target whose noise does not depend on its position.

    Parameters
    ----------
    truth : array_like, shape (n_steps, n_axes) or (n_steps, n_runs, n_axes)
        True positions (m), the same in all runs or each run's own; NaN where there is no plot.
    sigma : array_like
        Standard deviation (m), broadcast against (n_steps, n_runs, n_axes): a number, one for each
        axis.
    runs : sequence of SeedSequence
        Random stream of each run; see `streams`.
    noise : Noise
        Kind of noise.

    Returns
    -------
    Plots

    Raises
    ------
    ValueError
        If shapes do not fit, there is no run, or `sigma` is not positive.
    """
    positions = truth_of_runs(truth, len(runs))
    n_steps, _, n_axes = positions.shape
    deviation = positive("sigma", sigma)
    shape = (n_steps, len(runs), n_axes)
    draws = [noise.draw(np.random.default_rng(run), (n_steps, n_axes)) for run in runs]
    z = positions + deviation * np.stack(draws, axis=1)
    return Plots(z, np.where(np.isnan(z), np.nan, np.broadcast_to(deviation, shape)))


def truth_of_runs(truth: ArrayLike, runs: int) -> Array:
    """True positions with an axis for runs, of length 1 if they are the same in all runs.

    Parameters
    ----------
    truth : array_like, shape (n_steps, n_axes) or (n_steps, n_runs, n_axes)
        True positions (m), the same in all runs or each run's own.
    runs : int
        Number of runs.

    Returns
    -------
    ndarray, shape (n_steps, 1, n_axes) or (n_steps, n_runs, n_axes)

    Raises
    ------
    ValueError
        If there is no run, or shapes do not fit.
    """
    if not runs:
        raise ValueError("runs: at least one is needed")
    positions = np.asarray(truth, dtype=np.float64)
    if positions.ndim == 2:
        positions = positions[:, None]
    if positions.ndim != 3 or positions.shape[1] not in (1, runs):
        raise ValueError(
            f"truth: needs shape (n_steps, n_axes) or (n_steps, {runs}, n_axes); "
            f"got shape {np.shape(truth)}"
        )
    return positions
