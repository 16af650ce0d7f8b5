"""Scenario of a Monte Carlo experiment: a target, its sensors, and the scans that are scored."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive
from fuzzytrack.reprs import constructor_code, summary
from fuzzytrack.simulation.noise import (
    DETECTION,
    OUTLIERS,
    SPREAD,
    WHITE,
    Noise,
    Plots,
    noisy_plots,
    substream,
    truth_of_runs,
)
from fuzzytrack.simulation.sensor_field import SensorField

__all__ = ["FieldSensors", "PlotNoise", "Scenario", "Sensors"]


class Sensors(Protocol):
    """Makes plots of a target."""

    def measure(self, truth: Array, runs: Sequence[np.random.SeedSequence]) -> Plots:
        """Plots of a target.

        Parameters
        ----------
        truth : ndarray, shape (n_steps, n_axes) or (n_steps, n_runs, n_axes)
            True positions (m), the same in all runs or each run's own.
        runs : sequence of SeedSequence
            Random stream of each run.
        """
        ...


@dataclass(frozen=True)
class PlotNoise:
    """Sensors whose noise does not depend on the position of the target.

    Parameters
    ----------
    sigma : float or sequence of float
        Standard deviation (m), a number or one for each axis, > 0.
    noise : Noise
        Kind of noise.
    detection : float
        Probability of a plot in a scan, 0 < detection <= 1.
    clean : int
        Number of plots, from the first, that are certainly detected and have no noise.
    factors : sequence of float
        Factors of `sigma`, > 0, scan by scan, from the first again after the last.
    spread : float
        At least 1. The standard deviation of each plot is multiplied with a number between
        1/spread and spread, drawn uniformly in its logarithm.
    outliers : (float, float)
        Share of the plots that are outliers, from 0 to 1, and how many times as large their
        standard deviation is as the tracker is told, > 0.
    told : float
        The tracker is told this many times the standard deviation, > 0.

    Raises
    ------
    ValueError
        If a number is out of its range.
    """

    sigma: float | tuple[float, ...]
    noise: Noise = WHITE
    detection: float = 1.0
    clean: int = 0
    factors: tuple[float, ...] = ()
    spread: float = 1.0
    outliers: tuple[float, float] = (0.0, 1.0)
    told: float = 1.0

    def __repr__(self) -> str:
        return constructor_code(self)

    def __post_init__(self) -> None:
        deviation = positive("sigma", self.sigma).tolist()
        own = tuple(deviation) if isinstance(deviation, list) else float(deviation)
        object.__setattr__(self, "sigma", own)
        if not 0 < self.detection <= 1:
            raise ValueError(f"detection must be > 0 and <= 1, got {self.detection}")
        if self.clean < 0:
            raise ValueError(f"clean must not be negative, got {self.clean}")
        object.__setattr__(self, "factors", tuple(positive("factors", self.factors).tolist()))
        if not 1 <= self.spread < math.inf:
            raise ValueError(f"spread must be finite and >= 1, got {self.spread}")
        share, factor = self.outliers
        if not (0 <= share <= 1 and 0 < factor < math.inf):
            raise ValueError(
                f"outliers must be a share from 0 to 1 and a factor > 0, got {share} and {factor}"
            )
        positive("told", self.told)

    def measure(self, truth: Array, runs: Sequence[np.random.SeedSequence]) -> Plots:
        """Plots of a target; see `Sensors.measure`."""
        true = truth_of_runs(truth, len(runs))
        scans = len(true)
        deviation = self._deviation(scans, runs)
        plots = noisy_plots(true, deviation * self._excess(scans, runs), runs, self.noise)
        z = plots.z
        z[: self.clean] = np.broadcast_to(true, z.shape)[: self.clean]
        if self.detection < 1:
            missed = _uniform(runs, DETECTION, scans) >= self.detection
            missed[: self.clean] = False
            z[missed] = np.nan
        return Plots(z, np.where(np.isnan(z), np.nan, self.told * deviation))

    def _deviation(self, scans: int, runs: Sequence[np.random.SeedSequence]) -> Array:
        """Standard deviation of each plot but for outliers, shape (scans, runs, n_axes or 1)."""
        found = np.ones((scans, len(runs), 1))
        if self.factors:
            found *= np.resize(self.factors, scans)[:, None, None]
        if self.spread > 1:
            found *= self.spread ** (2 * _uniform(runs, SPREAD, scans) - 1)[..., None]
        return np.asarray(found * np.asarray(self.sigma))

    def _excess(self, scans: int, runs: Sequence[np.random.SeedSequence]) -> Array | float:
        """Factor of the standard deviation of each plot, which no tracker is told."""
        share, factor = self.outliers
        if not share:
            return 1.0
        return np.where(_uniform(runs, OUTLIERS, scans) < share, factor, 1.0)[..., None]


def _uniform(runs: Sequence[np.random.SeedSequence], number: int, scans: int) -> Array:
    """Numbers from 0 to 1, shape (scans, runs), each run's from a stream below its own."""
    return np.stack([substream(run, number).random(scans) for run in runs], axis=1)


