from dataclasses import dataclass

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.gains import covariance, kalata, noise_ratio
from fuzzytrack.recordings.ragged import run_tracks
from fuzzytrack.schedulers import GainScheduler, KalmanCA, KalmanCV
from fuzzytrack.trackers.covariance import track_covariance

ALPHA_BETA = FixedGains(0.5, 0.2)
ALPHA_BETA_GAMMA = FixedGains(0.6, 0.3, 0.1)


def record(seed=1, n=40):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.3, 3.0, n))
    sigma = random.uniform(1.0, 30.0, n)
    plots = 0.2 * times**2 + 5 * times + sigma * random.normal(size=n)
    plots[[1, 4, 5, 20, 31, 32]] = np.nan
    return times, plots, sigma


def kalman(order, velocity_sigma):
    if order == 2:
        return KalmanCV(0.7, velocity_sigma=velocity_sigma), {}
    return KalmanCA(0.7, 0.4, velocity_sigma=velocity_sigma), {"acceleration_sigma": 0.4}


def remembered(tracker, times, plots, sigma):
    """The scheduler's own covariance after every step, upper triangle row by row, and states."""
    state = tracker.start(plots[0], times[0], sigma[0])
    states = [state]
    for z, t, s in zip(plots[1:], times[1:], sigma[1:], strict=True):
        state = tracker.step(state, z, t, s)
        states.append(state)
    rows = state.rows
    return np.array([s.lanes[rows.memory + 1 : rows.state - 1, 0] for s in states]), states


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(
    ("start", "velocity_sigma"), [("one-point", 9.0), ("one-point", None), ("two-point", None)]
)
def test_it_is_what_a_kalman_scheduler_remembers(order, start, velocity_sigma, missed):
    times, plots, sigma = record()
    scheduler, others = kalman(order, velocity_sigma)
    tracker = AlphaBetaTracker(scheduler, start, missed)
    found = track_covariance(
        tracker.run(times, plots, sigma), sigma, 0.7,
        velocity_sigma=velocity_sigma, missed=missed, **others,
    )  # fmt: skip
    known = 2 if velocity_sigma is None else 0
    assert np.isnan(found.filtered[:known]).all()
    assert np.isnan(found.predicted[: known + 1]).all()
    above = found.filtered[:, *np.triu_indices(order)]
    wanted, states = remembered(tracker, times, plots, sigma)
    # A missed plot leaves the memory alone if time counts from the last one.
    kept = ~np.isnan(plots) | (missed == "step")
    kept[:known] = False
    assert above[kept] == pytest.approx(wanted[kept], rel=1e-9)
    below = found.filtered[:, *np.triu_indices(order)[::-1]]
    assert below[known:] == pytest.approx(above[known:], rel=1e-9)
    coasted = np.flatnonzero(np.isnan(plots[known + 1 :])) + known + 1
    assert len(coasted) > 4
    for k in coasted:
        variance = tracker.predict(states[k - 1], times[k]).position_variance
        assert found.filtered[k, 0, 0] == pytest.approx(variance, rel=1e-9)
    np.testing.assert_array_equal(found.filtered[coasted], found.predicted[coasted])


def simulated(order, times, sigma, missing, tracks, start_sigmas, seed, missed):
    """True states, shape (n_steps, tracks, order), and plots of what the model describes.

    A push lasts from one step of the model to the next one: from plot to plot, or from row to row.
    """
    random = np.random.default_rng(seed)
    state = random.normal(size=(tracks, order)) * np.array([500.0, *start_sigmas])
    states, last, noise = [state], 0, random.normal(0, 0.7, (tracks, 1))
    for k in range(1, len(times)):
        dt = times[k] - times[last]
        move = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])[:order, :order]
        push = np.array([dt * dt / 2, dt, 1.0])[:order]
        states.append(state @ move.T + push * noise)
        if k not in missing or missed == "step":
            state, last, noise = states[-1], k, random.normal(0, 0.7, (tracks, 1))
    truth = np.array(states)
    plots = truth[..., 0] + sigma[:, None] * random.normal(size=truth.shape[:2])
    plots[missing] = np.nan
    return truth, plots[..., None]


