"""Edits by name."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase, rulebase_path
from fuzzytrack.studio.commands import _IS, _SAID, COMMANDS, OF_ANY_TEXT, edited, parameters_of

TEXT = rulebase_path("stiffness-damping").read_text(encoding="utf-8")
LIST = rulebase_path("omega-schedule").read_text(encoding="utf-8")


def rule(text, **where):
    key = set(where.items())
    (found,) = (r for r in loads_rulebase(text).rules if set(r.conditions) == key)
    return ", ".join(map(str, found.consequents))


@pytest.mark.parametrize("command", COMMANDS)
def test_types_of_parameters_are_known(command):
    for kind, _ in parameters_of(command).values():
        assert kind in _IS
        assert kind in _SAID


def test_cells():
    text = edited(TEXT, "cell", {"where": {"E": "nl", "dE": "ns"}, "says": "L-Z@0.5"})
    assert rule(text, E="nl", dE="ns") == "stiffness is L @ 0.5, damping is Z @ 0.5"
    assert rule(text, E="pl", dE="ps") == "stiffness is Z, damping is S"
    both = edited(
        TEXT, "cell", {"where": {"E": "nl", "dE": "ns"}, "says": "L-Z@0.5", "symmetric": True}
    )
    assert rule(both, E="pl", dE="ps") == rule(both, E="nl", dE="ns")
    then = [{"output": "stiffness", "set": "L", "confidence": 0.5}]
    then += [
        {"output": "stiffness", "set": "M", "confidence": 0.5},
        {"output": "damping", "set": "Z"},
    ]
    text = edited(TEXT, "conclude", {"where": {"E": "ze", "dE": "ze"}, "then": then})
    assert "[L-Z@0.5, M-Z@0.5]" in text
    text = edited(text, "confidence",
        {"where": {"E": "ze", "dE": "ze"}, "confidence": 0.25, "output": "damping"})  # fmt: skip
    assert rule(text, E="ze", dE="ze").endswith("damping is Z @ 0.25")


def test_symmetric_sets():
    arguments = {"variable": "E", "set": "ps", "parameters": [0, 0.2, 0.3], "symmetric": True}
    text = edited(TEXT, "shape", arguments)
    assert text.also == (("E", "ns"), ("dE", "ns"), ("dE", "ps"))
    found = {s.name: s.parameters for s in loads_rulebase(text).input("dE").sets}
    assert found["ps"] == (0, 0.2, 0.3)
    assert found["ns"] == (-0.3, -0.2, 0)
    arguments = {"variable": "E", "set": "ze", "parameters": [-0.1, 0, 0.2], "symmetric": True}
    assert "ze: {trimf: [-0.2, 0, 0.2]}" in edited(TEXT, "shape", {**arguments, "apart": True})


def test_neighbors_that_share_a_corner_move_together():
    moved = [
        {"set": "ze", "parameters": [-0.1, 0, 0.35]},
        {"set": "ps", "parameters": [0, 0.35, 0.5]},
        {"set": "pm", "parameters": [0.35, 0.5, 0.6]},
    ]
    text = edited(TEXT, "shapes", {"variable": "E", "shapes": moved})
    assert text.also == (("dE", "ze"), ("dE", "ps"), ("dE", "pm"))
    # One by one they would not be in the order of their peaks.
    with pytest.raises(RuleBaseError, match="ascending peak"):
        edited(TEXT, "shape", {"variable": "E", "set": "ps", "parameters": [0, 0.35, 0.5]})
    both = edited(TEXT, "shapes", {"variable": "E", "shapes": moved, "symmetric": True})
    found = {s.name: s.parameters for s in loads_rulebase(both).input("E").sets}
    assert found["nm"] == (-0.6, -0.5, -0.35)
    assert found["ze"] == (-0.35, 0, 0.35)
    with pytest.raises(ValueError, match="'ze' is named twice"):
        edited(TEXT, "shapes", {"variable": "E", "shapes": [moved[0], moved[0]]})
    with pytest.raises(ValueError, match="shapes: must be sets, such as"):
        edited(TEXT, "shapes", {"variable": "E", "shapes": [{"set": "ze"}]})


def test_sets_operators_and_lists():
    new = {"variable": "E", "set": "px", "shape": "trimf", "parameters": [0.1, 0.2, 0.3]}
    text = edited(TEXT, "add-set", new)
    arguments = {"variable": "E", "set": "px", "with_rules": True}
    assert edited(text, "remove-set", arguments) == TEXT
    text = edited(TEXT, "rename-set", {"variable": "damping", "set": "Z", "name": "none"})
    assert "S-none" in text
    assert "&seven" not in edited(TEXT, "write-out", {"variable": "dE"})
    assert "and: min" in edited(TEXT, "operator", {"operator": "and", "word": "min"})
    with pytest.raises(RuleBaseError, match="no rule about stiffness can fire"):
        edited(LIST, "remove-rule", {"where": {"lag": "pl"}})
    longer = LIST.replace(
        "    universe: [0.29, 0.778, 41]\n", "    universe: [0.29, 0.778, 41]\n    default: 0.3\n"
    )
    removed = edited(longer, "remove-rule", {"where": {"lag": "pl"}})
    then = [{"output": "stiffness", "set": "L"}]
    assert edited(removed, "add-rule", {"where": {"lag": "pl"}, "then": then}) == longer


@pytest.mark.parametrize(
    ("command", "arguments", "message"),
    [
        ("celle", {}, "command: unknown 'celle'; did you mean 'cell'? allowed: cell, conclude"),
        (None, {}, "command: unknown 'None'"),
        ("cell", {"says": "L-L"}, "where: is missing; cell needs sets by input"),
        ("cell", {"where": {}, "say": "x"}, "say: is no argument of cell; did you mean 'says'?"),
        ("cell", {"where": {"E": 1}, "says": "x"}, "where: must be sets by input"),
        ("cell", {"where": {}, "says": "x" * 5000}, "says: 5000 characters; at most 4096"),
        ("cell", {"where": {}, "says": "x", "symmetric": 1}, "symmetric: must be true or false"),
        ("shape", {"variable": "E", "set": "ze", "parameters": ["0"]}, "a list of numbers"),
        ("shape", {"variable": "E", "set": "ze", "parameters": [True]}, "a list of numbers"),
        ("shape", {"variable": "E", "set": "ze", "parameters": [10**400]}, "a list of numbers"),
        ("confidence", {"where": {"E": "ze"}, "confidence": 2}, "no rule has exactly the"),
        ("confidence", {"where": {"E": "ze", "dE": "ze"}, "confidence": 2}, "within [0, 1], got 2"),
        ("confidence", {"where": {"E": "zz"}, "confidence": 1}, "E has no set 'zz'"),
        ("conclude", {"where": {}, "then": [{"set": "S"}]}, "then: must be conclusions"),
        ("shape", {"variable": "F", "set": "ze", "parameters": [], "symmetric": True}, "'F'"),
    ],
)  # fmt: skip
def test_refused(command, arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        edited(TEXT, command, arguments)


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda below: st.lists(below, max_size=3) | st.dictionaries(st.text(max_size=3), below),
    max_leaves=5,
)


@pytest.mark.untraced
@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_message_is_carried_out_or_refused(data):
    command = data.draw(st.sampled_from([*COMMANDS, "x"]))
    names = parameters_of(command) if command in COMMANDS else {"x": ("str", True)}
    words = st.sampled_from(["E", "dE", "stiffness", "ze", "Z", "trimf", "and", "S-L"])
    near = {"str": words, "dict[str, str]": st.dictionaries(words, words, max_size=2)}
    near["list[dict[str, Any]]"] = st.just([{"set": "ze", "parameters": [0, 0, 0]}])
    near["list[float]"] = st.lists(st.floats(-1, 1), max_size=4)
    arguments = {
        name: data.draw(JSON | near.get(kind, st.booleans())) for name, (kind, _) in names.items()
    }
    try:
        text = edited(TEXT, command, arguments)
    except ValueError as error:
        assert str(error)  # noqa: PT017
    else:
        assert command in OF_ANY_TEXT or loads_rulebase(text)
