import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains, FuzzyScheduler, loads_rulebase
from fuzzytrack.schedulers import InnovationScheduler, KalmanCA, KalmanCV
from fuzzytrack.trackers import ParallelBank, TrackStore, WindowSearch
from fuzzytrack.trackers.covariance import track_covariance

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))
CV = AlphaBetaTracker(KalmanCV(0.0))

PREDICTED = """
rulebase: 1
name: lopsided
inputs:
  E:
    universe: [-4, 4, 41]
    sets: {n: {trimf: [-4, -4, 1]}, p: {trimf: [-4, 1, 4]}, q: {trimf: [1, 4, 4]}}
outputs:
  alpha:
    universe: [0.2, 0.8, 61]
    sets: {low: {trimf: [0.2, 0.3, 0.4]}, high: {trimf: [0.5, 0.7, 0.8]}}
  beta:
    universe: [0.1, 0.5, 41]
    sets: {low: {trimf: [0.1, 0.15, 0.2]}, high: {trimf: [0.2, 0.4, 0.5]}}
operators: {and: product, or: sum, defuzzification: centroid}
rules:
  - {if: {E: n}, then: {alpha: low, beta: high}}
  - {if: {E: p}, then: {alpha: high, beta: low}}
  - {if: {E: q}, then: {alpha: high, beta: high}}
scheduler: {normalization: predicted, gains: direct%s}
"""


def test_a_line_through_two_plots_by_hand():
    """x = z₁, v = (z₁ - z₀)/T; with plots of σ = 3 and 4 at t = 0 and 2, predicted for t = 5."""
    state = CV.run([0.0, 2.0], [10.0, 14.0], [3.0, 4.0]).state
    found = CV.predict(state, 5.0, sigma=2.0)
    assert (found.time, found.position, found.velocity) == (5.0, 20.0, 2.0)
    # x + 3v = 2.5 z₁ - 1.5 z₀
    assert found.position_variance == pytest.approx(2.5**2 * 16 + 1.5**2 * 9)
    assert found.innovation_variance == pytest.approx(found.position_variance + 4.0)


def test_missed_plots_do_not_change_a_prediction():
    """One jump over the whole gap, whatever was asked before; noise comes once from plot to plot.

    P₁₁ after two plots of σ = 3 over 1 s is 9, and P₁₂ is 9; P₂₂ is 18 and a quarter of the noise.
    """
    tracker = AlphaBetaTracker(KalmanCV(2.0))
    state = tracker.run([0.0, 1.0], [10.0, 14.0], 3.0).state
    coasted = tracker.step(state, math.nan, 2.5, 1.0)
    assert (coasted.time, coasted.position, coasted.velocity) == (2.5, 20.0, 4.0)
    for known in (state, coasted):
        found = tracker.predict(known, 4.0)
        assert (found.position, found.velocity) == (26.0, 4.0)
        expected = 9 + 2 * 3 * 9 + 9 * (18 + 1.0) + 4.0 * 4.5**2
        assert found.position_variance == pytest.approx(expected)


def test_acceleration_carries_on():
    tracker = AlphaBetaTracker(FixedGains(0.5, 0.4, 0.2))
    state = tracker.run([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 4.0, 15.0]).state
    found = tracker.predict(state, 7.0)
    assert found.acceleration == state.acceleration != 0
    assert found.velocity == pytest.approx(state.velocity + 3 * state.acceleration)
    assert found.position == pytest.approx(
        state.position + 3 * state.velocity + 4.5 * state.acceleration
    )


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("gaps", [[1.0], [0.3, 2.0, 0.7]])
def test_the_variance_is_what_missed_plots_lead_to(gaps, missed):
    """Once the plots have gone, the covariance of a run is the one before the next of them."""
    random = np.random.default_rng(4)
    t = np.cumsum(random.uniform(0.5, 2.0, 12))
    z, sigma = random.normal(size=(12, 3, 2)), random.uniform(0.5, 3.0, (12, 3, 2))
    tracker = AlphaBetaTracker(KalmanCA(0.3, 2.0), missed=missed)
    state = tracker.run(t, z, sigma).state
    *before, later = t[-1] + np.cumsum(gaps)
    for time in before:
        state = tracker.step(state, np.full((3, 2), math.nan), time, 1.0)
    found = tracker.predict(state, later, sigma=[2.0, 5.0])

    none = np.full((len(gaps), 3, 2), math.nan)
    whole = tracker.run([*t, *before, later], np.concatenate([z, none]), [*sigma, *none])
    known = track_covariance(whole, [*sigma, *none], 0.3, acceleration_sigma=2.0, missed=missed)
    expected = known.predicted[-1, ..., 0, 0]
    np.testing.assert_allclose(found.position_variance, expected, rtol=1e-12)
    np.testing.assert_allclose(
        found.innovation_variance, expected + np.array([4.0, 25.0]), rtol=1e-12
    )


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("opening", ["", ", opening: growing-memory"])
def test_the_normalization_tells_what_noise_has_left(opening, missed):
    tracker = AlphaBetaTracker(FuzzyScheduler(loads_rulebase(PREDICTED % opening)), missed=missed)
    random = np.random.default_rng(5)
    t, z = np.cumsum(random.uniform(0.5, 2.0, 20)), random.normal(size=(20, 2))
    z[[7, 11], [0, 1]] = math.nan
    whole = tracker.run(t, z, 1.5)
    known = track_covariance(whole, 1.5, 0.0, missed=missed).innovation_variance
    state, seen = tracker.start(z[0], t[0], 1.5), 0
    for k in range(1, 20):
        found = tracker.predict(state, t[k], 1.5).innovation_variance
        there = ~np.isnan(known[k])
        np.testing.assert_allclose(found[there], known[k][there], rtol=1e-12)
        seen += there.sum()
        state = tracker.step(state, z[k], t[k], 1.5)
    assert seen == 2 * 18 - 2


