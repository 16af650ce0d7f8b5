import math
from itertools import combinations_with_replacement, product

import numpy as np
import pytest
import skfuzzy.membership as reference
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import SHAPES, FuzzySet

# Every shape, and every shoulder and vertical flank it can have.
CASES = [
    ("trimf", (-0.5, 0.2, 1.1)),
    ("trimf", (0.2, 0.2, 1.1)),
    ("trimf", (-0.5, 0.2, 0.2)),
    ("trimf", (0.2, 0.2, 0.2)),
    ("trapmf", (-1.0, -0.5, 0.25, 0.7)),
    ("trapmf", (-1.0, -1.0, 0.25, 0.7)),
    ("trapmf", (-1.0, -0.5, 0.7, 0.7)),
    ("trapmf", (-1.0, 0.25, 0.25, 0.7)),
    ("trapmf", (-0.5, -0.5, 0.5, 0.5)),
    ("gaussmf", (0.3, 0.17)),
    ("gauss2mf", (-0.3, 0.2, 0.4, 0.5)),
    ("gauss2mf", (0.1, 0.2, 0.1, 0.5)),
    ("gbellmf", (0.4, 2.5, -0.2)),
    ("gbellmf", (0.3, 0.5, 0.25)),
    ("sigmf", (0.1, 6.0)),
    ("sigmf", (0.1, -14.0)),
    ("smf", (-0.5, 0.75)),
    ("zmf", (-0.5, 0.75)),
    ("pimf", (-1.0, -0.5, 0.25, 0.75)),
    ("pimf", (-1.0, 0.25, 0.25, 0.75)),
]
# Where scikit-fuzzy itself divides zero by zero; (parameters, grade is one on [low, high]).
STEPS = [
    ("smf", (0.25, 0.25), 0.25, math.inf),
    ("zmf", (0.25, 0.25), -math.inf, 0.25),
    ("pimf", (-0.5, -0.5, 0.25, 0.25), -0.5, 0.25),
    ("pimf", (0.25, 0.25, 0.25, 0.25), 0.25, 0.25),
    ("singleton", (0.25,), 0.25, 0.25),
]
# On and between breakpoints, and far outside of them.
X = np.unique(
    np.concatenate([np.linspace(-2, 2, 1601), [-1e6, -40.0, 40.0, 1e6], *(p for _, p in CASES)])
)


def identity(case):
    return f"{case[0]}{case[1]}" if isinstance(case, tuple) else None


def evaluate(fuzzy_set, x):
    names = {"exp": math.exp, "abs": abs, "min": min, "max": max, "x": x, "__builtins__": {}}
    return eval(fuzzy_set.expression("x"), names)


def test_cases_cover_every_shape():
    assert {shape for shape, *_ in (*CASES, *STEPS)} == set(SHAPES)


@pytest.mark.parametrize(("shape", "parameters"), CASES)
def test_grades_are_scikit_fuzzys(shape, parameters):
    function = getattr(reference, shape)
    with np.errstate(all="ignore"):
        if shape in ("trimf", "trapmf"):
            expected = function(X, parameters)
        else:
            expected = function(X, *parameters)
    np.testing.assert_array_equal(FuzzySet("s", shape, parameters).membership(X), expected)


@pytest.mark.parametrize(("shape", "parameters"), CASES + [s[:2] for s in STEPS])
def test_expression_is_the_array_formula(shape, parameters):
    fuzzy_set = FuzzySet("s", shape, parameters)
    scalar = [evaluate(fuzzy_set, float(x)) for x in X]
    np.testing.assert_allclose(scalar, fuzzy_set.membership(X), rtol=0, atol=1e-14)


@pytest.mark.parametrize(("shape", "parameters", "low", "high"), STEPS)
def test_vertical_flanks_belong_to_the_set(shape, parameters, low, high):
    grades = FuzzySet("s", shape, parameters).membership(X)
    np.testing.assert_array_equal(grades, ((low <= X) & (high >= X)).astype(float))


