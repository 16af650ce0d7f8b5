"""What `repr` gives is code that makes the object again, or is marked as none."""

import pickle
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

import fuzzytrack as ft
from fuzzytrack import normalizations, schedulers, trackers
from fuzzytrack.fuzzy.saving import save_rulebase
from fuzzytrack.normalizations import Scale, Smoothed, SmoothedMagnitude
from fuzzytrack.schedulers import (
    FadingMemory,
    GrowingMemory,
    InnovationScheduler,
    KalmanCA,
    KalmanCV,
    LinearCombination,
    QualityGains,
)
from fuzzytrack.trackers import InteractingModels, ParallelBank, WindowSearch

NAMES = {
    name: getattr(module, name)
    for module in (ft, normalizations, schedulers, trackers)
    for name in module.__all__
}

CASES = {
    'load_rulebase("stiffness-damping")': ft.load_rulebase("stiffness-damping"),
    'FuzzyScheduler(load_rulebase("stiffness-damping"))': ft.FuzzyScheduler("stiffness-damping"),
    'FuzzyScheduler(load_rulebase("chan-style"), method="table")': ft.FuzzyScheduler(
        ft.load_rulebase("chan-style"), "table"
    ),
    "FixedGains(0.5, 0.2)": ft.FixedGains(0.5, 0.2),
    "FixedGains(0.5, 0.2, gamma=0.01)": ft.FixedGains(0.5, beta=0.2, gamma=0.01),
    'FadingMemory(0.64, convention="njonjo")': FadingMemory(0.64, "njonjo"),
    "GrowingMemory()": GrowingMemory(),
    "LinearCombination(weight=0.25, limit=20.0)": LinearCombination(0.05, 0.25, 20),
    "KalmanCV(0.5, velocity_sigma=3.0)": KalmanCV(0.5, velocity_sigma=3),
    "KalmanCA(0.5, 1.0)": KalmanCA(0.5, 1),
    "QualityGains(drop=5.0)": QualityGains(drop=5),
    "InnovationScheduler(sigma_d=5.0)": InnovationScheduler(5),
    "Scale()": Scale(),
    "Smoothed(rho=0.5)": Smoothed(0.5),
    "SmoothedMagnitude()": SmoothedMagnitude(),
    "AlphaBetaTracker(FixedGains(0.5, 0.2))": ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)),
    'AlphaBetaTracker(FuzzyScheduler(load_rulebase("omega-schedule")), start="one-point")': (
        ft.AlphaBetaTracker(ft.FuzzyScheduler("omega-schedule"), "one-point")
    ),
    'ParallelBank(highest=0.8, selection="last")': ParallelBank(0.1, 0.8, selection="last"),
    "WindowSearch()": WindowSearch(),
    'InteractingModels(0.1, 2.0, maneuver="cv", joint=False)': InteractingModels(
        0.1, 2, maneuver="cv", joint=False
    ),
    'Fuzzification(shape="gaussian", width=0.5)': ft.Fuzzification("gaussian", 0.5),
}


@pytest.mark.parametrize("code", CASES)
def test_it_is_short_code_that_makes_an_equal_one(code):
    assert repr(CASES[code]) == code
    made = eval(code, dict(NAMES))
    assert type(made) is type(CASES[code])
    assert made == CASES[code]
    assert hash(made) == hash(CASES[code])
    assert repr(pickle.loads(pickle.dumps(made))) == code


@pytest.mark.parametrize("path", ["mine.yaml", Path("mine.yaml"), Path("plain"), "./plain"])
def test_a_file_by_its_path(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rules = ft.load_rulebase("valve")
    save_rulebase(rules, path)
    # A path object needs no suffix; as a text it would be a name.
    shown = "mine.yaml" if "mine" in str(path) else "./plain"
    loaded = ft.load_rulebase(path)
    assert repr(loaded) == f'load_rulebase("{shown}")'
    assert loaded == eval(repr(loaded), dict(NAMES)) == rules
    assert hash(loaded) == hash(rules)


def test_a_rule_base_that_was_not_loaded_is_marked_as_no_code():
    rules = ft.load_rulebase("stiffness-damping")
    changed = replace(rules, name="mine")
    text = '<RuleBase "mine": E, dE -> stiffness, damping; 49 rules>'
    assert repr(changed) == text
    assert repr(ft.FuzzyScheduler(changed)) == f"FuzzyScheduler({text})"
    # Even if nothing was changed: a copy does not come from a file.
    assert repr(replace(rules)).startswith("<")
    assert repr(rules) == 'load_rulebase("stiffness-damping")'


@pytest.mark.parametrize(
    "code",
    [
        'FuzzySystem(load_rulebase("tipper"))',
        'FuzzySystem(load_rulebase("tipper"), method="relation", '
        'fuzzification=Fuzzification(shape="triangular", width=2.5))',
        'FuzzySystem(load_rulebase("valve"), method="table", table_nodes=31)',
    ],
)
def test_fuzzy_systems(code):
    made = eval(code, dict(NAMES))
    assert repr(made) == code
    again = eval(repr(made), dict(NAMES))
    names = ("rules", "method", "fuzzification", "table_nodes")
    assert all(getattr(again, name) == getattr(made, name) for name in names)


def test_what_the_constructor_of_another_takes_is_not_guessed():
    class Half(ft.FixedGains):
        def __init__(self, beta):
            super().__init__(0.5, beta)

    class Renamed(ft.FixedGains):
        pass

    @dataclass(frozen=True, repr=False)
    class Own(ft.FixedGains):
        word: str = "a"
        pair: tuple = ()

    assert repr(Half(0.2)).startswith("<")
    assert repr(Renamed(0.5, 0.2)) == "Renamed(0.5, 0.2)"
    assert repr(Own(0.5, 0.2, 0.01, word='say "a"', pair=("b'", 1))) == (
        """Own(0.5, 0.2, gamma=0.01, word='say "a"', pair=("b'", 1))"""
    )
    assert repr(Own(0.5, 0.2, pair=("b",))) == 'Own(0.5, 0.2, pair=("b",))'


def test_rules_by_name_or_path(tmp_path):
    rules = ft.load_rulebase("chan-style")
    save_rulebase(rules, tmp_path / "mine.yaml")
    for given in ("chan-style", tmp_path / "mine.yaml", str(tmp_path / "mine.yaml")):
        assert ft.FuzzyScheduler(given) == ft.FuzzyScheduler(rules)
    assert replace(ft.FuzzyScheduler("chan-style"), method="table").method == "table"
    with pytest.raises(ft.RuleBaseError, match="did you mean 'chan-style'"):
        ft.FuzzyScheduler("chan-stile")
    with pytest.raises(TypeError, match=r"rules must be a RuleBase, the name .* got int"):
        ft.FuzzyScheduler(5)