@pytest.mark.parametrize(
    "tracker",
    [
        FIXED,
        AlphaBetaTracker(InnovationScheduler()),
        ParallelBank(),
        WindowSearch(),
    ],
    ids=lambda tracker: tracker.name,
)
def test_without_a_covariance_variances_are_nan(tracker):
    state = tracker.run(range(5), np.arange(10.0).reshape(5, 2), 1.0).state
    found = tracker.predict(state, 6.0, 1.0)
    assert np.isnan(found.position_variance).all()
    assert np.isnan(found.innovation_variance).all()
    assert np.isfinite(found.position).all()


def test_noise_of_the_plot_to_come():
    own = AlphaBetaTracker(KalmanCV(1.0, sigma_w=3.0))
    for tracker, expected in ((CV, math.nan), (own, 9.0)):
        state = tracker.run(range(4), [0.0, 1.0, 2.5, 3.0], 2.0).state
        found = tracker.predict(state, 4.0)
        noise = found.innovation_variance - found.position_variance
        np.testing.assert_allclose(noise, expected)
        found = tracker.predict(state, 4.0, sigma=5.0)
        assert found.innovation_variance - found.position_variance == pytest.approx(25.0)


def test_until_a_track_has_started():
    nothing = CV.run([0.0], [[math.nan, math.nan]], 1.0).state
    found = CV.predict(nothing, 2.0, 1.0)
    assert np.isnan(found.position).all()
    assert np.isnan(found.innovation_variance).all()
    one = CV.step(nothing, [5.0, math.nan], 2.0, 1.0)
    found = CV.predict(one, 3.0, 1.0)
    np.testing.assert_array_equal(found.position, [5.0, math.nan])
    assert np.isnan(found.position_variance).all()
    two = CV.step(one, [6.0, 7.0], 4.0, 1.0)
    assert np.isnan(CV.predict(two, 5.0, 1.0).innovation_variance).tolist() == [False, True]


def test_a_start_from_one_plot_knows_its_variance_if_it_presumes_a_velocity():
    presumed = AlphaBetaTracker(KalmanCV(0.0, velocity_sigma=2.0), "one-point")
    found = presumed.predict(presumed.start(5.0, 0.0, 3.0), 4.0, 1.0)
    assert found.position_variance == pytest.approx(3.0**2 + 4.0**2 * 2.0**2)
    unknown = AlphaBetaTracker(KalmanCV(0.0), "one-point")
    assert math.isnan(unknown.predict(unknown.start(5.0, 0.0, 3.0), 4.0, 1.0).position_variance)


@pytest.mark.parametrize(
    ("scheduler", "start"),
    [
        (KalmanCV(1.0, velocity_sigma=2.0), "one-point"),
        (KalmanCA(1.0, 3.0, velocity_sigma=2.0), "one-point"),
        (FuzzyScheduler(loads_rulebase(PREDICTED % "")), "two-point"),
    ],
    ids=["kalman-cv", "kalman-ca", "predicted"],
)
def test_no_variance_after_a_start_that_the_covariance_is_not_for(scheduler, start):
    t, z = [0.0, 1.0, 3.0, 3.5], [0.0, 2.0, 1.0, 5.0]
    for mode in ("two-point", "one-point"):
        tracker = AlphaBetaTracker(scheduler, mode)
        found = tracker.predict(tracker.run(t, z, 1.0).state, 5.0, 1.0)
        assert np.isfinite(found.position_variance) == (mode == start)


