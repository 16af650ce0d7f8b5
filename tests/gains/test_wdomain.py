import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains import (
    alpha_beta_from_s,
    alpha_beta_from_w,
    alpha_beta_gamma_from_w,
    benedict_bordner,
    critically_damped,
    eigenfrequency,
    from_abc,
    is_stable,
    kalata,
    kalata_damping,
    poles,
    w_from_alpha_beta,
    w_from_alpha_beta_gamma,
)

# Spans more decades than any design, and leaves room for the square in floating point.
positive = st.floats(1e-5, 1e5)


@pytest.mark.parametrize(
    ("zeta", "omega0", "alpha", "beta"),
    [
        (0.7, 0.3, 0.556291391, 0.238410596),
        (0.54, 0.25, 0.405253283, 0.187617261),
        (0.89, 0.35, 0.713835577, 0.280721856),
        (1.3, 0.8, 1.118279570, 0.688172043),
        (1.0, 1.0, 1.0, 1.0),
    ],
)
def test_known_values(zeta, omega0, alpha, beta):
    assert alpha_beta_from_w(omega0, zeta) == pytest.approx((alpha, beta), abs=5e-10)


def test_corners_of_the_published_limits():
    alpha, beta = alpha_beta_from_w([0.25, 0.25, 0.35, 0.35], [0.54, 0.89, 0.54, 0.89])
    np.testing.assert_allclose(alpha, [0.4053, 0.5904, 0.5038, 0.7138], atol=1e-4)
    np.testing.assert_allclose(beta, [0.1876, 0.1658, 0.3266, 0.2807], atol=1e-4)
    assert w_from_alpha_beta(0.5377, 0.2018) == pytest.approx((0.27224, 0.72539), abs=1e-4)


@given(positive, positive)
def test_every_frequency_and_damping_give_a_stable_filter(omega0, zeta):
    alpha, beta = map(float, alpha_beta_from_w(omega0, zeta))
    assert alpha > 0
    assert beta > 0
    # 4 - 2α - β = 4/(1 + 2ζω₀ + ω₀²) is lost to rounding only where it is smaller than that.
    room = 4 / (1 + 2 * zeta * omega0 + omega0**2)
    assert 4 - 2 * alpha - beta == pytest.approx(room, rel=1e-9, abs=2e-15)


@given(st.floats(0.01, 30), st.floats(0.01, 30))
def test_poles_of_the_recursion_lie_inside_the_unit_circle(omega0, zeta):
    alpha, beta = map(float, alpha_beta_from_w(omega0, zeta))
    transition = np.array([[1 - alpha, 1 - alpha], [-beta, 1 - beta]])  # of (x, T v), filtered
    assert np.abs(np.linalg.eigvals(transition)).max() < 1


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_map_is_a_bijection(omega0, zeta):
    back = w_from_alpha_beta(*alpha_beta_from_w(omega0, zeta))
    assert back == pytest.approx((omega0, zeta), rel=1e-6)


@given(st.floats(0.0, 1.0, exclude_min=True, exclude_max=True), st.floats(0.001, 0.999))
def test_the_inverse_covers_the_whole_triangle(across, up):
    alpha, beta = 2 * across, up * (4 - 4 * across)
    if alpha < 1e-6 or 4 - 2 * alpha - beta < 1e-6:
        return
    assert alpha_beta_from_w(*w_from_alpha_beta(alpha, beta)) == pytest.approx(
        (alpha, beta), rel=1e-6
    )


@pytest.mark.parametrize("index", [0.01, 0.1, 0.327, 1.0, 5.0])
def test_kalata_gains_lie_on_their_design_curve(index):
    """Kalata's steady-state gains are ω₀ = √λ/2 and ζ² = 1/2 + ω₀²/4."""
    r = (4 + index - np.sqrt(8 * index + index**2)) / 4
    expected = 1 - r**2, 2 * (1 + r**2) - 4 * r
    omega0 = np.sqrt(index) / 2
    gains = alpha_beta_from_w(omega0, np.sqrt(0.5 + omega0**2 / 4))
    assert gains == pytest.approx(expected, abs=1e-12)
    assert gains == pytest.approx(kalata(index), abs=1e-14)


@given(st.floats(0.01, 0.99))
def test_design_curves(alpha):
    omega0, zeta = w_from_alpha_beta(alpha, benedict_bordner(alpha))
    assert zeta == pytest.approx(np.sqrt((1 + omega0**2) / 2), rel=1e-12)
    omega0, zeta = w_from_alpha_beta(alpha, critically_damped(alpha))
    assert zeta == pytest.approx(1, rel=1e-12)
    # Least steady error for a noise ratio: (2α + β)² = 4β.
    beta = (2 * (1 - np.sqrt(1 - 0.999 * alpha / 2 - 0.0005))) ** 2
    omega0, zeta = w_from_alpha_beta(np.sqrt(beta) - beta / 2, beta)
    assert zeta == pytest.approx((np.sqrt(omega0**2 + 4) - omega0) / 4, rel=1e-9)


