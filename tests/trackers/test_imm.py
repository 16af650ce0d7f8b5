import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import KalmanCA, KalmanCV
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.imm import InteractingPair
from fuzzytrack.trackers.runners import runner

# One whole-track tracker for all checks that need it compiled.
JOINT = InteractingPair(0.2, 3.0, sigma_w=10.0)


def plots(seed, n_axes, steps=60):
    """Irregular times, a maneuver, misses (also at both ends of the start), noise by plot."""
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.3, 3.0, steps))
    sigma = random.uniform(0.5, 8.0, (steps, n_axes))
    bend = np.where(times > times[steps // 2], (times - times[steps // 2]) ** 2, 0.0)
    z = times[:, None] * random.normal(0.0, 9.0, n_axes) + np.outer(bend, np.arange(1, n_axes + 1))
    z += sigma * random.normal(size=z.shape)
    z[random.random(steps) < 0.2] = np.nan
    z[[0, 2, 3]] = np.nan
    z[[1, 4]] = 5.0
    return times, z, sigma


def textbook(tracker, times, z, sigma):
    """The cycle of section 11.6.6, in matrices over one state of all axes, (x, v, a) by axis.

    Between axes nothing is kept of the covariance, and a probability is at least 1e-12. A missed
    plot leaves no trace if time counts from the last plot: probabilities are then those after it.
    """
    n_axes = z.shape[1]
    order = 3 * n_axes
    chain = np.array(
        [
            [tracker.quiet_stay, 1 - tracker.quiet_stay],
            [1 - tracker.maneuver_stay, tracker.maneuver_stay],
        ]
    )
    mu = np.linalg.matrix_power(chain, 4096)[0]
    h = np.kron(np.eye(n_axes), [1.0, 0.0, 0.0])
    same_axis = np.kron(np.eye(n_axes), np.ones((3, 3)))
    accelerates = [False, tracker.maneuver == "ca"]
    sigmas = [tracker.quiet_sigma, tracker.maneuver_sigma]
    start_acceleration = [0.0, tracker.maneuver_sigma**2 * accelerates[1]]
    x = p = None
    count, last, now = 0, 0.0, None
    history = {name: [] for name in ("predicted", "filtered", "velocity", "acceleration", "mu")}
    history["variance"] = []
    for k in range(len(times)):
        dt = times[k] - now if count else 1.0
        before = x and list(x), p and list(p), mu
        seen = not np.isnan(z[k]).any()
        r = np.diag(sigma[k] ** 2)
        predicted = np.full(n_axes, np.nan)
        if count:
            if count == 2:
                c = mu @ chain
                share = chain * mu[:, None] / c  # from i to j
                means = [sum(share[i, j] * x[i] for i in (0, 1)) for j in (0, 1)]
                p = [
                    same_axis
                    * sum(
                        share[i, j] * (p[i] + np.outer(x[i] - means[j], x[i] - means[j]))
                        for i in (0, 1)
                    )
                    for j in (0, 1)
                ]
                x, mu = means, c
            for j in (0, 1):
                f = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])
                push = np.array([dt * dt / 2, dt, 1.0])
                if not accelerates[j]:
                    f[:, 2] = push[2] = 0.0
                f = np.kron(np.eye(n_axes), f)
                x[j] = f @ x[j]
                p[j] = f @ p[j] @ f.T
                p[j] += np.kron(np.eye(n_axes), np.outer(push, push)) * sigmas[j] ** 2
            if count == 2:
                predicted = h @ (mu[0] * x[0] + mu[1] * x[1])
        if seen and count == 0:
            x = [h.T @ z[k]] * 2
            p = [
                h.T @ r @ h + np.kron(np.eye(n_axes), np.diag([0, 0, a]))
                for a in start_acceleration
            ]
        elif seen:
            logs = []
            for j in (0, 1):
                s = h @ p[j] @ h.T + r
                e = z[k] - h @ x[j]
                gain = p[j] @ h.T @ np.linalg.inv(s)
                if count == 1:
                    gain = np.kron(np.eye(n_axes), [[1.0], [1 / (times[k] - last)], [0.0]])
                rest = np.eye(order) - gain @ h
                x[j] = x[j] + gain @ e
                p[j] = rest @ p[j] @ rest.T + gain @ r @ gain.T
                determinant = np.linalg.det(2 * math.pi * s)
                logs.append(-0.5 * (e @ np.linalg.solve(s, e) + math.log(determinant)))
            if count == 2:
                likelihoods = np.exp(np.array(logs) - max(logs))
                mu = np.clip(mu * likelihoods / (mu @ likelihoods), 1e-12, 1 - 1e-12)
        if seen:
            count, last = min(count + 1, 2), times[k]
        mean = np.full(order, np.nan) if x is None else mu[0] * x[0] + mu[1] * x[1]
        history["predicted"].append(predicted)
        history["filtered"].append(mean[0::3])
        history["velocity"].append(np.nan_to_num(mean[1::3]))
        history["acceleration"].append(np.nan_to_num(mean[2::3]))
        total = np.full((order, order), np.nan)
        # Coasted with an unknown velocity, a position has no variance.
        if x is not None and (seen or count == 2):
            apart = [x[j] - mean for j in (0, 1)]
            total = sum(mu[j] * (p[j] + np.outer(apart[j], apart[j])) for j in (0, 1))
        history["variance"].append(np.diag(total)[0::3])
        if seen or tracker.missed == "step":
            now = times[k]
        else:
            x, p, mu = before
        history["mu"].append(mu[1])
    return {name: np.array(values) for name, values in history.items()}


