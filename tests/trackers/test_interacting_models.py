import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.trackers import (
    InteractingModels,
    InteractingPair,
    MotionModel,
    three_model_imm,
    two_model_imm,
)
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.markov_chain import MarkovChain

STRAIGHT, DECAYING, KEEPING = MotionModel(0.4), MotionModel(1.5, 6.0), MotionModel(0.3, math.inf)
FOUR = InteractingModels(
    (DECAYING, STRAIGHT, KEEPING, MotionModel(0.05, 1.0)),
    ((0, 0.3, 0, 0.02), (0, 0, 0.5, 0), (0.1, 0, 0, 0.1), (0.04, 0, 0, 0)),
    (0.1, 0.6, 0.2, 0.1),
    gap=1.5,
)
TRACKERS = {
    "two": two_model_imm(level=0.8),
    "three, without a level": three_model_imm(start_acceleration=0.8),
    "three, Gaussian": three_model_imm(level=2.5, freedom=math.inf, gap=math.inf),
    "four": replace(FOUR, freedom=4),
    "constant velocity and constant acceleration": InteractingModels(
        (STRAIGHT, KEEPING), ((0, 0.05), (0.2, 0)), (0.7, 0.3), level=3.0, sigma_w=4.0
    ),
    "one": InteractingModels((DECAYING,), ((0,),), (1,), level=1.0, gap=4.0),
}