@pytest.mark.untraced
@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("start", ["one-point", "two-point"])
@pytest.mark.parametrize("gains", [ALPHA_BETA, ALPHA_BETA_GAMMA], ids=["ab", "abg"])
def test_errors_of_simulated_tracks_have_it(gains, start, missed):
    tracks, order = 4000, 2 + (gains.gamma > 0)
    times = np.array([0.0, 1.0, 2.5, 3.0, 5.0, 6.0, 6.8, 8.0])
    sigma = np.array([3.0, 5.0, 2.0, 4.0, 1.0, 3.0, 6.0, 2.0])
    truth, plots = simulated(
        order, times, sigma, [1, 5, 6], tracks, (9.0, 0.4)[: order - 1], 7, missed
    )
    result = AlphaBetaTracker(gains, start, missed).run(times, plots)
    found = track_covariance(
        result,
        sigma[:, None, None],
        0.7,
        velocity_sigma=9.0 if start == "one-point" else None,
        acceleration_sigma=0.4 if order == 3 else None,
        missed=missed,
    )
    outputs = (result.filtered, result.velocity, result.acceleration)[:order]
    errors = np.concatenate(outputs, axis=-1) - truth
    first = 0 if start == "one-point" else 2
    for k in range(first, len(times)):
        p = found.filtered[k, 0, 0]
        sample = errors[k].T @ errors[k] / tracks
        standard_error = np.sqrt((np.outer(p.diagonal(), p.diagonal()) + p**2) / tracks)
        assert (np.abs(sample - p) <= 4 * standard_error + 1e-9).all()
    corrected = ~np.isnan(result.innovation[:, 0, 0])
    squares = found.nis[corrected]
    assert np.abs(squares.mean(axis=1) - 1).max() < 4 * np.sqrt(2 / tracks)


@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.2), (0.3, 0.7), (1.2, 0.9)])
def test_it_settles_at_the_closed_form(alpha, beta):
    times = np.arange(0.0, 600.0, 2.0)
    result = AlphaBetaTracker(FixedGains(alpha, beta)).run(times, np.zeros(300))
    found = track_covariance(result, 5.0, 0.3)
    assert found.filtered[-1] == pytest.approx(covariance(alpha, beta, 5.0, 2.0, 0.3), rel=1e-10)


def test_noise_alone_settles_at_the_noise_ratios_with_gamma_too():
    times = np.arange(0.0, 600.0, 2.0)
    result = AlphaBetaTracker(ALPHA_BETA_GAMMA).run(times, np.arange(300) ** 2.0)
    found = track_covariance(result, 5.0, 0.0, acceleration_sigma=1.0)
    gains = (ALPHA_BETA_GAMMA.alpha, ALPHA_BETA_GAMMA.beta, ALPHA_BETA_GAMMA.gamma)
    wanted = [noise_ratio(*gains, of=of) for of in ("filtered", "velocity", "acceleration")]
    scaled = found.filtered[-1].diagonal() / 25 * [1, 2**2, 2**4]
    assert scaled == pytest.approx(np.array(wanted), rel=1e-9)
    assert found.predicted[-1, 0, 0] / 25 == pytest.approx(noise_ratio(*gains), rel=1e-9)


def test_optimal_gains_have_the_least_covariance():
    index = 0.3 * 2.0**2 / 5.0
    alpha, beta = kalata(index)
    plots = np.zeros(200)
    times = 2.0 * np.arange(200)
    traces = []
    for change in (1.0, 0.9, 1.1):
        gains = FixedGains(alpha * change, beta)
        result = AlphaBetaTracker(gains).run(times, plots)
        traces.append(track_covariance(result, 5.0, 0.3).filtered[-1, 0, 0])
    assert traces[0] == min(traces)


def test_the_two_point_start_over_one_step():
    result = AlphaBetaTracker(ALPHA_BETA).run([0.0, 3.0], [0.0, 1.0])
    p = track_covariance(result, [4.0, 2.0], 0.5).filtered[1]
    wanted = [[4.0, 4.0 / 3.0], [4.0 / 3.0, 20.0 / 9.0 + 0.25 * 9.0 / 4.0]]
    assert p == pytest.approx(np.array(wanted), rel=1e-14)


