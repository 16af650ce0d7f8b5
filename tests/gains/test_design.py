import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_discrete_are

from fuzzytrack.gains import (
    benedict_bordner,
    critically_damped,
    fading_memory,
    growing_memory,
    is_stable,
    kalata,
    poles,
    quality,
    tracking_index,
    w_from_alpha_beta,
)

indices = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
PREDICT = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])


def kalman(noise, order):
    """Steady gains (α, β[, γ]) and covariances at T = σ_w = 1, from the Riccati equation."""
    predict, observe = PREDICT[:order, :order], np.eye(order)[:1]
    before = solve_discrete_are(predict.T, observe.T, noise, np.ones((1, 1)))
    gain = before[:, 0] / (before[0, 0] + 1)
    after = before - np.outer(gain, before[0])
    return gain * np.array([1, 1, 2])[:order], before, after


def run(gains_of, plots, start=0, state=None):
    """The recursion with gains of step k; the state (x, Tv, T²a) after each plot."""
    state = np.zeros(3) if state is None else state
    for k in range(start, len(plots)):
        alpha, beta, gamma = (*gains_of(k), 0.0)[:3]
        predicted = PREDICT @ state
        state = predicted + np.array([alpha, beta, gamma / 2]) * (plots[k] - predicted[0])
        yield k, state


def fitted(plots, order, weights=None):
    """Position, velocity and acceleration at the last plot, of the least-squares polynomial."""
    age = np.arange(1.0 - len(plots), 1.0)
    coefficients = np.polyfit(age, plots, order - 1, w=weights)[::-1]
    return coefficients * np.array([1, 1, 2])[:order]


# ---------------------------------------------------------------- Kalata


def test_tracking_index():
    assert tracking_index(2.0, 100.0, 5.0) == pytest.approx(0.5)
    assert tracking_index([0, 2], 100.0, [[5], [10]]).shape == (2, 2)
    for name, arguments in (
        ("sigma_v must be finite and >= 0, got -1", (-1, 1, 1)),
        ("sigma_w must be finite and > 0, got 0", (1, 0, 1)),
        ("dt must be finite and > 0, got nan", (1, 1, np.nan)),
    ):
        with pytest.raises(ValueError, match=name):
            tracking_index(*arguments)


@pytest.mark.parametrize(
    ("index", "alpha", "beta", "velocity_variance"),
    [
        (1, 0.75, 0.5, 1),
        (0.1, 0.36, 0.08, 0.04),
        (0.327, 0.5521479360, 0.2188341229, 0.2163317542),
        (5, 0.9450399668, 1.1721778146, 7.6556443707),
        (0.01, 0.1318509913, 0.0093174514, None),
    ],
)
def test_known_gains_of_order_two(index, alpha, beta, velocity_variance):
    assert kalata(index) == pytest.approx((alpha, beta), abs=6e-11)
    alpha, beta = kalata(index)
    _, before, after = kalman(index**2 * np.outer([0.5, 1], [0.5, 1]), 2)
    assert beta * (2 * alpha - beta) / (2 * (1 - alpha)) == pytest.approx(after[1, 1], rel=1e-8)
    if velocity_variance is not None:
        assert after[1, 1] == pytest.approx(velocity_variance, abs=6e-11)
    # Variance of the innovation, and the part of it that the state before the maneuver has.
    assert before[0, 0] + 1 == pytest.approx(1 / (1 - alpha), rel=1e-9)
    carried = before[0, 0] - index**2 / 4
    assert carried == pytest.approx(alpha / (1 - alpha) - index**2 / 4, rel=1e-7)


@pytest.mark.parametrize(
    ("index", "gains"),
    [
        (1, (0.8643179409, 0.7979622904, 0.7367009139)),
        (0.1, (0.6047587512, 0.2757538879, 0.1257364305)),
        # The acceleration-only optimum at La is Kalata's filter of λ = La.
        (0.5, (0.7953736627, 0.5998269654, 0.4523564273)),
        (2, (0.9189033352, 1.0230942834, 1.1390990463)),
    ],
)
def test_known_gains_of_order_three(index, gains):
    assert kalata(index, 3) == pytest.approx(gains, abs=6e-11)


@given(indices)
@settings(max_examples=50)
def test_gains_are_those_of_the_steady_kalman_filter(index):
    for order, push in ((2, [0.5, 1]), (3, [0.5, 1, 1])):
        expected = kalman(index**2 * np.outer(push, push), order)[0]
        np.testing.assert_allclose(kalata(index, order), expected, rtol=1e-6)


