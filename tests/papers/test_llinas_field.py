"""Trackers of Llinas et al. (1998) on canonical maneuvers, beside the means of the prototypes."""

import math

import numpy as np
import pytest

from fuzzytrack.simulation.noise import noisy_plots, streams
from fuzzytrack.simulation.published import MANEUVERS, llinas_maneuver
from fuzzytrack.simulation.sensor_field import canonical_field
from fuzzytrack.simulation.starting import prepare_start
from fuzzytrack.trackers.catalog import make_tracker

RUNS = 300
TRACKERS = {
    "T1": "fixed:alpha=0.5377:beta=0.2018:missed=step", "T4": "stiffness-damping-cog:missed=step"
}  # fmt: skip
# Mean distance of prediction and truth (m), scans 3 to 20, coasted ones too.
FIELD = {"T1": (141.8, 200.7, 250.8, 442.5), "T4": (143.7, 203.8, 254.3, 438.3)}
# The same with noise of 115 m on each axis, nothing missed.
OPEN = {"T1": (156.8, 170.5, 205.0, 304.2), "T4": (161.2, 170.9, 206.1, 304.4)}


def mean_error(tracker, t, truth, plots):
    predicted = tracker.run(t, plots.z, plots.sigma).predicted
    distance = np.hypot(*np.moveaxis(predicted - truth[:, None], -1, 0))[2:]
    return distance.mean(), distance.mean(axis=0).std(ddof=1) / math.sqrt(distance.shape[1])


@pytest.mark.untraced
@pytest.mark.parametrize("name", TRACKERS)
def test_mean_errors(name):
    tracker, field = make_tracker(TRACKERS[name]), canonical_field()
    for maneuver, seen, free in zip(MANEUVERS, FIELD[name], OPEN[name], strict=True):
        t, truth = llinas_maneuver(maneuver)
        plots = field.measure(truth, streams(1, RUNS), linear=True)
        times, plots = prepare_start(t, plots.z, plots.sigma)
        mean, error = mean_error(tracker, times, truth, plots)
        assert abs(mean - seen) < 3 * error + 0.02 * seen, (maneuver, mean, error)
        mean, error = mean_error(tracker, t, truth, noisy_plots(truth, 115.0, streams(2, RUNS)))
        assert abs(mean - free) < 3 * error + 0.01 * free, (maneuver, mean, error)
