"""Rule bases that say the noise and the retention of a maneuver."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from maneuver_oracle import MANEUVER, TWO_RULES, say, track
from maneuver_vectors import FOUR_RULES, LEVEL, PLOTS, SIGMA, TIMES
from maneuver_vectors import TWO_RULES as TWO_RULES_VECTORS
from scipy.linalg import solve_discrete_are

import fuzzytrack as ft
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.schedulers import KalmanCA
from fuzzytrack.schedulers.catalog import make_scheduler

RULES = {"maneuver": MANEUVER, "maneuver-two-rules": TWO_RULES}


def follow(scheduler, t, z, sigma, two_point=True):
    """The recursion, plot by plot, with the kernel of a scheduler; as `track`."""
    n = z.shape[1]
    kernel, memory = scheduler.kernel(n), scheduler.initial_memory(n)
    rest, found = (0.0,) * n, []
    x, v, a, tau = z[0], np.zeros(n), np.zeros(n), math.inf
    *_, memory = kernel(rest, rest, 1.0, tuple(sigma[0].tolist()), memory)
    for k in range(1, len(t)):
        dt, deviation = float(t[k] - t[k - 1]), tuple(sigma[k].tolist())
        if two_point and k == 1:
            *_, tau, memory = kernel(rest, rest, dt, deviation, memory)
            x, v = z[1], (z[1] - z[0]) / dt
            continue
        variance = scheduler.prediction_variance(np.array(memory)[:, None], np.array([dt]))
        phi = 1 / (1 + dt / tau + (dt / tau) ** 2 / 2)
        a = phi * a
        x, v = x + v * dt + a * dt * dt / 2, v + a * dt
        e = z[k] - x
        alpha, beta, gamma, tau, memory = kernel(tuple(e.tolist()), rest, dt, deviation, memory)
        alpha, beta, gamma = map(np.array, (alpha, beta, gamma))
        predicted = x
        x, v, a = x + alpha * e, v + beta / dt * e, a + gamma / (2 * dt * dt) * e
        found.append({
            "alpha": alpha, "beta": beta, "gamma": gamma, "tau": tau, "predicted": predicted,
            "filtered": x, "gate": variance[..., 0] + (sigma[k] ** 2).mean(), "phi": phi,
        })  # fmt: skip
    return found


def scheduler(name="maneuver", **options):
    return ft.FuzzyScheduler(name, **options)


@pytest.mark.parametrize(
    ("name", "expected"), [("maneuver", FOUR_RULES), ("maneuver-two-rules", TWO_RULES_VECTORS)]
)
def test_published_vectors(name, expected):
    sigma = np.repeat(SIGMA[:, None], 2, axis=1)
    found = follow(scheduler(name, level=LEVEL), TIMES, PLOTS, sigma)
    columns = ("alpha", "beta", "gamma", "phi", "tau", "gate")
    rows = [[*(float(row[key]) for key in columns), *row["predicted"]] for row in found]
    assert np.array(rows) == pytest.approx(expected[:, 1:], rel=1e-9)


def record(n_axes, seed=4, plots=60):
    random = np.random.default_rng(seed)
    t = 100.0 + np.cumsum(random.lognormal(0.0, 1.0, plots))
    sigma = random.uniform(0.5, 3.0, (plots, n_axes))
    turn = np.stack([np.sin(0.1 * t + j) * 40 for j in range(n_axes)], axis=1)
    return t, turn + sigma * random.normal(size=turn.shape), sigma


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize("n_axes", [1, 2, 3])
@pytest.mark.parametrize(
    ("options", "two_point"),
    [
        ({"level": 1.5}, True),
        ({}, True),
        ({"level": 1.5}, False),
        ({}, False),
        ({"level": 1.5, "velocity_sigma": 6.0}, False),
    ],
)
def test_all_numbers_are_those_of_full_matrices(name, n_axes, options, two_point):
    t, z, sigma = record(n_axes)
    expected = track(RULES[name], t, z, sigma, two_point=two_point, **options)
    found = follow(scheduler(name, **options), t, z, sigma, two_point)
    assert len(found) == len(expected) == len(t) - (2 if two_point else 1)
    for row, want in zip(found, expected, strict=True):
        for key, value in want.items():
            same = np.broadcast_to(row[key], np.shape(value))
            assert same == pytest.approx(value, rel=1e-9, abs=1e-12), key


# ------------------------------------------------------------------ the covariance

CONSTANT = """
rulebase: 1
name: constant
inputs: {any: {universe: [0, 1, 11], sets: {whole: {trapmf: [0, 0, 1, 1]}}}}
outputs:
  retention: {universe: [1e-3, 1e12, 11], sets: {always: {singleton: [RETENTION]}}}
  noise: {universe: [1e-12, 10, 11], sets: {always: {singleton: [NOISE]}}}
