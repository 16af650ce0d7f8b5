import numpy as np
import pytest

import fuzzytrack as ft
from benchmarks.families import FAMILIES, stretched
from benchmarks.objective import prediction_mse
from fuzzytrack.simulation.published import track_set
from fuzzytrack.trackers import Tracker


def test_stretched_limits_move_sets_and_outputs_alike():
    rules = ft.load_rulebase("stiffness-damping")
    assert stretched(rules, {}) == rules
    moved = stretched(rules, {"damping": (0.4, 1.1)})
    before, after = (
        ft.FuzzySystem(base).evaluate(np.array([[0.3, -0.2]])) for base in (rules, moved)
    )
    part = (before["damping"] - 0.54) / (0.89 - 0.54)
    np.testing.assert_allclose(after["damping"], 0.4 + part * 0.7, rtol=1e-12)
    np.testing.assert_array_equal(after["stiffness"], before["stiffness"])
    with pytest.raises(ft.RuleBaseError, match="limits of damping must rise"):
        stretched(rules, {"damping": (1.1, 0.4)})


@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_makes_trackers_at_its_start_and_its_limits(name):
    family = FAMILIES[name]
    assert len(family.start) == len(family.low) == len(family.high)
    assert all(
        low <= x <= high for low, x, high in zip(family.low, family.start, family.high, strict=True)
    )
    for numbers in {family.start, family.low, family.high}:
        assert isinstance(family.make(numbers), Tracker)


def test_the_schedule_at_its_own_numbers_is_the_shipped_one():
    family = FAMILIES["omega-schedule, tuned"]
    tracks = track_set("strong", 3, 5)
    shipped = prediction_mse(FAMILIES["omega-schedule"].make(()), tracks, 1)
    np.testing.assert_allclose(prediction_mse(family.make(family.start), tracks, 1), shipped)
    with pytest.raises(ValueError, match="levels must rise"):
        family.make((0.8, 2.0, 0.5, 0.4, 0.6, 0.7))
