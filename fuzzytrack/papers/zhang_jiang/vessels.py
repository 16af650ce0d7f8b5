"""Vessels that go straight and turn around a radar, and their plots with clutter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scan.scan import Scan

__all__ = ["BEARING_NOISE", "PERIOD", "RANGE_NOISE", "Recording", "Traffic"]

#: Time between scans (s), and standard deviations of a plot (m, rad).
PERIOD, RANGE_NOISE, BEARING_NOISE = 3.0, 15.0, np.radians(0.1)
#: Steps between two scans in which turns are followed.
_STEPS = 6


@dataclass(frozen=True, eq=False)
class Recording:
    """Plots, and what they are of.

    Attributes
    ----------
    scans : list of Scan
    vessel : list of ndarray of int
        Vessel of each plot of a scan; -1 of clutter.
    truth : ndarray, shape (n_scans, n_vessels, 2)
        Positions (m); the radar is at the origin.
    """

    scans: list[Scan]
    vessel: list[NDArray[np.int64]]
    truth: Array


@dataclass(frozen=True)
class Traffic:
    """How many vessels, scans, and plots of clutter a scan.

    Vessels start at ranges from 1.5 to 20 km with 4 to 12 m/s. They go straight for 120 s on
    average, then turn by 30 to 90 degrees at 0.3 to 1 times the rate of turn. They are detected
    with probability 0.95; clutter is uniform in the disk of 20 km.
    """

    vessels: int = 200
    scans: int = 300
    clutter: int = 50

    def record(self, turn: float, seed: int) -> Recording:
        """Recording of vessels that turn at `turn` degrees per second at most."""
        rng = np.random.default_rng(seed)
        truth = self._truth(np.radians(turn), rng)
        scans, vessels = [], []
        for k, now in enumerate(truth):
            seen = np.flatnonzero(rng.random(self.vessels) < 0.95)
            r = np.hypot(*now[seen].T) + rng.normal(0.0, RANGE_NOISE, len(seen))
            bearing = np.arctan2(now[seen, 1], now[seen, 0])
            bearing += rng.normal(0.0, BEARING_NOISE, len(seen))
            r = np.append(r, 20e3 * np.sqrt(rng.random(self.clutter)))
            bearing = np.append(bearing, rng.uniform(-np.pi, np.pi, self.clutter))
            plots = np.stack([r * np.cos(bearing), r * np.sin(bearing)], axis=1)
            scans.append(Scan(PERIOD * k, plots))
            vessels.append(np.append(seen, np.full(self.clutter, -1)))
        return Recording(scans, vessels, truth)

    def _truth(self, turn: float, rng: np.random.Generator) -> Array:
        n, dt = self.vessels, PERIOD / _STEPS
        r, bearing = rng.uniform(1.5e3, 20e3, n), rng.uniform(0.0, 2 * np.pi, n)
        place = np.stack([r * np.cos(bearing), r * np.sin(bearing)], axis=1)
        speed, heading = rng.uniform(4.0, 12.0, n), rng.uniform(0.0, 2 * np.pi, n)
        straight, rate, left = rng.exponential(120.0, n), np.zeros(n), np.zeros(n)
        truth = np.empty((self.scans, n, 2))
        for k in range(self.scans):
            truth[k] = place
            for _ in range(_STEPS):
                if turn > 0.0:
                    straight -= np.where(rate == 0.0, dt, 0.0)
                    starts = (rate == 0.0) & (straight <= 0.0)
                    m = int(starts.sum())
                    rate[starts] = turn * rng.uniform(0.3, 1.0, m) * rng.choice([-1.0, 1.0], m)
                    left[starts] = np.radians(rng.uniform(30.0, 90.0, m))
                    heading += rate * dt
                    left -= abs(rate) * dt
                    ends = (rate != 0.0) & (left <= 0.0)
                    straight[ends], rate[ends] = rng.exponential(120.0, int(ends.sum())), 0.0
                course = np.stack([np.cos(heading), np.sin(heading)], axis=1)
                place = place + (speed * dt)[:, None] * course
        return truth
