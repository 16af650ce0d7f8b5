"""The JSON Schema that editors use."""

from __future__ import annotations

import json

import pytest
import yaml
from jsonschema import Draft202012Validator
from test_loading import LIST, TABLE

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase, rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.operators import DEFUZZIFICATIONS
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.fuzzy.schema import dumps_schema, rulebase_schema
from fuzzytrack.fuzzy.shapes import SHAPES
from fuzzytrack.schedulers.settings import scheduler_schema

SCHEMA = rulebase_schema(scheduler_schema())
VALIDATOR = Draft202012Validator(SCHEMA)


def valid(text):
    return VALIDATOR.is_valid(yaml.safe_load(text))


def test_the_shipped_file_is_the_generated_one():
    shipped = rulebase_path("tipper").with_name("rulebase.schema.json")
    assert shipped.read_text(encoding="utf-8") == dumps_schema(scheduler_schema()), (
        "write it anew: fuzzytrack rulebase schema -o rulebases/rulebase.schema.json"
    )
    assert json.loads(dumps_schema()) == rulebase_schema()


@pytest.mark.parametrize("schema", [SCHEMA, rulebase_schema()])
def test_it_is_a_schema(schema):
    Draft202012Validator.check_schema(schema)


def test_the_engine_itself_takes_any_settings():
    valid = Draft202012Validator(rulebase_schema()).is_valid
    text = TABLE.replace("{gains: direct}", "{model: x, limit: 2}")
    loads_rulebase(text)
    assert valid(yaml.safe_load(text))
    assert not valid(yaml.safe_load(TABLE.replace("{gains: direct}", "{gains: [direct]}")))


def test_it_knows_the_vocabulary():
    schema = rulebase_schema()
    assert set(schema["$defs"]["set"]["properties"]) == set(SHAPES)
    operators = schema["properties"]["operators"]["properties"]
    assert operators["defuzzification"]["enum"] == list(DEFUZZIFICATIONS)
    assert "a, b, c, d" in schema["$defs"]["set"]["properties"]["trapmf"]["description"]


@pytest.mark.parametrize("name", shipped_rulebases())
def test_shipped_rule_bases_are_valid(name):
    text = rulebase_path(name).read_text(encoding="utf-8")
    VALIDATOR.validate(yaml.safe_load(text))
    VALIDATOR.validate(yaml.safe_load(dumps_rulebase(loads_rulebase(text))))


@pytest.mark.parametrize("text", [TABLE, LIST, LIST.replace("hi", "1")])
def test_every_form_is_valid(text):
    loads_rulebase(text)
    VALIDATOR.validate(yaml.safe_load(text))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("rulebase: 1", "rulebase: 2"),
        ("name: small\n", ""),
        ("name: small", "nam: small"),
        ("label: error", "lable: error"),
        ("  E:\n", "  E-1:\n"),
        ("[0, 1, 11]", "[0, 1]"),
        ("[0, 1, 11]", "[0, 1, 1]"),
        ("[0, 1, 11]", "[0, 1, 11, 12]"),
        ("[0, 1, 11]", "{low: 0, high: 1}"),
        ("midpoints", "middle"),
        ("{trimf: [-0.5, 0, 0.5]}", "{trinf: [-0.5, 0, 0.5]}"),
        ("{trimf: [-0.5, 0, 0.5]}", "{trimf: [-0.5, 0]}"),
        ("{trimf: [-0.5, 0, 0.5]}", "{trimf: [-0.5, 0, 0.5, 1]}"),
        ("{trimf: [-0.5, 0, 0.5]}", "{trimf: [-0.5, x, 0.5]}"),
        ("{trimf: [-0.5, 0, 0.5]}", "{}"),
        ("ze: {trimf", "z@e: {trimf"),
        ("and: product", "and: prod"),
        ("or: sum, ", ""),
        ("  columns: E\n", ""),
        ("[S-S, S-L]", "S-S"),
        ("[S-S, S-L]", "[S-S, S L]"),
        ("[S-S, S-L]", "[S-S, S-L@half]"),
        ("[S-S, S-L]", "[S-S, {}]"),
        ("gains: direct", "gains: [direct]"),
    ],
)
def test_typical_mistakes_are_not(old, new):
    text = TABLE.replace(old, new, 1)
    assert text != TABLE
    assert not valid(text)
    with pytest.raises(RuleBaseError):
        loads_rulebase(text)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("then: {u: S}", "than: {u: S}"),
        (", then: {u: S}", ""),
        ("if any: {E: hi, d: hi}", "if any: {E: hi}, if: {d: hi}"),
        ("if: {E: lo}", "if: {}"),
        ("if: {E: lo}", "if: {E: [lo, hi]}"),
        ("default: 1.5", "default: high"),
    ],
)
def test_typical_mistakes_in_lists_are_not(old, new):
    text = LIST.replace(old, new, 1)
    assert text != LIST
    assert not valid(text)
    with pytest.raises(RuleBaseError):
        loads_rulebase(text)
