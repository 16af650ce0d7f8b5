"""Closed forms against the literal recursion, Lyapunov and Riccati equations, and known values."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov

from fuzzytrack.gains import (
    circular_error,
    covariance,
    frequency_response,
    kalata,
    noise_ratio,
    steady_error,
    transient_cost,
)

OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "interval")
few = settings(max_examples=12)
shares = hnp.arrays(np.float64, (3, 24), elements=st.floats(0.03, 0.97))


def triples(share, gamma=True, slow=0.985):
    """Stable gains from shares of what is left of the stability region, without slow poles."""
    alpha = 2 * share[0]
    beta = (4 - 2 * alpha) * share[1]
    third = 4 * alpha * beta / (2 - alpha) * share[2] * gamma
    a, _ = system(alpha, beta, third)
    if not gamma:
        a = a[:, :2, :2]
    slowest = np.abs(np.linalg.eigvals(a)).max(axis=-1)
    keep = slowest < slow
    return alpha[keep], beta[keep], third[keep]


def system(alpha, beta, gamma):
    """Transition and gain of the filtered state (x, T v, T² a)."""
    f = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    k = np.stack([alpha, beta, gamma / 2], axis=-1)
    return f - k[..., :, None] * f[0], k


def run(alpha, beta, gamma, z, dt=1.0):
    """The recursion as it is written: predictions and filtered states, from rest."""
    x, v, a = (np.zeros(np.shape(alpha), dtype=z.dtype) for _ in range(3))
    predicted, filtered = [], []
    for plot in z:
        ahead, speed = x + v * dt + a * dt**2 / 2, v + a * dt
        e = plot - ahead
        x, v, a = ahead + alpha * e, speed + beta / dt * e, a + gamma / (2 * dt**2) * e
        predicted.append(ahead)
        filtered.append((x, v, a))
    return np.array(predicted), np.array(filtered)


@pytest.mark.parametrize(
    ("gains", "of", "expected"),
    [
        ((0.5, 0.7), "predicted", 1.9565217391),
        ((0.5, 0.7), "interval", 1.2057971014),
        ((0.5, 0.7), "filtered", 0.7391304348),
        ((0.5, 0.7), "velocity", 0.8521739130),
        ((0.5, 0.7), "acceleration", 0.0),
        ((0.7, 0.44, 0.24), "predicted", 1.737520129),
        ((1.05, 1.225, 1.5), "predicted", 11.170450020),
        ((0.5, 0.4, 0.1), "predicted", 1.343195266),
        ((0.5, 0.4, 0.1), "filtered", 0.585798817),
        ((0.5, 0.4, 0.1), "velocity", 0.273964497),
        ((0.5, 0.4, 0.1), "acceleration", 0.004733728),
        ((0.737856, 0.318816, 2 * 0.046656), "predicted", 1.294331),
        ((0.737856, 0.318816, 4 * 0.046656), "predicted", 1.412824),
    ],
)
def test_known_noise_ratios(gains, of, expected):
    tolerance = 6e-7 if gains[0] == 0.737856 else 6e-10
    assert noise_ratio(*gains, of=of) == pytest.approx(expected, abs=tolerance)


def test_the_three_columns_of_the_published_table():
    published = {"predicted": 1.9565, "interval": 1.2058, "filtered": 0.7391}
    assert {of: round(float(noise_ratio(0.5, 0.7, of=of)), 4) for of in published} == published


@few
@given(shares, st.booleans())
def test_noise_ratios_are_sums_of_the_squared_impulse_response(share, gamma):
    alpha, beta, third = triples(share, gamma)
    z = np.zeros((1100, alpha.size))
    z[0] = 1
    predicted, filtered = run(alpha, beta, third, z)
    x, v, a = filtered.swapaxes(0, 1)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    between = sum(
        w / 2 * (x + v * t + a * t * t / 2) ** 2
        for t, w in zip((nodes + 1) / 2, weights, strict=True)
    )
    squares = dict(zip(OUTPUTS, (predicted**2, x**2, v**2, a**2, between), strict=True))
    for of, square in squares.items():
        ratio = noise_ratio(alpha, beta, third, of=of)
        np.testing.assert_allclose(ratio, square.sum(axis=0), rtol=1e-9, atol=1e-12, err_msg=of)


@few
@given(shares)
def test_noise_ratios_solve_the_lyapunov_equation(share):
    for alpha, beta, gamma in zip(*triples(share), strict=True):
        a, k = system(alpha, beta, gamma)
        p = solve_discrete_lyapunov(a, np.outer(k, k))
        ahead = np.array([1, 1, 0.5])
        expected = [ahead @ p @ ahead, p[0, 0], p[1, 1], p[2, 2]]
        got = [noise_ratio(alpha, beta, gamma, of=of) for of in OUTPUTS[:4]]
        assert got == pytest.approx(expected, rel=1e-7)


def test_noise_ratio_in_the_space_of_poles():
    """The polynomial of the a-b-c form, for another derivation of Eq. 2.68."""
    rng = np.random.default_rng(0)
    a = rng.uniform(0.05, 1.95, 500)
    b = (4 - 2 * a) * rng.uniform(0.05, 0.95, 500)
    c = rng.uniform(-0.95, 0.95, 500)
    powers = [
        6 * a**2 + 7 * a * b + 4 * a + 2 * b**2,
        -2 * a**3 - 3 * a**2 * b + 6 * a**2 - a * b**2 + a * b + 12 * a - 2 * b**2,
        2 * a**2 * b - 6 * a**2 + a * b**2 - 7 * a * b + 12 * a,
        2 * a**3 + a**2 * b - 6 * a**2 - a * b + 4 * a,
    ]
    below = a * (1 - c) * (4 - 2 * a - b) * ((1 + c) ** 2 - c * (a + b + a * c))
    expected = sum(p * c**k for k, p in enumerate(powers)) / below
    gains = 1 + c * (1 - a), a * (1 + c) + b * (1 - c) / 2, 2 * b * (1 + c)
    np.testing.assert_allclose(noise_ratio(*gains), expected, rtol=1e-9)


# ---------------------------------------------------------------- covariance


@few
@given(shares, st.floats(0.1, 10), st.floats(0, 50), st.floats(0, 5))
def test_covariance_solves_the_lyapunov_equation(share, dt, sigma_w, sigma_v):
    alpha, beta, _ = triples(share, gamma=False)
    got = covariance(alpha, beta, sigma_w, dt, sigma_v)
    assert got.shape == (alpha.size, 2, 2)
    f, g = np.array([[1, dt], [0, 1]]), np.array([dt**2 / 2, dt])
    for each, a, b in zip(got, alpha, beta, strict=True):
        k = np.array([a, b / dt])
        keep = np.eye(2) - np.outer(k, [1, 0])
        noise = np.outer(k, k) * sigma_w**2 + np.outer(keep @ g, keep @ g) * sigma_v**2
        residual = keep @ f @ each @ f.T @ keep.T + noise - each
        assert np.abs(residual).max() <= 1e-9 * max(np.abs(each).max(), noise.max())


@pytest.mark.parametrize(
    ("index", "expected"),
    [
        (1.0, (0.75, 0.5, 1.0)),
        (0.1, (0.36, 0.08, 0.04)),
        (0.327, (0.5521479360, 0.2188341229, 0.2163317542)),
        (5.0, (0.9450399668, 1.1721778146, 7.6556443707)),
    ],
)
def test_covariance_at_optimal_gains_is_the_published_one(index, expected):
    p = covariance(*expected[:2], sigma_w=1, dt=1, sigma_v=index)
    assert (p[0, 0], p[0, 1], p[1, 1]) == pytest.approx(expected, abs=1e-9)
    dt, sigma_w = 3.0, 20.0
    sigma_v = index * sigma_w / dt**2
    alpha, beta = kalata(index)
    kim_lee = np.array(
        [[alpha, beta / dt], [beta / dt, beta * (2 * alpha - beta) / (2 * (1 - alpha) * dt**2)]]
    )
    got = covariance(alpha, beta, sigma_w, dt, sigma_v)
    np.testing.assert_allclose(got, kim_lee * sigma_w**2, rtol=1e-9)
    f, g, h = np.array([[1, dt], [0, 1]]), np.array([dt**2 / 2, dt]), np.array([[1.0], [0]])
    before = solve_discrete_are(f.T, h, np.outer(g, g) * sigma_v**2, sigma_w**2)
    k = before @ h / (before[0, 0] + sigma_w**2)
    np.testing.assert_allclose(got, before - k @ h.T @ before, rtol=1e-8)


def test_covariance_without_target_noise_is_the_noise_ratio():
    alpha, beta = np.array([0.2, 0.9, 1.4]), np.array([0.1, 1.2, 0.4])
    p = covariance(alpha, beta, sigma_w=[[2.0], [3.0]], dt=0.5)
    assert p.shape == (2, 3, 2, 2)
    for row, sigma in zip(p, (2, 3), strict=True):
        ratio = noise_ratio(alpha, beta, of="filtered") * sigma**2
        np.testing.assert_allclose(row[:, 0, 0], ratio)
        speed = noise_ratio(alpha, beta, of="velocity") * sigma**2 / 0.5**2
        np.testing.assert_allclose(row[:, 1, 1], speed)


# ---------------------------------------------------------------- lag, circle, transient


def test_known_errors():
    assert steady_error(0.5, 0.7, dt=2, acceleration=0.2) == pytest.approx(1.142857143, abs=6e-10)
    assert steady_error(0.5, 0.4, 0.1, 2, jerk=0.01) == pytest.approx(1.6)
    circle = circular_error([0.5, 0.7], [0.4, 0.9], [0.1, 0.6], [0.3, 1.1], 1, [100, 45])
    np.testing.assert_allclose(circle, [26.786931140, 115.986845656], atol=6e-10)
    # The same turn, fast and infinitely slow (Sklansky's approximation).
    assert circular_error(0.5, 0.7, 0, 0.1028888889, 1, 45) == pytest.approx(0.685844324, abs=6e-10)
    slow = steady_error(0.5, 0.7, acceleration=45 * 0.1028888889**2)
    assert slow == pytest.approx(0.680536508, abs=6e-10)


@few
@given(shares, st.floats(0.2, 5), st.floats(-3, 3), st.floats(-2, 2))
def test_steady_error_is_where_the_recursion_ends(share, dt, acceleration, jerk):
    t = dt * np.arange(250.0)[:, None]  # not longer: the cube of the time costs digits
    for gamma, j in ((False, 0.0), (True, jerk)):
        *gains, third = triples(share, gamma, slow=0.9)
        x = acceleration * t**2 / 2 + j * t**3 / 6
        lag = (x - run(*gains, third, x, dt)[0])[-1]
        got = steady_error(*gains, third, dt, acceleration, j)
        np.testing.assert_allclose(got, lag, rtol=1e-7, atol=1e-12 * np.abs(x).max())


def test_a_filter_without_acceleration_loses_a_jerking_target():
    lag = steady_error(0.5, 0.4, [0.0, 0.0, 0.1], jerk=[-1.0, 0.0, -1.0], acceleration=2.0)
    np.testing.assert_allclose(lag, [-np.inf, 5.0, -20.0])


@few
@given(shares, st.floats(0.01, 3.1), st.booleans())
def test_circular_error_is_where_the_recursion_ends(share, angle, gamma):
    alpha, beta, third = triples(share, gamma)
    z = 45 * np.exp(1j * angle * np.arange(2200))[:, None]
    distance = np.abs(z - run(alpha, beta, third, z)[0])[-1]
    got = circular_error(alpha, beta, third, -angle / 2, 2.0, 45)
    np.testing.assert_allclose(got, distance, rtol=1e-8, atol=1e-9)


def test_circular_error_keeps_its_digits_for_slow_turns():
    rate = 10.0 ** -np.arange(1, 9)
    np.testing.assert_allclose(
        circular_error(0.5, 0.4, 0.1, rate, 1, 1)[3:], 2 * rate[3:] ** 3 / 0.1, rtol=1e-5
    )
    np.testing.assert_allclose(
        circular_error(0.5, 0.4, 0, rate, 1, 1)[3:], rate[3:] ** 2 / 0.4, rtol=1e-5
    )
    assert circular_error(0.5, 0.4, 0, 0, 1, 1) == 0
    assert circular_error(0.5, 0.4, 0.1, 0.3, 1, 0) == 0


def test_known_transient_costs():
    assert transient_cost(0.5, 0.7, 0, 2, 3, 0.2) == pytest.approx(118.767904677, abs=6e-10)
    assert transient_cost(0.7, 0.44, 0.24, 2, 3, [0.2, 0]) == pytest.approx(
        [204.637681159, 188.405797101], abs=6e-10
    )
    assert transient_cost(0.7, 0.44, 0.24, 2, 0, 0.2) == pytest.approx(16.231884058, abs=6e-10)


@few
@given(shares, st.floats(0.2, 5), st.floats(-20, 20), st.floats(-3, 3), st.booleans())
def test_transient_cost_is_the_sum_over_the_recursion(share, dt, velocity, acceleration, gamma):
    alpha, beta, third = triples(share, gamma)
    t = dt * np.arange(1300.0)[:, None]
    x = velocity * t + acceleration * t**2 / 2
    error = x - run(alpha, beta, third, x, dt)[0]
    # Long sums of squares of small differences of large numbers: cut where it has settled.
    lag = 0 if gamma else steady_error(alpha, beta, dt=dt, acceleration=acceleration)
    got = transient_cost(alpha, beta, third, dt, velocity, acceleration)
    noise = (1e-15 * np.abs(x).max()) ** 2 * len(t) * dt * 1e6
    np.testing.assert_allclose(got, (dt * (error - lag) ** 2).sum(axis=0), rtol=1e-7, atol=noise)


def test_a_well_chosen_beta_hides_the_transient_but_not_the_lag():
    """With v T = 1 and β = α a T/v, cost and lag tend to 16/3 and v T/α as a tends to 0."""
    small = 1e-7
    assert transient_cost(0.5, 0.5 * small, 0, 1, 1, small) == pytest.approx(16 / 3, rel=1e-5)
    assert steady_error(0.5, 0.5 * small, acceleration=small) == pytest.approx(2)


def test_costs_and_ratios_without_gamma_are_limits():
    alpha, beta = np.array([0.3, 0.9, 1.5]), np.array([0.2, 0.8, 0.6])
    for of in OUTPUTS:
        np.testing.assert_allclose(
            noise_ratio(alpha, beta, 1e-9, of=of), noise_ratio(alpha, beta, of=of), atol=1e-7
        )
    np.testing.assert_allclose(
        transient_cost(alpha, beta, 1e-9, 1, 2, 0), transient_cost(alpha, beta, 0, 1, 2, 0)
    )
    assert (transient_cost(alpha, beta, 1e-9, 1, 2, 1) > 1e8).all()


# ---------------------------------------------------------------- frequency response


@few
@given(shares, st.floats(0, 3.1), st.booleans())
def test_frequency_response_is_what_the_recursion_makes_of_a_wave(share, angle, gamma):
    alpha, beta, third = triples(share, gamma)
    z = np.exp(1j * angle * np.arange(2200))[:, None]
    predicted, filtered = run(alpha, beta, third, z)
    for of, output in (("predicted", predicted), ("filtered", filtered[:, 0])):
        got = frequency_response(alpha, beta, third, angle / 0.5, 0.5, of=of)
        np.testing.assert_allclose(got, (output / z)[-1], rtol=1e-7, atol=1e-7)


def test_frequency_response_and_circular_error_agree():
    rate = np.geomspace(1e-3, 3, 40)[:, None]
    gamma = np.array([0.0, 0.1])
    error = 45 * np.abs(1 - frequency_response(0.5, 0.4, gamma, rate, 1))
    np.testing.assert_allclose(error, circular_error(0.5, 0.4, gamma, rate, 1, 45), rtol=1e-5)


@few
@given(shares)
def test_noise_ratio_is_the_mean_square_of_the_frequency_response(share):
    """Parseval: sampled finely enough, the mean over the circle is exact."""
    alpha, beta, gamma = triples(share)
    response = frequency_response(
        alpha, beta, gamma, 2 * np.pi * np.arange(4096)[:, None] / 4096, 1
    )
    np.testing.assert_allclose(
        (np.abs(response) ** 2).mean(axis=0), noise_ratio(alpha, beta, gamma), rtol=1e-9
    )


# ---------------------------------------------------------------- arguments


def test_numbers_for_numbers_and_arrays_broadcast():
    assert isinstance(noise_ratio(0.5, 0.4), float)
    assert isinstance(steady_error(0.5, 0.4, acceleration=1), float)
    assert isinstance(circular_error(0.5, 0.4, 0, 0.1, 1, 1), float)
    assert isinstance(transient_cost(0.5, 0.4, 0.1, 1, 1, 1), float)
    assert isinstance(frequency_response(0.5, 0.4, 0, 0.1, 1), complex)
    column, row = np.array([[0.3], [0.5]]), np.array([0.0, 0.05, 0.1])
    assert noise_ratio(column, 0.4, row).shape == (2, 3)
    assert steady_error(0.5, 0.4, row, column, 1, 1).shape == (2, 3)
    assert circular_error(0.5, 0.4, row, column, 1, 1).shape == (2, 3)
    assert transient_cost(0.5, 0.4, row, 1, column, 1).shape == (2, 3)
    assert frequency_response(0.5, 0.4, row, column, 1).shape == (2, 3)
    assert noise_ratio(np.empty((0, 2)), 0.4).shape == (0, 2)


CALLS = {
    "noise_ratio": lambda *gains: noise_ratio(*gains),
    "steady_error": lambda *gains: steady_error(*gains),
    "circular_error": lambda *gains: circular_error(*gains, 0.1, 1, 1),
    "transient_cost": lambda *gains: transient_cost(*gains, 1, 1, 1),
    "frequency_response": lambda *gains: frequency_response(*gains, 0.1, 1),
    "covariance": lambda a, b, _: covariance(a, b, 1, 1),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
@pytest.mark.parametrize("gains", [(np.nan, 0.4, 0), (0.5, -0.1, 0), (1.8, 0.4, 0), (0, 0, 0)])
def test_unstable_gains_are_refused(call, gains):
    with pytest.raises(ValueError, match=r"alpha.*2 alpha \+ beta < 4"):
        call(*gains)


def test_an_unstable_gamma_is_refused():
    with pytest.raises(ValueError, match="gamma"):
        noise_ratio(0.5, 0.7, [0.1, 0.94])  # the edge is at 0.9333


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: steady_error(0.5, 0.4, dt=-1), "dt must be finite and > 0, got -1"),
        (lambda: steady_error(0.5, 0.4, acceleration=np.nan), "acceleration must be finite"),
        (lambda: steady_error(0.5, 0.4, jerk=np.inf), "jerk must be finite"),
        (lambda: circular_error(0.5, 0.4, 0, np.nan, 1, 1), "angular_rate must be finite"),
        (lambda: circular_error(0.5, 0.4, 0, 1, 0, 1), "dt must be finite and > 0"),
        (lambda: circular_error(0.5, 0.4, 0, 1, 1, -1), "radius must be finite and >= 0"),
        (lambda: transient_cost(0.5, 0.4, 0, -2, 1, 1), "dt must be finite and > 0"),
        (lambda: transient_cost(0.5, 0.4, 0, 1, np.nan, 1), "velocity must be finite"),
        (lambda: transient_cost(0.5, 0.4, 0, 1, 1, np.nan), "acceleration must be finite"),
        (lambda: covariance(0.5, 0.4, -1, 1), "sigma_w must be finite and >= 0"),
        (lambda: covariance(0.5, 0.4, 1, 0), "dt must be finite and > 0"),
        (lambda: covariance(0.5, 0.4, 1, 1, -1), "sigma_v must be finite and >= 0"),
        (lambda: frequency_response(0.5, 0.4, 0, np.nan, 1), "frequencies must be finite"),
        (lambda: frequency_response(0.5, 0.4, 0, 1, -1), "dt must be finite and > 0"),
        (lambda: frequency_response(0.5, 0.4, 0, 1, 1, of="speed"), "of must be one of"),
        (lambda: noise_ratio(0.5, 0.4, of="speed"), "of must be one of 'predicted', .*'speed'"),
    ],
)
def test_arguments_out_of_range_are_named(call, name):
    with pytest.raises(ValueError, match=name):
        call()
