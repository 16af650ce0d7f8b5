import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.schedulers import BenedictBordner
from fuzzytrack.simulation.noise import Noise, streams
from fuzzytrack.simulation.published import s3
from fuzzytrack.simulation.scenario import PlotNoise
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.runners import runner
from fuzzytrack.trackers.window_search import WindowSearch


def corrected(x, v, z, gap, dt, alpha):
    """State after a plot, of that after the plot before, and the innovation; β counts per dt."""
    e = z - (x + v * gap)
    return x + v * gap + alpha * e, v + alpha**2 / (2 - alpha) / dt * e, e


def literal_search(times, plots, window, alpha, grid, mode):
    """Predictions and α of one axis: states are looked up, and every window is run anew."""
    seen = np.flatnonzero(~np.isnan(plots))
    predicted, alphas = np.full(len(plots), np.nan), np.full(len(plots), np.nan)
    first, second = seen[:2]
    v = (plots[second] - plots[first]) / (times[second] - times[first])
    states = {second: (plots[second], v)}

    def spans(last, now):
        gap = times[now] - times[last]
        return gap, gap if mode == "elapsed" else times[now] - times[now - 1]

    for k in range(second + 1, len(plots)):
        before = [j for j in seen if j < k]
        x, v = states[before[-1]]
        predicted[k] = x + v * (times[k] - times[before[-1]])
        if k not in seen:
            continue
        alphas[k] = alpha
        *state, _ = corrected(x, v, plots[k], *spans(before[-1], k), alpha)
        states[k] = tuple(state)
        used = [*before, k]
        if len(used) - 2 < window:
            continue
        sums = []
        for candidate in grid:
            x, v = states[used[-window - 1]]
            total = 0.0
            for last, now in zip(used[-window - 1 :], used[-window:], strict=False):
                x, v, e = corrected(x, v, plots[now], *spans(last, now), candidate)
                total += e**2
            sums.append(total)
        alpha = grid[int(np.argmin(sums))]
    return predicted, alphas


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1),
    window=st.integers(2, 12),
    grid_step=st.sampled_from([0.05, 0.1, 0.3, 1.0]),
    missed=st.sampled_from([0.0, 0.3]),
    mode=st.sampled_from(["elapsed", "step"]),
)
def test_equals_the_literal_search(seed, window, grid_step, missed, mode):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 2.0, 30))
    plots = np.cumsum(np.cumsum(random.normal(0, 3, 30))) + random.normal(0, 10, 30)
    plots[random.random(30) < missed] = np.nan
    tracker = WindowSearch(window, 0.2, grid_step, mode)
    result = tracker.run(times, plots)
    grid = np.arange(1, int(1 / grid_step + 1e-9) + 1) * grid_step
    predicted, alphas = literal_search(times, plots, window, 0.2, grid, mode)
    np.testing.assert_allclose(tracker.grid, grid, rtol=1e-15)
    np.testing.assert_allclose(result.gains.alpha, alphas, rtol=1e-12)
    np.testing.assert_allclose(result.predicted, predicted, rtol=1e-9, atol=1e-9)


