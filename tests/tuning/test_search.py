import math

import numpy as np
import pytest

from fuzzytrack.simulation.published import track_set
from fuzzytrack.tuning import FAMILIES, tune
from fuzzytrack.tuning.objective import prediction_mse


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


def test_tuning_finds_what_a_grid_finds():
    sets = [track_set("mixed", 4, 3), track_set("strong", 4, 3)]
    family, shares = FAMILIES["fading memory"], []
    (best,) = tune(family, sets, seed=2, evaluations=25, progress=shares.append)

    def loss(xi):
        tracker = family.make((xi,))
        return np.mean([np.log(prediction_mse(tracker, s, 2).mean()) / 2 for s in sets])

    grid = np.linspace(0.1, 0.9, 33)
    assert loss(best) <= min(map(loss, grid)) + 1e-4
    assert shares == sorted(shares)
    assert 0 < shares[-1] <= 1


def test_a_family_without_tracker_at_some_numbers_is_tuned_all_the_same():
    numbers = tune(
        FAMILIES["omega-schedule, tuned"], [track_set("report", 2, 3)], 2, evaluations=12
    )
    assert list(numbers[2:]) == sorted(numbers[2:])
