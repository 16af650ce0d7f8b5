import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.gains import kalata, tracking_index
from fuzzytrack.schedulers.innovation import InnovationScheduler


def capped(sigma_v, sigma, dt):
    return min(tracking_index(sigma_v, sigma, dt), 10.0)


def by_the_paper(innovations, dts, sigmas, scheduler):
    """α by Eqs. 5 to 17 with matrices, of one innovation after the other."""
    n, alphas = scheduler.window, []
    terms = n + scheduler.extra_term
    for k in range(len(innovations)):
        dt, sigma = dts[k], sigmas[k]
        squares = np.square(innovations[max(0, k + 1 - terms) : k + 1])
        s = squares.sum() / (n * len(squares) / terms)
        sigma_v2 = scheduler.sigma_d**2
        if len(squares) == terms or scheduler.partial:
            if scheduler.q_scale is None:
                alpha = 1 - sigma**2 / s
                beta = 2 * (2 - alpha) - 4 * np.sqrt(max(1 - alpha, 0))
                phi = beta**2 / (1 - alpha) * sigma**2 / dt**4 if alpha > 0 else -1
            else:
                a, b = kalata(capped(scheduler.sigma_d, sigma, dt))
                corner = b * (2 * a - b) / (2 * (1 - a) * dt**2)
                p = np.array([[a, b / dt], [b / dt, corner]]) * sigma**2
                move, h = np.array([[1, dt], [0, 1]]), np.array([[1, 0]])
                g = np.array([[dt**2 / 2], [dt]])
                q = g @ g.T * scheduler.q_scale**2
                left = s - (h @ move @ p @ move.T @ h.T).item() - sigma**2
                phi = left / (h @ q @ h.T).item()
            if scheduler.floor == "max":
                sigma_v2 = max(phi, sigma_v2)
            elif phi >= 0:
                sigma_v2 = phi
        alphas.append(kalata(capped(np.sqrt(sigma_v2), sigma, dt))[0])
    return np.array(alphas)


CASES = [
    InnovationScheduler(),
    InnovationScheduler(sigma_d=0.3, window=1, floor="negative"),
    InnovationScheduler(4.0, 5, partial=False),
    InnovationScheduler.as_published(),
    InnovationScheduler.as_published(2.0, 1.0, 3),
    InnovationScheduler(2.0, 4, 3.0, extra_term=True),
]


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("scheduler", CASES)
def test_it_is_the_recursion_of_the_paper(scheduler, missed):
    random = np.random.default_rng(8)
    times = np.cumsum(random.uniform(0.5, 2.0, 80))
    sigma = random.uniform(5.0, 20.0, 80)
    plots = np.where(times > 60, (times - 60) ** 2, 0.0) + sigma * random.normal(size=80)
    plots[[10, 11, 30]] = np.nan
    result = AlphaBetaTracker(scheduler, missed=missed).run(times, plots, sigma)
    asked, seen = ~np.isnan(result.innovation), ~np.isnan(plots)
    # Since the last plot, not since the last time at which there could have been one.
    spans = np.diff(times[seen])[1:]
    expected = by_the_paper(result.innovation[asked], spans, sigma[asked], scheduler)
    np.testing.assert_allclose(result.gains.alpha[asked], expected, rtol=1e-8)
    beta = 2 * (1 - np.sqrt(1 - expected)) ** 2
    steps = spans
    if missed == "step":
        steps = np.diff(times, prepend=0.0)[asked]
        assert (steps < spans).sum() == 2
    np.testing.assert_allclose(result.gains.beta[asked] / steps, beta / spans, rtol=1e-7)


@given(st.floats(1.01, 45.0), st.floats(0.1, 10.0), st.floats(0.5, 500.0))
def test_the_default_gain_is_one_less_the_share_of_noise(ratio, dt, sigma):
    kernel = InnovationScheduler(1e-9, window=1).kernel(1)
    alpha, *_ = kernel(sigma * np.sqrt(ratio), 0.0, dt, sigma, (0.0, 2.0, 0.0, 0.0))
    assert alpha == pytest.approx(1 - 1 / ratio, rel=1e-6)