@given(st.floats(1e-8, 1e4))
def test_relations_of_the_gains(index):
    alpha, beta = kalata(index)
    assert beta**2 / (1 - alpha) == pytest.approx(index**2, rel=1e-6)
    assert beta == pytest.approx(2 * (2 - alpha) - 4 * np.sqrt(1 - alpha), abs=1e-11)
    omega0, zeta = w_from_alpha_beta(alpha, beta)
    assert omega0 == pytest.approx(np.sqrt(index) / 2, rel=1e-6)
    assert zeta**2 == pytest.approx(0.5 + omega0**2 / 4, rel=1e-6)
    alpha, beta, gamma = kalata(index, 3)
    assert gamma == pytest.approx(beta**2 / alpha, rel=1e-12)
    assert gamma**2 / (4 * (1 - alpha)) == pytest.approx(index**2, rel=1e-6)
    assert beta == pytest.approx(2 * (2 - alpha) - 4 * np.sqrt(1 - alpha), abs=1e-11)


def test_gains_over_the_whole_range_of_numbers():
    index = 10.0 ** np.arange(-300, 301, 10)
    for order in (2, 3):
        gains = np.array(kalata(index, order))
        assert np.isfinite(gains).all()
        assert (np.diff(gains) >= 0).all()
        ordinary = (index > 1e-60) & (index < 1e11)
        assert is_stable(*gains[:, ordinary]).all()
    # α → √(8λ)/2 and the like keep their digits.
    small = index[index < 1e-20]
    np.testing.assert_allclose(kalata(small)[0], np.sqrt(2 * small), rtol=1e-9)
    np.testing.assert_allclose(kalata(small, 3)[0], 2 * np.cbrt(small), rtol=1e-6)
    assert kalata(0) == (0, 0)
    assert kalata(0, 3) == (0, 0, 0)


# ---------------------------------------------------------------- curves


@given(indices)
@settings(max_examples=50)
def test_benedict_bordner_is_a_steady_kalman_filter(strength):
    """That of a target whose position and velocity jump together: Q of [1 1; 1 1]."""
    alpha, beta = kalman(strength**2 * np.ones((2, 2)), 2)[0]
    assert benedict_bordner(alpha) == pytest.approx(beta, rel=1e-6)
    omega0, zeta = w_from_alpha_beta(alpha, benedict_bordner(alpha))
    assert zeta**2 == pytest.approx((1 + omega0**2) / 2, rel=1e-9)


@pytest.mark.parametrize(
    ("alpha", "beta"),
    [
        (0.5377, 0.197717),
        (0.3617694618, 0.0798893321),
        (0.7690872515, 0.4805338162),
        (0.9671862148, 0.9057287843),
    ],
)
def test_known_values_of_benedict_bordner(alpha, beta):
    assert benedict_bordner(alpha) == pytest.approx(beta, abs=5e-7)


def test_benedict_bordner_is_stable_up_to_its_end():
    end = 4 - 2 * np.sqrt(2)
    alpha = np.linspace(0, end, 102)[1:-1]
    assert is_stable(alpha, benedict_bordner(alpha)).all()
    assert not is_stable(end + 1e-9, (end + 1e-9) ** 2 / (2 - end))
    for bad in (0, end + 1e-9, np.nan):
        with pytest.raises(ValueError, match=r"alpha must be > 0 and < 4 - 2 sqrt\(2\).*got"):
            benedict_bordner([0.5, bad])


@given(st.floats(0.001, 1))
def test_critically_damped_poles_coincide(alpha):
    s = np.sqrt(1 - alpha)
    for branch, pole in (("lower", s), ("upper", -s)):
        beta = critically_damped(alpha, branch)
        np.testing.assert_allclose(
            np.poly([pole, pole]), [1, alpha + beta - 2, 1 - alpha], atol=1e-15
        )
        np.testing.assert_allclose(poles(alpha, beta), pole, atol=1e-7)
    assert critically_damped(alpha) <= critically_damped(alpha, "upper")
    if alpha < 1:
        zeta = w_from_alpha_beta(alpha, critically_damped(alpha))[1]
        assert zeta == pytest.approx(1, rel=1e-9)


def test_critical_damping_of_the_published_alpha():
    assert critically_damped(0.5377) == pytest.approx(0.102447, abs=5e-7)
    assert critically_damped(np.full((2, 3), 0.5)).shape == (2, 3)
    assert critically_damped(1e-9) == pytest.approx(0.25e-18, rel=1e-8)
    for bad in (0, 1.001, np.nan):
        with pytest.raises(ValueError, match="alpha must be > 0 and <= 1, got"):
            critically_damped(bad)
    with pytest.raises(ValueError, match="branch must be 'lower' or 'upper', got 'middle'"):
        critically_damped(0.5, "middle")