@given(st.floats(0.01, 5), st.floats(0.05, 5))
def test_where_alpha_exceeds_one(omega0, zeta):
    limit = (1 + omega0**2) / (2 * omega0)
    if abs(zeta - limit) > 1e-9:
        assert (alpha_beta_from_w(omega0, zeta)[0] > 1) == (zeta > limit)


# ---------------------------------------------------------------- sampling time


def test_frequency_in_radians_per_second():
    expected = pytest.approx((0.556291391, 0.238410596), abs=5e-10)
    assert alpha_beta_from_w(0.02, 0.7, dt=30) == expected
    assert alpha_beta_from_w(0.3, 0.7, dt=2) == expected
    back = w_from_alpha_beta(*alpha_beta_from_w(0.02, 0.7, dt=30), dt=30)
    assert back == pytest.approx((0.02, 0.7), rel=1e-12)
    assert alpha_beta_from_w(0.02, 0.7, dt=[10, 20, 30])[0].shape == (3,)
    assert w_from_alpha_beta(0.5, 0.2, dt=[10, 20, 30])[0].shape == (3,)


@given(st.floats(0.001, 1), st.floats(0.05, 3), st.floats(0.1, 50))
def test_poles_are_the_bilinear_image_of_the_continuous_ones(omega0, zeta, dt):
    s = np.roots([1, 2 * zeta * omega0, omega0**2]) * dt / 2
    alpha, beta = alpha_beta_from_w(omega0, zeta, dt)
    np.testing.assert_allclose(
        [1, alpha + beta - 2, 1 - alpha], np.poly((1 + s) / (1 - s)).real, atol=1e-12
    )


@pytest.mark.parametrize("value", [-1, 0, np.nan, np.inf])
def test_a_sampling_time_is_positive(value):
    for call in (
        lambda: alpha_beta_from_w(0.1, 0.7, value),
        lambda: w_from_alpha_beta(0.5, 0.2, value),
        lambda: alpha_beta_gamma_from_w(0.1, 0.7, 0.1, value),
        lambda: w_from_alpha_beta_gamma(0.5, 0.4, 0.1, value),
        lambda: alpha_beta_from_s(0.1, 0.7, value),
    ):
        with pytest.raises(ValueError, match=f"dt must be finite and > 0, got {value}"):
            call()


# ---------------------------------------------------------------- the third pole


def test_known_values_with_a_third_pole():
    expected = pytest.approx((0.672041463, 0.352433055, 0.124388137), abs=5e-10)
    assert alpha_beta_gamma_from_w(0.02, 0.7, 0.01, dt=30) == expected
    assert alpha_beta_gamma_from_w(0.3, 0.7, 0.15) == expected


def test_no_third_pole_is_the_alpha_beta_filter():
    omega0, zeta = np.meshgrid(np.linspace(0, 3, 20), np.linspace(0, 3, 20))
    alpha, beta, gamma = alpha_beta_gamma_from_w(omega0, zeta, 0, dt=3.0)
    np.testing.assert_array_equal((alpha, beta), alpha_beta_from_w(omega0, zeta, dt=3.0))
    assert not gamma.any()


@given(
    st.floats(0.01, 10), st.floats(0.05, 5), st.floats(0.01, 10), st.sampled_from([None, 0.5, 4.0])
)
def test_third_pole_there_and_back(omega0, zeta, omega3, dt):
    half = 1 if dt is None else dt / 2
    gains = alpha_beta_gamma_from_w(omega0, zeta, omega3, dt)
    assert is_stable(*gains)
    w = np.append(np.roots([1, 2 * zeta * omega0, omega0**2]), -omega3) * half
    np.testing.assert_allclose(
        np.poly(poles(*gains)).real, np.poly((1 + w) / (1 - w)).real, atol=1e-11
    )
    a, b = alpha_beta_from_w(omega0, zeta, dt)
    assert gains == pytest.approx(from_abc(a, b, (omega3 * half - 1) / (omega3 * half + 1)))
    back = w_from_alpha_beta_gamma(*gains, dt)
    assert alpha_beta_gamma_from_w(*back, dt) == pytest.approx(gains, rel=1e-9, abs=1e-12)
    if zeta < 0.99:  # two complex poles: no choice which one is the third
        assert back == pytest.approx((omega0, zeta, omega3), rel=1e-5)
    else:
        assert back[2] <= omega3 * (1 + 1e-4)


