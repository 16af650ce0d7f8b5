"""Complaints beside the cell or set that they are about."""

from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.studio.complaints import Complaint, complaint_of, complaints_of_rules

TEXT = rulebase_path("stiffness-damping").read_text(encoding="utf-8")


def complaints(text):
    return complaints_of_rules(text, "x.yaml")[1]


def test_none():
    rules, found = complaints_of_rules(TEXT, "x.yaml")
    assert rules.name == "stiffness-damping"
    assert found == ()


def test_every_cell_with_a_mistake_is_named():
    text = TEXT.replace("[S-L, M-L, L-L, L-L, S-L, Z-M, Z-S]", "[X-L, M-L, L-L, L-Y, S-L, Z-M, Z]")
    text = text.replace("ze: [Z-Z, S-S", "ze: [Z-Z, {power: S}")
    rules, found = complaints_of_rules(text, "x.yaml")
    assert rules is None
    assert [c.cell for c in found] == [
        {"E": "nl", "dE": "nl"},
        {"E": "ze", "dE": "nl"},
        {"E": "pl", "dE": "nl"},
        {"E": "nm", "dE": "ze"},
    ]
    lines = text.splitlines()
    words = [lines[c.line - 1][c.column - 1 :] for c in found]
    assert words[0].startswith("X-L")
    assert words[1].startswith("Y, S")
    assert words[2].startswith("Z]")
    assert words[3].startswith("power: S")
    assert found[1].path == ("rules", "table", "nl", 3)
    assert found[0].path == ("rules", "table", "nl", 0)


def test_sets_and_other_places():
    (found,) = complaints(TEXT.replace("ze: {trimf: [-0.1, 0, 0.1]}", "ze: {trimf: [-0.1, 1]}"))
    assert found.path[:5] == ("inputs", "E", "sets", "ze", "trimf")
    assert found.cell == {}
    (found,) = complaints("rulebase: 1\n\tname: x")
    assert (found.line, found.path) == (2, ())
    (found,) = complaints("")
    assert "empty" in found.message


def test_rules_that_load_but_schedule_no_gains():
    rules, (found,) = complaints_of_rules(
        TEXT.replace("gains: w-domain", "gains: direct"), "x.yaml"
    )
    assert rules is not None
    assert not found.stops
    assert found.path == ("scheduler", "gains")


def test_errors_without_a_place():
    assert complaint_of(ValueError("no")) == Complaint("no")


def test_many_mistakes_in_a_large_text_take_no_longer():
    row = "[" + ", ".join(["X-L"] * 7) + "]"
    text = TEXT.replace("[S-L, M-L, L-L, L-L, S-L, Z-M, Z-S]", row)
    assert len(complaints(text)) == 7
    padded = text + "\n#" + "x" * 100_000
    assert len(complaints(padded)) == 3


def test_a_plugin_that_raises_is_a_complaint(monkeypatch):
    def broken(rules):
        raise KeyError("oh")

    monkeypatch.setattr("fuzzytrack.studio.complaints.FuzzyScheduler", broken)
    rules, (found,) = complaints_of_rules(TEXT, "x.yaml")
    assert rules is not None
    assert "KeyError" in found.message
    assert not found.stops