# ---------------------------------------------------------------- memories


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("xi", [0.0, 0.3, 0.64, 0.8])
def test_fading_memory_is_discounted_least_squares(order, xi):
    plots = np.cumsum(np.random.default_rng(0).normal(size=250))
    gains = fading_memory(xi, order)
    for k, state in run(lambda _: gains, plots):
        if k >= 240:
            used = plots[: k + 1] if xi else plots[k + 1 - order : k + 1]
            # polyfit squares its weights
            weights = np.sqrt(xi if xi else 1) ** np.arange(len(used))[::-1]
            recent = weights > 1e-10
            expected = fitted(used[recent], order, weights[recent])
            np.testing.assert_allclose(state[:order], expected, atol=1e-6)


@given(st.floats(0, 0.999))
def test_fading_memory_has_all_poles_in_one_place(xi):
    pair, triple = fading_memory(xi), fading_memory(xi, 3)
    np.testing.assert_allclose(np.poly(poles(*pair)), np.poly([xi] * 2), atol=1e-14)
    np.testing.assert_allclose(np.poly(poles(*triple)), np.poly([xi] * 3), atol=1e-14)
    assert critically_damped(pair[0]) == pytest.approx(pair[1], abs=1e-7)
    assert is_stable(*triple)


def test_fading_memory_of_arrays_and_errors():
    assert [gain.shape for gain in fading_memory(np.zeros((2, 3)), 3)] == [(2, 3)] * 3
    assert fading_memory(0, 3) == (1, 1.5, 2)
    for bad in (-0.1, 1, np.nan):
        with pytest.raises(ValueError, match="xi must be >= 0 and < 1, got"):
            fading_memory(bad)


@pytest.mark.parametrize("order", [2, 3])
def test_growing_memory_is_least_squares(order):
    plots = np.random.default_rng(1).normal(size=60).cumsum()
    exact = np.zeros(3)
    exact[:order] = fitted(plots[:order], order)
    checked = 0
    for k, state in run(lambda k: growing_memory(k + 1, order), plots, order, exact):
        np.testing.assert_allclose(state[:order], fitted(plots[: k + 1], order), atol=1e-10)
        checked += 1
    assert checked == 60 - order
    # At n = order the gains alone make the fit exact, given states from one plot less.
    before = np.zeros(3)
    before[: order - 1] = fitted(plots[: order - 1], order - 1)
    for _, state in run(lambda k: growing_memory(k + 1, order), plots[:order], order - 1, before):
        np.testing.assert_allclose(state, exact, atol=1e-12)


def test_growing_memory_values_and_errors():
    assert growing_memory(2) == (1, 1)
    assert growing_memory(3, 3) == pytest.approx((1, 1.5, 2))
    n = np.arange(3, 1000)
    assert is_stable(*growing_memory(n)).all()
    assert is_stable(*growing_memory(n, 3)).all()
    assert growing_memory([[2, 3]])[0].shape == (1, 2)
    with pytest.raises(ValueError, match="n must be >= 2, the order, got 1 at index 1"):
        growing_memory([2, 1])
    with pytest.raises(ValueError, match="n must be >= 3, the order, got 2"):
        growing_memory(2, 3)
    with pytest.raises(ValueError, match="n must be finite, got inf"):
        growing_memory(np.inf)


@pytest.mark.parametrize("function", [kalata, fading_memory, growing_memory])
def test_order_is_two_or_three(function):
    with pytest.raises(ValueError, match="order must be 2 or 3, got 4"):
        function(0.5, order=4)


@pytest.mark.parametrize("bad", [-1, np.nan, np.inf])
def test_the_tracking_index_is_not_negative(bad):
    with pytest.raises(ValueError, match=f"tracking_index must be finite and >= 0, got {bad}"):
        kalata(bad, 3)


# ---------------------------------------------------------------- track quality


@pytest.mark.parametrize(
    ("n", "alpha", "beta"),
    [
        (1, 0.8333333333, 0.7003401715),
        (2, 0.7, 0.4091097700),
        (10, 0.2948717949, 0.0513799192),
        (30, 0.1193181818, 0.0075776687),
    ],
)
def test_known_gains_of_quality(n, alpha, beta):
    assert quality(n) == pytest.approx((alpha, beta), abs=6e-11)


def test_quality_mixes_growing_memory_and_kalata():
    n = np.arange(1, 200)
    alpha, beta = quality(n)
    np.testing.assert_array_equal(alpha, growing_memory(n + 2)[0])
    np.testing.assert_allclose(kalata(beta / np.sqrt(1 - alpha)), (alpha, beta), rtol=1e-12)
    assert (beta > growing_memory(n + 2)[1]).all()  # not the least-squares one
    assert quality([[1, 2]])[1].shape == (1, 2)
    with pytest.raises(ValueError, match="n must be >= 1, got 0 at index 1"):
        quality([1, 0])
    with pytest.raises(ValueError, match="n must be finite, got nan"):
        quality(np.nan)