@pytest.mark.parametrize(("shape", "parameters"), CASES + [s[:2] for s in STEPS])
def test_any_array_shape_and_nan(shape, parameters):
    fuzzy_set = FuzzySet("s", shape, parameters)
    assert fuzzy_set.membership([]).shape == (0,)
    assert fuzzy_set.membership(np.empty((2, 0))).shape == (2, 0)
    one = fuzzy_set.membership(0.25)
    assert one.shape == ()
    assert one == fuzzy_set.membership([0.25])[0]
    grid = X[:12].reshape(3, 4)
    np.testing.assert_array_equal(
        fuzzy_set.membership(grid), fuzzy_set.membership(grid.ravel()).reshape(3, 4)
    )
    mixed = fuzzy_set.membership([0.1, np.nan, 0.3])
    np.testing.assert_array_equal(np.isnan(mixed), [False, True, False])
    np.testing.assert_array_equal(mixed[[0, 2]], fuzzy_set.membership([0.1, 0.3]))


@pytest.mark.parametrize(
    ("shape", "parameters", "core", "center"),
    [
        ("trimf", (-0.5, 0.2, 1.1), (0.2, 0.2), 0.2),
        ("trimf", (-0.5, 4.0, 5.0), (1.0, 1.0), 1.0),
        ("trapmf", (-3.0, -2.0, 0.5, 0.7), (-1.0, 0.5), -0.25),
        ("gaussmf", (0.3, 0.1), (0.3, 0.3), 0.3),
        ("gauss2mf", (0.1, 0.2, 0.4, 0.5), (0.1, 0.4), 0.25),
        ("gbellmf", (0.4, 2.0, -0.2), (-0.2, -0.2), -0.2),
        ("sigmf", (0.0, 3.0), (1.0, 1.0), 1.0),
        ("sigmf", (0.0, -3.0), (-1.0, -1.0), -1.0),
        ("smf", (0.0, 0.5), (0.5, 1.0), 0.75),
        ("zmf", (-0.5, 0.5), (-1.0, -0.5), -0.75),
        ("pimf", (-0.5, -0.25, 0.75, 1.0), (-0.25, 0.75), 0.25),
        ("singleton", (0.125,), (0.125, 0.125), 0.125),
    ],
)
def test_core_and_center(shape, parameters, core, center):
    fuzzy_set = FuzzySet("s", shape, parameters)
    assert fuzzy_set.core(-1.0, 1.0) == core
    assert fuzzy_set.center(-1.0, 1.0) == pytest.approx(center, abs=1e-15)
    grid = np.linspace(-1, 1, 801)
    inside = fuzzy_set.membership(np.array(core))
    assert np.all(inside >= fuzzy_set.membership(grid).max() - 1e-12)


@pytest.mark.parametrize(
    ("shape", "parameters", "words"),
    [
        ("triangle", (0, 1, 2), ("'near'", "'triangle'", "trimf", "singleton")),
        ("trimf", (0, 1), ("'near'", "3 parameters", "a, b, c", "2")),
        ("trimf", (2, 1, 3), ("'near'", "a <= b <= c", "[2.0, 1.0, 3.0]")),
        ("trapmf", (0, 1, 3, 2), ("'near'", "a <= b <= c <= d", "3.0, 2.0")),
        ("trapmf", (0, 1, np.nan, 2), ("'near'", "finite", "nan")),
        ("gaussmf", (math.inf, 1), ("'near'", "finite", "inf")),
        ("gaussmf", (1e101, 1), ("'near'", "1e100", "1e+101")),
        ("gaussmf", (0, 0), ("'near'", "sigma > 0", "0.0")),
        ("gaussmf", (0, 1e-200), ("'near'", "sigma > 0 (from 1e-100)", "1e-200")),
        ("gauss2mf", (1, 1, 0, 1), ("'near'", "mean1 <= mean2", "1.0, 1.0, 0.0")),
        ("gauss2mf", (0, 1, 1, -1), ("'near'", "sigma2 > 0", "-1.0")),
        ("gbellmf", (0, 1, 0), ("'near'", "a > 0", "[0.0, 1.0, 0.0]")),
        ("gbellmf", (1, -1, 0), ("'near'", "b > 0", "-1.0")),
        ("gbellmf", (1, 1e7, 0), ("'near'", "b up to 1e6", "10000000.0")),
        ("sigmf", (0, 0), ("'near'", "c != 0", "[0.0, 0.0]")),
        ("smf", (1, 0), ("'near'", "a <= b", "[1.0, 0.0]")),
        ("zmf", (1, 0), ("'near'", "a <= b", "[1.0, 0.0]")),
        ("pimf", (0, 2, 1, 3), ("'near'", "a <= b <= c <= d", "2.0, 1.0")),
    ],
)
def test_errors_name_set_value_and_what_is_allowed(shape, parameters, words):
    with pytest.raises(RuleBaseError) as error:
        FuzzySet("near", shape, parameters)
    for word in words:
        assert word in str(error.value)


