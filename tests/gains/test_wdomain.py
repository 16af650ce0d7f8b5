import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains import alpha_beta_from_w, w_from_alpha_beta

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
    kalata = 1 - r**2, 2 * (1 + r**2) - 4 * r
    omega0 = np.sqrt(index) / 2
    assert alpha_beta_from_w(omega0, np.sqrt(0.5 + omega0**2 / 4)) == pytest.approx(
        kalata, abs=1e-12
    )


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
