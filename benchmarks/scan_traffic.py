"""Open water with ships and clutter at a given density, for sizes that no recording has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.peers import Array
from fuzzytrack.scan.scan import Scan

__all__ = ["Traffic", "traffic"]


@dataclass(frozen=True)
class Traffic:
    """Scans, and where the ships were.

    Attributes
    ----------
    scans : list of Scan
        Plots with their covariance, ships and clutter in random order.
    truth : ndarray, shape (n_scans, ships, 2)
        Positions (m).
    """

    scans: list[Scan]
    truth: Array

    def paths(self) -> dict[int, Array]:
        """Time and position of each ship, shape (n_scans, 3)."""
        times = np.array([scan.time for scan in self.scans])[:, None]
        return {
            ship: np.hstack([times, self.truth[:, ship]]) for ship in range(self.truth.shape[1])
        }


def traffic(
    ships: int,
    area: float,
    *,
    scans: int = 25,
    clutter: float = 1.0,
    detection: float = 0.93,
    noise: float = 1.2,
    period: float = 1.678,
    seed: int = 0,
) -> Traffic:
    """Ships that keep their velocity on a square, at 1 to 6 m/s on any course.

    Parameters
    ----------
    ships : int
    area : float
        For each ship (m²).
    scans : int
    clutter : float
        Clutter plots for each ship and scan, anywhere on the square.
    detection : float
        Probability that a ship is seen in a scan.
    noise : float
        Standard deviation of a plot in each axis (m).
    period : float
        Of a scan (s).
    """
    rng = np.random.default_rng(seed)
    side = np.sqrt(area * ships)
    start, course = rng.uniform(0, side, (ships, 2)), rng.uniform(0, 2 * np.pi, ships)
    speed = rng.uniform(1, 6, ships)
    velocity = speed[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)
    times = period * np.arange(scans)
    truth = start + times[:, None, None] * velocity
    found = []
    for time, places in zip(times, truth, strict=True):
        seen = places[rng.random(ships) < detection]
        plots = np.concatenate(
            [
                seen + noise * rng.standard_normal(seen.shape),
                rng.uniform(0, side, (rng.poisson(clutter * ships), 2)),
            ]
        )
        rng.shuffle(plots)
        variances = np.tile([noise**2, 0.0, noise**2], (len(plots), 1))
        found.append(Scan(float(time), plots, covariances=variances))
    return Traffic(found, truth)