finite = st.floats(-1e100, 1e100)
widths = st.floats(1e-100, 1e100)


@st.composite
def fuzzy_sets(draw):
    shape = draw(st.sampled_from(sorted(SHAPES)))
    n = len(SHAPES[shape].parameters)
    if shape in ("trimf", "trapmf", "smf", "zmf", "pimf"):
        parameters = sorted(draw(st.lists(finite, min_size=n, max_size=n)))
    elif shape == "gaussmf":
        parameters = [draw(finite), draw(widths)]
    elif shape == "gauss2mf":
        low, high = sorted([draw(finite), draw(finite)])
        parameters = [low, draw(widths), high, draw(widths)]
    elif shape == "gbellmf":
        parameters = [draw(widths), draw(st.floats(1e-100, 1e6)), draw(finite)]
    elif shape == "sigmf":
        parameters = [draw(finite), draw(finite.filter(bool))]
    else:
        parameters = [draw(finite)]
    return FuzzySet("s", shape, tuple(parameters))


@given(fuzzy_sets(), st.one_of(finite, st.floats(-2, 2)))
def test_grades_are_within_0_and_1_for_all_parameters(fuzzy_set, x):
    grade = float(fuzzy_set.membership(x))
    assert 0.0 <= grade <= 1.0
    assert evaluate(fuzzy_set, x) == pytest.approx(grade, abs=1e-13)
    for breakpoint_ in fuzzy_set.breakpoints():
        assert 0.0 <= float(fuzzy_set.membership(breakpoint_)) <= 1.0


# Corners that coincide, that are neighboring floats, and that are too near to 0 to have an inverse.
CORNERS = [-1e100, -1.0, -1e-323, -5e-324, 0.0, 5e-324, 1.5e-323, 3e-308, *(
    1.0 + k * 2.0**-52 for k in (0, 1, 3)), 1e100]  # fmt: skip
WIDTHS = [1e-100, 2e-16, 1.0, 1e100]
CENTERS = [-1e100, 0.0, 5e-324, 1.0, 1e100]
EXTREMES = {
    "trimf": list(combinations_with_replacement(CORNERS, 3)),
    "trapmf": list(combinations_with_replacement(CORNERS, 4)),
    "pimf": list(combinations_with_replacement(CORNERS, 4)),
    "smf": list(combinations_with_replacement(CORNERS, 2)),
    "zmf": list(combinations_with_replacement(CORNERS, 2)),
    "gaussmf": list(product(CENTERS, WIDTHS)),
    "gauss2mf": [
        (low, left, high, right)
        for low, high in combinations_with_replacement(CENTERS, 2)
        for left, right in product(WIDTHS, WIDTHS)
    ],
    "gbellmf": list(product(WIDTHS, [1e-100, 0.5, 1e6], CENTERS)),
    "sigmf": list(product(CENTERS, [-1e100, -5e-324, 5e-324, 1e-100, 3.0, 1e100])),
    "singleton": [(value,) for value in CORNERS],
}


@pytest.mark.untraced
@pytest.mark.parametrize("shape", SHAPES)
def test_grades_at_extreme_corners(shape):
    points = np.array(sorted({*CORNERS, *(np.nextafter(x, 2.0 * x) for x in CORNERS), *CENTERS}))
    for parameters in EXTREMES[shape]:
        fuzzy_set = FuzzySet("s", shape, parameters)
        grades = fuzzy_set.membership(points)
        assert np.all((grades >= 0.0) & (grades <= 1.0)), parameters
        scalar = [evaluate(fuzzy_set, float(x)) for x in points]
        np.testing.assert_allclose(scalar, grades, rtol=0, atol=1e-13, err_msg=str(parameters))


@pytest.mark.parametrize(("shape", "parameters"), CASES + [s[:2] for s in STEPS])
def test_support_is_where_the_grade_is_above_zero(shape, parameters):
    fuzzy_set = FuzzySet("s", shape, parameters)
    low, high, with_low, with_high = fuzzy_set.support()
    above = fuzzy_set.membership(X) > 0
    inside = (low < X) & (high > X) | ((low == X) & with_low) | ((high == X) & with_high)
    near = np.abs(X) <= 2  # far off, exp and powers fade to zero
    np.testing.assert_array_equal(above[near], inside[near])
    assert not np.any(above & ~inside)
