"""Scenario of a Monte Carlo experiment: a target, its sensors, and the scans that are scored."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.noise import WHITE, Noise, Plots, noisy_plots, truth_of_runs
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

    Raises
    ------
    ValueError
        If a number is out of its range.
    """

    sigma: float | tuple[float, ...]
    noise: Noise = WHITE
    detection: float = 1.0
    clean: int = 0

    def __post_init__(self) -> None:
        deviation = positive("sigma", self.sigma).tolist()
        own = tuple(deviation) if isinstance(deviation, list) else float(deviation)
        object.__setattr__(self, "sigma", own)
        if not 0 < self.detection <= 1:
            raise ValueError(f"detection must be > 0 and <= 1, got {self.detection}")
        if self.clean < 0:
            raise ValueError(f"clean must not be negative, got {self.clean}")

    def measure(self, truth: Array, runs: Sequence[np.random.SeedSequence]) -> Plots:
        """Plots of a target; see `Sensors.measure`."""
        plots = noisy_plots(truth, self.sigma, runs, self.noise)
        z, sigma = plots.z, plots.sigma
        true = truth_of_runs(truth, len(runs))
        z[: self.clean] = np.broadcast_to(true, z.shape)[: self.clean]
        if self.detection < 1:
            # From a stream of its own, so that the noise does not depend on `detection`.
            draws = [np.random.default_rng(run.spawn(1)[0]).random(len(z)) for run in _copies(runs)]
            missed = np.stack(draws, axis=1) >= self.detection
            missed[: self.clean] = False
            z[missed] = sigma[missed] = np.nan
        return Plots(z, sigma)


def _copies(runs: Sequence[np.random.SeedSequence]) -> list[np.random.SeedSequence]:
    """Copies of random streams, so that spawning from them does not change the given ones."""
    return [np.random.SeedSequence(entropy=run.entropy, spawn_key=run.spawn_key) for run in runs]


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
    time : array_like, shape (n_steps,)
        Times of the scans (s), increasing.
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
        if time.ndim != 1 or len(time) < 2 or not (np.diff(time) > 0).all():
            raise ValueError(
                "time must be two increasing times at least, "
                f"got {np.array2string(time, threshold=6)}"
            )
        if position.ndim not in (2, 3) or len(position) != len(time) or 0 in position.shape:
            raise ValueError(
                f"position must have shape ({len(time)}, n_axes) or ({len(time)}, n_tracks, "
                f"n_axes), got {position.shape}"
            )
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

    def truth(self, first: int, count: int) -> tuple[Array, Array | None]:
        """True position and velocity of runs, shape (n_steps, n_axes) if it is the same in all.

        Parameters
        ----------
        first, count : int
            The first run, and how many.
        """
        if self.position.ndim == 2:
            return self.position, self.velocity
        tracks = np.arange(first, first + count) % self.position.shape[1]
        velocity = None if self.velocity is None else self.velocity[:, tracks]
        return self.position[:, tracks], velocity
