import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains import (
    Region,
    critically_damped,
    eigenfrequency,
    from_abc,
    in_closed_region,
    is_stable,
    jury,
    poles,
    region,
)
from fuzzytrack.gains.checks import nonnegative, stable_gains

unit = st.floats(0.001, 0.999)


def recursions(alpha, beta, gamma):
    """Matrices of the literal recursion: predict (x, Tv, T²a), then correct."""
    predict = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gain = np.stack(np.broadcast_arrays(alpha, beta, np.asarray(gamma) / 2), axis=-1)
    return (np.eye(3) - gain[..., :, None] * np.array([1.0, 0, 0])) @ predict


def companions(polynomials):
    order = polynomials.shape[-1] - 1
    matrices = np.zeros((*polynomials.shape[:-1], order, order))
    matrices[..., 0, :] = -polynomials[..., 1:] / polynomials[..., :1]
    matrices[..., 1:, :-1] += np.eye(order - 1)
    return matrices


def radius(matrices):
    return np.abs(np.linalg.eigvals(matrices)).max(axis=-1)


# ---------------------------------------------------------------- Jury


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_jury_agrees_with_the_roots(order):
    rng = np.random.default_rng(order)
    count = 10_000
    # Random coefficients are nearly all unstable at high order; random roots are half and half.
    coefficients = rng.normal(size=(count, order + 1))
    limit = 0.5 ** (1 / order) * 2
    built = np.ones((count, 1))
    for _ in range(order // 2):
        size, angle = limit * np.sqrt(rng.random(count)) / 1.1, rng.uniform(0, np.pi, count)
        built = times(built, np.stack([np.ones(count), -2 * size * np.cos(angle), size**2], -1))
    if order % 2:
        built = times(built, np.stack([np.ones(count), rng.uniform(-1.2, 1.2, count)], -1))
    scales = rng.choice([-3.0, 1.0, 1e-200, 1e200], count)[:, None]
    for polynomials in (coefficients, built * scales):
        largest = radius(companions(polynomials))
        clear = np.abs(largest - 1) > 1e-7
        assert clear.mean() > 0.99
        np.testing.assert_array_equal(jury(polynomials)[clear], (largest < 1)[clear])
    stable = jury(built).mean()
    assert 0.02 < stable < 0.98


def times(left, right):
    product = np.zeros((len(left), left.shape[1] + right.shape[1] - 1))
    for power in range(right.shape[1]):
        product[:, power : power + left.shape[1]] += left * right[:, power : power + 1]
    return product


@pytest.mark.parametrize("polynomial", [[1, 0, 1], [1, -2, 1], [1, -1], [1, 1], [1, 0, 0, -1]])
def test_jury_is_strict_on_the_circle(polynomial):
    assert not jury(polynomial)


def test_jury_of_many_and_of_one():
    answers = jury([[[1, 0, 0.5], [1, 0, 2]], [[-1, 0, -0.5], [1, 0, 0]]])
    np.testing.assert_array_equal(answers, [[True, False], [True, True]])
    assert isinstance(jury([1, 0, 0.5]), np.bool_)
    assert jury(np.empty((0, 3))).shape == (0,)
    assert not jury([1, 0, 1, 0, 0])  # a row of zeros in the table


def test_jury_says_what_it_cannot_take():
    with pytest.raises(ValueError, match=r"at least 2 values.*got shape \(1,\)"):
        jury([1])
    with pytest.raises(ValueError, match="got shape \\(\\)"):
        jury(1)
    with pytest.raises(ValueError, match="begin with a value other than 0"):
        jury([[1, 2], [0, 1]])
    with pytest.raises(ValueError, match=r"coefficients must be finite, got nan at index \(1, 0\)"):
        jury([[1, 2], [np.nan, 1]])


# ---------------------------------------------------------------- stability


def test_stable_is_what_has_all_poles_inside_the_circle():
    rng = np.random.default_rng(1)
    alpha = rng.uniform(-0.1, 2.1, 100_000)
    beta = rng.uniform(-0.1, 4.1, 100_000) * (1.05 - alpha / 2)
    gamma = rng.uniform(-0.05, 1.3, 100_000) * np.minimum(8, np.abs(4 * alpha * beta / (2 - alpha)))
    matrices = recursions(alpha, beta, gamma)
    expected = radius(matrices) < 1
    assert 0.3 < expected.mean() < 0.9
    np.testing.assert_array_equal(is_stable(alpha, beta, gamma), expected)
    np.testing.assert_array_equal(np.abs(poles(alpha, beta, gamma)).max(axis=-1) < 1, expected)
    np.testing.assert_array_equal(is_stable(alpha, beta), radius(matrices_of_two(alpha, beta)) < 1)


def matrices_of_two(alpha, beta):
    """The recursion of the α-β filter for (x, Tv)."""
    rows = [[1 - alpha, 1 - alpha], [-beta, 1 - beta]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def test_largest_gamma():
    """4αβ/(2 - α) = 0.9333... at (0.5, 0.7)."""
    assert is_stable(0.5, 0.7, 0.9333333333)
    assert not is_stable(0.5, 0.7, 0.9333333334)
    assert np.abs(poles(0.5, 0.7, 4 * 0.5 * 0.7 / 1.5)).max() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(
    ("alpha", "beta", "gamma", "stable"),
    [
        (1.5, 0.5, 0, True),  # α < 1 is not needed
        (0.5, -0.1, 0, False),
        (0.0, 0.5, 0, False),
        (2.0, 1e-9, 0, False),
        (1.0, 2.0, 0, False),
        (1.0, 1.0, 0, True),
        (0.5, 0.7, -1e-9, False),
        (1e-200, 1e-200, 0, True),
        (1e300, 1e300, 1e300, False),
    ],
)
def test_edges_of_the_triangle(alpha, beta, gamma, stable):
    assert is_stable(alpha, beta, gamma) == stable


# ---------------------------------------------------------------- poles


def test_known_poles():
    np.testing.assert_allclose(poles(0.5, 0.7), [0.4 + 0.583095j, 0.4 - 0.583095j], atol=5e-7)
    assert poles(0.5, [0.7, 0.1]).shape == (2, 2)
    assert poles(0.5, [0.7, 0.1], 0).shape == (2, 2)
    assert poles(0.5, [0.7, 0.1], [[0], [0.1]]).shape == (2, 2, 3)
    assert poles(0.5, 0.7, [0, 0.1])[0, 2] == 1
    np.testing.assert_array_equal(poles(1, 1), [0, 0])
    np.testing.assert_array_equal(poles(0, 0), [1, 1])


@given(unit, unit, st.floats(-0.999, 0.999))
def test_poles_are_the_eigenvalues_of_the_recursion(across, up, c):
    gains = from_abc(2 * across, up * (4 - 4 * across), c)
    computed = poles(*gains)
    # Coefficients are compared, since multiple roots are known only to a root of the rounding.
    matrix = recursions(*gains)
    np.testing.assert_allclose(np.poly(computed), np.poly(matrix), atol=2e-13)
    pair = poles(*gains[:2])
    np.testing.assert_allclose(np.poly(pair), np.poly(matrices_of_two(*gains[:2])), atol=2e-13)


def test_poles_come_in_a_fixed_order():
    rng = np.random.default_rng(2)
    found = poles(*rng.uniform(-3, 5, (3, 1000)))
    assert (found[:, 0].imag >= 0).all()
    assert (found[:, 2].imag == 0).all()
    real = found[:, 0].imag == 0
    assert (found[real, 0].real >= found[real, 1].real).all()
    assert (found[real, 2].real >= found[real, 0].real - 1e-7).all()
    np.testing.assert_allclose(found[~real, 0], found[~real, 1].conj())
    assert 0.1 < real.mean() < 0.9


# ---------------------------------------------------------------- regions


def test_regions_are_those_of_the_poles():
    rng = np.random.default_rng(3)
    alpha, beta = rng.uniform(-0.1, 2.1, 20_000), rng.uniform(-0.1, 4.1, 20_000)
    found = np.linalg.eigvals(matrices_of_two(alpha, beta))
    first, second = found[:, 0], found[:, 1]
    complex_ = first.imag != 0
    expected = np.select(
        [
            np.abs(found).max(axis=-1) >= 1,
            complex_ & (first.real >= 0),
            complex_,
            first.real * second.real < 0,
            first.real + second.real > 0,
        ],
        [
            "unstable",
            "underdamped",
            "underdamped, negative real part",
            "mixed",
            "overdamped",
        ],
        "oscillating at the Nyquist rate",
    )
    names = region(alpha, beta)
    np.testing.assert_array_equal(names, expected)
    assert set(names) == set(Region)


def test_lines_between_regions():
    alpha = np.linspace(0.001, 1, 400)
    assert (region(alpha, critically_damped(alpha)) == Region.OVERDAMPED).all()
    assert (region(alpha[:-1], critically_damped(alpha[:-1], "upper")) == Region.NYQUIST).all()
    assert (region([0.25, 0.5, 0.75], [1.75, 1.5, 1.25]) == Region.UNDERDAMPED).all()
    assert region(1, 1) == Region.OVERDAMPED
    assert Region(region(1, 1.5)) is Region.NYQUIST
    assert region(1, 2) == region(0.5, 0) == Region.UNSTABLE
    assert region(np.full((3, 1), 0.5), np.full(4, 0.7)).shape == (3, 4)


# ---------------------------------------------------------------- frequency


def test_known_frequencies():
    assert eigenfrequency(0.5, 0.7) == pytest.approx(0.969532110, abs=5e-10)
    # A plain arctangent of the quotient gives -1.052990559 here.
    assert eigenfrequency(0.5, 2.2) == pytest.approx(2.088602095, abs=5e-10)
    assert eigenfrequency(0.5, 2.2) == pytest.approx(np.pi - 1.052990559, abs=1e-9)


def test_frequency_is_the_angle_of_the_dominant_pole():
    rng = np.random.default_rng(4)
    alpha, beta = rng.uniform(-1, 3, 20_000), rng.uniform(-1, 5, 20_000)
    found = np.linalg.eigvals(matrices_of_two(alpha, beta))
    dominant = np.take_along_axis(found, np.abs(found).argmax(axis=-1)[:, None], axis=-1)[:, 0]
    np.testing.assert_allclose(eigenfrequency(alpha, beta), np.abs(np.angle(dominant)), atol=1e-6)


def test_critically_damped_filters_do_not_ring():
    alpha = np.linspace(0.001, 1, 400)
    assert (eigenfrequency(alpha, critically_damped(alpha)) == 0).all()
    np.testing.assert_array_equal(
        eigenfrequency(alpha[:-1], critically_damped(alpha[:-1], "upper")), np.pi
    )


# ---------------------------------------------------------------- arguments


@pytest.mark.parametrize("function", [is_stable, poles])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_gains_must_be_finite(function, bad):
    for name, gains in (("alpha", (bad, 1, 1)), ("beta", (1, bad, 1)), ("gamma", (1, 1, bad))):
        with pytest.raises(ValueError, match=f"{name} must be finite, got {bad}"):
            function(*gains)


@pytest.mark.parametrize("function", [region, eigenfrequency])
def test_pairs_must_be_finite(function):
    with pytest.raises(ValueError, match="alpha must be finite, got nan at index 1"):
        function([0.5, np.nan], 0.5)
    with pytest.raises(ValueError, match="beta must be finite, got inf"):
        function(0.5, np.inf)


def test_the_shared_check_names_the_first_bad_gains_and_the_region():
    a, b, c = stable_gains([[0.5], [0.6]], [0.1, 0.2, 0.3])
    assert a.shape == b.shape == c.shape == (2, 3)
    with pytest.raises(ValueError, match=r"2 alpha \+ beta < 4; got alpha=0.5, beta=nan at index"):
        stable_gains([0.5, 0.5], [0.1, np.nan])
    with pytest.raises(
        ValueError,
        match=r"0 <= gamma < 4 alpha beta / \(2 - alpha\); "
        r"got alpha=0.5, beta=0.1, gamma=9 at index \(1, 0\)",
    ):
        stable_gains(0.5, [0.1, 0.2], [[0.1, 0.1], [9, 0.1]])
    with pytest.raises(ValueError, match=r"got alpha=0.5, beta=0.2, gamma=-1$"):
        stable_gains(0.5, 0.2, -1)
    with pytest.raises(ValueError, match="radius must be finite and >= 0, got -1 at index 2"):
        nonnegative("radius", [0, 1, -1])


def test_the_theory_of_gains_is_pure_numpy():
    code = (
        "import sys, fuzzytrack.gains as g; g.kalata(1, 3); g.to_abc(.5, .4, .1); g.poles(.5, .4);"
        "sys.exit(any(name.split('.')[0] in ('scipy', 'matplotlib') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@given(
    st.floats(-0.5, 2.5), st.floats(-0.5, 4.5), st.floats(-0.5, 8.0) | st.just(0.0), st.floats(0, 1)
)
def test_the_closed_region_is_that_of_poles_within_the_circle(alpha, beta, gamma, retention):
    step = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gains = np.array([[alpha], [beta], [gamma / 2]])
    keep = np.diag([1.0, 1.0, retention if gamma else 0.0])
    poles = np.linalg.eigvals(keep @ (np.eye(3) - gains @ [[1, 0, 0]]) @ step)
    size = np.abs(poles).max()
    if abs(size - 1) > 1e-4:
        assert in_closed_region(alpha, beta, gamma, retention) == (size < 1)
    if is_stable(alpha, beta, gamma):
        assert in_closed_region(alpha, beta, gamma)


def test_the_edge_belongs_to_the_closed_region():
    assert in_closed_region([0, 0, 2, 1, 1.5], [0, 4, 0, 2, 1]).all()
    assert in_closed_region([0.5, 1.0], [0.7, 1.5], 4 * np.array([0.35, 1.5]) / [1.5, 1.0]).all()
    assert not in_closed_region([0, 2.1, 1, 1e300], [-0.1, 0.1, 2.1, 1e300], [0, 0, 0, 1.0]).any()
