"""A tracker's covariance, whatever chooses its gains."""

import pickle

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.schedulers import KalmanCV, QualityGains
from fuzzytrack.trackers.covariance import track_covariance

SIGMA_V = 0.7

SPECS = {
    "fixed": "fixed:alpha=0.5:beta=0.3",
    "with acceleration": "fixed:alpha=0.6:beta=0.3:gamma=0.1",
    "rule base": "stiffness-damping",
    "rule base of all axes": "chan-style",
    "with an opening": "omega-schedule",
    "kalman-cv": "kalman-cv:sigma_v=0.3",
    "track-quality": "track-quality",
}


def recording(seed=1, n=30, tracks=3):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.3, 3.0, n))
    sigma = random.uniform(1.0, 30.0, (n, tracks, 2))
    plots = 0.2 * times[:, None, None] ** 2 + sigma * random.normal(size=(n, tracks, 2))
    plots[random.random((n, tracks)) < 0.25] = np.nan
    return times, plots, sigma


def states(tracker, times, plots, sigma):
    """States after each step."""
    state = tracker.start(plots[0], times[0], sigma[0])
    found = [state]
    for z, t, s in zip(plots[1:], times[1:], sigma[1:], strict=True):
        state = tracker.step(state, z, t, s)
        found.append(state)
    return found


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("name", SPECS)
def test_it_is_the_covariance_of_the_gains_that_were_used(name, missed):
    times, plots, sigma = recording()
    tracker = ft.AlphaBetaTracker(SPECS[name], missed=missed, covariance=SIGMA_V)
    result = tracker.run(times, plots, sigma)
    gamma = bool((np.nan_to_num(result.gains.gamma) != 0).any())
    known = track_covariance(
        result, sigma, SIGMA_V, missed=missed, acceleration_sigma=SIGMA_V if gamma else None
    )
    compared = 0
    for k, state in enumerate(states(tracker, times, plots, sigma)[:-1]):
        found = tracker.predict(state, times[k + 1], sigma[k + 1])
        wanted = known.predicted[k + 1, ..., 0, 0]
        np.testing.assert_allclose(found.position_variance, wanted, rtol=1e-9)
        np.testing.assert_allclose(
            found.innovation_variance, found.position_variance + sigma[k + 1] ** 2, rtol=1e-12
        )
        compared += np.count_nonzero(np.isfinite(wanted))
    assert compared > 0.8 * plots.size


@pytest.mark.parametrize("name", SPECS)
def test_gains_and_tracks_are_the_same_to_the_bit(name):
    times, plots, sigma = recording()
    without = ft.AlphaBetaTracker(SPECS[name]).run(times, plots, sigma)
    tracker = ft.AlphaBetaTracker(SPECS[name], covariance=SIGMA_V)
    carried = tracker.run(times, plots, sigma)
    for key in ("predicted", "filtered", "velocity", "acceleration", "innovation"):
        np.testing.assert_array_equal(getattr(carried, key), getattr(without, key))
    np.testing.assert_array_equal(carried.gains.beta, without.gains.beta)
    last = states(pickle.loads(pickle.dumps(tracker)), times, plots, sigma)[-1]
    np.testing.assert_array_equal(last.lanes, carried.state.lanes)


@pytest.mark.untraced
@pytest.mark.parametrize("name", ["with acceleration", "rule base of all axes"])
def test_compiled_code_gives_the_same(name):
    times, plots, sigma = recording()
    tracker = ft.AlphaBetaTracker(SPECS[name], covariance=SIGMA_V)
    plain = tracker.run(times, plots, sigma)
    many = tracker.run(times, np.repeat(plots, 1500, axis=1), np.repeat(sigma, 1500, axis=1))
    np.testing.assert_array_equal(many.predicted[:, ::1500], plain.predicted)
    lanes = many.state.lanes.reshape(len(plain.state.lanes), 3, 1500, -1)[:, :, 0]
    np.testing.assert_array_equal(lanes.reshape(plain.state.lanes.shape), plain.state.lanes)


def test_a_kalman_filter_tells_the_same_variance_with_its_own_noise():
    times, plots, _ = recording()
    own = ft.AlphaBetaTracker(KalmanCV(SIGMA_V, sigma_w=5.0))
    carried = ft.AlphaBetaTracker(KalmanCV(SIGMA_V, sigma_w=5.0), covariance=SIGMA_V)
    assert not carried.needs_sigma
    later = times[-1] + 2.0
    one, other = (each.predict(each.run(times, plots).state, later) for each in (own, carried))
    np.testing.assert_allclose(one.innovation_variance, other.innovation_variance, rtol=1e-9)


def test_normalized_innovations_of_a_quiet_target_have_their_variance():
    random = np.random.default_rng(2)
    times, tracks = np.arange(40.0), 400
    truth = np.outer(times, random.normal(size=tracks))[..., None]
    plots = truth + random.normal(0.0, 3.0, truth.shape)
    plots[random.random(truth.shape) < 0.2] = np.nan
    tracker = ft.AlphaBetaTracker("fixed:alpha=0.4:beta=0.1", covariance=0.0)
    squares = []
    found = states(tracker, times, plots, np.full(len(times), 3.0))
    for k in range(20, len(times) - 1):
        s = tracker.predict(found[k], times[k + 1], 3.0).innovation_variance
        squares.append((found[k + 1].innovation ** 2 / s).ravel())
    assert np.nanmean(np.concatenate(squares)) == pytest.approx(1.0, abs=0.05)


def test_what_is_refused():
    with pytest.raises(ValueError, match="covariance must be"):
        ft.AlphaBetaTracker("stiffness-damping", covariance=-1.0)
    with pytest.raises(ValueError, match="covariance: needs start 'two-point', got 'one-point'"):
        ft.AlphaBetaTracker("stiffness-damping", start="one-point", covariance=1.0)
    with pytest.raises(ValueError, match="needs the standard deviation"):
        ft.AlphaBetaTracker("stiffness-damping", covariance=1.0).run([0, 1], [0.0, 1.0])


def test_it_is_given_like_any_parameter():
    tracker = ft.trackers.catalog.make_tracker("track-quality:covariance=0.5")
    assert repr(tracker) == "AlphaBetaTracker(QualityGains(), covariance=0.5)"
    assert tracker == ft.AlphaBetaTracker(QualityGains(), covariance=0.5)
