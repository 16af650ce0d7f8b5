import math
from itertools import combinations, combinations_with_replacement, permutations, product

import numpy as np
import pytest
import skfuzzy.membership as reference
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.hedges import HEDGES
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES

# A linear function of the inputs has no grades.
GRADED = set(SHAPES) - {LINEAR}

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
# Shapes that scikit-fuzzy does not have, or not with this formula.
OWN_CASES = [
    ("linsmf", (-0.5, 0.75)),
    ("linzmf", (-0.5, 0.75)),
    ("dsigmf", (-0.5, 6.0, 0.4, 9.0)),
    ("dsigmf", (0.4, 9.0, -0.5, 6.0)),
    ("psigmf", (-0.5, 6.0, 0.4, -9.0)),
    ("psigmf", (-0.5, 6.0, 0.4, 9.0)),
    ("discrete", (-0.5, 0.0, 0.0, 1.0, 0.25, 1.0, 0.5, 0.0, 0.75, 0.25)),
    ("discrete", (-0.5, 0.75, 0.0, 0.125, 0.5, 0.5)),
    ("cosine", (0.25, 1.5)),
    ("spike", (0.25, 1.5)),
    ("concave", (-0.5, 0.75)),
    ("concave", (0.75, -0.5)),
    ("arc", (-0.5, 0.75)),
    ("arc", (0.75, -0.5)),
    ("ellipse", (-0.5, 0.75)),
    ("gauss2mf", (0.5, 0.4, -0.25, 0.3)),
]
# Where scikit-fuzzy itself divides zero by zero; (parameters, grade is one on [low, high]).
STEPS = [
    ("smf", (0.25, 0.25), 0.25, math.inf),
    ("zmf", (0.25, 0.25), -math.inf, 0.25),
    ("pimf", (-0.5, -0.5, 0.25, 0.25), -0.5, 0.25),
    ("pimf", (0.25, 0.25, 0.25, 0.25), 0.25, 0.25),
    ("singleton", (0.25,), 0.25, 0.25),
    ("linsmf", (0.25, 0.25), 0.25, math.inf),
    ("linzmf", (0.25, 0.25), -math.inf, 0.25),
]
EVERY_CASE = CASES + OWN_CASES + [s[:2] for s in STEPS]
# On and between breakpoints, and far outside of them.
X = np.unique(
    np.concatenate([np.linspace(-2, 2, 1601), [-1e6, -40.0, 40.0, 1e6], *(p for _, p in CASES)])
)


def identity(case):
    return f"{case[0]}{case[1]}" if isinstance(case, tuple) else None


def evaluate(fuzzy_set, x):
    names = {
        "exp": math.exp,
        "cos": math.cos,
        "abs": abs,
        "min": min,
        "max": max,
        "x": x,
        "__builtins__": {},
    }
    return eval(fuzzy_set.expression("x"), names)


def test_cases_cover_every_shape():
    assert {shape for shape, *_ in EVERY_CASE} == GRADED


@pytest.mark.parametrize(("shape", "parameters"), CASES)
def test_grades_are_scikit_fuzzys(shape, parameters):
    function = getattr(reference, shape)
    with np.errstate(all="ignore"):
        if shape in ("trimf", "trapmf"):
            expected = function(X, parameters)
        else:
            expected = function(X, *parameters)
    np.testing.assert_array_equal(FuzzySet("s", shape, parameters).membership(X), expected)


# Other forms of the same curves: inverse functions, identities of angles, lines through points.
def lines(pairs, x):
    left, right = np.array(pairs[:-1]), np.array(pairs[1:])
    inside = (left[:, 0] <= x) & (x <= right[:, 0])
    if not inside.any():
        return pairs[0][1] if x < pairs[0][0] else pairs[-1][1]
    k = int(np.argmax(inside))
    part = (x - left[k, 0]) / (right[k, 0] - left[k, 0])
    return (1 - part) * left[k, 1] + part * right[k, 1]


def tanh_sigmoid(x, b, c):
    return 0.5 * (1 + math.tanh(c * (x - b) / 2))


def mirrored(function):
    """For a shape with two ends: the curve for ends in the other order."""
    return lambda x, a, b: function(x, a, b) if a < b else function(-x, -a, -b)


