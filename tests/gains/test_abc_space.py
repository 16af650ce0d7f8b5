import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains import abc_preimages, fading_memory, from_abc, is_stable, to_abc

unit = st.floats(0.001, 0.999)


def prism(count, seed=0):
    """Random (a, b, c) of stable filters."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(0, 2, count)
    return a, rng.random(count) * (4 - 2 * a), rng.uniform(-1, 1, count)


def roots_of_the_recursion(alpha, beta, gamma):
    predict = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gain = np.array([[alpha], [beta], [gamma / 2]])
    return np.linalg.eigvals((np.eye(3) - gain @ [[1, 0, 0]]) @ predict)


def difference(left, right):
    return max(np.abs(x - y).max() for x, y in zip(left, right, strict=True))


@pytest.mark.parametrize(
    ("abc", "gains"),
    [((0.5, 0.3, -0.6), (0.7, 0.44, 0.24)), ((0.8, 0.6, 0.25), (1.05, 1.225, 1.5))],
)
def test_known_gains(abc, gains):
    assert from_abc(*abc) == pytest.approx(gains, abs=1e-15)


def test_known_inverse():
    assert to_abc(0.5, 0.4, 0.1) == pytest.approx(
        (0.421312281, 0.367711585, -0.864023865), abs=5e-10
    )
    a, b, c = abc_preimages(0.5, 0.4, 0.1)
    np.testing.assert_array_equal([a[0], b[0], c[0]], to_abc(0.5, 0.4, 0.1))
    assert np.isnan([a[1:], b[1:], c[1:]]).all()


def test_three_real_poles_give_three_preimages():
    expected = [
        (0.838997487, 0.292664992, -0.931662479),
        (0.75, 0.05, -0.6),
        (0.441002513, 0.027335008, -0.268337521),
    ]
    found = np.transpose(abc_preimages(0.85, 0.34, 0.04))
    np.testing.assert_allclose(found, expected, atol=5e-10)
    assert to_abc(0.85, 0.34, 0.04) == pytest.approx(expected[0], abs=5e-10)
    for abc in found:
        assert from_abc(*abc) == pytest.approx((0.85, 0.34, 0.04), abs=1e-15)


def test_round_trip():
    gains = from_abc(*prism(100_000))
    assert is_stable(*gains).all()
    a, b, c = to_abc(*gains)
    assert difference(from_abc(a, b, c), gains) <= 1e-14
    # Always inside the prism.
    assert ((a > 0) & (b > 0) & (2 * a + b < 4) & (np.abs(c) < 1)).all()


def test_round_trip_of_every_preimage():
    gains = from_abc(*prism(20_000, seed=1))
    found = abc_preimages(*gains)
    there = ~np.isnan(found[0])
    assert there[:, 0].all()
    assert (there[:, 1] == there[:, 2]).all()
    assert 0.2 < there[:, 1].mean() < 0.8
    repeated = [np.broadcast_to(gain[:, None], there.shape)[there] for gain in gains]
    assert difference(from_abc(*(value[there] for value in found)), repeated) <= 1e-14
    c = found[2][there[:, 1]]
    assert (np.diff(c, axis=-1) >= -1e-7).all()  # the largest pole first


def test_as_many_preimages_as_real_poles():
    for gains in np.transpose(from_abc(*prism(200, seed=2))):
        poles = roots_of_the_recursion(*gains)
        real = np.sort(poles[poles.imag == 0].real)[::-1]
        c = abc_preimages(*gains)[2]
        np.testing.assert_allclose(-c[: len(real)], real, atol=1e-6)
        assert np.isnan(c[len(real) :]).all()


@given(unit, unit, st.floats(-0.999, 0.999))
def test_the_polynomials_are_one(across, up, c):
    a, b = 2 * across, up * (4 - 4 * across)
    literal = np.poly(roots_of_the_recursion(*from_abc(a, b, c)))
    np.testing.assert_allclose(np.polymul([1, c], [1, a + b - 2, 1 - a]), literal, atol=1e-12)


@pytest.mark.parametrize("apart", [0, 1e-16, 1e-12, 1e-8, 1e-5])
@pytest.mark.parametrize("side", [1, -1])
def test_multiple_poles_are_no_trouble(apart, side):
    """Newton's method meets a double root, or a double root that is not quite one."""
    rng = np.random.default_rng(3)
    first, second, third = rng.random(5000), rng.random(5000), rng.uniform(-1, 1, 5000)
    first = side * first + apart * rng.normal(size=5000)
    second = first + apart * rng.normal(size=5000)
    third[:2000] = first[:2000]  # triple
    gains = from_abc(1 - first * second, (1 - first) * (1 - second), -third)
    assert difference(from_abc(*to_abc(*gains)), gains) <= 1e-14


def test_critically_damped_filters_have_one_triple_pole():
    xi = np.linspace(0, 0.999, 1000)
    gains = fading_memory(xi, order=3)
    assert difference(from_abc(*to_abc(*gains)), gains) <= 1e-14
    np.testing.assert_allclose(-to_abc(*gains)[2], xi, atol=1e-4)


def test_poles_many_decades_apart_keep_relative_accuracy():
    rng = np.random.default_rng(4)
    small = 10.0 ** rng.uniform(-12, -9, 1000)
    gains = from_abc(small, small**2, np.zeros(1000))
    a, b, _ = to_abc(*gains)
    assert (a > 0).all()
    np.testing.assert_allclose(b, small**2, rtol=1e-12)


def test_without_gamma_the_map_is_the_identity():
    rng = np.random.default_rng(5)
    alpha, beta = rng.uniform(-3, 5, (2, 1000))
    a, b, c = to_abc(alpha, beta, 0)
    np.testing.assert_array_equal(a, alpha)
    np.testing.assert_array_equal(b, beta)
    np.testing.assert_array_equal(c, -1)
    np.testing.assert_array_equal(from_abc(a, b, c), (alpha, beta, np.zeros(1000)))


def test_unstable_gains_factor_too():
    gains = np.random.default_rng(6).uniform(-10, 10, (3, 10_000))
    assert difference(from_abc(*to_abc(*gains)), gains) <= 1e-12


def test_shapes():
    assert all(isinstance(value, np.float64) for value in to_abc(0.5, 0.4, 0.1))
    assert all(isinstance(value, np.float64) for value in from_abc(0.5, 0.4, 0.1))
    column, row = np.full((3, 1), 0.5), np.full(4, 0.4)
    assert [value.shape for value in to_abc(column, row, 0.1)] == [(3, 4)] * 3
    assert [value.shape for value in from_abc(column, row, 0.1)] == [(3, 4)] * 3
    assert [value.shape for value in abc_preimages(column, row, 0.1)] == [(3, 4, 3)] * 3
    assert [value.shape for value in to_abc([], 0.4, 0.1)] == [(0,)] * 3


@pytest.mark.parametrize("position", [0, 1, 2])
def test_arguments_must_be_finite(position):
    arguments = [0.5, 0.4, 0.1]
    arguments[position] = [0.1, np.inf]
    for function, names in ((to_abc, ("alpha", "beta", "gamma")), (from_abc, "abc")):
        with pytest.raises(ValueError, match=f"{names[position]} must be finite, got inf at"):
            function(*arguments)