def test_batches_are_their_tracks_one_by_one():
    times, plots, sigma = record()
    axes = np.stack([plots, np.roll(plots, 1), plots[::-1]], axis=1)
    batch = np.stack([axes, axes + 3.0, np.full_like(axes, np.nan)], axis=1)
    own_times = np.stack([times, 2 * times, times + 1], axis=1)
    tracker = AlphaBetaTracker(ALPHA_BETA)
    whole = track_covariance(tracker.run(own_times, batch), sigma[:, None, None], 0.7)
    assert whole.predicted.shape == (*batch.shape, 2, 2)
    for track in range(3):
        result = tracker.run(own_times[:, track], batch[:, track])
        one = track_covariance(result, sigma[:, None], 0.7)
        np.testing.assert_array_equal(whole.filtered[:, track], one.filtered)
        np.testing.assert_array_equal(whole.nis[:, track], one.nis)
        for axis in range(3):
            alone = track_covariance(
                tracker.run(own_times[:, track], batch[:, track, axis]), sigma, 0.7
            )
            np.testing.assert_array_equal(one.predicted[:, axis], alone.predicted)
            np.testing.assert_array_equal(
                one.innovation_variance[:, axis], alone.innovation_variance
            )
    assert np.isnan(whole.filtered[:, 2]).all()


def test_nis_sums_the_axes_that_there_are():
    plots = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, np.nan], [np.nan, np.nan], [4.0, 7.0]])
    result = AlphaBetaTracker(ALPHA_BETA).run(np.arange(5.0), plots)
    found = track_covariance(result, 2.0, 0.5)
    squares = result.innovation**2 / found.innovation_variance
    assert found.axes.tolist() == [0, 0, 1, 0, 2]
    assert np.isnan(found.nis[[0, 1, 3]]).all()
    assert found.nis[2] == squares[2, 0]
    assert found.nis[4] == pytest.approx(squares[4].sum())
    predicted = found.predicted[4, :, 0, 0]
    assert found.innovation_variance[4] == pytest.approx(predicted + 4.0)


def test_a_coupled_tracker_misses_a_plot_that_lacks_an_axis():
    @dataclass(frozen=True)
    class Coupled(GainScheduler):
        coupled = True

        def kernel(self, n_axes):
            return lambda innovation, change, dt, sigma, memory: (0.5, 0.2, 0.0, 1.0, memory)

    plots = np.array(
        [[0.0, np.nan], [1.0, 1.0], [np.nan, 2.0], [3.0, 3.5], [4.0, np.nan], [5.0, 6]]
    )
    times = np.arange(6.0)
    found = track_covariance(AlphaBetaTracker(Coupled()).run(times, plots), 2.0, 0.5)
    whole = np.where(np.isnan(plots).any(axis=1, keepdims=True), np.nan, plots)
    wanted = track_covariance(AlphaBetaTracker(ALPHA_BETA).run(times, whole), 2.0, 0.5)
    np.testing.assert_array_equal(found.filtered, wanted.filtered)
    np.testing.assert_array_equal(found.nis, wanted.nis)


@pytest.mark.parametrize("shape", [(0,), (0, 2), (5, 0, 2), (1,), (5,), (5, 3, 2)])
def test_nothing_seen_gives_nothing(shape):
    result = AlphaBetaTracker(ALPHA_BETA).run(np.arange(shape[0]), np.full(shape, np.nan))
    found = track_covariance(result, 1.0, 1.0)
    assert found.predicted.shape == found.filtered.shape == (*shape, 2, 2)
    assert found.innovation_variance.shape == shape
    assert found.nis.shape == found.axes.shape == (shape if len(shape) == 1 else shape[:-1])
    assert np.isnan(found.filtered).all()
    assert not found.axes.any()


