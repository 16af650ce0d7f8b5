"""Optimal gains against known values, Riccati equations, and every other filter there is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from opponents import ALPHA, BETA, GAMMA
from scipy.linalg import solve_discrete_are
from scipy.optimize import minimize

from fuzzytrack.gains import (
    Optimum,
    TrackingCost,
    acceleration_index,
    circular_error,
    is_stable,
    kalata,
    noise_ratio,
    optimal_alpha_beta_gamma,
    optimal_for_acceleration,
    optimal_for_steady_error,
    optimal_for_velocity,
    optimal_gains,
    optimal_on_circle,
    steady_error,
    steady_index,
    transient_cost,
    velocity_index,
)

few = settings(max_examples=25)
indices = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
index_arrays = hnp.arrays(np.float64, 20, elements=indices)


def velocity_cost(index, alpha, beta, gamma=0.0):
    return transient_cost(alpha, beta, gamma, 1, index, 0) + noise_ratio(alpha, beta, gamma)


def acceleration_cost(index, alpha, beta):
    return transient_cost(alpha, beta, 0, 1, 0, index) + noise_ratio(alpha, beta)


def steady_cost(index, alpha, beta):
    return steady_error(alpha, beta, acceleration=index) ** 2 + noise_ratio(alpha, beta)


CLOSED = {
    "velocity": (optimal_for_velocity, velocity_cost),
    "acceleration": (optimal_for_acceleration, acceleration_cost),
    "steady error": (optimal_for_steady_error, steady_cost),
}


# ---------------------------------------------------------------- closed forms


@pytest.mark.parametrize(
    ("rule", "index", "expected"),
    [
        (optimal_for_velocity, 0.1, (0.3617694618, 0.0798893321)),
        (optimal_for_velocity, 1.0, (0.7690872515, 0.4805338162)),
        (optimal_for_velocity, 5.0, (0.9671862148, 0.9057287843)),
        (optimal_for_acceleration, 0.05, (0.3550721473, 0.1873685031)),
        (optimal_for_acceleration, 0.5, (0.5416393630, 0.6718621400)),
        (optimal_for_acceleration, 5.0, (0.6014700710, 1.7578405893)),
        (optimal_for_acceleration, 50.0, (0.5309175724, 2.7247064407)),
        (optimal_for_steady_error, 0.01, (0.1772283888, 0.0386291334)),
        (optimal_for_steady_error, 0.3, (0.4370885100, 0.4163922788)),
        (optimal_for_steady_error, 1.0, (0.4963434623, 0.8362800320)),
        (optimal_for_steady_error, 10.0, (0.3853226671, 2.1871744105)),
    ],
)
def test_known_optima(rule, index, expected):
    assert rule(index) == pytest.approx(expected, abs=6e-11)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "expected"),
    [
        (0, 0.5, (0.7953736627, 0.5998269654, 0.4523564273)),
        (0, 2, (0.9189033352, 1.0230942834, 1.1390990463)),
        (0.5, 0.2, (0.7400709359, 0.4646580669, 0.2039329553)),
        (1, 1, (0.8873768135, 0.8415577628, 0.6711875638)),
    ],
)
def test_known_optima_with_gamma(velocity, acceleration, expected):
    assert optimal_alpha_beta_gamma(velocity, acceleration) == pytest.approx(expected, abs=6e-11)


@pytest.mark.untraced
@pytest.mark.parametrize(("rule", "cost"), CLOSED.values(), ids=CLOSED)
@few
@given(index=index_arrays)
def test_no_other_filter_costs_less(rule, cost, index):
    best = cost(index, *rule(index))
    others = cost(index[:, None], ALPHA, BETA).min(axis=1)
    assert (best <= others * (1 + 1e-12)).all()


@few
@given(velocity=index_arrays, acceleration=index_arrays)
def test_no_other_filter_with_gamma_costs_less(velocity, acceleration):
    def cost(v, a, *gains):
        return transient_cost(*gains, 1, v, a) + noise_ratio(*gains)

    velocity, acceleration = velocity[:6], acceleration[:6]
    best = cost(velocity, acceleration, *optimal_alpha_beta_gamma(velocity, acceleration))
    others = cost(velocity[:, None], acceleration[:, None], ALPHA, BETA, GAMMA).min(axis=1)
    assert (best <= others * (1 + 1e-12)).all()


@pytest.mark.parametrize(("rule", "cost"), CLOSED.values(), ids=CLOSED)
@pytest.mark.parametrize("index", [0.02, 0.3, 3.0, 30.0])
def test_numerical_minimization_finds_the_closed_form(rule, cost, index):
    def in_w(logarithms):
        omega, damping = np.exp(logarithms)  # 2ζω₀ is `damping`
        d = 1 + damping + omega**2
        return (
            float(cost(index, 2 * damping / d, 4 * omega**2 / d)),
            2 * damping / d,
            4 * omega**2 / d,
        )

    found = minimize(
        lambda x: in_w(x)[0],
        [-1.0, -1.0],
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-15, "maxiter": 1000},
    )
    assert rule(index) == pytest.approx(in_w(found.x)[1:], abs=2e-7)


@pytest.mark.parametrize("index", [0.001, 0.1, 1.0, 20.0])
def test_constant_velocity_is_a_steady_kalman_filter(index):
    f, h = np.array([[1.0, 1], [0, 1]]), np.array([[1.0], [0]])
    before = solve_discrete_are(f.T, h, index**2 * np.ones((2, 2)), np.eye(1))
    gain = (before @ h)[:, 0] / (before[0, 0] + 1)
    assert optimal_for_velocity(index) == pytest.approx(gain, rel=1e-7)


@pytest.mark.parametrize("velocity", [0, 0.05, 0.5, 1, 6])
@pytest.mark.parametrize("acceleration", [0.02, 0.2, 1, 4])
def test_velocity_with_acceleration_is_a_steady_kalman_filter(velocity, acceleration):
    f, h = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1.0]]), np.eye(3)[:, :1]
    g, v = np.array([0.5, 1, 1]), np.array([1.0, 1, 0])
    q = acceleration**2 * np.outer(g, g) + velocity**2 * np.outer(v, v)
    before = solve_discrete_are(f.T, h, q, np.eye(1))
    alpha, beta, half = (before @ h)[:, 0] / (before[0, 0] + 1)
    got = optimal_alpha_beta_gamma(velocity, acceleration)
    assert got == pytest.approx((alpha, beta, 2 * half), rel=1e-6)


@few
@given(index_arrays, index_arrays)
def test_the_optima_lie_on_their_curves(velocity, acceleration):
    alpha, beta = optimal_for_velocity(velocity)
    np.testing.assert_allclose(beta, alpha**2 / (2 - alpha), rtol=1e-12)
    alpha, beta = optimal_for_acceleration(velocity)
    np.testing.assert_allclose(alpha, (np.sqrt(beta**2 + 144 * beta) - 5 * beta) / 12, rtol=1e-12)
    alpha, beta = optimal_for_steady_error(velocity)
    np.testing.assert_allclose((2 * alpha + beta) ** 2, 4 * beta, rtol=1e-12)
    alpha, beta, gamma = optimal_alpha_beta_gamma(velocity, acceleration)
    np.testing.assert_allclose(beta * (2 - alpha), alpha * (alpha + gamma / 4), rtol=1e-12)
    np.testing.assert_allclose(velocity**2 * (1 - alpha) + alpha * gamma, beta**2, rtol=1e-9)
    np.testing.assert_allclose(acceleration**2 * (1 - alpha), gamma**2 / 4, rtol=1e-9)


def test_the_optimum_with_both_has_the_others_as_limits():
    index = np.array([0.01, 0.5, 2.0, 30.0])
    alpha, beta, gamma = optimal_alpha_beta_gamma(index, 0)
    np.testing.assert_allclose((alpha, beta), optimal_for_velocity(index), rtol=1e-12)
    assert not gamma.any()
    both = optimal_alpha_beta_gamma(0, index)
    np.testing.assert_allclose(both, kalata(index, order=3), rtol=1e-10)


def test_the_ends_of_the_curve_for_acceleration():
    alpha, beta = optimal_for_acceleration(np.geomspace(1e-12, 1e12, 4001))
    assert (np.diff(beta) >= 0).all()
    assert alpha.max() == pytest.approx(30 - 12 * np.sqrt(6), abs=1e-4)
    assert beta[alpha.argmax()] == pytest.approx(1.485, abs=5e-3)
    assert (alpha[-1], beta[-1]) == pytest.approx((0.5, 3))
    # Near 0, β is (index²/0.2)^(1/3) and α its root.
    small = (1e-24 / 0.2) ** (1 / 3)
    assert (alpha[0], beta[0]) == pytest.approx((small**0.5, small), rel=1e-3)


@few
@given(index_arrays)
def test_all_optima_are_stable(index):
    for rule, _ in CLOSED.values():
        assert is_stable(*rule(index)).all()
    assert is_stable(*optimal_alpha_beta_gamma(index, index[::-1])).all()


def test_the_published_pair_is_near_an_optimum_for_constant_velocity():
    alpha, beta = optimal_for_velocity(np.sqrt(0.087605))
    assert (alpha, beta) == pytest.approx((0.540929, 0.200542), abs=6e-7)
    cost = [velocity_cost(np.sqrt(0.087605), *pair) for pair in ((alpha, beta), (0.5377, 0.2018))]
    assert cost[1] / cost[0] - 1 == pytest.approx(3.06e-5, abs=6e-8)
    alpha = 0.5377
    assert alpha**2 / (2 - alpha) == pytest.approx(0.197717, abs=6e-7)


# ---------------------------------------------------------------- indices


@few
@given(
    st.floats(0.1, 50),
    st.floats(0.1, 10),
    st.floats(0.1, 20),
    st.floats(0.1, 30),
    st.floats(0.1, 9),
)
def test_indices_make_costs_dimensionless(velocity, acceleration, dt, sigma, kappa):
    pair = 0.6, 0.3
    noise = kappa * sigma**2 * noise_ratio(*pair)
    index = velocity_index(-velocity, dt, sigma, kappa)
    cost = transient_cost(*pair, 0, dt, velocity, 0) + noise
    assert cost / (kappa * sigma**2) == pytest.approx(velocity_cost(index, *pair))
    index = acceleration_index(-acceleration, dt, sigma, kappa)
    cost = transient_cost(*pair, 0, dt, 0, acceleration) + noise
    assert cost / (kappa * sigma**2) == pytest.approx(acceleration_cost(index, *pair))
    index = steady_index(-acceleration, dt, sigma, kappa, kappa_steady=3)
    cost = 3 * steady_error(*pair, 0, dt, acceleration) ** 2 + noise
    assert cost / (kappa * sigma**2) == pytest.approx(steady_cost(index, *pair))


def test_closed_forms_broadcast():
    assert isinstance(optimal_for_velocity(1.0)[0], float)
    assert isinstance(velocity_index(1, 1, 1), float)
    assert velocity_index([[1], [2]], [1, 2, 3], 1).shape == (2, 3)
    for rule, _ in CLOSED.values():
        alpha, beta = rule(np.ones((2, 3)))
        assert alpha.shape == beta.shape == (2, 3)
        assert isinstance(rule(1.0)[1], float)
    assert optimal_alpha_beta_gamma(np.ones((2, 1)), np.ones(3))[2].shape == (2, 3)
    assert isinstance(optimal_alpha_beta_gamma(1, 1)[2], float)


# ---------------------------------------------------------------- the search


@pytest.mark.parametrize("index", [0.01, 0.3, 3.0, 30.0])
def test_the_search_finds_the_closed_forms(index):
    found = optimal_gains(TrackingCost(sigma=1, velocity=index))
    assert found.gains == pytest.approx((*optimal_for_velocity(index), 0), abs=1e-6)
    found = optimal_gains(TrackingCost(sigma=1, acceleration=index))
    assert found.gains == pytest.approx((*optimal_for_acceleration(index), 0), abs=1e-6)
    found = optimal_gains(TrackingCost(sigma=1, acceleration=index, transient=0, steady=1))
    assert found.gains == pytest.approx((*optimal_for_steady_error(index), 0), abs=1e-6)
    assert found.at_bound == ()


@pytest.mark.parametrize("indices", [(0, 0.5), (0, 2), (0.5, 0.2), (1, 1), (0.1, 0.01)])
def test_the_search_finds_the_closed_form_with_gamma(indices):
    found = optimal_gains(
        TrackingCost(sigma=1, velocity=indices[0], acceleration=indices[1]), gamma=True
    )
    assert found.gains == pytest.approx(optimal_alpha_beta_gamma(*indices), abs=1e-6)


def test_the_search_uses_units():
    v, dt, sigma, kappa = 12.0, 4.0, 30.0, 2.5
    found = optimal_gains(TrackingCost(sigma=sigma, dt=dt, velocity=v, kappa=kappa))
    expected = optimal_for_velocity(velocity_index(v, dt, sigma, kappa))
    assert found.gains[:2] == pytest.approx(expected, abs=1e-6)


def test_a_filter_that_needs_no_gamma_gets_none():
    found = optimal_gains(TrackingCost(sigma=1, velocity=1), gamma=True)
    assert found.gains == pytest.approx((*optimal_for_velocity(1.0), 0), abs=1e-6)
    assert found.gamma == 0
    assert found.at_bound == ("gamma",)


def test_any_function_is_a_cost():
    def valley(alpha, beta):
        return (alpha - 0.3) ** 2 + (beta - 0.25) ** 2

    assert optimal_gains(valley).gains == pytest.approx((0.3, 0.25, 0), abs=1e-6)

    def hollow(alpha, beta, gamma):
        if alpha > 1.5:  # not for arrays, and not everywhere
            return np.nan
        return (alpha - 0.7) ** 2 + (beta - 0.4) ** 2 + (gamma - 0.1) ** 2

    found = optimal_gains(hollow, gamma=True, start=(0.5, 0.5, 0.1))
    assert found.gains == pytest.approx((0.7, 0.4, 0.1), abs=1e-6)
    assert found.cost < 1e-12


def test_the_best_of_several_valleys_is_found():
    def two(alpha, beta):
        shallow = 1 - 0.5 * np.exp(-((alpha - 0.2) ** 2 + (beta - 0.1) ** 2) / 0.01)
        return shallow - np.exp(-((alpha - 1.3) ** 2 + (beta - 0.6) ** 2) / 0.02)

    assert optimal_gains(two).gains[:2] == pytest.approx((1.3, 0.6), abs=1e-3)

    # A start in a valley too narrow for the grid.
    def narrow(alpha, beta):
        return two(alpha, beta) - 3 * np.exp(-((alpha - 0.61) ** 2 + (beta - 0.9) ** 2) / 1e-5)

    found = optimal_gains(narrow, start=(0.612, 0.901))
    assert found.gains[:2] == pytest.approx((0.61, 0.9), abs=1e-4)


def test_bounds_hold():
    cost = TrackingCost(sigma=1, velocity=1)
    found = optimal_gains(cost, {"alpha": (0.1, 0.4)})
    assert found.alpha == 0.4
    assert found.at_bound == ("alpha",)
    line = np.linspace(0.01, 3, 100_001)
    assert found.beta == pytest.approx(line[cost(0.4, line).argmin()], abs=1e-4)

    found = optimal_gains(cost, {"alpha": (0.9, 1.2), "beta": (0.0, 0.3)})
    assert found.gains == pytest.approx((0.9, 0.3, 0))
    assert set(found.at_bound) == {"alpha", "beta"}

    found = optimal_gains(cost, {"alpha": (0.5, 0.5)})
    assert found.alpha == 0.5

    both = TrackingCost(sigma=1, velocity=0.1, acceleration=0.1)
    found = optimal_gains(both, {"gamma": (0.3, 5.0), "beta": (0.1, 2)}, gamma=True)
    assert found.gamma == pytest.approx(0.3)
    assert "gamma" in found.at_bound
    assert is_stable(*found.gains)
    others = (GAMMA >= 0.3) & (BETA >= 0.1) & (BETA <= 2)
    assert found.cost <= both(ALPHA[others], BETA[others], GAMMA[others]).min()

    inactive = optimal_gains(cost, {"alpha": (0.1, 1.9), "beta": (0.1, 1.9)})
    assert inactive.gains == pytest.approx(optimal_gains(cost).gains, abs=1e-6)


@settings(max_examples=8)
@given(st.floats(0.1, 3), st.floats(0, 2), st.floats(0, 3), st.floats(0.5, 3), st.booleans())
def test_no_other_filter_beats_the_search(velocity, acceleration, steady, dt, gamma):
    cost = TrackingCost(
        sigma=2, dt=dt, velocity=velocity, acceleration=acceleration, steady=steady, kappa=0.7
    )
    found = optimal_gains(cost, gamma=gamma)
    third = GAMMA if gamma else 0
    assert found.cost <= cost(ALPHA, BETA, third).min() * (1 + 1e-12)
    assert is_stable(*found.gains)
    assert found.cost == pytest.approx(cost(*found.gains))


def test_without_a_weight_on_the_lag_a_small_acceleration_makes_the_optimum_jump():
    def best(acceleration, steady=0.0):
        cost = TrackingCost(sigma=1, velocity=1, acceleration=acceleration, steady=steady)
        return optimal_gains(cost)

    ordinary = optimal_for_velocity(1.0)
    jumped = best(1e-3)
    assert jumped.beta == pytest.approx(1e-3 * jumped.alpha, rel=0.01)
    assert jumped.cost < 0.7 * velocity_cost(1.0, *ordinary)
    assert best(-1e-3).gains[:2] == pytest.approx(ordinary, rel=5e-3)
    assert best(1e-3, steady=10.0).gains[:2] == pytest.approx(ordinary, rel=5e-3)


def test_a_cost_that_adds_everything_up():
    cost = TrackingCost(
        sigma=3, dt=2, velocity=4, acceleration=0.5, jerk=0.1, radius=50, angular_rate=0.2,
        kappa=0.5, transient=2, steady=7, circle=0.3,
    )  # fmt: skip
    alpha, beta, gamma = np.array([[0.5, 0.7], [0.4, 0.3], [0.1, 0.2]])
    expected = (
        2 * transient_cost(alpha, beta, gamma, 2, 4, 0.5)
        + 7 * steady_error(alpha, beta, gamma, 2, 0.5, 0.1) ** 2
        + 0.3 * circular_error(alpha, beta, gamma, 0.2, 2, 50) ** 2
        + 0.5 * 9 * noise_ratio(alpha, beta, gamma)
    )
    np.testing.assert_allclose(cost(alpha, beta, gamma), expected)
    assert cost(0.5, 0.4) == np.inf  # with a jerk, and no γ
    np.testing.assert_allclose(cost(0.5, 0.4, [0, 0.1]), [np.inf, expected[0]])


# ---------------------------------------------------------------- arguments


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: optimal_for_velocity(0), "index must be finite and > 0"),
        (lambda: optimal_for_acceleration(np.nan), "index must be finite and > 0"),
        (lambda: optimal_for_steady_error([1, -1]), "index must be finite and > 0"),
        (lambda: optimal_alpha_beta_gamma(-1, 1), "velocity_index must be finite and >= 0"),
        (lambda: optimal_alpha_beta_gamma(1, np.inf), "acceleration_index must be finite"),
        (lambda: optimal_alpha_beta_gamma([1, 0], 0), "must not both be 0"),
        (lambda: velocity_index(np.nan, 1, 1), "velocity must be finite"),
        (lambda: velocity_index(1, -1, 1), "dt must be finite and > 0"),
        (lambda: acceleration_index(1, 1, 0), "sigma must be finite and > 0"),
        (lambda: acceleration_index(np.inf, 1, 1), "acceleration must be finite"),
        (lambda: steady_index(1, 1, 1, kappa=-1), "kappa must be finite and > 0"),
        (lambda: steady_index(1, 1, 1, kappa_steady=0), "kappa_steady must be finite and > 0"),
        (lambda: TrackingCost(sigma=-1), "sigma must be finite and >= 0"),
        (lambda: TrackingCost(sigma=1, dt=0), "dt must be finite and > 0"),
        (lambda: TrackingCost(sigma=1, velocity=np.nan), "velocity must be finite"),
        (lambda: TrackingCost(sigma=1, steady=-1), "steady must be finite and >= 0"),
        (lambda: TrackingCost(sigma=1, radius=[1, 2]), "radius must be one number"),
        (lambda: TrackingCost(sigma=1)(1.8, 0.4), "2 alpha"),
        (lambda: optimal_on_circle(np.nan, 1, 1, 1), "angular_rate must be finite"),
        (lambda: optimal_on_circle(0, 1, 1, 1), "angular_rate must not be 0"),
        (lambda: optimal_on_circle(3.2, 1, 1, 1), "less than pi/dt"),
        (lambda: optimal_on_circle(0.1, -1, 1, 1), "dt must be finite and > 0"),
        (lambda: optimal_on_circle(0.1, 1, 0, 1), "radius must be finite and > 0"),
        (lambda: optimal_on_circle(0.1, 1, 1, [1, 2]), "sigma must be one number"),
        (lambda: optimal_on_circle(0.1, 1, 1, 1, kappa=0), "kappa must be finite and > 0"),
    ],
)
def test_arguments_out_of_range_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


COST = TrackingCost(sigma=1, velocity=1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bounds": {"gamma": (0, 1)}}, "bounds must be for alpha, beta; got 'gamma'"),
        ({"bounds": {"alfa": (0, 1)}, "gamma": True}, "alpha, beta, gamma; got 'alfa'"),
        ({"bounds": {"alpha": (0.5, 0.4)}}, "bounds of alpha must be low <= high"),
        ({"bounds": {"alpha": (np.nan, 0.4)}}, "bounds of alpha"),
        ({"bounds": {"alpha": (2.5, 3)}}, "bounds must leave stable gains"),
        ({"bounds": {"alpha": (-1, 0)}}, "bounds must leave stable gains"),
        ({"bounds": {"beta": (-1, 0)}}, "bounds must leave stable gains"),
        ({"bounds": {"alpha": (1, 2), "beta": (3, 4)}}, "bounds must leave stable gains"),
        ({"bounds": {"gamma": (20, 30)}, "gamma": True}, "bounds must leave stable gains"),
        ({"bounds": {"alpha": (2, 2)}}, "finite for some stable gains"),
        ({"start": (0.5, 0.4, 0.1)}, "start must be 2 gains"),
        ({"start": (1.8, 0.9)}, "2 alpha"),
        ({"start": (0.5, 0.4), "bounds": {"beta": (0.5, 1)}}, "start must be within.*beta"),
    ],
)
def test_bounds_and_starts_out_of_range_are_named(options, message):
    with pytest.raises(ValueError, match=message):
        optimal_gains(COST, **options)


def test_a_cost_without_a_minimum_is_refused():
    with pytest.raises(ValueError, match="falls to the edge of stability"):
        optimal_gains(TrackingCost(sigma=1))  # the less a filter does, the less noise it passes
    found = optimal_gains(TrackingCost(sigma=1), {"alpha": (0.3, 2), "beta": (0.1, 4)})
    assert found == Optimum(0.3, 0.1, 0.0, pytest.approx(found.cost), ("alpha", "beta"))
    with pytest.raises(ValueError, match="cost must be finite for some stable gains"):
        optimal_gains(lambda alpha, beta: np.nan)
