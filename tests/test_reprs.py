"""What `repr` gives is code that makes the object again, or is marked as none."""

import pickle
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack import normalizations, schedulers, trackers
from fuzzytrack.fuzzy.saving import save_rulebase
from fuzzytrack.fuzzy.shapes import SHAPES
from fuzzytrack.gains.cost import TrackingCost
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.recording import Recording, Track
from fuzzytrack.normalizations import Scale, Smoothed, SmoothedMagnitude
from fuzzytrack.papers.llinas.columns import columns
from fuzzytrack.papers.llinas.programs import Run
from fuzzytrack.papers.llinas.sampling import ReportTracks
from fuzzytrack.papers.reproduction import Reproduction
from fuzzytrack.plugins.scripts import Script
from fuzzytrack.recordings.ragged import batches
from fuzzytrack.recordings.streaming import run_iter
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers import (
    FadingMemory,
    GrowingMemory,
    InnovationScheduler,
    KalmanCA,
    KalmanCV,
    LinearCombination,
    QualityGains,
)
from fuzzytrack.schedulers.reachable_gains import certify, reachable_gains
from fuzzytrack.schedulers.review import review
from fuzzytrack.simulation.published import track_set
from fuzzytrack.simulation.scenario_files import load_scenario
from fuzzytrack.simulation.sensor_field import canonical_field
from fuzzytrack.testbed.comparison import compare
from fuzzytrack.testbed.metrics import PairedDifference
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.trackers import (
    InteractingModels,
    InteractingPair,
    MotionModel,
    ParallelBank,
    WindowSearch,
)
from fuzzytrack.trackers.covariance import track_covariance
from fuzzytrack.trackers.track_store import TrackStore
from fuzzytrack.tuning import VARIANTS, rank
from fuzzytrack.tuning.scored_plots import scored_plots

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
    'InteractingPair(0.1, 2.0, maneuver="cv", joint=False)': InteractingPair(
        0.1, 2, maneuver="cv", joint=False
    ),
    "InteractingModels((MotionModel(0.5), MotionModel(2.0, retention=4.0)), "
    "((0.0, 0.25), (0.5, 0.0)), (0.75, 0.25), level=3.0)": InteractingModels(
        (MotionModel(0.5), MotionModel(2, 4)), ((0, 0.25), (0.5, 0)), (0.75, 0.25), 3
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


@pytest.mark.parametrize("draw", [ft.plot_memberships, ft.plot_gain_surfaces, ft.plot_surface])
def test_rules_by_name_in_functions(draw):
    _, axes = draw("omega-schedule")
    assert len(axes) == len(draw(ft.load_rulebase("omega-schedule"))[1])
    plt.close("all")
    with pytest.raises(TypeError, match=r"rules must be a RuleBase, the name .* got int"):
        draw(5)


def test_rules_by_name_in_the_theory(tmp_path):
    rules = ft.load_rulebase("chan-style")
    save_rulebase(rules, tmp_path / "mine.yaml")
    assert ft.FuzzySystem("chan-style").rules == rules
    assert ft.FuzzySystem(tmp_path / "mine.yaml", "table").rules == rules
    assert certify("chan-style").rate == certify(rules).rate
    assert (reachable_gains("chan-style") == reachable_gains(rules)).all()
    gains = ft.Gains(*np.array([[0.5, 0.6], [0.2, 0.1], [0.0, 0.0]]))
    _, plane = ft.plot_gain_plane(gains, "chan-style")
    assert "limits of chan-style" in plane.get_legend_handles_labels()[1]
    plt.close("all")
    with pytest.raises(TypeError, match=r"gains must be pairs \(alpha, beta\), .* got FixedGains"):
        certify(ft.FixedGains(0.5, 0.2))
    with pytest.raises(TypeError, match=r"rules must be a RuleBase, .* got FixedGains"):
        ft.FuzzySystem(ft.FixedGains(0.5, 0.2))
    with pytest.raises(TypeError, match=r"box must be \(\(low, .* got FixedGains"):
        ft.plot_gain_plane(gains, ft.FixedGains(0.5, 0.2))
    with pytest.raises(TypeError, match="a rule base needs a name or a path, got int"):
        ft.load_rulebase(5)
    assert review("chan-style").rules == rules
    with pytest.raises(ft.RuleBaseError, match="did you mean 'chan-style'"):
        certify("chan-stile")


# ------------------------------------------------------------------ values that hold arrays


def values():
    """One of each class of values with arrays, and of others whose fields are long."""
    rules = ft.load_rulebase("stiffness-damping")
    tracker = ft.AlphaBetaTracker(KalmanCV(0.5))
    times = np.arange(6.0)
    plots = times[:, None, None] * [[3.0, -1.0], [2.0, 0.5], [1.0, 7.0]]
    result = tracker.run(times, plots, 1.5)
    scenario = load_scenario("constant-velocity")
    results = monte_carlo(scenario, ["chan-style", "kalman-cv:sigma_v=0.5"], runs=3, seed=1)
    piece = Piece.of(["a"] * 6, times, plots[:, 0])
    system = ft.FuzzySystem(rules, "table", table_nodes=5)
    store = TrackStore(tracker, 2)
    store.add(tracker.start(plots[0], 0.0, 1.5))
    yield from (result, result.gains, result.state, tracker.predict(result.state, 9.0), store)
    yield from (scenario, scenario.sensors, results, results.sample)
    yield from (piece, piece.ids, *run_iter("chan-style", [piece]), *batches([times, times[:4]]))
    yield from (
        Track("a", times, plots[:, 0]),
        Recording("a.csv", Columns("t", "id", ("x", "y")), ()),
    )
    yield from (certify(rules), certify("stiffness-damping-wide"), review(rules))
    yield from (rules.inputs[0], *rules.rules, system.surface("damping", 5), SHAPES["trapmf"])
    yield from (track_covariance(result, 1.5, 0.5), tracker.program(2), columns(rules))
    yield from (canonical_field(1500.0), track_set("mixed", 3, 1), ReportTracks.of(4.0, 60.0, 2))
    yield from (Run(plots[:, 0], times), Script("a.py", b"x = 1\n" * 90))
    yield TrackingCost(sigma=10.0, dt=2.0, velocity=3.0)
    yield Reproduction("llinas", "Llinas et al. (1998)", ())
    yield compare(["chan-style"], times, plots[:, 0], 2.0, runs=20, seed=1)
    yield PairedDifference("constant-velocity", "chan-style", "predicted", "rmse",
                           *np.random.default_rng(1).random(5), 200)  # fmt: skip
    yield rank(["fixed:alpha=0.5:beta=0.2"], 2, 1, ["jitter"])
    yield scored_plots("report", VARIANTS["jitter"], 2, 1)


def test_values_with_arrays_are_one_short_line():
    found = {type(value).__name__: repr(value) for value in values()}
    assert len(found) > 30
    wrong = {name: text for name, text in found.items() if len(text) >= 200 or "\n" in text}
    assert not wrong
    assert not {name: text for name, text in found.items() if "array(" in text or " at 0x" in text}


def test_what_a_summary_says():
    found = compare(["chan-style"], range(6), np.arange(12.0).reshape(6, 2), 2.0, runs=20, seed=1)
    assert repr(found) == '<Comparison: names=("chan-style",), runs=20, seed=1, sigma=2>'
    store = TrackStore("fixed:alpha=0.5:beta=0.2", 2)
    store.add(store.tracker.start([[1.0, 2.0], [3.0, 5.0], [0.0, 9.0]], 0.0))
    assert repr(store) == (
        "<TrackStore: tracker=AlphaBetaTracker(FixedGains(0.5, 0.2)), n_axes=2, tracks=3>"
    )
    prediction = store.predict([0, 2], 4.0)
    assert repr(prediction) == "<Prediction: time.shape=(2,), position.shape=(2, 2)>"
    track = ft.AlphaBetaTracker("fixed:alpha=0.5:beta=0.2").start([1.0, 2.0], 0.25)
    assert repr(track) == "<TrackState: time=0.25, shape=(2,)>"


def test_the_beginning_of_what_is_long():
    class Long:
        names = tuple("abcdef")
        text = "x" * 500
        none = None
        by_name = MappingProxyType({"p": np.ones(3), "q": np.ones(3)})

    assert summary(Long(), "names", "none", "by_name", third=1 / 3) == (
        '<Long: names=("a", "b", "c", "d", … 6 in all), none=None, by_name=("p", "q"), '
        "third=0.333333>"
    )
    assert summary(Long(), "text") == f'<Long: text="{"x" * 70}…>'