@pytest.mark.parametrize("scheduler", [InnovationScheduler(), InnovationScheduler.as_published()])
def test_one_plot_far_off_does_not_ring_on(scheduler):
    times = np.arange(200.0)
    plots = 100 * times + np.random.default_rng(0).normal(0, 10, 200)
    plots[50] += 1e4
    result = AlphaBetaTracker(scheduler).run(times, plots, 10.0)
    assert np.nanmax(result.gains.beta) == pytest.approx(1.459, abs=1e-3)
    assert np.abs(result.predicted - 100 * times)[65:].max() < 80


def test_noise_and_time_steps_of_nothing():
    for sigma, times in ((1e-150, [0.0, 1, 2, 3]), (10.0, [0.0, 1e-200, 2e-200, 3e-200])):
        for scheduler in CASES:
            result = AlphaBetaTracker(scheduler).run(times, [0.0, 10, 19, 31], sigma)
            assert np.isfinite(result.filtered).all()


def simulate(scheduler, runs=400, start=2):
    """Kim & Lee's ±5 g target, filtered from the truth at k = 2: RMSE of position, and α."""
    acceleration = np.zeros(101)
    acceleration[26:36], acceleration[66:76] = 49.05, -49.05
    x, v = np.zeros(101), np.full(101, 120.0)
    for k in range(1, 101):
        x[k] = x[k - 1] + v[k - 1] + acceleration[k] / 2
        v[k] = v[k - 1] + acceleration[k]
    assert v.max() == pytest.approx(610.5)
    plots = x[:, None] + np.random.default_rng(2).normal(0.0, 150.0, (101, runs))
    # A start from two points of the truth is the truth.
    plots[1:3] = x[1:3, None]
    result = AlphaBetaTracker(scheduler).run(np.arange(1.0, 101), plots[1:, :, None], 150.0)
    errors = np.full((101, runs), np.nan)
    errors[1:] = result.filtered[:, :, 0] - x[1:, None]
    alpha = np.full((101, runs), np.nan)
    alpha[1:] = result.gains.alpha[:, :, 0]
    return np.sqrt(np.mean(errors**2, axis=1)), alpha


@pytest.mark.untraced
@pytest.mark.parametrize(
    ("scheduler", "mean", "maneuver", "quiet"),
    [
        (InnovationScheduler(), 113.3, 135.5, 101.8),
        (InnovationScheduler.as_published(), 110.5, 133.5, 103.3),
    ],
)
def test_errors_on_the_published_scenario(scheduler, mean, maneuver, quiet):
    rmse, _ = simulate(scheduler)
    ours = [
        rmse[14:].mean(),
        np.r_[rmse[26:36], rmse[66:76]].mean(),
        np.r_[rmse[48:66], rmse[88:101]].mean(),
    ]
    assert ours == pytest.approx([mean, maneuver, quiet], rel=0.025)


@pytest.mark.untraced
def test_unit_process_noise_latches_up():
    """25 s after the maneuver the gains of nearly all runs are still those of a maneuver."""
    _, alpha = simulate(InnovationScheduler.as_published(q_scale=1.0), runs=200)
    assert np.mean(alpha[60] > 0.8) == pytest.approx(0.93, abs=0.06)
    _, alpha = simulate(InnovationScheduler(), runs=200)
    assert np.mean(alpha[60] > 0.8) < 0.1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sigma_d": 0.0}, "sigma_d must be finite and > 0, got 0"),
        ({"q_scale": -1.0}, "q_scale must be finite and > 0, got -1"),
        ({"window": 0}, "window must be a whole number from 1 to 64, got 0"),
        ({"window": 2.5}, "window must be a whole number from 1 to 64, got 2.5"),
        ({"floor": "min"}, "floor must be one of max, negative, got 'min'"),
    ],
)
def test_parameters_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        InnovationScheduler(**arguments)