def side(x, mean, sigma, sign):
    return (
        math.prod([math.exp(-(((x - mean) / sigma) ** 2) / 4)] * 2) if sign * x > sign * mean else 1
    )


ORACLES = {
    "gauss2mf": lambda x, m, s, n, t: side(x, m, s, -1) * side(x, n, t, 1),
    "linsmf": lambda x, a, b: lines([(a, 0), (b, 1)], x),
    "linzmf": lambda x, a, b: lines([(a, 1), (b, 0)], x),
    "dsigmf": lambda x, a, s, b, t: abs(tanh_sigmoid(x, a, s) - tanh_sigmoid(x, b, t)),
    "psigmf": lambda x, a, s, b, t: tanh_sigmoid(x, a, s) * tanh_sigmoid(x, b, t),
    "discrete": lambda x, *p: lines(list(zip(p[::2], p[1::2], strict=True)), x),
    "cosine": lambda x, c, w: math.cos(math.pi * (x - c) / w) ** 2 if abs(x - c) < w / 2 else 0,
    "spike": lambda x, c, w: math.exp(-10) ** (abs(x - c) / w),
    # A hyperbola through 1 at its end and 1/2 at its inflection.
    "concave": mirrored(lambda x, i, e: 1 / (1 + (e - x) / (e - i)) if x < e else 1),
    "arc": mirrored(
        lambda x, a, b: math.sin(math.acos((b - x) / (b - a))) if a < x < b else float(x >= b)
    ),
    "ellipse": lambda x, a, b: math.sqrt(4 * (x - a) * (b - x)) / (b - a) if a < x < b else 0,
}


@pytest.mark.parametrize(("shape", "parameters"), OWN_CASES)
def test_grades_of_own_shapes_follow_another_form_of_the_formula(shape, parameters):
    expected = [ORACLES[shape](float(x), *parameters) for x in X]
    grades = FuzzySet("s", shape, parameters).membership(X)
    np.testing.assert_allclose(grades, expected, rtol=0, atol=1e-7 if shape == "arc" else 1e-14)


@pytest.mark.parametrize("shape", ["trimf", "trapmf", "linsmf", "linzmf"])
def test_not_is_0_where_the_grade_is_1(shape):
    # By the array formula and by the expression: at a corner a rule fires in both, or in neither.
    corners = [round(0.1 * k, 1) for k in range(-60, 60, 11)]
    count = len(SHAPES[shape].parameters)
    for parameters in combinations(corners, count):
        fuzzy_set = FuzzySet("A", f"not {shape}", parameters)
        core = {"trimf": [1], "trapmf": [1, 2], "linsmf": [1], "linzmf": [0]}[shape]
        points = [parameters[k] for k in core]
        assert not fuzzy_set.membership(points).any()
        assert not any(eval(fuzzy_set.expression("x"), {"x": x}) for x in points)


@pytest.mark.parametrize("words", ["", "seldom ", "not "])
def test_an_ellipse_is_0_at_its_ends_and_1_at_its_middle(words):
    # A root makes 1e-8 of a rounding, and a second one 1e-4: a rule would fire where none does.
    tenths = [round(0.1 * k, 1) for k in range(-60, 60, 7)]
    for start, end in combinations(tenths, 2):
        ellipse = FuzzySet("A", f"{words}ellipse", (start, end))
        points = [start, (start + end) / 2, end]
        due = [1.0, 0.0, 1.0] if words == "not " else [0.0, 1.0, 0.0]
        assert ellipse.membership(points).tolist() == due
        assert [eval(ellipse.expression("x"), {"x": x}) for x in points] == due


@pytest.mark.parametrize("shape", ["dsigmf", "psigmf"])
def test_two_sigmoids_are_scikit_fuzzys(shape):
    expected = getattr(reference, shape)(X[4:-4], -0.5, 6.0, 0.4, 9.0)
    grades = FuzzySet("s", shape, (-0.5, 6.0, 0.4, 9.0)).membership(X[4:-4])
    np.testing.assert_allclose(grades, expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    "parameters",
    [(-0.5, 6.0, 0.4, 9.0), (0.4, 9.0, -0.5, 6.0), (-0.5, 6.0, 0.4, -9.0), (0, 2, 1, 2)],
)
def test_peaks_of_two_sigmoids_are_where_the_grade_is_largest(parameters):
    rising = parameters[1] * parameters[3] > 0
    fuzzy_set = FuzzySet("s", "dsigmf" if rising else "psigmf", parameters)
    start, end = fuzzy_set.core(-2.0, 2.0)
    dense = np.linspace(-2, 2, 400_001)
    assert start == end
    assert start == pytest.approx(dense[np.argmax(fuzzy_set.membership(dense))], abs=2e-5)


