import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains, RuleBaseError, load_rulebase
from fuzzytrack.fuzzy.saving import save_rulebase
from fuzzytrack.io.piece import Piece
from fuzzytrack.recordings.ragged import run_tracks
from fuzzytrack.recordings.streaming import run_iter
from fuzzytrack.schedulers import schedulers
from fuzzytrack.schedulers.catalog import make_scheduler
from fuzzytrack.simulation.scenario import PlotNoise, Scenario
from fuzzytrack.testbed.comparison import compare, compare_tracks
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.operations import count_operations
from fuzzytrack.trackers import trackers
from fuzzytrack.trackers.catalog import as_trackers, catalog, make_tracker
from fuzzytrack.trackers.track_store import TrackStore


@pytest.fixture
def toy():
    """Plug-ins that take parameters of every sort."""

    class Toy(FixedGains):
        def __init__(self, level: int, word: str = "a", maybe: float | None = None,
                     flag: bool = False, loose=None) -> None:  # fmt: skip
            super().__init__(0.5, 0.2)
            for name, value in (("level", level), ("word", word), ("maybe", maybe),
                                ("flag", flag), ("loose", loose)):  # fmt: skip
                object.__setattr__(self, name, value)

    schedulers.register("toy")(Toy)
    trackers.register("toy-tracker")(lambda scheduler, width=2: AlphaBetaTracker(Toy(width)))
    trackers.register("toy-broken")(lambda: "nothing")
    yield
    schedulers.unregister("toy")
    trackers.unregister("toy-tracker")
    trackers.unregister("toy-broken")


def test_rule_bases_by_name_and_file(tmp_path):
    rules = load_rulebase("stiffness-damping")
    assert make_tracker("stiffness-damping").scheduler.rules == rules
    for name in ("mine.yaml", "MINE.YML"):
        save_rulebase(rules, tmp_path / name)
        assert make_tracker(str(tmp_path / name)).scheduler.rules == rules
    one = make_tracker(f" {tmp_path / 'mine.yaml'}:method=relation:start=one-point ")
    assert (one.scheduler.method, one.start_mode) == ("relation", "one-point")
    assert make_tracker(f"{tmp_path / 'mine.yaml'}:missed=step").missed == "step"


def test_upper_case_suffix_is_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_rulebase(load_rulebase("chan-style"), "A.YAML")
    assert make_tracker("A.YAML").scheduler.rules.name == "chan-style"


def test_fixed_gains():
    tracker = make_tracker("fixed:alpha=0.5:beta=.2:gamma=1e-2:start=one-point")
    assert tracker == AlphaBetaTracker(FixedGains(0.5, 0.2, 0.01), start="one-point")


def test_trackers_take_schedulers_and_rule_bases_by_name():
    assert make_tracker("alpha-beta:scheduler=chan-style") == make_tracker("chan-style")
    assert make_tracker("fuzzy:rules=chan-style") == make_tracker("chan-style")


