"""Point symmetry of sets and rules."""

import numpy as np
import pytest

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.studio.symmetry import mirrored_conditions, mirrored_shape, symmetric_shape

SHAPES = [
    ("trimf", (0, 1, 4)),
    ("trapmf", (0, 1, 2, 4)),
    ("gaussmf", (1, 2)),
    ("gauss2mf", (0, 1, 2, 3)),
    ("gbellmf", (1, 2, 3)),
    ("sigmf", (1, 2)),
    ("smf", (0, 2)),
    ("zmf", (1, 2)),
    ("pimf", (0, 1, 2, 4)),
    ("singleton", (3,)),
]


@pytest.mark.parametrize(("shape", "parameters"), SHAPES)
def test_mirror_images(shape, parameters):
    left = FuzzySet("left", shape, parameters)
    variable = Variable("x", Universe(-1, 5, 7), (left, FuzzySet("right", "singleton", (5,))))
    image = mirrored_shape(variable, left)
    assert image.name == "right"
    x = np.linspace(-1, 5, 61)
    np.testing.assert_allclose(image.membership(4 - x), left.membership(x), atol=1e-12)
    assert mirrored_shape(variable, image) == left


def test_conditions():
    rules = load_rulebase("stiffness-damping")
    assert mirrored_conditions(rules, {"E": "nl", "dE": "ps"}) == {"E": "pl", "dE": "ns"}


def test_a_set_that_is_its_own_mirror():
    variable = load_rulebase("stiffness-damping").input("E")
    new = symmetric_shape(variable, FuzzySet("ze", "trimf", (-0.1, 0, 0.2)))
    assert new.parameters == (-0.2, 0, 0.2)
    assert symmetric_shape(variable, FuzzySet("ze", "gaussmf", (0, 0.2))).shape == "gaussmf"
    with pytest.raises(RuleBaseError, match="'ze' of E is its own mirror"):
        symmetric_shape(variable, FuzzySet("ze", "trimf", (-0.1, 0.05, 0.1)))
