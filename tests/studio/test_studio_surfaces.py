"""Surfaces as the page draws them."""

import re

import numpy as np
import pytest

from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.wdomain import alpha_beta_from_w
from fuzzytrack.studio.surfaces import surface_names, surfaces

SEVEN = FuzzySystem(load_rulebase("stiffness-damping"))
ONE = FuzzySystem(load_rulebase("omega-schedule"))


def test_outputs_and_gains():
    assert surface_names(SEVEN) == ("stiffness", "damping", "alpha", "beta")
    found = surfaces(SEVEN, surface_names(SEVEN), 11)
    assert found.inputs == ("E", "dE")
    exact = SEVEN.surface("stiffness", 11)
    np.testing.assert_allclose(found.values["stiffness"], exact.values, rtol=1e-6)
    np.testing.assert_allclose(found.x, exact.x, rtol=1e-6)
    alpha, _ = alpha_beta_from_w(exact.values, SEVEN.surface("damping", 11).values)
    np.testing.assert_allclose(found.values["alpha"], alpha, rtol=1e-6)
    assert all(v.dtype == "<f4" and v.shape == (11, 11) for v in found.values.values())
    turned = surfaces(SEVEN, ["alpha"], 11, inputs=["dE", "E"])
    np.testing.assert_array_equal(turned.values["alpha"], found.values["alpha"].T)


def test_one_input_and_gains_as_outputs():
    found = surfaces(ONE, ["stiffness", "beta"], 21)
    assert found.values["beta"].shape == (21, 1)
    assert found.y.tolist() == [0.0]
    assert surface_names(FuzzySystem(load_rulebase("chan-style"))) == ("alpha", "beta")


def test_difference():
    wide = FuzzySystem(load_rulebase("stiffness-damping-wide"))
    found = surfaces(SEVEN, ["beta"], 9, less=wide)
    both = [surfaces(s, ["beta"], 9).values["beta"] for s in (SEVEN, wide)]
    np.testing.assert_allclose(found.values["beta"], both[0] - both[1], atol=1e-6)
    assert not surfaces(SEVEN, ["beta"], 9, less=SEVEN).values["beta"].any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": 202}, "points: must be a whole number from 2 to 201, got 202"),
        ({"points": 1}, "points: must be"),
        ({"points": 2.5}, "points: must be"),
        ({"names": ["gamma"]}, "names: gamma does not follow from the outputs"),
        ({"names": ["stifness"]}, "unknown output 'stifness'; did you mean 'stiffness'?"),
        ({"names": []}, "names: give at least one of stiffness, damping, alpha, beta"),
        ({"inputs": ["E", "E"]}, "inputs: must be 2 of E, dE, got E, E"),
        ({"inputs": ["E", "F"]}, "inputs: must be 2 of"),
        ({"at": {"E": 0}}, "at: must give a number for no input; got E=0"),
        ({"less": ONE}, "less: omega-schedule has inputs lag; a difference"),
    ],
)
def test_refused(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        surfaces(SEVEN, **{"names": ["alpha"], **arguments})