@pytest.mark.usefixtures("toy")
def test_values_follow_the_annotations():
    made = make_tracker("toy:level=3:word=1:maybe=2:flag=yes:loose=4").scheduler
    assert (made.level, made.word, made.maybe, made.flag, made.loose) == (3, "1", 2.0, True, 4)
    assert make_tracker("toy:level=3:loose=1.5").scheduler.loose == 1.5
    assert make_tracker("toy:level=3:loose=x").scheduler.loose == "x"
    assert make_tracker("toy-tracker:scheduler=x:width=5").scheduler.level == 5


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("", "a name is missing"),
        ("stifness-damping", "no such tracker; did you mean 'stiffness-damping'.*fixed.*yaml"),
        (
            "fixed:alpha=.5",
            "needs beta; write it as :beta=...; parameters: alpha, beta, gamma=0.0, period=None, "
            "start=two-point, missed=elapsed",
        ),
        (
            "fixed:alfa=.5",
            r"did you mean 'alpha'\? allowed: alpha, beta, gamma, period, start, missed",
        ),
        ("fixed:alhpa=.5:beta=.2", "unknown parameter 'alhpa'; did you mean 'alpha'.*allowed"),
        ("fixed:alpha=a:beta=.2", "alpha must be a number, got 'a'"),
        ("fixed:alpha=1:alpha=1", "parameter 'alpha' is given twice"),
        ("fixed:.5:beta=.2", "'.5' is no parameter; write parameters as name=value"),
        ("fixed:alpha=3:beta=1", "tracker 'fixed:alpha=3:beta=1': alpha, beta must keep"),
        ("chan-style:start=q", "start: unknown 'q'"),
        ("chan-style:missed=q", "missed: unknown 'q'; one of elapsed, step"),
        ("chan-style:method=q", "unknown 'q'"),
        ("chan-style:metod=table", "did you mean 'method'"),
        ("alpha-beta", "needs scheduler"),
        ("alpha-beta:strat=1", "unknown parameter 'strat'; did you mean 'start'"),
        ("alpha-beta:scheduler=q", "scheduler 'q': no such scheduler; allowed: chan-style"),
        ("toy:level=1.5", "level must be a whole number, got '1.5'"),
        ("toy:level=1:flag=perhaps", "flag must be true or false"),
        ("toy:level=1:maybe=x", "maybe must be a number"),
        ("toy-broken", "its plug-in made no tracker, but str"),
    ],
)
@pytest.mark.usefixtures("toy")
def test_mistakes(spec, message):
    with pytest.raises(ValueError, match=message):
        make_tracker(spec)


@pytest.mark.parametrize("spec", ["valve", "nowhere.yaml", r"C:\nowhere.yaml:method=table",
                                  "fuzzy:rules=stif"])  # fmt: skip
def test_mistakes_in_rule_bases(spec):
    with pytest.raises(RuleBaseError):
        make_tracker(spec)


def test_annotations_for_type_checkers_only(monkeypatch):
    def factory(scheduler: "Absent" = None, k: "Absent" = 1):  # noqa: F821
        return AlphaBetaTracker(FixedGains(0.5, k / 10))

    trackers.register("toy-late")(factory)
    try:
        assert make_tracker("toy-late:k=3").scheduler.beta == 0.3
    finally:
        trackers.unregister("toy-late")


@pytest.mark.usefixtures("toy")
def test_everything_listed_has_a_name_parameters_and_package():
    entries = {(e.kind, e.name): e for e in catalog()}
    assert entries["rule base", "stiffness-damping"].parameters == (
        "method=exact", "period=None", "start=two-point", "missed=elapsed", "covariance=None",
    )  # fmt: skip
    assert entries["scheduler", "fixed"].parameters[:3] == ("alpha", "beta", "gamma=0.0")
    assert entries["scheduler", "fixed"].package == "fuzzytrack"
    assert "Llinas" in entries["tracker", "alpha-beta"].source
    assert ("rule base", "valve") not in entries
    assert ("tracker", "toy-tracker") in entries


# ------------------------------------------------------------------ texts in place of objects

TEXT = "kalman-cv:sigma_v=0.5:sigma_w=2:start=one-point"
TIMES = np.array([0.0, 1.0, 3.0, 4.0, 7.0])
TRUTH = TIMES[:, None] * [3.0, -1.0]


def a_comparison(tracker):
    return compare({"a": tracker}, TIMES, TRUTH, 2.0, runs=3, seed=1).predicted_mse


def pooled(tracker):
    return compare_tracks({"a": tracker}, [(TIMES, TRUTH)], 2.0, runs=3, seed=1).predicted_mse


def an_experiment(tracker):
    scenario = Scenario("line", TIMES, TRUTH, PlotNoise(2.0))
    return monte_carlo(scenario, {"a": tracker}, runs=3, seed=1).predicted


def pieces(tracker):
    piece = Piece.of(["a"] * len(TIMES), TIMES, TRUTH)
    (tracked,) = run_iter(tracker, [piece])
    return tracked.outputs["predicted"]


