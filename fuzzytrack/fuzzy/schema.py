"""JSON Schema of rule-base files, with which editors complete and check them."""

from __future__ import annotations

import json
from typing import Any

from fuzzytrack.fuzzy.hedges import HEDGES
from fuzzytrack.fuzzy.operators import CONJUNCTIONS, DEFUZZIFICATIONS, DISJUNCTIONS
from fuzzytrack.fuzzy.reader import (
    FORMAT_VERSION,
    MAX_NAME,
    SET_NAME,
    VARIABLE_NAME,
)
from fuzzytrack.fuzzy.rulebase import (
    MAX_ALTERNATIVES,
    MAX_INPUTS,
    MAX_OUTPUTS,
    MAX_RULES,
)
from fuzzytrack.fuzzy.shapes import MAX_PARAMETERS, SHAPES
from fuzzytrack.fuzzy.variable import GRIDS, MAX_POINTS

__all__ = ["dumps_schema", "rulebase_schema"]

Schema = dict[str, Any]

_ANY_SETTINGS: Schema = {
    "description": "Settings for a gain scheduler that uses the rule base.",
    "type": "object",
    "minProperties": 1,
    "additionalProperties": {"type": ["string", "number"]},
}


def rulebase_schema(scheduler: Schema | None = None) -> Schema:
    """JSON Schema (2020-12) of the rule-base format.

    Parameters
    ----------
    scheduler : dict, optional
        Schema of the part ``scheduler``, which the fuzzy engine does not read; any words and
        numbers unless given. See `fuzzytrack.schedulers.settings.scheduler_schema`.

    Returns
    -------
    dict
        The schema. It contains the words and the structure of the format; whether the parts fit
        each other is checked when a file is loaded.
    """
    properties = {
        "rulebase": {"description": "Version of the format.", "const": int(FORMAT_VERSION)},
        "name": _text("Short name."),
        "description": _text("What the rule base is for."),
        "source": _text("Where it comes from."),
        "inputs": _variables("Inputs, by name.", MAX_INPUTS, _variable()),
        "outputs": _variables("Outputs, by name.", MAX_OUTPUTS, _variable(output=True)),
        "operators": _operators(),
        "rules": {
            "description": "A table over two inputs, or a list of if/then rules.",
            "oneOf": [_table(), _list()],
        },
        "scheduler": _ANY_SETTINGS if scheduler is None else scheduler,
    }
    optional = {"description", "source", "scheduler"}
    top = _closed(
        "A fuzzy rule base of fuzzytrack.",
        properties,
        tuple(k for k in properties if k not in optional),
    )
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "fuzzytrack rule base",
    }
    return {**head, **top, "$defs": _definitions()}


def dumps_schema(scheduler: Schema | None = None) -> str:
    """Text of `rulebase_schema`; with the settings of gain schedulers ``rulebase.schema.json``."""
    return json.dumps(rulebase_schema(scheduler), indent=2, ensure_ascii=False) + "\n"


def _closed(description: str, properties: Schema, required: tuple[str, ...]) -> Schema:
    return {
        "description": description,
        "type": "object",
        "properties": properties,
        "required": list(required),
        "additionalProperties": False,
        "minProperties": 1,
    }


def _text(description: str) -> Schema:
    return {"description": description, "type": "string", "minLength": 1}


def _number(description: str) -> Schema:
    return {"description": description, "type": "number"}


def _reference(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}


def _variables(description: str, limit: int, variable: Schema) -> Schema:
    return {
        "description": description,
        "type": "object",
        "minProperties": 1,
        "maxProperties": limit,
        "propertyNames": {"pattern": f"^{VARIABLE_NAME}$", "maxLength": MAX_NAME},
        "additionalProperties": variable,
    }


def _variable(output: bool = False) -> Schema:
    properties = {
        "label": _text("For axes and tables."),
        "unit": _text('Unit, for axes and tables; "1" for a pure number.'),
        "universe": _reference("universe"),
        "sets": {
            "description": "Fuzzy sets, by name, in ascending order of their peaks.",
            "type": "object",
            "minProperties": 1,
            "propertyNames": {"pattern": f"^{SET_NAME}$", "maxLength": MAX_NAME},
            "additionalProperties": _reference("set"),
        },
    }
    if output:
        properties["operators"] = _operators()
        properties["default"] = _number(
            "Value where no rule fires, within the universe; NaN and a warning without it."
        )
    return _closed("A linguistic variable.", properties, ("universe", "sets"))