def test_an_alpha_beta_tracker_of_an_accelerating_target():
    times, plots, sigma = record()
    result = AlphaBetaTracker(ALPHA_BETA).run(times, plots)
    without = track_covariance(result, sigma, 0.0)
    still = track_covariance(result, sigma, 0.0, acceleration_sigma=0.0)
    assert still.filtered[3:, :2, :2] == pytest.approx(without.filtered[3:], rel=1e-12)
    assert not still.filtered[3:, 2].any()
    found = track_covariance(result, sigma, 0.0, acceleration_sigma=0.4)
    assert (found.predicted[3:, 0, 0] > still.predicted[3:, 0, 0]).all()


# ---------------------------------------------------------------- what is refused


def run(gains=ALPHA_BETA, start="two-point", **others):
    times, plots, _ = record()
    return AlphaBetaTracker(gains, start).run(times, plots, **others)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sigma": 0.0}, "sigma must be finite and > 0 where there is a plot, got 0 at index 0"),
        ({"sigma": np.ones(3)}, r"sigma: shape \(3,\) does not broadcast with the plots' \(40,\)"),
        ({"sigma_v": -1.0}, "sigma_v must be finite and >= 0, got -1"),
        ({"velocity_sigma": np.inf}, "velocity_sigma must be finite and >= 0, got inf"),
        ({"acceleration_sigma": -2.0}, "acceleration_sigma must be finite and >= 0, got -2"),
        ({"missed": "late"}, "missed: unknown 'late'; one of elapsed, step"),
    ],
)
def test_standard_deviations_out_of_range(arguments, message):
    with pytest.raises(ValueError, match=message):
        track_covariance(run(), **{"sigma": 1.0, "sigma_v": 1.0, **arguments})


def test_a_one_point_start_needs_the_velocity():
    with pytest.raises(ValueError, match="velocity_sigma: a one-point start needs"):
        track_covariance(run(start="one-point"), 1.0, 1.0)


@pytest.mark.parametrize(("mode", "other"), [("elapsed", "step"), ("step", "elapsed")])
def test_time_counts_as_for_the_tracker(mode, other):
    times, plots, _ = record()
    result = AlphaBetaTracker(ALPHA_BETA, missed=mode).run(times, plots)
    track_covariance(result, 1.0, 1.0, missed=mode)
    with pytest.raises(ValueError, match="do not follow from its gains"):
        track_covariance(result, 1.0, 1.0, missed=other)


def test_gamma_needs_the_acceleration():
    with pytest.raises(ValueError, match="acceleration_sigma: a tracker with gamma"):
        track_covariance(run(ALPHA_BETA_GAMMA), 1.0, 1.0)


@pytest.mark.parametrize("cut", [1, 2, 3, 10])
def test_a_track_that_goes_on_is_refused(cut):
    times, plots, _ = record()
    tracker = AlphaBetaTracker(ALPHA_BETA)
    before = tracker.run(times[:cut], plots[:cut])
    after = tracker.run(times[cut:], plots[cut:], state=before.state)
    with pytest.raises(ValueError, match="result: it continues from a state"):
        track_covariance(after, 1.0, 1.0)


def test_a_member_of_a_batch_without_its_state_is_refused_where_it_matters():
    times, plots = np.arange(6.0), np.random.default_rng(0).normal(size=(6, 2))
    whole = run_tracks(AlphaBetaTracker(ALPHA_BETA), [(times, plots), (times, plots)])[0]
    alone = AlphaBetaTracker(ALPHA_BETA).run(times, plots)
    np.testing.assert_array_equal(
        track_covariance(whole, 1.0, 0.1).innovation_variance,
        track_covariance(alone, 1.0, 0.1).innovation_variance,
    )
    plots[0, 1] = np.nan
    lacking = run_tracks(AlphaBetaTracker(ALPHA_BETA), [(times, plots), (times, plots)])[0]
    with pytest.raises(ValueError, match="result: a plot lacks a coordinate, and without its"):
        track_covariance(lacking, 1.0, 0.1)


def test_a_fading_acceleration_is_refused():
    @dataclass(frozen=True)
    class Fading(GainScheduler):
        uses_retention = True

        def kernel(self, n_axes):
            return lambda innovation, change, dt, sigma, memory: (0.6, 0.3, 0.1, 0.9, memory)

    with pytest.raises(ValueError, match="do not follow from its gains"):
        track_covariance(run(Fading()), 1.0, 1.0, acceleration_sigma=1.0)