def streamed(tracker, times, z, sigma):
    """Probability of a maneuver and variance of the position after every step."""
    states = [tracker.start(z[0], times[0], sigma[0])]
    for k in range(1, len(times)):
        states.append(tracker.step(states[-1], z[k], times[k], sigma[k]))
    probabilities = np.array([tracker.maneuver_probability(state) for state in states])
    return probabilities, np.array([tracker.position_variance(state) for state in states])


def assert_textbook(tracker, times, z, sigma, part=slice(None)):
    expected = textbook(tracker, times, z[:, part], sigma[:, part])
    result = tracker.run(times, z, sigma)
    for name in ("predicted", "filtered", "velocity", "acceleration"):
        ours = getattr(result, name)[:, part]
        scale = np.nanmax(np.abs(expected[name]))
        assert ours == pytest.approx(expected[name], rel=1e-9, abs=1e-9 * scale, nan_ok=True), name
    probabilities, variances = streamed(tracker, times, z, sigma)
    probabilities = probabilities if tracker.joint else probabilities[:, part][:, 0]
    assert probabilities == pytest.approx(expected["mu"], rel=1e-9, abs=2e-12)
    assert variances[:, part] == pytest.approx(expected["variance"], rel=1e-9, nan_ok=True)
    # The models have differed, or all of this would be about one filter.
    assert np.ptp(probabilities) > 0.5


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("n_axes", [1, 2, 3])
@pytest.mark.parametrize("maneuver", ["ca", "cv"])
def test_joint_axes_are_the_textbook_cycle(maneuver, n_axes, missed):
    tracker = InteractingPair(0.1, 2.0, 0.93, 0.88, maneuver=maneuver, missed=missed)
    assert_textbook(tracker, *plots(n_axes, n_axes))


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("maneuver", ["ca", "cv"])
def test_each_axis_by_itself_is_the_textbook_cycle(maneuver, missed):
    tracker = InteractingPair(0.1, 2.0, 0.93, 0.88, maneuver=maneuver, joint=False, missed=missed)
    for axis in (0, 1):
        assert_textbook(tracker, *plots(4, 2), slice(axis, axis + 1))