def _operators() -> Schema:
    words = {
        "and": ("Conjunction, also of a rule with its consequents.", CONJUNCTIONS),
        "or": ("Disjunction of the rules; sum is the plain sum.", DISJUNCTIONS),
        "defuzzification": ("From the fuzzy output to one value.", DEFUZZIFICATIONS),
        "implication": ("From a rule to the set it concludes; the word of and.", CONJUNCTIONS),
        "weighting": ("Confidence and the strength of a rule; the word of and.", CONJUNCTIONS),
        "alternatives": ("OR inside of one rule; max unless given.", DISJUNCTIONS),
    }
    properties = {
        key: {"description": description, "enum": list(allowed)}
        for key, (description, allowed) in words.items()
    }
    return _closed("The algebra of the rules.", properties, tuple(words)[:3])


def _definitions() -> Schema:
    return {
        "universe": _universe(),
        "set": {
            **_closed("A membership shape.", {name: _shape(name) for name in SHAPES}, ()),
            "patternProperties": {
                f"^({'|'.join(HEDGES)}) ": {
                    "description": "A shape after up to three hedges.",
                    "type": "array",
                    "items": {"type": "number"},
                }
            },
            "maxProperties": 1,
        },
        "word": {
            "description": "One set for each output, joined by '-', e.g. S-L; with a confidence "
            "from 0 to 1, S-L@0.5.",
            # Names such as 1 are numbers to an editor.
            "type": ["string", "number"],
            "pattern": f"^{SET_NAME}(@[-+.0-9eE]+)?$",
        },
        "consequents": {
            "description": "What a rule concludes.",
            "oneOf": [
                _reference("word"),
                _words("Several conclusions, which share the rule by their confidences."),
                {
                    "description": "For each output a set, or several.",
                    "type": "object",
                    "minProperties": 1,
                    "propertyNames": {"pattern": f"^{VARIABLE_NAME}$"},
                    "additionalProperties": {
                        "oneOf": [_reference("word"), _words("Several sets of one output.")]
                    },
                },
            ],
        },
        "conditions": {
            "description": "For each input that matters, its set.",
            "type": "object",
            "minProperties": 1,
            "propertyNames": {"pattern": f"^{VARIABLE_NAME}$"},
            "additionalProperties": {"type": ["string", "number"], "pattern": f"^{SET_NAME}$"},
        },
    }


def _words(description: str) -> Schema:
    return {
        "description": description,
        "type": "array",
        "minItems": 1,
        "items": _reference("word"),
    }


def _universe() -> Schema:
    low, high = _number("Lower end."), _number("Upper end.")
    points = {
        "description": "Number of grid points.",
        "type": "integer",
        "minimum": 2,
        "maximum": MAX_POINTS,
    }
    grid = {
        "description": "Whether both ends are grid points, or the midpoints of equal cells are.",
        "enum": list(GRIDS),
    }
    brief = {
        "description": "low, high, points",
        "type": "array",
        "prefixItems": [low, high, points],
        "items": False,
        "minItems": 3,
    }
    full = _closed(
        "The same, with a choice of grid.",
        {"low": low, "high": high, "points": points, "grid": grid},
        ("low", "high", "points"),
    )
    return {"description": "The discrete universe of discourse.", "oneOf": [brief, full]}


def _shape(name: str) -> Schema:
    shape = SHAPES[name]
    count = len(shape.parameters)
    more: Schema = {"items": False}
    if shape.repeats:
        more = {"items": {"type": "number"}, "maxItems": MAX_PARAMETERS}
    return {
        "description": f"{name}: {', '.join(shape.parameters)}; {shape.requirement}",
        "type": "array",
        "prefixItems": [_number(parameter) for parameter in shape.parameters],
        **more,
        "minItems": count,
    }


def _table() -> Schema:
    row = {"type": "array", "minItems": 1, "items": _reference("consequents")}
    names = {"type": "string", "minLength": 1}
    properties = {
        "columns": _text("The input whose sets, in order, are the columns."),
        "rows": _text("The input whose sets name the rows."),
        "cells": {
            "description": "The outputs, in the order in which a cell names their sets.",
            "oneOf": [names, {"type": "array", "minItems": 1, "uniqueItems": True, "items": names}],
        },
        "table": {
            "description": "For each row its cells, one for each column.",
            "type": "object",
            "minProperties": 1,
            "additionalProperties": row,
        },
    }
    return _closed("Rules as a table.", properties, tuple(properties))


def _list() -> Schema:
    consequents = _reference("consequents")
    every = _closed(
        "If every condition holds.",
        {
            "if": _reference("conditions"),
            "or": {
                "description": "Further conditions: the rule fires if those of any of them hold.",
                "type": "array",
                "minItems": 1,
                "maxItems": MAX_ALTERNATIVES - 1,
                "items": _reference("conditions"),
            },
            "then": consequents,
        },
        ("if", "then"),
    )
    either = _closed(
        "One rule for each condition.",
        {"if any": _reference("conditions"), "then": consequents},
        ("if any", "then"),
    )
    return {
        "description": "Rules as a list.",
        "type": "array",
        "minItems": 1,
        "maxItems": MAX_RULES,
        "items": {"oneOf": [every, either]},
    }
