import numpy as np
import pytest
from builders import triangles

from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.variable import Universe, Variable

X = Variable("x", Universe(0, 2, 5), triangles("ab", (0.0, 2.0)))
Y = Variable("y", Universe(0, 2, 4, "midpoints"), triangles("ab", (0.0, 2.0)))


def test_shapes_on_the_grid():
    grades = Fuzzification("gaussian", 0.7).membership(X, np.array([0.5, 1.1]))
    expected = [
        [np.exp(-((v - x) ** 2) / (2 * 0.7**2)) for v in (0, 0.5, 1, 1.5, 2)] for x in (0.5, 1.1)
    ]
    np.testing.assert_allclose(grades, expected, rtol=0, atol=1e-15)
    grades = Fuzzification("triangular", {"y": 0.8, "x": 9.0}).membership(Y, np.array([0.25, 2.0]))
    np.testing.assert_allclose(grades, [[1, 0.375, 0, 0], [0, 0, 0.0625, 0.6875]], atol=1e-15)


def test_membership_keeps_the_shape_of_x():
    fuzzy = Fuzzification("gaussian", 0.5)
    assert fuzzy.membership(X, np.zeros((2, 3))).shape == (2, 3, 5)
    assert fuzzy.membership(X, np.zeros(0)).shape == (0, 5)


def test_a_fuzzy_input_never_falls_between_grid_points():
    x = np.linspace(0, 2, 401)
    for variable in (X, Y):
        grades = Fuzzification("triangular", variable.universe.step).membership(variable, x)
        assert grades.max(axis=-1).min() >= 0.5 - 1e-12


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("bell", 1.0), ("'bell'", "singleton, gaussian, triangular")),
        (("gaussian",), ("width", "'gaussian'", "None")),
        (("singleton", 1.0), ("width", "gaussian and triangular", "1.0")),
    ],
)
def test_errors(arguments, words):
    with pytest.raises(ValueError, match="fuzzification") as error:
        Fuzzification(*arguments)
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize("width", [0.49, 0.0, -1.0, np.nan, np.inf, {"y": 1.0}])
def test_width_is_checked_against_the_grid(width):
    with pytest.raises(ValueError, match=r"width of x must be .* at least its grid step 0.5, got"):
        Fuzzification("gaussian", width).check(X)


def test_width_for_one_input():
    assert Fuzzification("triangular", {"x": 0.5, "y": 2}).check(X) == 0.5
    assert Fuzzification("triangular", {"x": 0.5, "y": 2}).check(Y) == 2.0
    assert Fuzzification("triangular", 0.75).check(Y) == 0.75
    assert Fuzzification().is_singleton
    assert not Fuzzification("gaussian", 1.0).is_singleton