@pytest.mark.parametrize("velocity_sigma", [None, 9.0])
@pytest.mark.parametrize(
    ("tracker", "scheduler"),
    [
        (InteractingPair(0.7, 0.7, maneuver="cv"), KalmanCV(0.7)),
        (InteractingPair(0.7, 5.0, 1.0, 1.0, maneuver_start=0.0), KalmanCV(0.7)),
        (InteractingPair(0.1, 0.7, 1.0, 1.0, maneuver_start=1.0), KalmanCA(0.7, 0.7)),
        (InteractingPair(0.1, 0.7, 0.4, 1.0, maneuver_start=1.0), KalmanCA(0.7, 0.7)),
    ],
    ids=["equal models", "quiet for ever", "maneuvering for ever", "no way back"],
)
def test_where_one_model_is_all_it_is_the_kalman_filter(tracker, scheduler, velocity_sigma):
    times, z, sigma = plots(6, 2)
    start = "two-point" if velocity_sigma is None else "one-point"
    other = {"velocity_sigma": velocity_sigma}
    ours = replace(tracker, **other).run(times, z, sigma)
    theirs = AlphaBetaTracker(replace(scheduler, **other), start).run(times, z, sigma)
    for name in ("predicted", "filtered", "velocity", "acceleration", "innovation"):
        expected = getattr(theirs, name)
        scale = np.nanmax(np.abs(expected)) or 1.0
        assert getattr(ours, name) == pytest.approx(
            expected, rel=1e-12, abs=1e-12 * scale, nan_ok=True
        )
    for name in ("alpha", "beta", "gamma"):
        # Sigma differs between the axes, and joint gains are those of the axes in the mean.
        expected = getattr(theirs.gains, name).mean(axis=1)
        for axis in (0, 1):
            ours_of_axis = getattr(ours.gains, name)[:, axis]
            assert ours_of_axis == pytest.approx(expected, rel=1e-11, nan_ok=True)


def test_one_axis_is_the_same_joint_or_not():
    times, z, sigma = plots(7, 1)
    joint = InteractingPair(0.1, 2.0).run(times, z, sigma)
    alone = InteractingPair(0.1, 2.0, joint=False).run(times, z[:, 0], sigma[:, 0])
    assert np.array_equal(joint.filtered[:, 0], alone.filtered, equal_nan=True)


def test_a_maneuver_is_noticed_and_forgotten():
    t = np.arange(80.0)
    acceleration = np.where((t > 30) & (t <= 45), 2.0, 0.0)
    x = np.cumsum(np.cumsum(acceleration)) + 5 * t
    z = x + np.random.default_rng(8).normal(0.0, 1.0, 80)
    for maneuver, sigma in (("ca", 0.5), ("cv", 1.5)):
        tracker = InteractingPair(0.02, sigma, maneuver=maneuver, sigma_w=1.0)
        probabilities, _ = streamed(tracker, t, z[:, None], np.ones((80, 1)))
        assert probabilities[32:46].mean() > 0.7
        assert probabilities[60:].mean() < 0.25
        assert probabilities[10:30].mean() < 0.25


# ---------------------------------------------------------------- edges


def numbers(result):
    rows = result.state.rows
    return result.state.lanes[rows.memory : rows.state]


@pytest.mark.parametrize("maneuver", ["ca", "cv"])
@pytest.mark.parametrize("size", [1e9, -1e9, 1e60])
@pytest.mark.parametrize("sigma", [1e-6, 1.0, 1e5])
def test_no_innovation_is_too_large(maneuver, size, sigma):
    tracker = InteractingPair(0.1, 1.0, maneuver=maneuver, sigma_w=sigma)
    z = np.zeros((60, 2))
    z[10:13] = size
    result = tracker.run(np.arange(60.0), z)
    assert np.isfinite(numbers(result)).all()
    assert np.isfinite(result.filtered).all()
    if sigma < abs(size):
        assert np.abs(result.filtered[-1]).max() < 0.2 * abs(size)


