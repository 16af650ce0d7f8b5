"""The lag of the clock of plots against that of the truth."""

import math

import numpy as np
import pytest

from fuzzytrack.io.columns import Columns
from fuzzytrack.io.recording import Recording, Track
from fuzzytrack.recordings.clock_lag import fitted_lag

COLUMNS = Columns("t", "id", ("x", "y"))
TIMES = np.arange(0.0, 200.0, 2.0)


def turning(t):
    return np.stack([300 * np.sin(t / 40), 200 * np.cos(t / 25) + t], axis=1)


def steady(t):
    return np.stack([10 * t, 5 * t], axis=1)


def recorded(path, lag=0.0, noise=3.0, offset=0.0, seed=1, names=("a",)):
    """Plots of a path with a clock that is late, and the truth each second."""
    rng = np.random.default_rng(seed)
    tracks, truth, fine = [], [], np.arange(-60.0, 260.0)
    for k, name in enumerate(names):

        def where(t, k=k):
            return path(t + 37.0 * k)

        z = where(TIMES - lag) + offset + noise * rng.standard_normal((len(TIMES), 2))
        tracks.append(Track(name, TIMES, z))
        truth.append(Track(name, fine, where(fine)))
    return tracks, Recording("truth.csv", COLUMNS, tuple(truth))


@pytest.mark.parametrize("lag", [0.0, 1.37, -5.2])
@pytest.mark.parametrize("offset", [0.0, 25.0])
def test_a_lag_is_found(lag, offset):
    found = fitted_lag(*recorded(turning, lag, offset=offset))
    assert found.unknown == ""
    assert found.lag == pytest.approx(lag, abs=4 * found.error)
    assert 0.01 < found.error < 0.1


def test_the_error_is_the_spread_of_lags():
    found = [fitted_lag(*recorded(turning, 0.5, seed=seed)) for seed in range(60)]
    spread = np.std([one.lag for one in found], ddof=1)
    assert spread == pytest.approx(found[0].error, rel=0.3)
    assert np.mean([one.lag for one in found]) == pytest.approx(0.5, abs=4 * spread / math.sqrt(60))


def test_several_tracks_have_one_lag():
    found = fitted_lag(*recorded(turning, 2.0, names=("a", "b", "c")))
    assert found.lag == pytest.approx(2.0, abs=4 * found.error)


def test_straight_paths_in_other_directions_tell_a_lag():
    tracks, truth = [], []
    for name, course in (("a", 0.2), ("b", 2.5)):
        way = np.array([np.cos(course), np.sin(course)])
        plots, true = recorded(lambda t, way=way: 12 * t[:, None] * way, 1.5, names=(name,))
        tracks += plots
        truth += true.tracks
    found = fitted_lag(tracks, Recording("truth.csv", COLUMNS, tuple(truth)))
    assert found.lag == pytest.approx(1.5, abs=4 * found.error)
    assert found.taken_off == found.lag


def gentle(t):
    return np.stack([10 * t, 0.002 * t**2], axis=1)


def circling(t):
    return np.stack([50 * np.sin(t), 50 * np.cos(t)], axis=1)


@pytest.mark.parametrize(
    ("path", "lag", "why"),
    [
        (steady, 1.0, "move too steadily"),
        (gentle, 1.0, "move too steadily"),
        (lambda t: np.zeros((len(t), 2)), 0.0, "move too steadily"),
        (circling, 0.0, "several lags fit alike"),
        (turning, 70.0, "no lag within ±49.5 s fits best"),
    ],
)
def test_a_lag_that_cannot_be_told_is_none(path, lag, why):
    found = fitted_lag(*recorded(path, lag))
    assert why in found.unknown
    assert (found.lag, found.taken_off) == (0.0, 0.0)
    assert math.isnan(found.error)


def test_a_lag_that_may_be_chance_is_not_taken_off():
    found = fitted_lag(*recorded(turning, 0.0))
    assert abs(found.lag) < 3 * found.error
    assert found.taken_off == 0


def test_too_little_is_said():
    tracks, true = recorded(turning)
    one = Track("a", TIMES[:1], tracks[0].plots[:1])
    assert fitted_lag([one], true).unknown == "there are too few plots"
    late = Track("a", TIMES + 1e5, tracks[0].plots)
    assert fitted_lag([late], true).unknown == "the truth is known for too few plots"
