"""What a page does not edit is shown with its line; what shares a text changes together."""

import numpy as np
import pytest

from fuzzytrack.fuzzy.loading import loads_rulebase, rulebase_path
from fuzzytrack.studio.places import Places, places_of
from fuzzytrack.studio.state import rulebase_state

TEXT = rulebase_path("tipper").read_text(encoding="utf-8")


def state(*changes):
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    found = rulebase_state(loads_rulebase(text), places_of(text))
    return found, [None, *text.splitlines()]


def test_rules_of_if_any_have_one_line():
    found, lines = state()
    rules = found["rules"]["rules"]
    assert [rule["together"] for rule in rules] == [2, 2, 1, 2, 2]
    assert [lines[rule["line"]].split("then: ")[1] for rule in rules] == [
        "{tip: cheap}}", "{tip: cheap}}", "{tip: average}}", "{tip: generous}}", "{tip: generous}}",
    ]  # fmt: skip


def test_alternatives_of_a_rule():
    changed = (
        "{if any: {service: poor, food: rancid},     ",
        "{if: {service: poor}, or: [{food: rancid}],",
    )
    found, lines = state(changed)
    rule = found["rules"]["rules"][0]
    assert (rule["if"], rule["or"]) == ({"service": "poor"}, [{"food": "rancid"}])
    assert "or: [" in lines[rule["line"]]


@pytest.mark.parametrize("shape", ["not gaussmf", "spike"])
def test_a_shape_that_is_not_drawn_has_its_curve(shape):
    found, lines = state(("good:      {gaussmf: ", f"good:      {{{shape}: "))
    good = found["inputs"][0]["sets"][1]
    assert "good:" in lines[good["line"]]
    assert tuple(good["names"]) == (("mean", "sigma") if "gauss" in shape else ("center", "width"))
    x = np.linspace(0, 10, 201)
    expected = {
        "not gaussmf": 1 - np.exp(-(((x - 5) / 1.5) ** 2) / 2),
        "spike": np.exp(-10 * np.abs(x - 5) / 1.5),
    }[shape]
    np.testing.assert_allclose(good["grades"], expected, atol=1e-12)
    assert "grades" not in found["inputs"][0]["sets"][0]


def test_a_linear_set_has_numbers_by_inputs():
    sets = [
        ("{trimf: [0, 5, 10]}", "{linear: [1, 0.5, 2]}"),
        ("{trimf: [10, 15, 20]}", "{linear: [0, 0.5, 12]}"),
        ("{trimf: [20, 25, 30]}", "{linear: [0, 0, 25]}"),
    ]
    found, _ = state(*sets, ("defuzzification: centroid", "defuzzification: weighted-centers"))
    cheap = found["outputs"][0]["sets"][0]
    assert (cheap["names"], cheap["core"]) == (("service", "food", "constant"), None)
    assert tuple(cheap["grades"]) == ()


def test_operators_of_an_output():
    own = "operators: {and: min, or: sum, defuzzification: centroid}"
    found, lines = state(('unit: "%"', own))
    operators = found["outputs"][0]["operators"]
    assert operators["words"] == ["min", "sum", "centroid"]
    assert own in lines[operators["line"]]
    assert found["inputs"][0]["operators"] is None


def test_what_cannot_be_read_has_no_places():
    assert places_of("a: [") == Places()
    assert places_of("inputs: 1\nrules: [1]") == Places(rules=[(2, 1)])


def test_lines_of_another_text_are_not_taken():
    found = rulebase_state(loads_rulebase(TEXT), places_of("rules: [1]"))
    assert {rule["line"] for rule in found["rules"]["rules"]} == {None}


def test_conclusions_of_if_any_change_together(page):
    page.ask("open", name="tipper")
    text = page.ask("set_rule", index=1, text="average@0.5")["state"]["text"]
    assert text == TEXT.replace("then: {tip: cheap}", "then: {tip: average@0.5}")