operators: {and: product, or: sum, defuzzification: weighted-centers}
rules: [{if: {any: whole}, then: {noise: always, retention: always}}]
scheduler: {normalization: NORMALIZATION, gains: covariance, delay: DELAY, gap: GAP, start: 0.5}
"""


def constant(noise, retention, delay=0.0, gap=1e12, normalization="surprise", **options):
    """A scheduler with one rule, whose noise and retention are always the same."""
    text = CONSTANT.replace("NORMALIZATION", normalization)
    numbers = {"NOISE": noise, "RETENTION": retention, "DELAY": delay, "GAP": gap}
    for word, value in numbers.items():
        text = text.replace(word, repr(value))
    return ft.FuzzyScheduler(ft.loads_rulebase(text), **options)


@pytest.mark.parametrize("delay", [0.0, 1.5])
def test_constant_noise_and_sampling_settle_at_the_riccati_equation(delay):
    # With this level and sigma, a₀ is 2 m/s² and τ₀ 1.5 s.
    level, sigma, dt, noise, retention, gap = 6.0, 4.5, 0.75, 0.4, 3.0, 2.0
    tau, time = retention * 1.5, 1.5
    phi = 1 / (1 + dt / tau + (dt / tau) ** 2 / 2)
    f = np.array([[1, dt, phi * dt**2 / 2], [0, 1, phi * dt], [0, 0, phi]])
    d = dt + delay * time
    g = np.array([[d * d / 2, d, 1]])
    q = (1 - phi**2) / (1 + dt / (gap * time)) * (noise * 2.0) ** 2 * g.T @ g
    h = np.array([[1.0, 0.0, 0.0]])
    p = solve_discrete_are(f.T, h.T, q, [[sigma**2]])
    gain = p[:, 0] / (p[0, 0] + sigma**2)

    t, z = dt * np.arange(200.0), np.zeros((200, 2))
    made = constant(noise, retention, delay, gap, level=level)
    last = follow(made, t, z, np.full_like(z, sigma))[-1]
    gains = [float(last[key]) for key in ("alpha", "beta", "gamma")]
    assert gains == pytest.approx(gain * [1, dt, 2 * dt * dt], rel=1e-9)
    assert float(last["gate"]) == pytest.approx(p[0, 0] + sigma**2, rel=1e-9)


def test_without_noise_and_decay_it_is_the_kalman_filter_of_constant_acceleration():
    t, z, sigma = record(1)
    level = 1.5
    # The start of 0.5 is in units of a third of the level.
    kalman = KalmanCA(sigma_v=0.0, acceleration_sigma=0.25)
    memory = (2.0, *_two_points(t, sigma[:, 0], 0.25), 0.0)
    expected, kernel = [], kalman.kernel(1)
    for k in range(2, len(t)):
        alpha, beta, gamma, _, memory = kernel(
            0.0, 0.0, float(t[k] - t[k - 1]), float(sigma[k, 0]), memory
        )
        expected.append((alpha, beta, gamma))
    found = follow(constant(1e-9, 1e12, level=level), t, z, sigma)
    gains = [[float(row[key]) for key in ("alpha", "beta", "gamma")] for row in found]
    assert np.array(gains) == pytest.approx(np.array(expected), rel=1e-6, abs=1e-12)


def _two_points(t, sigma, acceleration):
    """Covariance after two plots: P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃."""
    dt = t[1] - t[0]
    r0, r1, q = sigma[0] ** 2, sigma[1] ** 2, acceleration**2
    return r1, r1 / dt, 0.0, (r0 + r1) / dt**2 + q * dt**2 / 4, q * dt / 2, q


@pytest.mark.parametrize("axes", ["shared", "own"])
def test_axes_that_are_scheduled_alone(axes):
    """With a normalization of single axes, each lane is a track of its own."""
    t, z, sigma = record(1)
    made = constant(0.4, 3.0, 1.0, 0.6, normalization="smoothed", level=1.5, axes=axes)
    assert not made.coupled
    kernel, memory = made.kernel(1), made.initial_memory(1)
    coupled = constant(0.4, 3.0, 1.0, 0.6, level=1.5)
    expected = follow(coupled, t, z, sigma)
    rest = 0.0
    *_, memory = kernel(rest, rest, 1.0, float(sigma[0, 0]), memory)
    *_, memory = kernel(rest, rest, float(t[1] - t[0]), float(sigma[1, 0]), memory)
    for k, row in enumerate(expected, start=2):
        dt = float(t[k] - t[k - 1])
        alpha, beta, gamma, tau, memory = kernel(1.0, rest, dt, float(sigma[k, 0]), memory)
        found = {"alpha": alpha, "beta": beta, "gamma": gamma, "tau": tau}
        assert found == pytest.approx({key: float(row[key]) for key in found}, rel=1e-12)


def test_a_missed_plot_lets_the_covariance_grow_and_keeps_the_rest():
    made = scheduler(level=1.5)
    t, _, sigma = record(2, plots=12)
    kernel, memory = made.kernel(2), made.initial_memory(2)
    rest, missing = (0.0, 0.0), (math.inf, math.inf)
    for k in range(12):
        dt = float(t[k] - t[k - 1]) if k else 1.0
        seen = tuple(sigma[k].tolist())
        # After the start, every plot is a surprise.
        e = (4.0, 1.0) if k > 1 else rest
        *_, tau, memory = kernel(e, rest, dt, seen, memory)
    variance = made.prediction_variance(np.array(memory)[:, None], 2.0)
    alpha, beta, gamma, still, after = kernel(rest, rest, 2.0, missing, memory)
    assert (alpha, beta, gamma, still) == (0.0, 0.0, 0.0, tau)
    # Smoothed innovations, their product, number of plots: as before. P₁₁: as predicted.
    assert after[:6] == memory[:6]
    assert after[10] == pytest.approx(float(variance[0]), rel=1e-12)
    assert all(map(math.isfinite, after))


@pytest.mark.parametrize("options", [{"level": 2.0}, {}])
def test_a_plot_that_is_missed_before_the_velocity_is_known(options):
    """The two plots give position and velocity, whatever was between them."""
    made = scheduler(**options)
    kernel, memory = made.kernel(2), made.initial_memory(2)
    rest, one, other = (0.0, 0.0), (2.0, 2.0), (3.0, 3.0)
    *_, memory = kernel(rest, rest, 1.0, one, memory)
    assert np.isnan(made.prediction_variance(np.array(memory)[:, None], 1.0)).all()
    *_, straight = kernel(rest, rest, 4.0, other, memory)
    for dt in (1.0, 2.5):
        *_, memory = kernel(rest, rest, dt, (math.inf, math.inf), memory)
        assert np.isnan(made.prediction_variance(np.array(memory)[:, None], 1.0)).all()
    *_, memory = kernel(rest, rest, 0.5, other, memory)
    assert memory == pytest.approx(straight, rel=1e-12)
    # Variance of the velocity: of the difference of two plots over 4 s, and of acceleration.
    acceleration = 0.65 * (options["level"] / 3 if options else 2.0 / 4**2)
    expected = (2.0**2 + 3.0**2) / 4**2 + acceleration**2 * 4**2 / 4
    assert memory[5 + 5 + 3] == pytest.approx(expected, rel=1e-12)


# ------------------------------------------------------------------ parameters and settings


def test_parameters_in_texts_and_in_python():
    made = make_scheduler("maneuver:level=5:velocity_sigma=30:axes=own")
    assert made == scheduler(level=5.0, velocity_sigma=30, axes="own")
    assert repr(scheduler("maneuver-two-rules", level=5.0)).endswith(", level=5.0)")
    assert pickle.loads(pickle.dumps(made)) == made != scheduler(level=5.0)
    assert made.needs_sigma
    assert made.uses_acceleration
    assert made.uses_retention
    assert made.coupled
    assert (made.variance_start, scheduler().variance_start) == ("one-point", None)
    assert not ft.FuzzyScheduler("stiffness-damping").uses_retention


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("maneuver", {"level": 0.0}, "level must be finite and > 0, got 0"),
        ("maneuver", {"level": math.nan}, "level must be finite and > 0, got nan"),
        ("maneuver", {"level": math.inf}, "level must be finite and > 0, got inf"),
        ("maneuver", {"level": 1.0, "velocity_sigma": -1.0}, "velocity_sigma must be finite and >"),
        ("maneuver", {"velocity_sigma": 3.0}, "velocity_sigma needs a level"),
        ("maneuver", {"axes": "each"}, "axes: unknown 'each'; one of shared, own"),
        ("maneuver", {"period": 4.0}, "period: the gains of maneuver belong to no sampling time"),
        ("omega-schedule", {"level": 1.0}, "level: omega-schedule does not use it.*gains: kalata"),
        ("chan-style", {"axes": "own"}, "axes: chan-style does not use it.*gains: direct"),
        ("stiffness-damping", {"velocity_sigma": 1.0}, "velocity_sigma: stiffness-damping does no"),
    ],
)
def test_parameters_are_checked(name, options, message):
    with pytest.raises(ValueError, match=message):
        scheduler(name, **options)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("start: 0.65", "start: 0", "start must be finite and > 0, got 0"),
        ("gap: 0.6", "gap: -1", "gap must be finite and > 0, got -1"),
        ("delay: 1", "delay: -0.5", "delay must be finite and >= 0, got -0.5"),
        ("gap: 0.6", "gap: soon", "gap of gains 'covariance' must be a number, got 'soon'"),
        ("clip: 4", "clip: 0", "clip must be finite and > 0, got 0"),
        ("clip: 4", "klip: 4", "unknown scheduler setting 'klip'.*did you mean 'clip'"),
        ("delay: 1", "delai: 1", "unknown scheduler setting 'delai'.*did you mean 'delay'"),
        ("agreement_time: 16, ", "", "'surprise' gives 1 signals .surprise.; .* has 2 inputs"),
        ("start: 0.65", "start: 0.65, opening: growing-memory", "opening: gains 'covariance' open"),
        ("start: 0.65", "start: 0.65, period: 4", "period: the gains of maneuver belong to no"),
        ("gains: covariance", "gains: kovariance", "unknown gains 'kovariance'; one of w-domain"),
        (
            "normalization: surprise, time: 6.5, clip: 4, agreement_time: 16",
            "normalization: predicted",
            "normalization 'predicted' has a covariance of its own; beside gains: covariance",
        ),
    ],
)
def test_settings_are_checked_where_they_stand(old, new, message):
    text = dumps_rulebase(ft.load_rulebase("maneuver"))
    assert old in text
    with pytest.raises(ft.RuleBaseError, match=message) as caught:
        ft.FuzzyScheduler(ft.loads_rulebase(text.replace(old, new), "my.yaml"))
    line = next(n for n, each in enumerate(text.splitlines(), 1) if old in each)
    assert str(caught.value).startswith(f"my.yaml:{line}:")


def test_a_surprise_needs_a_covariance():
    text = dumps_rulebase(ft.load_rulebase("omega-schedule"))
    old = "normalization: smoothed, rho: 0.774, gains: kalata, opening: growing-memory"
    assert old in text
    wrong = ft.loads_rulebase(text.replace(old, "normalization: surprise, gains: kalata"))
    with pytest.raises(ft.RuleBaseError, match="'surprise' needs gains: covariance, got 'kalata'"):
        ft.FuzzyScheduler(wrong)


@pytest.mark.parametrize("name", ["noise", "retention"])
def test_noise_and_retention_are_positive(name):
    rules = ft.load_rulebase("maneuver")
    outputs = tuple(
        replace(v, universe=replace(v.universe, low=0.0)) if v.name == name else v
        for v in rules.outputs
    )
    with pytest.raises(ft.RuleBaseError, match=f"{name} must be > 0; its universe starts at 0"):
        ft.FuzzyScheduler(replace(rules, outputs=outputs))


def test_rules_of_the_shipped_files_are_those_of_the_table():
    rules = ft.load_rulebase("maneuver")
    system = ft.FuzzySystem(rules)
    for surprise, agreement in [(0.0, -5.0), (2.0, 3.0), (3.5, 9.0), (9.0, 1.0), (0.5, 5.0)]:
        found = system(surprise=surprise, agreement=agreement)
        expected = say(MANEUVER, surprise, agreement)
        assert (found["noise"], found["retention"]) == pytest.approx(expected, rel=1e-12)
    assert len(ft.load_rulebase("maneuver-two-rules").rules) == 2