def test_until_the_window_is_full_it_is_a_fixed_filter():
    random = np.random.default_rng(1)
    times = np.cumsum(random.uniform(0.5, 2.0, 40))
    plots = np.cumsum(random.normal(0, 30, (40, 3, 2)), axis=0)
    plots[random.random(plots.shape) < 0.2] = np.nan
    one = WindowSearch(39, 0.3).run(times, plots)
    other = ft.AlphaBetaTracker(BenedictBordner(0.3)).run(times, plots)
    for name in ("predicted", "filtered", "velocity", "acceleration", "innovation"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    for name in ("alpha", "beta", "gamma"):
        ours, theirs = getattr(one.gains, name), getattr(other.gains, name)
        np.testing.assert_allclose(ours, theirs, rtol=1e-15, err_msg=name)


def test_the_window_is_of_plots():
    plots = np.cumsum(np.cumsum(np.random.default_rng(2).normal(0, 9, 12)))
    alphas = WindowSearch(4).run(np.arange(12), plots).gains.alpha
    assert (alphas[2:6] == 0.05).all()
    assert alphas[6] != 0.05
    # With plots missed in between it is full later.
    spread = np.full(24, np.nan)
    spread[::2] = plots
    later = WindowSearch(4).run(np.arange(24), spread).gains.alpha
    assert (later[4:12:2] == 0.05).all()
    assert later[12] != 0.05


@pytest.mark.parametrize("far", [1e9, 1e160, -1e200])
def test_survives_any_innovation(far):
    plots = [0, 10, 20, 30, far, 50, *[60.0] * 8]
    result = WindowSearch(3).run(np.arange(14.0), plots)
    assert np.isfinite(result.filtered).all()
    assert np.isin(result.gains.alpha[2:], WindowSearch(3).grid).all()


def test_no_plots_no_tracks_one_plot():
    tracker = WindowSearch()
    assert np.isnan(tracker.run(np.arange(5.0), np.full(5, np.nan)).filtered).all()
    assert tracker.run(np.arange(5.0), np.zeros((5, 0, 2))).predicted.shape == (5, 0, 2)
    one = tracker.run([0, 1, 2], [np.nan, 7.0, np.nan])
    np.testing.assert_array_equal(one.filtered, [np.nan, 7, 7])


def test_from_a_word():
    tracker = make_tracker("window-search:window=20:grid_step=0.1")
    assert tracker == WindowSearch(20, grid_step=0.1)
    assert pickle.loads(pickle.dumps(tracker)) == tracker


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"window": 1}, "window must be at least 2 plots, got 1"),
        ({"alpha": 0.0}, "alpha must be > 0"),
        ({"grid_step": 0.0}, "grid_step must be > 0 and <= 1, got 0"),
        ({"grid_step": 1.5}, "grid_step must be > 0 and <= 1, got 1.5"),
        ({"missed": "late"}, "missed: unknown 'late'; one of elapsed, step"),
    ],
)
def test_bad_parameters(parameters, message):
    with pytest.raises(ValueError, match=message):
        WindowSearch(**parameters)


# The RMSE of the paper's Eq. 26, as in test_bank: predictions, divided by the number of all plots.
def published_errors(tracker, noise, runs, native):
    times, truth = s3()
    z = noise.measure(truth, streams(1, runs)).z
    core = runner(tracker, 1)
    outputs = core(
        None, z.reshape(100, 2 * runs, 1), times[:, None], np.full((1, 1, 1), np.nan),
        native=native,
    )[1]  # fmt: skip
    errors = outputs["predicted"].reshape(z.shape) - truth[:, None]
    return np.sqrt(np.sum(errors[2:] ** 2, axis=0) / len(truth))


WHITE_NOISE = PlotNoise((15.0, 23.0), clean=2)
COLORED_NOISE = PlotNoise((19.0, 23.0), Noise(correlation=0.7), clean=2)


@pytest.mark.parametrize(
    ("noise", "expected", "tolerance"),
    [(WHITE_NOISE, (14.0, 272.4), (0.8, 1.0)), (COLORED_NOISE, (13.4, 272.4), (0.8, 1.0))],
)
def test_a_window_over_most_of_the_track_fits_the_paper(noise, expected, tolerance):
    errors = published_errors(WindowSearch(80), noise, 500, native=True)
    assert (np.abs(errors.mean(axis=0) - expected) < tolerance).all(), errors.mean(axis=0)


def test_a_short_window_follows_the_maneuver():
    short = published_errors(WindowSearch(), WHITE_NOISE, 20, native=False)[:, 1]
    # 24.1 m with a standard deviation of 7 m, which is 1.6 m for the mean of 20 runs
    assert abs(short.mean() - 24.1) < 5
