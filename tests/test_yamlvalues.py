"""Values of a YAML text changed in place."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.errors import FileError, ScenarioError
from fuzzytrack.simulation.scenario_files import scenario_path, shipped_scenarios
from fuzzytrack.yamltree import Document, Mapping, Sequence
from fuzzytrack.yamlvalues import insert_value, remove_value, set_value

TEXT = """\
# a comment
name: turn   # of a ship
target:
  points: [[0, 0.50],   [1, 2]]   # m
  speed: 6.0            # m/s
  kind:
  - a   # first
  - "b"
sensors: {sigma: 115, 'k': [1, 2]}
"""
CRLF = TEXT.replace("\n", "\r\n")


@pytest.mark.parametrize("text", [TEXT, CRLF, TEXT.rstrip("\n"), "\ufeff" + TEXT])
@pytest.mark.parametrize(
    ("path", "value", "old", "new"),
    [
        (["target", "speed"], 7.5, "6.0 ", "7.5 "),
        (["target", "points"], [[0, 0.5], [1, 3]], "[1, 2]]   #", "[1, 3]]   #"),
        (["target", "points", 1, 0], -4, "[1, 2]]   #", "[-4, 2]]   #"),
        (["target", "points"], [[1, 2]], "[[0, 0.50],   [1, 2]]", "[[1, 2]]"),
        (["target", "kind", 0], "c d", "- a   #", '- "c d"   #'),
        (["target", "kind", 1], "no", '- "b"', '- "no"'),
        (["sensors", "sigma"], 115.0, "", ""),
        (["sensors", "new"], "x", "'k': [1, 2]}", "'k': [1, 2], new: x}"),
    ],
)
def test_set(text, path, value, old, new):
    assert set_value(text, path, value) == text.replace(old, new)


@pytest.mark.parametrize("text", [TEXT, CRLF, TEXT.rstrip("\n"), "\ufeff" + TEXT])
def test_inserted_and_removed(text):
    end = "\r\n" if "\r" in text else "\n"
    for path, value, shown in (
        (["target", "points", 1], [5, 6], "0.50], [5, 6],   [1, 2]]"),
        (["target", "points", 0], [5, 6], "[[5, 6], [0, 0.50],"),
        (["target", "points", 2], [5, 6], "[1, 2], [5, 6]]   # m"),
        (["target", "kind", 0], "z", f"  - z{end}  - a   # first"),
        (["target", "kind", 2], "z", f'  - "b"{end}  - z'),
    ):
        longer = insert_value(text, path, value)
        assert shown in longer
        assert remove_value(longer, path) == text
    longer = set_value(text, ["target", "more"], [1, "x"])
    assert f'  - "b"{end}  more: [1, x]' in longer
    assert remove_value(longer, ["target", "more"]) == text


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: set_value(t, [], 1), "path: must have at least one key"),
        (lambda t: set_value(t, ["a", "b"], 1), "2:1: path: no key 'a' here; allowed: name, tar"),
        (lambda t: set_value(t, ["name", "b"], 1), "path: no 'b' in a word"),
        (lambda t: set_value(t, ["target", "kind", 2], 1), "path: no '2' in a list of 2"),
        (lambda t: set_value(t, ["target", "kind", -1], 1), "path: no '-1' in a list of 2"),
        (lambda t: set_value(t, ["target", 0], 1), "path: no key '0' here"),
        (lambda t: insert_value(t, ["target", "x"], 1), "target is no list; set the value instead"),
        (lambda t: insert_value(t, ["target", "kind", 3], 1), "has 2 items; no item 3 can be add"),
        (lambda t: remove_value(t, ["target", "x"]), "path: no key 'x' here"),
        (lambda t: remove_value("a: [1]", ["a", 0]), "the last entry cannot be removed"),
        (lambda t: set_value("a: &x [1]\nb: *x", ["b", 0], 2), "other parts share this text"),
        (lambda t: set_value("a: [", ["a"], 2), "not YAML"),
    ],
)
def test_refused(call, message):
    with pytest.raises(FileError, match=re.escape(message)):
        call(TEXT)


def test_the_error_is_that_of_the_kind_of_text():
    with pytest.raises(ScenarioError, match=r"^f\.yaml:2:1: "):
        set_value(TEXT, ["a", "b"], 1, "f.yaml", ScenarioError)


def paths(node, path=()):
    if path:
        yield path
    if isinstance(node, Mapping):
        for word, (_, value) in node.entries.items():
            yield from paths(value, (*path, word))
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from paths(item, (*path, index))


TEXTS = [scenario_path(name).read_text(encoding="utf-8") for name in shipped_scenarios()]


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_word_of_a_scenario_is_set_and_set_back(data):
    text = data.draw(st.sampled_from(TEXTS))
    if data.draw(st.booleans()):
        text = text.replace("\n", "\r\n")
    path = data.draw(st.sampled_from(list(paths(Document(text, "x").root))))
    changed = set_value(text, path, "qqq")
    # The words around stay, and so do the comments behind them.
    if isinstance(path[-1], str):
        assert changed.count("#") <= text.count("#")
    assert set_value(changed, path, "rr") == changed.replace("qqq", "rr")
