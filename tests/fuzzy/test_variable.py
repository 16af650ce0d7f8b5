import math
import pickle

import numpy as np
import pytest
from builders import triangles

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.variable import Universe, Variable

LOW = FuzzySet("low", "trimf", (0.0, 0.0, 1.0))
HIGH = FuzzySet("high", "trimf", (0.0, 1.0, 1.0))


def test_grid_of_ends():
    universe = Universe(-1, 3, 5)
    np.testing.assert_array_equal(universe.values, [-1.0, 0.0, 1.0, 2.0, 3.0])
    assert (universe.first, universe.step) == (-1.0, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        universe.values[0] = 0.0


def test_grid_of_midpoints():
    universe = Universe(-1, 3, 4, "midpoints")
    np.testing.assert_array_equal(universe.values, [-0.5, 0.5, 1.5, 2.5])
    assert (universe.first, universe.step) == (-0.5, 1.0)


@pytest.mark.parametrize("grid", ["ends", "midpoints"])
@pytest.mark.parametrize("points", [2, 7, 100])
def test_nearest_is_the_nearest_grid_point(grid, points):
    universe = Universe(-0.7, 1.9, points, grid)
    x = np.random.default_rng(3).uniform(-2, 3, 500)
    expected = np.abs(x[:, None] - universe.values).argmin(axis=1)
    np.testing.assert_array_equal(universe.nearest(x), expected)
    np.testing.assert_array_equal(universe.nearest(universe.values), np.arange(points))


def test_nearest_tie_goes_up_and_far_points_to_the_ends():
    universe = Universe(0, 4, 5)
    np.testing.assert_array_equal(universe.nearest(np.array([0.5, 2.5, -1e9, 1e9])), [1, 3, 0, 4])


def test_clip():
    clipped = Universe(0, 4, 5).clip(np.array([-1.0, 0.3, 9.0, np.nan]))
    np.testing.assert_array_equal(clipped, [0.0, 0.3, 4.0, np.nan])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((1, 1, 5), ("low < high", "low=1.0", "high=1.0")),
        ((2, 1, 5), ("low < high", "low=2.0", "high=1.0")),
        ((math.nan, 1, 5), ("low=nan",)),
        ((0, math.inf, 5), ("high=inf",)),
        ((-1e101, 0, 5), ("low=-1e+101",)),
        ((0, 1, 1), ("points", "from 2 to 100001", "got 1")),
        ((0, 1, 100_002), ("points", "from 2 to 100001", "got 100002")),
        ((0, 1, 2.5), ("points", "whole number", "got 2.5")),
        ((0, 1, math.nan), ("points", "whole number", "got nan")),
        ((0, 1, math.inf), ("points", "whole number", "got inf")),
        ((0, 1, "many"), ("points", "whole number", "got many")),
        ((0, 1, 5, "centers"), ("grid", "'centers'", "ends, midpoints")),
        ((1.0, 1.0 + 1e-15, 101), ("101 points", "finer than floating point")),
    ],
)
def test_universe_errors(arguments, words):
    with pytest.raises(RuleBaseError) as error:
        Universe(*arguments)
    for word in words:
        assert word in str(error.value)


def test_whole_float_points_become_int():
    universe = Universe(0, 1, 5.0)
    assert universe.points == 5
    assert isinstance(universe.points, int)


def test_variable_errors():
    universe = Universe(0, 1, 5)
    with pytest.raises(RuleBaseError, match="'speed' needs at least one set"):
        Variable("speed", universe, ())
    with pytest.raises(RuleBaseError, match="'speed': two sets of one name: 'low'"):
        Variable("speed", universe, (LOW, HIGH, LOW))
    with pytest.raises(RuleBaseError, match="speed has no set 'middle'; one of low, high"):
        Variable("speed", universe, (LOW, HIGH)).index("middle")


def test_names_index_and_label():
    variable = Variable("v", Universe(0, 1, 5), [LOW, HIGH], label="speed", unit="m/s")
    assert variable.set_names == ("low", "high")
    assert [variable.index("low"), variable.index("high")] == [0, 1]
    assert variable.axis_label == "speed (m/s)"
    assert Variable("v", Universe(0, 1, 5), (LOW,), unit="1").axis_label == "v"
    assert Variable("v", Universe(0, 1, 5), (LOW,), unit="s").axis_label == "v (s)"


def test_variables_are_values():
    a, b = (Variable("v", Universe(0, 1, 5), (LOW, HIGH)) for _ in range(2))
    _ = a.universe.values
    assert a == b
    assert hash(a) == hash(b)
    assert pickle.loads(pickle.dumps(a)) == b
    assert a != Variable("v", Universe(0, 1, 5, "midpoints"), (LOW, HIGH))


def test_memberships_keep_the_shape_of_x():
    variable = Variable("v", Universe(0, 1, 5), (LOW, HIGH))
    x = np.array([[0.0, 0.25], [0.5, 1.0], [0.75, 0.1]])
    grades = variable.memberships(x)
    assert grades.shape == (2, 3, 2)
    np.testing.assert_allclose(grades, [1 - x, x], atol=1e-15)
    np.testing.assert_allclose(
        variable.memberships(), [[1, 0.75, 0.5, 0.25, 0], [0, 0.25, 0.5, 0.75, 1]]
    )


def test_a_singleton_lies_on_the_nearest_grid_point():
    variable = Variable(
        "v",
        Universe(0, 1, 5),
        (LOW, FuzzySet("spike", "singleton", (0.6,)), FuzzySet("far", "singleton", (3.0,))),
    )
    np.testing.assert_array_equal(variable.memberships()[1], [0, 0, 1, 0, 0])
    np.testing.assert_array_equal(variable.memberships()[2], [0, 0, 0, 0, 1])
    np.testing.assert_array_equal(variable.memberships(np.array([0.5, 0.6]))[1], [0, 1])


def test_centers_are_inside_the_universe():
    variable = Variable("v", Universe(0, 1, 5), triangles("abc", (-0.5, 0.4, 2.0)))
    np.testing.assert_array_equal(variable.centers(), [0.0, 0.4, 1.0])


# ------------------------------------------------------------------- nodes


def test_nodes_are_even_points_and_corners():
    inside = FuzzySet("inside", "trimf", (-5.0, 0.3, 0.75))
    variable = Variable("x", Universe(-1, 1, 11), (inside, FuzzySet("bell", "gaussmf", (0, 0.2))))
    np.testing.assert_array_equal(variable.nodes(5), [-1, -0.5, 0, 0.3, 0.5, 0.75, 1])
    np.testing.assert_array_equal(variable.nodes(5, corners=False), [-1, -0.5, 0, 0.5, 1])


def test_sets_of_straight_lines_are_straight_between_nodes():
    sets = (
        FuzzySet("a", "trapmf", (-1.0, -1.0, -0.31, 0.17)),
        FuzzySet("jump", "trapmf", (0.4, 0.4, 0.6, 0.9)),
        FuzzySet("spike", "singleton", (0.123,)),
    )
    variable = Variable("x", Universe(-1, 1, 11), sets)
    nodes = variable.nodes(4)
    x = np.random.default_rng(0).uniform(-1, 1, 500)
    for each in sets:
        drawn = np.interp(x, nodes, each.membership(nodes))
        np.testing.assert_allclose(drawn, each.membership(x), atol=1e-12)


def test_an_even_point_beside_a_corner_is_left_out():
    # 3 * 0.1 is the float after 0.3.
    corner = FuzzySet("a", "trimf", (0.0, 3 * 0.1, 1.0))
    assert len(Variable("x", Universe(0, 1, 11), (corner,)).nodes(11)) == 11
