import math

import numpy as np
import pytest

from benchmarks.families import FAMILIES
from benchmarks.objective import prediction_mse
from fuzzytrack.simulation.published import track_set


def test_the_error_is_that_of_a_loop_over_scans():
    tracks = track_set("mixed", 2, 3)
    tracker = FAMILIES["fixed α-β, published"].make(())
    found = prediction_mse(tracker, tracks, 9)
    plots = tracks.position + np.random.default_rng([9, 1]).standard_normal(tracks.position.shape)
    for track in range(2):
        predicted = tracker.run(tracks.time, plots[:, track]).predicted
        squares = [
            math.dist(predicted[k], tracks.position[k, track]) ** 2
            for k in range(tracks.first_scored, len(tracks.time))
        ]
        assert found[track] == pytest.approx(np.mean(squares), rel=1e-12)