@dataclass(frozen=True)
class FieldSensors:
    """A field of sensors with the kind of its noise; see `SensorField.measure`."""

    field: SensorField
    noise: Noise = WHITE
    linear: bool = False
    sigma_from: str = "truth"

    def measure(self, truth: Array, runs: Sequence[np.random.SeedSequence]) -> Plots:
        """Plots of a target; see `Sensors.measure`."""
        return self.field.measure(
            truth, runs, noise=self.noise, linear=self.linear, sigma_from=self.sigma_from
        )


@dataclass(frozen=True, eq=False)
class Scenario:
    """A target, its sensors, and the scans whose errors are scored.

    Parameters
    ----------
    name : str
        Name of the scenario.
    time : array_like, shape (n_steps,) or (n_steps, n_tracks)
        Times of the scans (s), increasing; common, or each track's own.
    position : array_like, shape (n_steps, n_axes) or (n_steps, n_tracks, n_axes)
        True positions (m). Of several tracks, run k flies number k modulo n_tracks.
    sensors : Sensors
        Sensors that make the plots.
    velocity : array_like, optional
        True velocities (m/s), shaped as `position`; without them errors of velocity are not known.
    first_scored : int
        First scan, from 0, whose errors count; the default is the third, which is the first that
        a two-point start predicts.
    prepare_start : bool
        Whether plots are trimmed to the first seen and the second one interpolated where it was
        missed, as Llinas et al. (1998), section 4.1.1, do; see
        `fuzzytrack.simulation.starting.prepare_start`.
    process_sigma : float, optional
        Standard deviation of acceleration (m/s²), >= 0, that the consistency checks NIS and NEES
        presume; without it they are not made.
    trackers : tuple of str
        Trackers to run unless others are asked for, as `fuzzytrack.trackers.catalog.make_tracker`
        reads them.
    source : str
        Paper, or other origin.

    Raises
    ------
    ValueError
        If shapes do not fit, or a number is out of its range.
    """

    name: str
    time: Array
    position: Array
    sensors: Sensors
    velocity: Array | None = None
    first_scored: int = 2
    prepare_start: bool = False
    process_sigma: float | None = None
    trackers: tuple[str, ...] = field(default=())
    source: str = ""

    def __repr__(self) -> str:
        return summary(self, "name", "position", "trackers")

    def __post_init__(self) -> None:
        time, position = finite("time", self.time), finite("position", self.position)
        if time.ndim not in (1, 2) or len(time) < 2 or not (np.diff(time, axis=0) > 0).all():
            raise ValueError(
                "time must be two increasing times at least, "
                f"got {np.array2string(time, threshold=6)}"
            )
        if position.ndim not in (2, 3) or len(position) != len(time) or 0 in position.shape:
            raise ValueError(
                f"position must have shape ({len(time)}, n_axes) or ({len(time)}, n_tracks, "
                f"n_axes), got {position.shape}"
            )
        if time.shape not in (position.shape[:1], position.shape[:-1]):
            raise ValueError(
                "time must be common to all tracks or each track's own, as many as positions, "
                f"shape {position.shape[:-1]}; got {time.shape}"
            )
        if time.ndim == 2 and self.prepare_start:
            raise ValueError("prepare_start must be False where tracks have times of their own")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "position", position)
        if self.velocity is not None:
            velocity = finite("velocity", self.velocity)
            if velocity.shape != position.shape:
                raise ValueError(
                    f"velocity must be shaped as position, {position.shape}, got {velocity.shape}"
                )
            object.__setattr__(self, "velocity", velocity)
        if not 0 <= self.first_scored < len(time):
            raise ValueError(
                f"first_scored must be a scan from 0 to {len(time) - 1}, got {self.first_scored}"
            )
        if self.process_sigma is not None:
            nonnegative("process_sigma", self.process_sigma)

    @property
    def n_axes(self) -> int:
        """Number of axes of space."""
        return int(self.position.shape[-1])

    @property
    def scan_time(self) -> Array:
        """Times of the scans (s), shape (n_steps,): the mean over tracks that have their own."""
        return self.time if self.time.ndim == 1 else np.asarray(self.time.mean(axis=1))

    def times(self, first: int, count: int) -> Array:
        """Times of runs (s), shape (n_steps,) if they are the same in all, else (n_steps, count).

        Parameters
        ----------
        first, count : int
            The first run, and how many.
        """
        return self.time if self.time.ndim == 1 else self.time[:, self._tracks(first, count)]

    def truth(self, first: int, count: int) -> tuple[Array, Array | None]:
        """True position and velocity of runs, shape (n_steps, n_axes) if it is the same in all.

        Parameters
        ----------
        first, count : int
            The first run, and how many.
        """
        if self.position.ndim == 2:
            return self.position, self.velocity
        tracks = self._tracks(first, count)
        velocity = None if self.velocity is None else self.velocity[:, tracks]
        return self.position[:, tracks], velocity

    def _tracks(self, first: int, count: int) -> NDArray[np.intp]:
        """The track that each run flies, where there are several."""
        return np.asarray(np.arange(first, first + count) % self.position.shape[1])
