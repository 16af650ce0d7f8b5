from fuzzytrack_two_speed import SoftSign, TwoSpeed

import fuzzytrack as ft
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import schedulers
from fuzzytrack.testing import check_scheduler


def test_entry_points_are_found():
    assert schedulers.get("two-speed") is TwoSpeed
    assert normalizations.get("soft-sign") is SoftSign


def test_the_scheduler_keeps_the_contract():
    check_scheduler(TwoSpeed(threshold=2.0))


def test_the_normalisation_feeds_a_rule_base():
    text = dumps_rulebase(ft.load_rulebase("stiffness-damping"))
    assert "chan" in text
    rules = ft.loads_rulebase(text.replace("normalization: chan", "normalization: soft-sign"))
    check_scheduler(ft.FuzzyScheduler(rules))
