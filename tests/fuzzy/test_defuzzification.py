import numpy as np
import pytest
import skfuzzy
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fuzzytrack.fuzzy.defuzzification import DEFUZZIFIERS, defuzzify
from fuzzytrack.fuzzy.operators import DEFUZZIFICATIONS

Y = np.linspace(-1.0, 4.0, 41)
RANDOM = np.random.default_rng(11)
# Random heights on two levels: many plateaus, none symmetric.
FUZZY = np.round(RANDOM.random((60, 41)), 1)


def clipped(y, level=0.6):
    return np.minimum(level, skfuzzy.trapmf(y, [-0.5, 0.2, 0.7, 3.5]))


def test_every_operator_has_a_defuzzifier():
    assert set(DEFUZZIFIERS) == set(DEFUZZIFICATIONS)


@pytest.mark.parametrize("method", ["mom", "som", "lom"])
def test_maxima_are_scikit_fuzzys(method):
    expected = [skfuzzy.defuzz(Y, row, method) for row in FUZZY]
    np.testing.assert_allclose(defuzzify(method, Y, FUZZY), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("method", ["centroid", "bisector"])
def test_a_dense_grid_gives_scikit_fuzzys_integrals(method):
    y = np.linspace(-1.0, 4.0, 40_001)
    expected = skfuzzy.defuzz(y, clipped(y), method)
    assert defuzzify(method, y, clipped(y)) == pytest.approx(expected, abs=2e-4)


def test_centroid_is_the_plain_sum():
    expected = [
        sum(float(y) * float(m) for y, m in zip(Y, row, strict=True)) / sum(map(float, row))
        for row in FUZZY
    ]
    np.testing.assert_allclose(defuzzify("centroid", Y, FUZZY), expected, rtol=0, atol=1e-14)


def test_bisector_is_the_first_point_with_half_the_sum():
    for row in FUZZY:
        value = float(defuzzify("bisector", Y, row))
        k = int(np.flatnonzero(value == Y)[0])
        half = row.sum() / 2
        assert row[: k + 1].sum() >= half - 1e-9
        assert row[:k].sum() < half


def test_equal_halves_and_plateaus_are_not_split_by_rounding():
    y = np.arange(4.0)
    noisy = np.array([0.1 + 0.2, 0.3, 0.3, 0.1 + 0.2])
    assert noisy[0] != noisy[1]
    assert defuzzify("bisector", y, noisy) == 1.0
    assert [float(defuzzify(m, y, noisy)) for m in ("som", "mom", "lom")] == [0.0, 1.5, 3.0]


@pytest.mark.parametrize("method", sorted(DEFUZZIFIERS))
def test_empty_is_nan_without_a_warning(method):
    fuzzy = np.stack([FUZZY[0], np.zeros(41), FUZZY[1]])
    values = defuzzify(method, Y, fuzzy)
    np.testing.assert_array_equal(np.isnan(values), [False, True, False])
    np.testing.assert_array_equal(values[[0, 2]], defuzzify(method, Y, FUZZY[:2]))


@pytest.mark.parametrize("method", sorted(DEFUZZIFIERS))
def test_shapes(method):
    assert defuzzify(method, Y, FUZZY.reshape(3, 20, 41)).shape == (3, 20)
    assert defuzzify(method, Y, FUZZY[0]).shape == ()
    assert defuzzify(method, Y, np.empty((0, 41))).shape == (0,)


@pytest.mark.parametrize("method", sorted(DEFUZZIFIERS))
def test_faintest_grades_count(method):
    # Of any number of points: NumPy divides several at once, and the rest in another way.
    for points in range(3, 20, 2):
        y, grades = np.linspace(0.3, 0.4, points), np.zeros(points)
        grades[points // 2] = 5e-324
        assert defuzzify(method, y, grades) == pytest.approx(0.35, abs=1e-15)


@given(
    st.sampled_from(sorted(DEFUZZIFIERS)),
    arrays(float, 9, elements=st.floats(0, 1).map(lambda v: v**4)),
)
def test_value_is_within_the_support(method, fuzzy):
    y = np.linspace(0.25, 0.35, 9)
    value = float(defuzzify(method, y, fuzzy))
    if fuzzy.max() == 0:
        assert np.isnan(value)
    else:
        support = y[fuzzy > 0]
        assert support[0] - 1e-15 <= value <= support[-1] + 1e-15