def test_models_come_back():
    # Static models, of which the second never fits until it is the only one that does.
    tracker = InteractingPair(0.01, 5.0, 1.0, 1.0, maneuver="cv", sigma_w=1.0)
    z = np.zeros(3000)
    z[2000:] = np.cumsum(np.cumsum(5.0 * np.random.default_rng(3).normal(size=1000)))
    t = np.arange(3000.0)
    quiet, moved = tracker.run(t[:2000], z[:2000]), tracker.run(t, z)
    assert tracker.maneuver_probability(quiet.state) == pytest.approx(1e-12, rel=1e-9)
    assert tracker.maneuver_probability(moved.state) == pytest.approx(1.0, abs=2e-12)


def test_a_long_gap():
    for maneuver in ("ca", "cv"):
        tracker = InteractingPair(0.1, 1.0, maneuver=maneuver, sigma_w=1e-3)
        t = np.concatenate([np.arange(20.0), 1e7 + np.arange(20.0)])
        z = np.concatenate([np.zeros(20), np.full(20, 50.0)])
        result = tracker.run(t, z)
        assert result.filtered[20:] == pytest.approx(np.full(20, 50.0), abs=1.0)
        assert np.isfinite(numbers(result)).all()
        assert (tracker.position_variance(result.state) >= 0).all()


def test_before_the_start():
    tracker = InteractingPair(0.1, 1.0, 0.9, 0.8, sigma_w=2.0)
    state = tracker.start([np.nan, 1.0], 0.0)
    assert np.isnan(tracker.position_variance(state)).all()
    assert tracker.maneuver_probability(state) == pytest.approx(1 / 3)
    state = tracker.step(state, [3.0, 1.0], 1.0)
    assert tracker.position_variance(state).tolist() == [4.0, 4.0]
    # Nothing is known of a velocity that moves the track until the second plot.
    coasted = tracker.step(state, [np.nan, np.nan], 10.0)
    assert np.isnan(tracker.position_variance(coasted)).all()
    assert np.isnan(state.predicted).all()
    state = tracker.step(state, [5.0, 2.0], 3.0)
    assert state.velocity.tolist() == [1.0, 0.5]
    assert np.isnan(state.predicted).all()
    # A gate: the prediction to the time of the next plot.
    gate = tracker.step(state, [np.nan, np.nan], 4.0)
    after = tracker.step(state, [7.0, 2.5], 4.0)
    assert gate.position.tolist() == after.predicted.tolist() == [6.0, 2.5]
    assert (tracker.position_variance(gate) > tracker.position_variance(after)).all()


def predicted_by_chance(tracker, state, dt, count, seed):
    """Positions after `dt` of targets drawn from a state of one axis, model by model."""
    random = np.random.default_rng(seed)
    memory = state.lanes[state.rows.memory : state.rows.state, 0]
    stays = (tracker.quiet_stay, tracker.maneuver_stay)
    noises = (tracker.quiet_sigma, tracker.maneuver_sigma)
    positions = []
    for before in (0, 1):
        x, v, a, p11, p12, p13, p22, p23, p33 = memory[2 + 9 * before :][:9]
        covariance = [[p11, p12, p13], [p12, p22, p23], [p13, p23, p33]]
        many = round(memory[before] * count)
        drawn = random.multivariate_normal([x, v, a], covariance, many)
        now = np.where(random.random(many) < stays[before], before, 1 - before)
        pushed = random.normal(size=many) * np.take(noises, now)
        # The quiet model knows no acceleration but what its noise pushes with.
        pushed += np.where(now == 1, drawn[:, 2], 0.0)
        positions.append(drawn[:, 0] + dt * drawn[:, 1] + dt**2 / 2 * pushed)
    return np.concatenate(positions)


