"""Configurations read from YAML; the place of every mistake."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_parts import BASE, Bank, NoKind, Ring, Round, SmallSensor, read

from fuzzytrack.errors import ScannerError
from fuzzytrack.scan.scanners.reader import Configuration


def test_it_reads_all_parts():
    text = BASE + "description: For a test.\nkind: {part: bank, hits: 5}\n"
    assert read(text) == Configuration(
        "base",
        "For a test.",
        (
            ("sensor", SmallSensor(2.0, 0.8)),
            ("gate", Round(radius=30.0)),
            ("kind", Bank(hits=5)),
        ),
    )


def test_a_part_may_be_given_by_its_name_alone():
    assert read("name: a\nsensor: {noise: 1}\ngate: ring\n").part("gate") == Ring()


def test_a_role_with_a_part_none_may_be_left_out():
    assert read(BASE).part("kind") == NoKind()


def test_words_of_parts():
    found = read(BASE.replace("radius: 30", "shape: square"))
    assert found.part("gate") == Round(shape="square")
    found = read(BASE + "kind: {part: bank, tracker: imm}\n")
    assert found.part("kind") == Bank(tracker="imm")


def test_a_whole_number_is_an_int():
    found = read(BASE + "kind: {part: bank, hits: 7.0}\n").part("kind").hits
    assert found == 7
    assert isinstance(found, int)


def test_it_changes_some_numbers_of_another_configuration():
    found = read("name: mine\nbased_on: base\ngate: {radius: 20}\n")
    assert found.based_on == "base"
    assert found.part("gate") == Round(radius=20.0)
    assert found.part("sensor") == SmallSensor(2.0, 0.8)


@pytest.mark.parametrize("gate", ["{part: round, shape: square}", "{shape: square}"])
def test_what_it_does_not_change_stays(gate):
    found = read(f"name: mine\nbased_on: base\ngate: {gate}\n")
    assert found.part("gate") == Round(30.0, "square")


def test_another_part_has_its_own_numbers():
    found = read("name: mine\nbased_on: base\ngate: {part: ring, inner: 1.5}\n")
    assert found.part("gate") == Ring(inner=1.5)


# Each text with the place of its mistake and a part of the message.
MISTAKES = {
    "no name": ("sensor: {noise: 1}\n", "1:1", "lacks the key 'name'"),
    "misspelt role": (BASE + "knid: none\n", "5:1", "'knid'; did you mean 'kind'?"),
    "misspelt number": (
        BASE.replace("radius", "radios"),
        "4:21",
        "unknown key in gate: 'radios'; did you mean 'radius'?",
    ),
    "misspelt number of the sensor": (
        BASE.replace("detection", "detektion"),
        "3:20",
        "did you mean 'detection'?",
    ),
    "a part that is not registered": (
        BASE.replace("round", "rund"),
        "4:14",
        "unknown gate 'rund'; did you mean 'round'?",
    ),
    "a part by its name alone": (BASE + "kind: bnak\n", "5:7", "did you mean 'bank'?"),
    "a probability above 1": (
        BASE.replace(".8", "1.5"),
        "3:31",
        "sensor: detection must be a number >= 0 and <= 1, not '1.5'",
    ),
    "a probability below 0": (BASE.replace(".8", "-.1"), "3:31", ">= 0 and <= 1, not '-.1'"),
    "a limit that is excluded": (BASE.replace("30", "0"), "4:29", "must be a number > 0 (m)"),
    "a word for a number": (BASE.replace("30", "far"), "4:29", "not 'far'"),
    "no number": (BASE.replace("30", ".nan"), "4:29", "not '.nan'"),
    "an infinite number": (BASE.replace("30", "1e999"), "4:29", "not '1e999'"),
    "no whole number": (BASE + "kind: {part: bank, hits: 2.5}\n", "5:26", "a whole number >= 1"),
    "a wrong word": (
        BASE.replace("radius: 30", "shape: sqare"),
        "4:28",
        "gate: shape: unknown word 'sqare'; did you mean 'square'?",
    ),
    "numbers that do not fit": (
        BASE.replace("round, radius: 30", "ring, outer: 5, inner: 9"),
        "4:37",
        "gate: inner must be less than outer, got 9",
    ),
    "a default that does not fit": (
        BASE.replace("round, radius: 30", "ring, outer: .5"),
        "4:7",
        "gate: inner must be less than outer",
    ),
    "a part with a mistake": (
        BASE.replace("{part: round, radius: 30}", "broken"),
        "1:1",
        "gate: ZeroDivisionError",
    ),
    "a role that is missing": ("name: a\nsensor: {noise: 1}\n", "1:1", "lacks the key 'gate'"),
    "no sensor": ("name: a\ngate: ring\n", "1:1", "lacks the key 'sensor'"),
    "no part": (BASE.replace("part: round, ", ""), "4:7", "gate lacks the key 'part'"),
    "a list for a part": (BASE.replace("{part: round, radius: 30}", "[round]"), "4:7", "a list"),
    "a key twice": (BASE + "gate: ring\n", "5:1", "'gate' is given twice"),
    "another version": (BASE.replace("scanner: 1", "scanner: 2"), "1:10", "version 2"),
    "an unknown base": ("name: a\nbased_on: bas\n", "2:11", "unknown configuration 'bas'"),
    "no class": (BASE + "kind: function\n", "5:7", "kind 'function' must be a class"),
    "no YAML": (BASE + "kind: {\n", "6:1", "not YAML"),
    "nothing": ("", "1:1", "empty"),
}


@pytest.mark.parametrize(("text", "place", "message"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_line_with_its_place(text, place, message):
    with pytest.raises(ScannerError) as caught:
        read(text)
    assert str(caught.value).startswith(f"mine.yaml:{place}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.untraced
@given(st.data())
def test_a_damaged_text_is_read_or_refused(data):
    text = BASE + "kind: {part: bank, hits: 5, tracker: imm}\n"
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(text)))
        length = data.draw(st.integers(0, 5))
        text = text[:place] + data.draw(st.text(max_size=4)) + text[place + length :]
    found = error = None
    try:
        found = read(text)
    except ScannerError as caught:
        error = caught
    if error is None:
        assert 0 <= found.part("sensor").detection <= 1
    else:
        assert error.location is not None
        assert "\n" not in str(error)
