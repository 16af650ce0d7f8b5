"""Requests and answers as they go through the socket."""

import json
import struct

import numpy as np
import pytest

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.messages import Layers, MessageError, answer, error, read_request


def test_a_request_is_read():
    found = read_request('{"seq": 12, "command": "undo", "arguments": {"a": [1]}}')
    assert (found.seq, found.command, found.arguments) == (12, "undo", {"a": [1]})
    assert read_request('{"seq": 0, "command": "undo"}').arguments == {}


@pytest.mark.parametrize(
    ("text", "message", "seq"),
    [
        ("", "the message is no JSON", None),
        ("[" * 100_000, "the message is no JSON", None),
        ("1" * 10_000, "the message is no JSON", None),
        ('{"seq": NaN}', "the message is no JSON", None),
        ("[]", "no JSON object", None),
        ('{"command": "undo"}', "seq: needs a whole number from 0 to 4294967295", None),
        ('{"seq": -1, "command": "undo"}', "seq: needs", None),
        ('{"seq": 4294967296, "command": "undo"}', "seq: needs", None),
        ('{"seq": true, "command": "undo"}', "seq: needs", None),
        ('{"seq": 3, "command": 5}', "command: needs the name", 3),
        ('{"seq": 3, "command": "undo", "arguments": []}', "arguments: needs a JSON object", 3),
    ],
)
def test_what_is_no_request_is_refused(text, message, seq):
    with pytest.raises(MessageError, match=message) as caught:
        read_request(text)
    assert caught.value.seq == seq


def test_answers_have_no_nan():
    assert json.loads(answer(3, {"x": np.array([1.0, np.nan])})) == {
        "seq": 3,
        "result": {"x": [1.0, None]},
    }


def test_an_error_names_the_place_and_no_file():
    failure = RuleBaseError("unknown set 'q'", Location("/home/me/x.yaml", 7, 3))
    assert json.loads(error(4, failure)) == {
        "seq": 4,
        "error": "unknown set 'q'",
        "where": {"line": 7, "column": 3},
    }


def test_a_long_word_is_shortened():
    said = json.loads(error(1, f"unknown set {'x' * 3000!r}; allowed: a, b"))["error"]
    assert said == f"unknown set '{'x' * 59}…{'x' * 18}'; allowed: a, b"


def test_layers_are_floats_behind_six_numbers():
    values = np.arange(12.0).reshape(2, 3, 2)
    raw = Layers(values).message(9)
    assert struct.unpack("<6I", raw[:24]) == (9, 3, 2, 2, 0, 0)
    np.testing.assert_array_equal(np.frombuffer(raw[24:], "<f4"), np.arange(12))


@pytest.mark.parametrize(
    ("method", "value", "message"),
    [
        ("text", 5, "x: needs a text"),
        ("text", "a" * 200_000, "x: 200000 characters; at most 131072"),
        ("text", "\ud800", "x: has half a character"),
        ("texts", [], "x: needs a list of texts, at least one"),
        ("texts", ["a", 1], "x: needs a list of texts"),
        ("texts", ["a"] * 10_001, "x: 10001 items; at most 10000"),
        ("number", True, "x: needs numbers, got True"),
        ("number", 10**400, "x: needs finite numbers"),
        ("numbers", [1, "2"], "x: needs numbers, got '2'"),
        ("points", [[1, 2], [3]], r"x: needs a list of points \[x, y\]"),
        ("flag", 1, "x: needs true or false"),
        ("numbers_by_name", {"E": "a"}, "x: E: needs numbers"),
    ],
)
def test_an_argument_that_does_not_fit_is_named(method, value, message):
    with pytest.raises(ValueError, match=message):
        getattr(Arguments({"x": value}), method)("x")


def test_arguments_have_limits_and_defaults():
    given = Arguments({"n": 5.0, "w": "b", "none": None})
    assert given.whole("n", 1, 5) == 5
    assert given.choice("w", ("a", "b")) == "b"
    assert given.number("none", 2.5) == 2.5
    assert given.flag("none") is False
    with pytest.raises(ValueError, match="n: needs a whole number from 1 to 4, got 5"):
        given.whole("n", 1, 4)
    with pytest.raises(ValueError, match="w: unknown 'b'; one of a, c"):
        given.choice("w", ("a", "c"))
    with pytest.raises(ValueError, match="m: is missing; needs a number"):
        given.number("m")