def plots(seed, n_axes, steps=50):
    """Irregular times, a maneuver, noise by plot and axis."""
    random = np.random.default_rng(seed)
    intervals = random.uniform(0.3, 3.0, steps)
    intervals[11::17] = 60.0
    times = np.cumsum(intervals)
    sigma = random.uniform(0.5, 8.0, (steps, n_axes))
    bend = np.where(times > times[steps // 2], (times - times[steps // 2]) ** 2, 0.0)
    z = times[:, None] * random.normal(0.0, 9.0, n_axes) + np.outer(bend, np.arange(1, n_axes + 1))
    return times, z + sigma * random.normal(size=z.shape), sigma


class Textbook:
    """The cycle in matrices, for one model after another; a covariance is that of a mean axis."""

    def __init__(self, tracker, time, plot, variance):
        self.tracker, self.time, self.plot, self.variance = tracker, time, plot, variance
        self.seen = time
        self.first, self.intervals, self.p = variance, [], np.array(tracker.start_probabilities)
        self.means = self.covariances = None

    def units(self):
        """a0 and τ0."""
        if self.tracker.level is None:
            unit = np.mean(self.intervals)
            return math.sqrt(self.first) / unit**2, unit
        a0 = self.tracker.level / 3
        return a0, math.sqrt(math.sqrt(self.first) / a0)

    def start(self, time, plot, variance):
        """Take the second plot."""
        dt = time - self.time
        self.intervals.append(dt)
        a0, _ = self.units()
        self.means, self.covariances = [], []
        for model in self.tracker.models:
            still = model.retention == 0
            q = (a0 * (model.noise if still else self.tracker.start_acceleration)) ** 2
            p = np.diag([variance, (self.variance + variance) / dt**2 + q * dt**2 / 4, q])
            p[0, 1] = p[1, 0] = variance / dt
            p[1, 2] = p[2, 1] = q * dt / 2
            if still:
                p[2] = p[:, 2] = 0
            self.means.append(np.array([plot, (plot - self.plot) / dt, 0 * plot]))
            self.covariances.append(p)
        self.time = self.seen = time

    def predict(self, time):
        """Probabilities, means and covariances at a later time, and those of all models."""
        tracker, dt = self.tracker, time - self.time
        n, n_axes = len(tracker.models), self.plot.size
        a0, tau0 = self.units()
        chances = MarkovChain.of(tracker.rates).transitions(dt / tau0)
        c = self.p @ chances
        share = chances * self.p[:, None] / c  # from i to j
        means, covariances = [], []
        for j, model in enumerate(tracker.models):
            mean = sum(share[i, j] * self.means[i] for i in range(n))
            p = np.zeros((3, 3))
            for i in range(n):
                apart = self.means[i] - mean
                p += share[i, j] * (self.covariances[i] + apart @ apart.T / n_axes)
            still, kept = model.retention == 0, math.isinf(model.retention)
            x = 0.0 if still or kept else dt / (model.retention * tau0)
            phi = 0.0 if still else 1 / (1 + x + x**2 / 2)
            move = np.array([[1, dt, phi * dt**2 / 2], [0, 1, phi * dt], [0, 0, phi]])
            push = np.array([dt**2 / 2, dt, 0.0 if still else 1.0])
            q = (model.noise * a0) ** 2 * (1.0 if kept else 1 - phi**2)
            q /= 1 + dt / (tracker.gap * tau0)
            means.append(move @ mean)
            covariances.append(move @ p @ move.T + q * np.outer(push, push))
        x = sum(c[j] * means[j] for j in range(n))
        spread = sum(
            c[j] * (covariances[j][0, 0] + np.mean((means[j][0] - x[0]) ** 2)) for j in range(n)
        )
        return c, means, covariances, x, spread

    def coast(self, time):
        """Take a step without a plot."""
        self.p, self.means, self.covariances, _, _ = self.predict(time)
        self.time = time

    def correct(self, time, plot, variance):
        """Take a later plot."""
        c, means, covariances, _, _ = self.predict(time)
        n_axes, freedom = plot.size, self.tracker.freedom
        logs = []
        for j in range(len(c)):
            s = covariances[j][0, 0] + variance
            e = plot - means[j][0]
            k = covariances[j][:, 0] / s
            rest = np.eye(3) - np.outer(k, [1, 0, 0])
            means[j] = means[j] + np.outer(k, e)
            covariances[j] = rest @ covariances[j] @ rest.T + variance * np.outer(k, k)
            d = e @ e / s
            far = d / 2 if math.isinf(freedom) else (freedom + n_axes) / 2 * np.log1p(d / freedom)
            logs.append(-n_axes / 2 * math.log(s) - far)
        likelihoods = np.exp(np.array(logs) - max(logs))
        p = c * likelihoods / (c @ likelihoods) + 1e-7
        self.p, self.means, self.covariances = p / p.sum(), means, covariances
        self.intervals.append(time - self.seen)
        self.time = self.seen = time


@pytest.mark.parametrize("n_axes", [1, 2, 3])
@pytest.mark.parametrize("name", TRACKERS)
def test_it_is_the_textbook_cycle(name, n_axes):
    tracker = TRACKERS[name]
    times, z, sigma = plots(n_axes, n_axes)
    variance = (sigma**2).mean(axis=1)
    if tracker.sigma_w is not None:
        variance = np.full(len(times), tracker.sigma_w**2)
    result = tracker.run(times, z, sigma)
    book = Textbook(tracker, times[0], z[0], variance[0])
    state = tracker.start(z[0], times[0], sigma[0])
    far, history = np.abs(z).max(), []
    for k in range(1, len(times)):
        if k == 1:
            book.start(times[1], z[1], variance[1])
        else:
            _, _, _, expected, spread = book.predict(times[k])
            assert result.predicted[k] == pytest.approx(expected[0], abs=1e-9 * far)
            found = tracker.predict(state, times[k], 3.0)
            assert found.position_variance == pytest.approx([spread] * n_axes, rel=1e-8)
            assert found.velocity == pytest.approx(expected[1], abs=1e-8 * far)
            assert found.acceleration == pytest.approx(expected[2], abs=1e-8 * far)
            book.correct(times[k], z[k], variance[k])
        state = tracker.step(state, z[k], times[k], sigma[k])
        mean = sum(p * m for p, m in zip(book.p, book.means, strict=True))
        for row, array in zip(mean, (result.filtered, result.velocity, result.acceleration),
                              strict=True):  # fmt: skip
            assert array[k] == pytest.approx(row, abs=1e-8 * far)
        history.append(tracker.probabilities(state))
        assert history[-1] == pytest.approx(book.p, abs=1e-7)
    # The models have differed, or all of this would be about one filter.
    assert np.ptp(history, axis=0).max() > 0.5 or len(tracker.models) == 1


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("name", TRACKERS)
def test_missed_plots(name, missed):
    tracker = replace(TRACKERS[name], missed=missed)
    times, z, sigma = plots(12, 2)
    sigma[:] = 4.0
    z[[5, 13, 14, 15, 22], [0, 1, 1, 1, 0]] = np.nan
    gone = np.isnan(z).any(axis=1)
    book = Textbook(tracker, times[0], z[0], 16.0)
    book.start(times[1], z[1], 16.0)
    result = tracker.run(times, z, sigma)
    for k in range(2, len(times)):
        _, _, _, expected, _ = book.predict(times[k])
        assert result.predicted[k] == pytest.approx(expected[0], abs=1e-6)
        if gone[k]:
            assert result.velocity[k] == pytest.approx(expected[1], abs=1e-6)
            if missed == "step":
                book.coast(times[k])
        else:
            book.correct(times[k], z[k], 16.0)
    assert tracker.probabilities(result.state) == pytest.approx(book.p, abs=1e-7)


def test_a_single_straight_model_is_the_kalman_filter():
    times, z, sigma = plots(7, 2)
    sigma[:, 1] = sigma[:, 0]
    single = InteractingModels((MotionModel(0.6),), ((0.0,),), (1.0,), level=2.5)
    ours = single.run(times, z, sigma)
    kalman = AlphaBetaTracker(KalmanCV(0.5))
    theirs = kalman.run(times, z, sigma)
    for name in ("predicted", "filtered", "velocity", "innovation"):
        assert getattr(ours, name) == pytest.approx(getattr(theirs, name), abs=1e-7, nan_ok=True)
    for name in ("alpha", "beta"):
        expected = getattr(theirs.gains, name)
        assert getattr(ours.gains, name) == pytest.approx(expected, rel=1e-9, nan_ok=True)
    found, expected = (
        tracker.predict(state, times[-1] + 4.0, 2.0).innovation_variance
        for tracker, state in ((single, ours.state), (kalman, theirs.state))
    )
    assert found == pytest.approx(expected, rel=1e-9)


# ---------------------------------------------------------------- published numbers

TIMES = (0, 2, 4, 5, 9, 10.5, 11, 11.25, 14, 20, 21, 22, 24, 26, 27, 28, 33, 34, 36, 38)
PLOTS = (
    (-25, -5), (30, 12), (30, -16), (75, -40), (95, -31), (90, -57), (130, -34), (112.5, -55),
    (105, -29.75), (231.2, -85), (227.05, -64), (223.8, -88), (295, -116), (319.8, -101.5),
    (371.05, -123), (373.2, -102), (477.45, -142), (540, -121), (577.8, -149), (619.2, -132),
)  # fmt: skip
SIGMAS = {9: 35.0, 14: 10.0}

# Predicted x and y, and the variance S of the innovation.
THREE_MODELS = """
85.000000 29.000000 2400.0050    52.916569 -11.250097 983.3389    134.491644 -56.849161 2384.8176
136.747709 -52.222709 1291.4082  109.643075 -58.371806 711.6255   121.403575 -48.808362 585.8030
148.968437 -63.601617 332.9014   165.362284 -53.184461 632.1602   198.941607 -67.858978 574.5156
218.196642 -69.866657 552.0193   241.334810 -81.732839 565.0753   285.918106 -102.821255 703.5258
319.022479 -110.121838 706.2051  364.362701 -123.817143 635.5221  486.831096 -148.376140 1087.6151
505.894642 -150.546232 734.8084  577.145200 -145.371009 728.9789  635.749098 -155.507508 731.0704
"""
TWO_MODELS = """
85.000000 29.000000 2400.0298    52.916130 -11.250450 983.3530    134.490972 -56.853467 2385.1557
136.742361 -52.223678 1291.6327  109.637667 -58.372651 711.6578   121.400549 -48.808269 585.8155
148.959778 -63.602897 332.7817   165.453751 -53.274554 623.3502   198.652476 -67.731002 568.9436
217.679458 -69.731546 542.8396   240.767589 -81.459645 550.1186   281.051443 -100.166047 593.8667
309.266754 -106.407397 598.0270  348.670200 -118.419156 591.7590  458.544448 -142.582025 884.6919
492.386534 -148.462574 673.6919  564.412016 -146.748270 668.1776  626.442028 -157.256201 666.8766
"""


@pytest.mark.parametrize(
    ("tracker", "numbers"),
    [(three_model_imm(level=0.9), THREE_MODELS), (two_model_imm(level=0.9), TWO_MODELS)],
    ids=["three", "two"],
)
def test_numbers_of_another_program(tracker, numbers):
    expected = np.array(numbers.split(), dtype=float).reshape(-1, 3)
    # There, the probabilities after a plot add up to 1 + 1e-7 for each model.
    expected[1:] /= 1 + 1e-7 * len(tracker.models)
    sigmas = [SIGMAS.get(t, 20.0) for t in TIMES]
    state = tracker.start(PLOTS[0], TIMES[0], sigmas[0])
    for k in range(1, len(TIMES)):
        if k > 1:
            found = tracker.predict(state, TIMES[k], sigmas[k])
            assert found.position == pytest.approx(expected[k - 2, :2], abs=1e-6)
            assert found.innovation_variance == pytest.approx([expected[k - 2, 2]] * 2, abs=1e-4)
        state = tracker.step(state, PLOTS[k], TIMES[k], sigmas[k])


# ---------------------------------------------------------------- behavior


@pytest.mark.parametrize("level", [None, 0.7])
def test_units_do_not_matter(level):
    """The same in other units of length and time, and at another place."""
    times, z, sigma = plots(8, 2)
    tracker = three_model_imm(level=level)
    scaled = three_model_imm(level=None if level is None else level * 1e3 / 60**2)
    one = tracker.run(times, z, sigma)
    other = scaled.run(60 * times + 1e5, 1e3 * z + 5e4, 1e3 * sigma)
    assert (other.predicted - 5e4) / 1e3 == pytest.approx(one.predicted, abs=1e-6, nan_ok=True)
    assert scaled.probabilities(other.state) == pytest.approx(
        tracker.probabilities(one.state), abs=1e-6
    )


def test_a_maneuver_is_noticed_and_forgotten():
    t = np.arange(80.0)
    x = np.cumsum(np.cumsum(np.where((t > 30) & (t <= 45), 2.0, 0.0))) + 5 * t
    z = np.stack([x, -0.4 * x], axis=1) + np.random.default_rng(8).normal(0.0, 1.0, (80, 2))
    for tracker in (two_model_imm(level=3.0), three_model_imm(level=3.0)):
        state, history = tracker.start(z[0], t[0], 1.0), []
        for k in range(1, 80):
            state = tracker.step(state, z[k], t[k], 1.0)
            history.append(tracker.probabilities(state)[0])
        assert np.mean(history[9:29]) > 0.6
        assert np.mean(history[33:45]) < 0.2
        assert np.mean(history[62:]) > 0.6


def test_students_distribution_is_not_misled_by_an_outlier():
    t, z = np.arange(30.0), np.random.default_rng(1).normal(0.0, 1.0, (30, 2))
    z[20] = 12.0, -9.0
    gaussian, student = (three_model_imm(3.0, freedom=f) for f in (math.inf, 4.0))
    off = [np.abs(tracker.run(t, z, 1.0).predicted[21:26]).max() for tracker in (gaussian, student)]
    assert off[1] < 0.7 * off[0]


@pytest.mark.untraced
def test_single_precision():
    times, z, sigma = plots(9, 2)
    tracker = two_model_imm()
    exact = tracker.run(times, z, sigma).filtered
    found = tracker.run(times, z, sigma, dtype=np.float32).filtered
    assert found.dtype == np.float32
    assert 0.0 < np.abs(found - exact).max() < 0.02


# ---------------------------------------------------------------- edges

FAR_APART = st.floats(-3.0, 4.0).map(lambda power: 10.0**power)


@settings(max_examples=60)
@given(
    name=st.sampled_from(sorted(TRACKERS)),
    steps=st.lists(
        st.tuples(
            FAR_APART,
            st.one_of(st.floats(-1e3, 1e3), st.floats(-1e100, 1e100), st.just(math.nan)),
            st.floats(0.1, 10.0),
        ),
        min_size=3,
        max_size=25,
    ),
)
def test_it_stays_finite(name, steps):
    tracker = TRACKERS[name]
    times = np.cumsum([dt for dt, _, _ in steps])
    z = np.array([(z, 0.5 * z) for _, z, _ in steps])
    sigma = np.array([(s, 2.0 * s) for _, _, s in steps])
    result = tracker.run(times, z, sigma)
    rows = result.state.rows
    assert np.isfinite(result.state.lanes[rows.memory : rows.state]).all()
    probabilities = tracker.probabilities(result.state)
    assert probabilities.sum() == pytest.approx(1.0, abs=1e-9)
    assert (probabilities >= 0.0).all()
    if (~np.isnan(z[:, 0])).sum() >= 2:
        later = tracker.predict(result.state, times[-1] + 1.0, 1.0)
        assert np.isfinite(later.position).all()
        assert (later.position_variance >= 0.0).all()


def test_shapes_of_probabilities():
    tracker = three_model_imm()
    for shape in ((), (1,), (3,), (4, 3), (2, 4, 3), (0, 3)):
        state = tracker.run([0.0], np.zeros((1, *shape)), 1.0).state
        found = tracker.probabilities(state)
        assert found.shape == (*shape[:-1], 3)
        assert (found == [0.99, 0.005, 0.005]).all()
        # What is returned is no part of the state.
        found[...] = 7.0
        assert (tracker.probabilities(state) < 1.0).all()


def test_batches_keep_their_order():
    times, z, sigma = plots(9, 6)
    batch = z.reshape(-1, 3, 2)
    tracker = three_model_imm(2.0)
    state = tracker.run(times, batch, sigma.reshape(-1, 3, 2)).state
    later = tracker.predict(state, times[-1] + 1.0).position_variance
    for track in range(3):
        part = slice(2 * track, 2 * track + 2)
        alone = tracker.run(times, z[:, part], sigma[:, part]).state
        assert (tracker.probabilities(state)[track] == tracker.probabilities(alone)).all()
        expected = tracker.predict(alone, times[-1] + 1.0).position_variance
        assert later[track] == pytest.approx(expected, rel=1e-12)


def test_states_of_others_are_refused():
    alien = InteractingPair(0.1, 1.0, sigma_w=1.0).run([0.0], [[0.0, 0.0]]).state
    with pytest.raises(ValueError, match=r"state: it comes from InteractingPair\("):
        two_model_imm().probabilities(alien)


# ---------------------------------------------------------------- words

PAIR = {
    "models": (STRAIGHT, DECAYING),
    "rates": ((0.0, 0.1), (0.2, 0.0)),
    "start_probabilities": (0.9, 0.1),
}
FREEDOM = "freedom must be an even number from 2 to 1000, or infinity for a Gaussian"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"models": ()}, "models: at least one is needed"),
        ({"rates": ((0.0, 0.1),)}, "rates must be a row for each of 2 models, with 2 numbers each, "
         "got shape (1, 2)"),
        ({"rates": ((0.0, -0.1), (0.2, 0.0))}, "rates must be finite and >= 0, got -0.1 at index "
         "(0, 1)"),
        ({"rates": ((0.3, 0.1), (0.2, 0.0))}, "rates must be 0 on the diagonal: no model changes "
         "into itself"),
        ({"start_probabilities": (1.0,)}, "start_probabilities must be one for each of 2 models, "
         "got shape (1,)"),
        ({"start_probabilities": (0.5, 0.4)}, "start_probabilities must add up to 1, got 0.9"),
        ({"start_probabilities": (1.5, -0.5)}, "start_probabilities must be finite and >= 0, got "
         "-0.5 at index 1"),
        ({"level": 0.0}, "level must be finite and > 0, got 0"),
        ({"gap": 0.0}, "gap must be > 0, or infinity, got 0"),
        ({"gap": math.nan}, "gap must be > 0, or infinity, got nan"),
        ({"start_acceleration": -1.0}, "start_acceleration must be finite and >= 0, got -1"),
        ({"freedom": 5}, f"{FREEDOM}, got 5"),
        ({"freedom": 0}, f"{FREEDOM}, got 0"),
        ({"freedom": 1002}, f"{FREEDOM}, got 1002"),
        ({"sigma_w": -2.0}, "sigma_w must be finite and > 0, got -2"),
        ({"missed": "never"}, "missed: unknown 'never'; one of elapsed, step"),
    ],
)  # fmt: skip
def test_parameters_are_checked(change, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        InteractingModels(**{**PAIR, **change})


def test_models_are_checked():
    with pytest.raises(ValueError, match="noise must be finite and >= 0, got -1"):
        MotionModel(-1.0)
    with pytest.raises(ValueError, match="retention must be >= 0, or infinity, got -2"):
        MotionModel(1.0, -2.0)
    with pytest.raises(TypeError, match=r"models\[1\] must be a MotionModel, got float"):
        InteractingModels((STRAIGHT, 1.0), PAIR["rates"], (0.9, 0.1))


def test_plots_need_a_sigma_unless_there_is_one():
    with pytest.raises(ValueError, match="InteractingModels needs the standard deviation"):
        two_model_imm().run([0.0], [0.0])
    two_model_imm(sigma_w=1.0).run([0.0], [0.0])


def test_by_name():
    assert make_tracker("imm-three:level=5") == three_model_imm(5.0)
    assert make_tracker("imm-two:level=5:retention=8:freedom=inf") == two_model_imm(
        5.0, retention=8.0, freedom=math.inf
    )
    with pytest.raises(ValueError, match="tracker 'imm-two:level=0': level must be finite and > 0"):
        make_tracker("imm-two:level=0")