@pytest.mark.parametrize("dt", [0.5, 4.0])
def test_the_variance_of_a_prediction_by_chance(dt):
    tracker = InteractingPair(0.2, 1.5, 0.8, 0.6, acceleration_sigma=3.0)
    z = [0.0, 9.0, 21.0, 28.0, 44.0, 60.0, 71.0]
    state = tracker.run([0.0, 1.0, 2.5, 3.0, 4.0, 5.5, 6.0], z, 2.0).state
    assert 0.05 < tracker.maneuver_probability(state) < 0.95
    found = tracker.predict(state, 6.0 + dt, sigma=1.5)
    drawn = predicted_by_chance(tracker, state, dt, 400_000, 1)
    assert found.position == pytest.approx(drawn.mean(), abs=4 * drawn.std() / 600)
    assert found.position_variance == pytest.approx(drawn.var(), rel=0.02)
    assert found.innovation_variance == found.position_variance + 1.5**2


@pytest.mark.parametrize("maneuver", ["ca", "cv"])
@pytest.mark.parametrize("joint", [True, False])
@pytest.mark.parametrize("missed", ["elapsed", "step"])
def test_the_variance_of_a_prediction_is_that_after_missed_plots(maneuver, joint, missed):
    tracker = InteractingPair(0.1, 2.0, maneuver=maneuver, joint=joint, missed=missed)
    random = np.random.default_rng(8)
    z, sigma = random.normal(size=(12, 4, 2)) * 5, random.uniform(1.0, 4.0, (12, 4, 2))
    z[[4, 7, 7], [1, 2, 3], [0, 1, 0]] = np.nan
    z[:11, 3, 1] = np.nan
    t = np.cumsum(random.uniform(0.5, 2.0, (12, 4)), axis=0)
    state = tracker.run(t, z, sigma).state
    for later in (0.25, [0.25, 1.0, 5.0, 60.0]):
        found = tracker.predict(state, t[-1] + later, 2.0)
        coasted = tracker.step(state, np.full((4, 2), np.nan), t[-1] + later, 1.0)
        known = np.isfinite(found.position_variance)
        # One axis of the last track has one plot, or for a joint tracker the whole track has.
        assert known.tolist() == [[True] * 2] * 3 + [[not joint, False]]
        expected = tracker.position_variance(coasted)
        np.testing.assert_allclose(found.position_variance[known], expected[known], rtol=1e-12)
        assert (found.position_variance[known] > tracker.position_variance(state)[known]).all()


def test_shapes_of_probability_and_variance():
    alone = InteractingPair(0.1, 1.0, joint=False, sigma_w=1.0)
    for shape in ((), (1,), (3,), (4, 3), (2, 4, 3), (0, 3)):
        z = np.zeros((1, *shape))
        state = JOINT.run([0.0], z).state
        assert JOINT.maneuver_probability(state).shape == shape[:-1]
        assert JOINT.position_variance(state).shape == shape
        state = alone.run([0.0], z).state
        assert alone.maneuver_probability(state).shape == shape
        assert alone.position_variance(state).shape == shape


def test_states_of_others_are_refused():
    alien = AlphaBetaTracker(KalmanCV(1.0, 1.0)).run([0.0], [[0.0, 0.0]]).state
    for ask in (JOINT.maneuver_probability, JOINT.position_variance):
        with pytest.raises(ValueError, match=r"state: it comes from AlphaBetaTracker\(KalmanCV"):
            ask(alien)


def test_batches_keep_their_order():
    times, z, sigma = plots(9, 6)
    batch = z.reshape(-1, 3, 2)
    tracker = InteractingPair(0.1, 2.0)
    state = tracker.run(times, batch, sigma.reshape(-1, 3, 2)).state
    for track in range(3):
        part = slice(2 * track, 2 * track + 2)
        alone = tracker.run(times, z[:, part], sigma[:, part]).state
        assert tracker.maneuver_probability(state)[track] == tracker.maneuver_probability(alone)
        assert np.array_equal(
            tracker.position_variance(state)[track], tracker.position_variance(alone)
        )


# ---------------------------------------------------------------- properties

positive = st.floats(0.01, 100.0)
probability = st.floats(0.0, 1.0)