HEDGED = {
    "not": lambda g: 1 - g,
    "very": lambda g: g * g,
    "somewhat": math.sqrt,
    "extremely": lambda g: g * g * g,
    "intensely": lambda g: 2 * g * g if g <= 0.5 else 1 - 2 * (1 - g) * (1 - g),
    "seldom": lambda g: math.sqrt(g / 2) if g <= 0.5 else 1 - math.sqrt((1 - g) / 2),
    "any": lambda g: 1.0,
}


def test_hedges_are_all_tested():
    assert set(HEDGED) == set(HEDGES)


@pytest.mark.parametrize("words", [*([word] for word in HEDGED), ["not", "very"], ["very", "not"],
                                   ["not", "any"], ["seldom", "not", "intensely"]])  # fmt: skip
@pytest.mark.parametrize(("shape", "parameters"), [*CASES[:6], *OWN_CASES[6:8], CASES[15]])
def test_hedges_change_grades_support_and_expression_alike(shape, parameters, words):
    base = FuzzySet("s", shape, parameters)
    hedged = FuzzySet("s", " ".join([*words, shape]), parameters)
    expected = base.membership(X).tolist()
    for word in reversed(words):
        expected = [HEDGED[word](g) for g in expected]
    grades = hedged.membership(X)
    np.testing.assert_allclose(grades, expected, rtol=0, atol=1e-15)
    np.testing.assert_allclose([evaluate(hedged, float(x)) for x in X], grades, rtol=0, atol=1e-7)
    assert np.isnan(hedged.membership(np.nan))
    inside = [any(x in stretch for stretch in hedged.positive()) for x in X.tolist()]
    before = base.membership(X)
    exact = (before == 0) | (before == 1) | ((before > 1e-6) & (before < 1 - 1e-6))
    if shape != "sigmf":  # whose grades are rounded to 0 and 1 far off
        np.testing.assert_array_equal((grades > 0)[exact], np.array(inside)[exact])


def test_a_set_of_points_may_be_zero_everywhere():
    empty = FuzzySet("s", "discrete", (0, 0, 1, 0))
    assert empty.positive() == ()
    assert empty.support()[0] == math.inf
    assert not empty.membership(X).any()
    (whole,) = FuzzySet("s", "not discrete", (0, 0, 1, 0)).positive()
    assert (whole.low, whole.high) == (-math.inf, math.inf)


@pytest.mark.parametrize("shape", ["nearly trimf", "not", "trimf not", "not not very any trimf",
                                   "not linear", "not  trimf"])  # fmt: skip
def test_words_that_are_no_hedges_are_refused(shape):
    with pytest.raises(RuleBaseError, match="unknown shape"):
        FuzzySet("near", shape, (0, 1, 2))


@pytest.mark.parametrize(("shape", "parameters"), EVERY_CASE)
def test_expression_is_the_array_formula(shape, parameters):
    fuzzy_set = FuzzySet("s", shape, parameters)
    scalar = [evaluate(fuzzy_set, float(x)) for x in X]
    np.testing.assert_allclose(scalar, fuzzy_set.membership(X), rtol=0, atol=1e-14)


@pytest.mark.parametrize(("shape", "parameters", "low", "high"), STEPS)
def test_vertical_flanks_belong_to_the_set(shape, parameters, low, high):
    grades = FuzzySet("s", shape, parameters).membership(X)
    np.testing.assert_array_equal(grades, ((low <= X) & (high >= X)).astype(float))


