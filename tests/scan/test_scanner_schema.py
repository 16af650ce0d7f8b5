"""The JSON Schema of configurations."""

from __future__ import annotations

import json

import pytest
import yaml
from jsonschema import Draft202012Validator
from small_parts import BASE, MEANINGS, ROLES, Kind, SmallSensor, read
from test_scanner_reader import MISTAKES

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.scanners.schema import dumps_scanner_schema, scanner_schema
from fuzzytrack.scan.scanners.writer import dumps_configuration

# A function is no part, and has no numbers that a schema could tell.
CLASSES = {**ROLES, "kind": Registry("kind", "fuzzytrack.test.kinds", Kind)}
for plugin in ROLES["kind"]:
    if isinstance(plugin.factory, type):
        CLASSES["kind"].register(plugin.name)(plugin.factory)
CLASSES["gate"] = Registry("gate", "fuzzytrack.test.gates")
for plugin in ROLES["gate"]:
    if plugin.name != "broken":
        CLASSES["gate"].register(plugin.name)(plugin.factory)

SCHEMA = scanner_schema(SmallSensor, CLASSES, MEANINGS, plugins=True)


def valid(text):
    return Draft202012Validator(SCHEMA).is_valid(yaml.safe_load(text))


def test_it_is_a_schema():
    Draft202012Validator.check_schema(SCHEMA)
    assert json.loads(dumps_scanner_schema(SmallSensor, CLASSES, MEANINGS, plugins=True)) == SCHEMA


def test_it_tells_meaning_unit_limits_and_default():
    assert SCHEMA["properties"]["sensor"]["properties"]["detection"] == {
        "description": "probability of a plot; a number >= 0 and <= 1",
        "type": "number",
        "default": 0.9,
        "minimum": 0,
        "maximum": 1,
    }
    ring, round_ = SCHEMA["properties"]["gate"]["anyOf"][1:3]
    assert ring["properties"]["part"]["const"] == "ring"
    assert round_["properties"]["radius"]["description"] == "radius of the circle (m); a number > 0"
    assert round_["properties"]["shape"]["enum"] == ["circle", "square"]


@pytest.mark.parametrize(
    "text",
    [
        BASE,
        BASE + "kind: {part: bank, hits: 5, tracker: imm}\n",
        "name: a\nsensor: {noise: 1}\ngate: ring\n",
        "name: a\nbased_on: base\ngate: {radius: 5}\n",
        "name: a\nbased_on: base\n",
    ],
)
def test_what_is_read_is_valid(text):
    assert valid(text)
    assert valid(dumps_configuration(read(text), ROLES))


# What a schema cannot know: how numbers fit one another, what other files hold, texts that are no
# YAML, and what is registered elsewhere.
BEYOND = {"numbers that do not fit", "a default that does not fit", "an unknown base", "no YAML"}
# PyYAML, unlike the reader, takes the last of two equal keys, and has infinities and NaN.
BEYOND |= {"a key twice", "nothing", "no number", "an infinite number"}


@pytest.mark.parametrize("mistake", sorted(MISTAKES.keys() - BEYOND))
def test_what_is_refused_is_not_valid(mistake):
    assert not valid(MISTAKES[mistake][0])