def test_every_stable_triple_has_frequencies():
    rng = np.random.default_rng(0)
    alpha = rng.uniform(0, 2, 10_000)
    beta = rng.random(10_000) * (4 - 2 * alpha)
    gamma = rng.random(10_000) * 4 * alpha * beta / (2 - alpha)
    found = w_from_alpha_beta_gamma(alpha, beta, gamma)
    assert all((value > 0).all() for value in found)
    np.testing.assert_allclose(alpha_beta_gamma_from_w(*found), (alpha, beta, gamma), atol=1e-13)


def test_third_pole_shapes_and_errors():
    gains = alpha_beta_gamma_from_w(0.3, np.full((3, 1), 0.7), np.full(4, 0.1))
    assert [gain.shape for gain in gains] == [(3, 4)] * 3
    assert [gain.shape for gain in w_from_alpha_beta_gamma(0.5, 0.4, [0, 0.1])] == [(2,)] * 3
    with pytest.raises(ValueError, match="omega3 must be finite and >= 0, got -1"):
        alpha_beta_gamma_from_w(0.3, 0.7, -1)
    with pytest.raises(ValueError, match=r"0 <= gamma < 4 alpha beta / \(2 - alpha\); got .*=0.95"):
        w_from_alpha_beta_gamma(0.5, 0.7, [0.9, 0.95])


# ---------------------------------------------------------------- matched poles


def test_known_values_of_matched_poles():
    assert alpha_beta_from_s(0.02, 0.7, dt=30) == pytest.approx(
        (0.568289477, 0.236416242), abs=5e-10
    )
    assert alpha_beta_from_s(0.02, [[0.7], [1.7]], dt=[1, 2, 3])[1].shape == (2, 3)
    assert alpha_beta_from_s(0, 0.7, 1) == (0, 0)
    assert alpha_beta_from_s(1, 0, 1) == pytest.approx((0, 2 - 2 * np.cos(1)))


@given(st.floats(0.001, 3), st.floats(0.01, 5), st.floats(0.1, 1))
def test_matched_poles_are_sampled_continuous_ones(omega0, zeta, dt):
    alpha, beta = alpha_beta_from_s(omega0, zeta, dt)
    s = np.roots([1, 2 * zeta * omega0, omega0**2])
    np.testing.assert_allclose(
        [1, alpha + beta - 2, 1 - alpha], np.poly(np.exp(s * dt)).real, atol=1e-12
    )
    assert is_stable(alpha, beta)
    if zeta < 0.99:
        assert eigenfrequency(alpha, beta) == pytest.approx(
            omega0 * dt * np.sqrt(1 - zeta**2), rel=1e-6, abs=1e-9
        )


def test_slow_filters_are_the_same_either_way():
    slow = alpha_beta_from_s(1e-6, [0.3, 1, 4], 1)
    np.testing.assert_allclose(slow, alpha_beta_from_w(1e-6, [0.3, 1, 4], 1), rtol=1e-4)


def test_arrays_broadcast():
    alpha, beta = alpha_beta_from_w(np.full((3, 1), 0.3), np.full(4, 0.7))
    assert alpha.shape == beta.shape == (3, 4)
    omega0, zeta = w_from_alpha_beta(alpha, 0.2)
    assert omega0.shape == zeta.shape == (3, 4)
    assert alpha_beta_from_w([], 0.5)[0].shape == (0,)


def test_the_edge_of_the_quarter_plane_is_marginal():
    assert alpha_beta_from_w(0.5, 0.0) == pytest.approx((0.0, 0.8))
    assert alpha_beta_from_w(0.0, 0.5) == pytest.approx((0.0, 0.0))


@pytest.mark.parametrize("value", [-0.1, np.nan, np.inf])
def test_impossible_arguments_are_named(value):
    with pytest.raises(ValueError, match="omega0 must be finite and >= 0"):
        alpha_beta_from_w(value, 0.7)
    with pytest.raises(ValueError, match="zeta must be finite and >= 0"):
        alpha_beta_from_w([0.3, 0.3], [0.7, value])


@pytest.mark.parametrize(
    ("alpha", "beta"), [(0.0, 0.2), (0.5, 0.0), (1.5, 1.0), (np.nan, 0.1), (-0.1, 0.1)]
)
def test_unstable_gains_have_no_inverse(alpha, beta):
    with pytest.raises(ValueError, match="stability triangle"):
        w_from_alpha_beta([0.5, alpha], [0.2, beta])


@given(st.floats(1e-3, 3.0))
def test_the_damping_of_kalatas_gains(omega0):
    gains = alpha_beta_from_w(omega0, kalata_damping(omega0))
    assert gains == pytest.approx(kalata(4 * omega0**2), rel=1e-9)