@settings(max_examples=60)
@given(
    sigmas=st.tuples(positive, positive, positive),
    stays=st.tuples(probability, probability),
    maneuver=st.sampled_from(["ca", "cv"]),
    steps=st.lists(
        st.tuples(st.floats(0.1, 30.0), st.one_of(st.just(math.nan), st.floats(-1e9, 1e9))),
        min_size=1,
        max_size=25,
    ),
)
def test_probabilities_and_covariances(sigmas, stays, maneuver, steps):
    quiet, noisy, noise = sigmas
    tracker = InteractingPair(quiet, noisy, *stays, maneuver=maneuver, sigma_w=noise)
    times = np.cumsum([dt for dt, _ in steps])
    z = np.array([z for _, z in steps])
    memory = numbers(tracker.run(times, z))[:, 0]
    assert (memory[:2] >= 0).all()
    assert memory[:2].sum() == pytest.approx(1.0, abs=1e-12)
    # A plot far away puts the models far apart: rounding is relative to the square of that.
    rounding = 1e-6 + 1e-12 * (np.nanmax(np.abs(z), initial=0.0) / noise) ** 2
    for _, _, _, p11, p12, p13, p22, p23, p33 in memory[2:].reshape(2, 9):
        p = np.array([[p11, p12, p13], [p12, p22, p23], [p13, p23, p33]])
        scale = np.sqrt(np.diag(p))
        assert (np.diag(p) >= 0).all()
        # Correlations: at most rounding keeps them from being those of a covariance.
        scale[scale == 0] = 1.0
        assert np.linalg.eigvalsh(p / np.outer(scale, scale)).min() > -rounding


# ---------------------------------------------------------------- words


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"quiet_sigma": -1.0}, "quiet_sigma must be finite and >= 0, got -1"),
        ({"maneuver_sigma": 0.0}, "maneuver_sigma must be finite and > 0, got 0"),
        ({"maneuver_sigma": math.nan}, "maneuver_sigma must be finite and > 0, got nan"),
        ({"quiet_stay": 1.1}, "quiet_stay must be a probability, 0 to 1, got 1.1"),
        ({"maneuver_stay": math.nan}, "maneuver_stay must be a probability, 0 to 1, got nan"),
        ({"maneuver_start": -0.1}, "maneuver_start must be a probability, 0 to 1, got -0.1"),
        ({"sigma_w": 0.0}, "sigma_w must be finite and > 0, got 0"),
        ({"velocity_sigma": 0.0}, "velocity_sigma must be finite and > 0, got 0"),
        ({"acceleration_sigma": -1.0}, "acceleration_sigma must be finite and >= 0, got -1"),
        ({"maneuver": "turn"}, "maneuver: unknown 'turn'; one of ca, cv"),
        ({"missed": "late"}, "missed: unknown 'late'; one of elapsed, step"),
        ({"maneuver": "cv", "acceleration_sigma": 1.0}, "acceleration_sigma: only a model 'ca'"),
        ({"quiet_sigma": [1.0, 2.0]}, "quiet_sigma must be one number"),
    ],
)
def test_parameters_are_checked(change, message):
    with pytest.raises(ValueError, match=message):
        InteractingPair(**{"quiet_sigma": 0.1, "maneuver_sigma": 1.0, **change})


def test_plots_need_a_sigma_unless_there_is_one():
    with pytest.raises(ValueError, match="InteractingPair needs the standard deviation"):
        InteractingPair(0.1, 1.0).run([0.0], [0.0])
    InteractingPair(0.1, 1.0, sigma_w=1.0).run([0.0], [0.0])


def test_by_name():
    made = make_tracker("imm:quiet_sigma=.1:maneuver_sigma=2:maneuver=cv:joint=no:sigma_w=3")
    assert made == InteractingPair(0.1, 2.0, maneuver="cv", joint=False, sigma_w=3.0)
    assert runner(made, 1) is runner(InteractingPair(0.1, 2, 0.95, 0.9, "cv", False, 3), 1)