def a_store(tracker):
    store = TrackStore(tracker, 2)
    slots = store.add(store.tracker.start([[0.0, 1.0]], 0.0))
    store.step(slots, [[5.0, 3.0]], 2.0)
    return store.gather(slots).position


WAYS = {
    "run_tracks": lambda tracker: run_tracks(tracker, [(TIMES, TRUTH)])[0].predicted,
    "run_iter": pieces,
    "compare": a_comparison,
    "compare_tracks": pooled,
    "monte_carlo": an_experiment,
    "count_operations": lambda tracker: count_operations(tracker).total,
    "TrackStore": a_store,
}


@pytest.mark.parametrize("way", WAYS)
def test_a_text_stands_for_a_tracker(way):
    np.testing.assert_array_equal(WAYS[way](TEXT), WAYS[way](make_tracker(TEXT)))
    with pytest.raises(ValueError, match="no such tracker"):
        WAYS[way]("nothing")


# `count_operations` takes a scheduler as well.
@pytest.mark.parametrize("way", sorted(WAYS.keys() - {"count_operations"}))
def test_a_scheduler_is_no_tracker(way):
    with pytest.raises(TypeError, match=r"FixedGains; wrap it: AlphaBetaTracker\(\.\.\.\)$"):
        WAYS[way](FixedGains(0.5, 0.2))


def test_several_trackers():
    fixed = AlphaBetaTracker(FixedGains(0.5, 0.2))
    assert as_trackers({"a": fixed, "b": TEXT}) == {"a": fixed, "b": make_tracker(TEXT)}
    both = as_trackers(["chan-style", TEXT])
    assert both == {"chan-style": make_tracker("chan-style"), TEXT: make_tracker(TEXT)}
    assert list(both) == ["chan-style", TEXT]
    assert as_trackers(TEXT) == {TEXT: make_tracker(TEXT)}


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"a": FixedGains}, TypeError, "trackers: 'a' must be a Tracker, .* the class FixedGains$"),
        ({"a": 5}, TypeError, "trackers: 'a' must be a Tracker, or a text such as .*, got int$"),
        (AlphaBetaTracker(FixedGains(0.5, 0.2)), TypeError, "sequence of texts, got AlphaBetaTr"),
        (["chan-style", 5], TypeError, "sequence of texts; the sequence holds int"),
        (["a", "b", "a"], ValueError, "trackers: 'a' is given twice"),
        ({}, ValueError, "trackers: at least one is needed"),
        ((), ValueError, "trackers: at least one is needed"),
    ],
)
def test_what_several_trackers_are_not(given, error, message):
    with pytest.raises(error, match=message):
        as_trackers(given)


def test_a_text_stands_for_a_scheduler(tmp_path):
    assert AlphaBetaTracker("fixed:alpha=0.5:beta=0.2") == AlphaBetaTracker(FixedGains(0.5, 0.2))
    assert AlphaBetaTracker("chan-style", "one-point") == make_tracker("chan-style:start=one-point")
    save_rulebase(load_rulebase("chan-style"), tmp_path / "mine.yaml")
    mine = AlphaBetaTracker(f"{tmp_path / 'mine.yaml'}:method=table").scheduler
    assert mine == make_scheduler("chan-style:method=table")


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("", "scheduler '': no such scheduler"),
        ("fixd", "did you mean 'fixed'"),
        ("imm", "scheduler 'imm': no such scheduler"),
        ("fixed:alpha=0.5", "scheduler 'fixed:alpha=0.5': needs beta; write it as :beta=..."),
        ("fixed:alpha=0.5:beta=0.2:start=one-point", "unknown parameter 'start'"),
        ("fixed:0.5", "scheduler 'fixed:0.5': '0.5' is no parameter"),
    ],
)
def test_mistakes_in_schedulers(spec, message):
    with pytest.raises(ValueError, match=message):
        AlphaBetaTracker(spec)