@pytest.mark.parametrize(("shape", "parameters"), EVERY_CASE)
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
        ("gauss2mf", (0.5, 0.4, -0.25, 0.4), (0.125, 0.125), 0.125),
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
        ("gauss2mf", (41, 1, 0, 1), ("'near'", "mean1 <= mean2 + 20", "41.0, 1.0, 0.0")),
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
    shape = draw(st.sampled_from(sorted(GRADED)))
    n = len(SHAPES[shape].parameters)
    if shape in ("trimf", "trapmf", "smf", "zmf", "pimf", "linsmf", "linzmf"):
        parameters = sorted(draw(st.lists(finite, min_size=n, max_size=n)))
    elif shape == "gaussmf":
        parameters = [draw(finite), draw(widths)]
    elif shape == "gauss2mf":
        low, high = sorted([draw(finite), draw(finite)])
        parameters = [low, draw(widths), high, draw(widths)]
        crossed = [high, parameters[1], low, parameters[3]]
        if high - low <= 19 * (parameters[1] + parameters[3]) and draw(st.booleans()):
            parameters = crossed
    elif shape == "gbellmf":
        parameters = [draw(widths), draw(st.floats(1e-100, 1e6)), draw(finite)]
    elif shape in ("dsigmf", "psigmf"):
        slopes = finite.filter(bool)
        parameters = [draw(finite), draw(slopes), draw(finite), draw(slopes)]
    elif shape == "discrete":
        places = draw(st.lists(st.integers(-(10**9), 10**9), min_size=2, max_size=9, unique=True))
        grades = draw(st.lists(st.floats(0, 1), min_size=len(places), max_size=len(places)))
        scale = draw(st.sampled_from([1e-290, 1e-9, 1.0, 1e90]))
        places = [scale * place for place in sorted(places)]
        parameters = [x for pair in zip(places, grades, strict=True) for x in pair]
    elif shape in ("cosine", "spike"):
        parameters = [draw(finite), draw(widths)]
    elif shape in ("concave", "arc", "ellipse"):
        parameters = sorted(draw(st.lists(finite, min_size=2, max_size=2, unique=True)))
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
    "linsmf": list(combinations_with_replacement(CORNERS, 2)),
    "linzmf": list(combinations_with_replacement(CORNERS, 2)),
    "dsigmf": list(product(CENTERS[:3], [-1e100, 5e-324, 3.0], CENTERS[2:], [1e-100, -3.0])),
    "psigmf": list(product(CENTERS[:3], [-1e100, 5e-324, 3.0], CENTERS[2:], [1e-100, -3.0])),
    "discrete": [
        (a, 0.1, b, 1.0, c, 0.3)
        for a, b, c in combinations(CORNERS, 3)
        if min(b - a, c - b) > 1e-300
    ],
    "cosine": list(product(CENTERS, WIDTHS)),
    "spike": list(product(CENTERS, WIDTHS)),
    "concave": list(permutations(CORNERS, 2)),
    "arc": list(permutations(CORNERS, 2)),
    "ellipse": list(combinations(CORNERS, 2)),
}


@pytest.mark.untraced
@pytest.mark.parametrize("shape", sorted(GRADED))
def test_grades_at_extreme_corners(shape):
    points = np.array(sorted({*CORNERS, *(np.nextafter(x, 2.0 * x) for x in CORNERS), *CENTERS}))
    for parameters in EXTREMES[shape]:
        fuzzy_set = FuzzySet("s", shape, parameters)
        grades = fuzzy_set.membership(points)
        assert np.all((grades >= 0.0) & (grades <= 1.0)), parameters
        scalar = [evaluate(fuzzy_set, float(x)) for x in points]
        np.testing.assert_allclose(scalar, grades, rtol=0, atol=1e-13, err_msg=str(parameters))


@pytest.mark.parametrize(("shape", "parameters"), EVERY_CASE)
def test_support_is_where_the_grade_is_above_zero(shape, parameters):
    fuzzy_set = FuzzySet("s", shape, parameters)
    above = fuzzy_set.membership(X) > 0
    inside = np.array([any(x in piece for piece in fuzzy_set.positive()) for x in X.tolist()])
    first, last = fuzzy_set.positive()[0], fuzzy_set.positive()[-1]
    assert fuzzy_set.support() == (first.low, last.high, first.with_low, last.with_high)
    near = np.abs(X) <= 2  # far off, exp and powers fade to zero
    np.testing.assert_array_equal(above[near], inside[near])
    assert not np.any(above & ~inside)