@pytest.mark.parametrize("coupled", [False, True])
def test_times_common_or_of_each_track(coupled):
    tracker = make_coupled() if coupled else CV
    z = np.random.default_rng(6).normal(size=(4, 3, 2))
    together = tracker.run(range(4), z, 1.0).state
    apart = tracker.run(np.arange(4.0)[:, None] + [0.0, 0.25, 0.5], z, 1.0).state
    for state, t in ((together, [4.0, 6.0, 3.5]), (apart, 7.0), (apart, [4.0, 6.0, 3.75])):
        found = tracker.predict(state, t, [1.0, 2.0])
        np.testing.assert_array_equal(found.time, np.broadcast_to(t, 3))
        for track in range(3):
            times = np.arange(4.0) + (0.25 * track if state is apart else 0.0)
            alone = tracker.run(times, z[:, track], 1.0).state
            expected = tracker.predict(alone, found.time[track], [1.0, 2.0])
            for name in ("position", "velocity", "position_variance", "innovation_variance"):
                np.testing.assert_array_equal(getattr(found, name)[track], getattr(expected, name))


def make_coupled():
    return AlphaBetaTracker(FixedTogether(0.5, 0.2))


class FixedTogether(FixedGains):
    """One set of gains, and what each axis would have left of plots of 1 m."""

    coupled = True

    def kernel(self, n_axes):
        alpha, beta = self.alpha, self.beta

        def together(innovation, change, dt, sigma, memory):
            return alpha, beta, 0.0, 1.0, memory

        return together

    def prediction_variance(self, memory, dt):
        return np.stack([1.0 + dt, 3.0 + dt])


def test_a_coupled_scheduler_tells_a_variance_for_each_axis():
    tracker = make_coupled()
    state = tracker.run(range(3), np.arange(12.0).reshape(3, 2, 2)).state
    found = tracker.predict(state, [3.0, 5.0])
    assert found.position_variance.tolist() == [[2.0, 4.0], [4.0, 6.0]]


def test_no_tracks_at_all():
    state = CV.run(range(3), np.empty((3, 0, 2)), 1.0).state
    assert CV.predict(state, 4.0, 1.0).innovation_variance.shape == (0, 2)


@pytest.mark.parametrize("t", [3.0, 2.0])
def test_what_lies_behind_is_not_predicted(t):
    state = FIXED.run(range(4), range(4)).state
    with pytest.raises(
        DataError, match=rf"\({t} s\) is not later than that of the state \(3.0 s\)"
    ):
        FIXED.predict(state, t)
    several = FIXED.run(range(4), np.zeros((4, 2, 1))).state
    with pytest.raises(DataError, match=r"index \(0, 1\) .* not later than that of the state"):
        FIXED.predict(several, [4.0, t])


def test_what_cannot_be_predicted():
    state = CV.run(range(4), np.zeros((4, 2)), 1.0).state
    with pytest.raises(ValueError, match="sigma must be positive and finite"):
        CV.predict(state, 4.0, -1.0)
    with pytest.raises(ValueError, match=r"sigma: shape \(3,\) does not broadcast"):
        CV.predict(state, 4.0, [1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match=r"t: shape \(1, 2\) does not fit plots"):
        CV.predict(state, [4.0, 5.0])
    bank = ParallelBank(selection="hindsight")
    state = bank.run(range(4), range(4)).state
    with pytest.raises(ValueError, match="'hindsight' chooses its prediction by the plot"):
        bank.predict(state, 5.0)


def test_predictions_from_a_store():
    store = TrackStore(CV, 2)
    first = store.add(CV.run(range(3), np.arange(12.0).reshape(3, 2, 2), 1.0).state)
    second = store.add(CV.run([5.0, 6.0], [[0.0, 1.0], [3.0, 2.0]], 2.0).state)
    slots = np.array([*second, first[1]])
    found = store.predict(slots, [7.0, 4.0], sigma=[1.0, 2.0])
    assert found.position.tolist() == [[6.0, 3.0], [18.0, 19.0]]
    np.testing.assert_allclose(found.innovation_variance - found.position_variance, [[1, 4]] * 2)
    # 2z₁ - z₀ of plots with σ = 2
    np.testing.assert_allclose(found.position_variance[0], [20.0, 20.0])
    assert store.time(slots).tolist() == [6.0, 2.0]
    assert store.predict([], 9.0).position.shape == (0, 2)
