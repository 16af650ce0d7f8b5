import pickle

import pytest

from fuzzytrack import AlphaBetaTracker, FuzzyScheduler, RuleBaseError, loads_rulebase
from fuzzytrack.fuzzy.loading import load_rulebase, rulebase_path
from fuzzytrack.tuning.rulebase_numbers import rulebase_numbers


def free(name, words=None, options=None):
    text = rulebase_path(name).read_text(encoding="utf-8")
    return rulebase_numbers(text, name, options or {}, words)


def names(candidates):
    return [p.name for p in candidates.space.parameters]


LEVELS = ["stiffness.Z", "stiffness.S", "stiffness.M", "stiffness.L"]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (None, [*LEVELS, "lag.ps", "lag.pm", "lag.pl", "rho"]),
        (["outputs"], LEVELS),
        (["stiffness"], LEVELS),
        (["sets"], ["lag.ps", "lag.pm", "lag.pl"]),
        (["lag"], ["lag.ps", "lag.pm", "lag.pl"]),
        (["normalization"], ["rho"]),
        # The corners of a set: of the middle one its feet.
        (["lag.ze"], ["lag.ps"]),
        (["lag.ns"], ["lag.ps", "lag.pm"]),
        (["rho", "stiffness.M"], ["stiffness.M", "rho"]),
    ],
)
def test_words_choose_numbers(words, expected):
    assert names(free("omega-schedule", words)) == expected


def test_what_is_allowed_is_listed():
    with pytest.raises(ValueError, match=r"no number 'stifness'; did you mean 'stiffness'.* rho"):
        free("omega-schedule", ["stifness"])
    with pytest.raises(ValueError, match=r"no number that is free; name some out of lag, .*sets"):
        free("omega-schedule", [])
    with pytest.raises(RuleBaseError, match="lacks its format version"):
        rulebase_numbers("name: x", "x.yaml", {}, None)


@pytest.mark.parametrize(
    "name", ["omega-schedule", "stiffness-damping", "stiffness-damping-cog", "chan-style"]
)
def test_at_its_start_the_text_is_that_of_before(name):
    candidates = free(name)
    assert candidates.text(candidates.space.start) == candidates.rules_text
    tracker = candidates.tracker(candidates.space.start)
    assert tracker == AlphaBetaTracker(FuzzyScheduler(load_rulebase(name)))
    assert pickle.loads(pickle.dumps(candidates)) == candidates


def test_symmetric_sets_stay_symmetric_and_share_their_corners():
    candidates = free("omega-schedule", ["lag"])
    lag = loads_rulebase(candidates.text((0.5, 1.1, 3.0))).input("lag")
    assert (lag.universe.low, lag.universe.high) == (-3.0, 3.0)
    assert [s.parameters for s in lag.sets] == [
        (-3.0, -3.0, -1.1), (-3.0, -1.1, -0.5), (-1.1, -0.5, 0.0), (-0.5, 0.0, 0.5),
        (0.0, 0.5, 1.1), (0.5, 1.1, 3.0), (1.1, 3.0, 3.0),
    ]  # fmt: skip


def test_levels_move_with_the_universe_and_numbers_stay_in_order():
    candidates = free("stiffness-damping", ["stiffness"])
    assert candidates.space.rising == ((0, 1, 2, 3),)
    numbers = candidates.space.numbers([3.0, 0.0, -1.0, 2.0])
    stiffness = loads_rulebase(candidates.text(numbers)).output("stiffness")
    assert stiffness.universe.low == numbers[0] == min(numbers)
    assert stiffness.universe.high == numbers[3] == max(numbers)
    assert tuple(stiffness.centers()) == numbers
    # The damping is as it was.
    assert loads_rulebase(candidates.text(numbers)).outputs[1] == load_rulebase(
        "stiffness-damping"
    ).output("damping")


def test_sets_that_an_alias_shares_are_one_choice():
    candidates = free("stiffness-damping", ["dE"])
    assert names(candidates) == ["E.ps", "E.pm", "E.pl"]
    rules = loads_rulebase(candidates.text((0.2, 0.4, 0.7)))
    assert rules.input("E").sets == rules.input("dE").sets
    assert rules.input("dE").sets[-1].parameters == (0.4, 0.7, 1.0, 1.0)


def test_other_shapes_and_options():
    text = rulebase_path("omega-schedule").read_text(encoding="utf-8")
    text = text.replace("ze: {trimf: [-0.6866666666666666, 0, 0.6866666666666666]}",
                        "ze: {gaussmf: [0.1, 0.4]}")  # fmt: skip
    text = text.replace("pl: {trimf: [1.3733333333333333, 2.06, 2.06]}", "pl: {sigmf: [1.5, 6]}")
    text = text.replace("nl: {trimf: [-2.06, -2.06, -1.3733333333333333]}",
                        "nl: {sigmf: [-1.5, -6]}")  # fmt: skip
    options = {"start": "one-point"}
    candidates = rulebase_numbers(text, "x.yaml", options, ["lag"])
    found = dict(zip(names(candidates), candidates.space.start, strict=True))
    assert found["lag.ze"] == 0.1
    assert found["lag.ze.sigma"] == 0.4
    assert found["lag.nl.c"] == 6.0
    # Each number goes where it belongs; a falling slope stays falling.
    numbers = tuple(1.02 * x for x in candidates.space.start)
    lag = loads_rulebase(candidates.text(numbers)).input("lag")
    assert lag.sets[0].parameters == pytest.approx((-1.53, -6.12))
    assert lag.sets[3].parameters == pytest.approx((0.102, 0.408))
    assert candidates.tracker(numbers).start_mode == "one-point"
    with pytest.raises(ValueError, match="unknown parameter 'stat'"):
        rulebase_numbers(text, "x", {"stat": "one-point"}, ["lag"]).tracker(numbers)


def test_shapes_of_any_number_of_parameters_stay_as_they_are():
    text = rulebase_path("omega-schedule").read_text(encoding="utf-8")
    rules = load_rulebase("omega-schedule")
    first = rules.inputs[0].sets[0]
    line = next(line for line in text.splitlines() if f"{first.name}:" in line and "{" in line)
    shape = line[line.index("{") : line.index("}") + 1]
    low, high = rules.inputs[0].universe.low, rules.inputs[0].universe.high
    points = f"{{discrete: [{low}, 1, {(low + high) / 2}, 0.5, {high}, 0]}}"
    changed = rulebase_numbers(text.replace(shape, points, 1), "t", {}, None).space.parameters
    assert any(p.name.startswith("lag.") for p in changed)
    assert not any(p.name.startswith(f"lag.{first.name}") for p in changed)
