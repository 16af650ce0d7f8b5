import pytest

from fuzzytrack import RuleBaseError, loads_rulebase
from fuzzytrack.fuzzy.loading import rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.numbers import NumberPlaces, with_numbers


def shipped(name):
    return rulebase_path(name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", shipped_rulebases())
def test_all_numbers_are_found_and_setting_them_as_they_are_changes_nothing(name):
    text = shipped(name)
    rules, places = loads_rulebase(text), NumberPlaces.of(text)
    for part, variables in (("inputs", rules.inputs), ("outputs", rules.outputs)):
        for variable in variables:
            for fuzzy_set in variable.sets:
                for k, parameter in enumerate(fuzzy_set.parameters):
                    place = (part, variable.name, "sets", fuzzy_set.name, fuzzy_set.shape, k)
                    assert places.values[place] == parameter
                    start, end = places.spans[place]
                    assert float(text[start:end]) == parameter
    assert loads_rulebase(with_numbers(text, places.values)) == rules


def test_nothing_but_the_number_changes():
    text = shipped("omega-schedule").replace("\n", "\r\n")
    changed = with_numbers(
        "\ufeff" + text,
        {("scheduler", "rho"): 0.5, ("inputs", "lag", "sets", "ps", "trimf", 1): 0.7},
    )
    before, after = text.split("\r\n"), changed.removeprefix("\ufeff").split("\r\n")
    differ = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert differ == [
        (
            "      ps: {trimf: [0, 0.6866666666666666, 1.3733333333333333]}",
            "      ps: {trimf: [0, 0.7, 1.3733333333333333]}",
        ),
        tuple(
            f"scheduler: {{normalization: smoothed, rho: {rho}, gains: kalata, "
            "opening: growing-memory}"
            for rho in (0.774, 0.5)
        ),
    ]


def test_a_number_in_a_part_that_an_alias_repeats_changes_wherever_it_stands():
    text = shipped("stiffness-damping")
    rules = loads_rulebase(with_numbers(text, {("inputs", "dE", "sets", "ps", "trimf", 1): 0.15}))
    assert rules.input("E").sets == rules.input("dE").sets
    assert rules.input("E").sets[4].parameters == (0.0, 0.15, 0.3)


def test_a_number_that_an_anchor_shares_is_refused():
    text = shipped("omega-schedule").replace("[-2.06, 2.06, 41]", "[-2.06, &end 2.06, 41]")
    text = text.replace("pl: {trimf: [1.3733333333333333, 2.06, 2.06]}",
                        "pl: {trimf: [1.3733333333333333, *end, 2.06]}")  # fmt: skip
    with pytest.raises(
        RuleBaseError, match=r"omega\.yaml:\d+:23: '&end 2.06': a number that an an"
    ):
        NumberPlaces.of(text, "omega.yaml")


def test_a_change_that_makes_no_rule_base_and_an_unknown_place_are_refused():
    text = shipped("omega-schedule")
    with pytest.raises(RuleBaseError, match="trimf requires a <= b <= c"):
        with_numbers(text, {("inputs", "lag", "sets", "ps", "trimf", 1): 3.0})
    with pytest.raises(KeyError, match="speed"):
        with_numbers(text, {("scheduler", "speed"): 3.0})
