"""What it costs to track the axes of polar plots apart, without the covariance between them.

    python -m benchmarks.polar [--tracks 1000] [--json polar.json]

Targets of nearly constant velocity, 60 km from a radar. Filters have the numbers of the targets'
motion and of the plots' noise, and differ in the covariance that they use: that of each plot; its
diagonal, as fuzzytrack; or its diagonal along and across the line of sight. The tracker
`maneuver` is run on the same plots, along both pairs of axes.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.polar import polar_to_cartesian
from fuzzytrack.trackers.catalog import as_tracker

RANGE, SCAN, SCANS, SPEED, ACCELERATION = 60e3, 4.0, 60, 200.0, 2.0
#: Scans at which the errors are counted: the start is left out.
COUNTED = slice(20, None)
SIGMA_RANGE = 50.0
#: Noise in azimuth (deg): across the line of sight 1, 2, 6 and 20 times that along it.
NOISES = (0.05, 0.1, 0.3, 1.0)
AZIMUTHS = (0.0, 22.5, 45.0)


def targets(tracks: int, azimuth: float, rng: np.random.Generator) -> Array:
    """True positions of targets about one azimuth (deg), shape (SCANS, tracks, 2)."""
    angle = np.radians(azimuth)
    place = RANGE * np.array([np.sin(angle), np.cos(angle)])
    heading = rng.uniform(0, 2 * np.pi, tracks)
    velocity = SPEED * np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    # The middle of each track is at the azimuth.
    position = place - velocity * SCAN * SCANS / 2
    found = np.empty((SCANS, tracks, 2))
    for scan in range(SCANS):
        found[scan] = position
        push = rng.normal(0, ACCELERATION, (tracks, 2))
        position = position + velocity * SCAN + push * SCAN**2 / 2
        velocity = velocity + push * SCAN
    return found


def full_covariance(z: Array, covariance: Array) -> Array:
    """Predictions of a Kalman filter over both axes, with the covariance of each plot."""
    unit = np.eye(2)
    move = np.block([[unit, SCAN * unit], [np.zeros((2, 2)), unit]])
    push = np.vstack([unit * SCAN**2 / 2, unit * SCAN])
    noise = push @ push.T * ACCELERATION**2
    tracks = z.shape[1]
    state = np.concatenate([z[0], np.zeros((tracks, 2))], axis=-1)
    spread = np.zeros((tracks, 4, 4))
    spread[:, :2, :2] = covariance[0]
    # Next to nothing is known of the velocity.
    spread[:, 2:, 2:] = 1e8 * unit
    predicted = np.full(z.shape, np.nan)
    for scan in range(1, len(z)):
        state = state @ move.T
        spread = move @ spread @ move.T + noise
        predicted[scan] = state[:, :2]
        innovation = spread[:, :2, :2] + covariance[scan]
        gain = spread[:, :, :2] @ np.linalg.inv(innovation)
        state = state + (gain @ (z[scan] - state[:, :2])[..., None])[..., 0]
        left = np.eye(4) - np.concatenate([gain, np.zeros((tracks, 4, 2))], axis=-1)
        spread = left @ spread @ np.swapaxes(left, -1, -2)
        spread = spread + gain @ covariance[scan] @ np.swapaxes(gain, -1, -2)
    return predicted


def apart(tracker: str, z: Array, covariance: Array, turn: Array) -> Array:
    """Predictions of a tracker of each axis, along axes that are turned."""
    sigma = np.sqrt(np.diagonal(turn @ covariance @ turn.T, axis1=-2, axis2=-1))
    times = SCAN * np.arange(SCANS)
    return np.asarray(as_tracker(tracker).run(times, z @ turn.T, sigma=sigma).predicted @ turn)


def rmse(predicted: Array, truth: Array) -> float:
    """Root mean square of the errors of predictions, over both axes."""
    return float(np.sqrt(np.mean(np.sum((predicted - truth)[COUNTED] ** 2, axis=-1))))


def measure(tracks: int, azimuth: float, noise: float, seed: int = 1) -> dict[str, float]:
    """Errors (m) of predictions at one azimuth and noise in azimuth (deg)."""
    rng = np.random.default_rng(seed)
    truth = targets(tracks, azimuth, rng)
    sigma = np.radians(noise)
    distance = np.hypot(truth[..., 0], truth[..., 1]) + rng.normal(0, SIGMA_RANGE, truth.shape[:2])
    angle = np.arctan2(truth[..., 0], truth[..., 1]) + rng.normal(0, sigma, truth.shape[:2])
    plots = polar_to_cartesian(
        distance.ravel(), angle.ravel(), sigma_range=SIGMA_RANGE, sigma_azimuth=sigma
    )
    assert plots.covariance is not None
    z = plots.position.reshape(truth.shape)
    covariance = plots.covariance.reshape(*truth.shape, 2)
    sin, cos = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
    straight, sight = np.eye(2), np.array([[sin, cos], [cos, -sin]])
    kalman, rules = f"kalman-cv:sigma_v={ACCELERATION}", "maneuver"
    return {
        "plots": rmse(z, truth),
        "full covariance": rmse(full_covariance(z, covariance), truth),
        "kalman-cv, x and y": rmse(apart(kalman, z, covariance, straight), truth),
        "kalman-cv, along sight": rmse(apart(kalman, z, covariance, sight), truth),
        "maneuver, x and y": rmse(apart(rules, z, covariance, straight), truth),
        "maneuver, along sight": rmse(apart(rules, z, covariance, sight), truth),
    }


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.polar",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tracks", type=int, default=1000, help="of each kind (1000)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures")
    given = parser.parse_args(arguments)
    rows: list[dict[str, Any]] = []
    for noise in NOISES:
        for azimuth in AZIMUTHS:
            found = measure(given.tracks, azimuth, noise)
            rows.append({"azimuth": azimuth, "sigma_azimuth": noise, **found})
            if len(rows) == 1:
                print("| " + " | ".join(rows[0]) + " |")
            print("| " + " | ".join(f"{value:.4g}" for value in rows[-1].values()) + " |")
    if given.json:
        given.json.write_text(json.dumps(rows, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
