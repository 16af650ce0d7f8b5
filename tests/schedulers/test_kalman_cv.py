import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.gains import growing_memory, kalata
from fuzzytrack.schedulers import KalmanCA, KalmanCV


def matrices(order, dt):
    move = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])[:order, :order]
    push = np.array([dt * dt / 2, dt, 1.0])[:order, None]
    return move, push


def numpy_filter(times, plots, sigma, sigma_v, start, missed):
    """Textbook filter with full matrices: predictions, states, covariances that are remembered.

    If time counts from the last plot, noise comes once from plot to plot, and a missed one leaves
    no trace.
    """
    order = len(start) + 1
    h = np.eye(order)[:1]
    x = np.zeros((order, 1))
    x[0] = plots[0]
    p = np.diag([sigma[0] ** 2, *(s**2 for s in start)])
    states, predictions, covariances, last = [x], [np.nan], [p], 0
    for k in range(1, len(times)):
        before = x, p
        move, push = matrices(order, times[k] - times[last])
        x, p = move @ x, move @ p @ move.T + push @ push.T * sigma_v**2
        predictions.append(x[0, 0])
        if not np.isnan(plots[k]):
            gain = p @ h.T / (h @ p @ h.T + sigma[k] ** 2)
            x, p = x + gain * (plots[k] - x[0]), (np.eye(order) - gain @ h) @ p
        states.append(x)
        if np.isnan(plots[k]) and missed == "elapsed":
            x, p = before
        else:
            last = k
        covariances.append(p)
    return np.array(predictions), np.array(states)[:, :, 0], np.array(covariances)


def record(seed=1, n=60):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.3, 3.0, n))
    sigma = random.uniform(1.0, 30.0, n)
    plots = 0.2 * times**2 + 5 * times + sigma * random.normal(size=n)
    plots[[3, 4, 5, 20, 41, 42]] = np.nan
    return times, plots, sigma


def make(order, sigma_v=0.7, velocity_sigma=9.0, **others):
    if order == 2:
        return KalmanCV(sigma_v, velocity_sigma=velocity_sigma, **others)
    return KalmanCA(sigma_v, 0.4, velocity_sigma=velocity_sigma, **others)


@pytest.mark.parametrize("last_plot", [np.nan, 900.0])
@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("order", [2, 3])
def test_it_is_the_kalman_filter_at_any_times_noise_and_gaps(order, missed, last_plot):
    times, plots, sigma = record()
    plots[-1] = last_plot
    tracker = AlphaBetaTracker(make(order), start="one-point", missed=missed)
    result = tracker.run(times, plots, sigma)
    start = (9.0, 0.4)[: order - 1]
    predictions, states, covariances = numpy_filter(times, plots, sigma, 0.7, start, missed)
    assert result.predicted[1:] == pytest.approx(predictions[1:], rel=1e-11)
    assert result.filtered == pytest.approx(states[:, 0], rel=1e-11)
    assert result.velocity == pytest.approx(states[:, 1], rel=1e-9)
    if order == 3:
        assert result.acceleration == pytest.approx(states[:, 2], rel=1e-8, abs=1e-10)
    rows = result.state.rows
    memory = result.state.lanes[rows.memory : rows.state, 0]
    assert memory[1:-1] == pytest.approx(covariances[-1][np.triu_indices(order)], rel=1e-9)


@pytest.mark.parametrize("order", [2, 3])
def test_unknown_velocity_is_the_limit_of_a_vague_one(order):
    times, plots, sigma = record()
    plots[1:3] = np.nan
    vague = AlphaBetaTracker(make(order, velocity_sigma=1e5), "one-point")
    unknown = AlphaBetaTracker(make(order, velocity_sigma=None), "one-point")
    one, other = vague.run(times, plots, sigma), unknown.run(times, plots, sigma)
    assert one.filtered == pytest.approx(other.filtered, rel=1e-5)
    assert one.velocity == pytest.approx(other.velocity, rel=1e-4, abs=1e-4)
    # ... and the same after a start from two points
    two = AlphaBetaTracker(make(order, velocity_sigma=None)).run(times, plots, sigma)
    assert two.filtered == pytest.approx(other.filtered, rel=1e-12)
    assert two.velocity == pytest.approx(other.velocity, rel=1e-12)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("index", [0.1, 1.0, 5.0])
def test_the_gains_settle_at_kalatas(order, index):
    dt, sigma_w = 2.5, 30.0
    scheduler = make(order, sigma_v=index * sigma_w / dt**2, sigma_w=sigma_w)
    gains = AlphaBetaTracker(scheduler).run(np.arange(200) * dt, np.zeros(200)).gains
    last = (gains.alpha[-1], gains.beta[-1], gains.gamma[-1])
    assert last[:order] == pytest.approx(kalata(index, order), rel=1e-9)


def test_a_target_that_never_accelerates_is_fitted_by_least_squares():
    gains = AlphaBetaTracker(KalmanCV(0.0, sigma_w=7.0)).run(np.arange(30.0), np.ones(30)).gains
    alpha, beta = growing_memory(np.arange(3, 31))
    assert gains.alpha[2:] == pytest.approx(alpha)
    assert gains.beta[2:] == pytest.approx(beta)


def test_noise_of_the_first_plot_counts():
    sigma = np.array([1.0, 50.0, 1.0, 1.0])
    runs = [AlphaBetaTracker(KalmanCV(0.1)).run(np.arange(4.0), np.zeros(4), s)
            for s in (sigma, np.full(4, 1.0))]  # fmt: skip
    assert runs[0].gains.alpha[2] > runs[1].gains.alpha[2]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sigma_v": -1.0}, "sigma_v must be finite and >= 0, got -1"),
        ({"sigma_v": 1.0, "sigma_w": 0.0}, "sigma_w must be finite and > 0, got 0"),
        ({"sigma_v": 1.0, "velocity_sigma": np.inf}, "velocity_sigma must be .* > 0, got inf"),
    ],
)
def test_parameters_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        KalmanCV(**arguments)
    with pytest.raises(ValueError, match=message):
        KalmanCA(acceleration_sigma=1.0, **arguments)


def test_the_initial_acceleration_is_checked():
    with pytest.raises(ValueError, match="acceleration_sigma must be finite and >= 0, got nan"):
        KalmanCA(1.0, float("nan"))


def test_sigma_is_asked_for():
    assert not KalmanCV(1.0, 2.0).needs_sigma
    assert not KalmanCA(1.0, 1.0, 2.0).needs_sigma
    with pytest.raises(ValueError, match="KalmanCA needs the standard deviation"):
        AlphaBetaTracker(KalmanCA(1.0, 1.0)).run([0, 1], [0, 1])
