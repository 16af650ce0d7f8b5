"""JSON Schema of configurations of scan trackers: editors complete and check files by it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from fuzzytrack.scan.part import Parameter, Part, Word, declared
from fuzzytrack.scan.scanners.reader import FORMAT_VERSION, NONE, PART, SENSOR, Roles

__all__ = ["dumps_scanner_schema", "scanner_schema"]

Schema = dict[str, Any]


def scanner_schema(
    sensor: type[Part], roles: Roles, meanings: Mapping[str, str], plugins: bool = False
) -> Schema:
    """JSON Schema (2020-12) of the format, from the numbers that the parts declare.

    Parameters
    ----------
    sensor : type of Part
    roles : mapping of str to Registry
        The registry of the parts of each role.
    meanings : mapping of str to str
        What each role does, and the sensor.
    plugins : bool
        Whether parts of installed packages and of scripts are in it.
    """
    properties: Schema = {
        "scanner": {"description": "Version of the format.", "const": int(FORMAT_VERSION)},
        "name": _text("Short name."),
        "description": _text("What it is for."),
        "based_on": _text("Name or file of the configuration of which it changes something."),
        SENSOR: _mapping(meanings[SENSOR], _properties(sensor)),
    }
    for role, registry in roles.items():
        names = registry.names() if plugins else sorted(registry.built_in())
        kinds = {name: registry.get(name) for name in names}
        properties[role] = _role(meanings[role], kinds)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "fuzzytrack configuration of a scan tracker",
        "type": "object",
        "properties": properties,
        "required": ["name"],
        "additionalProperties": False,
        # A file that changes another one names what it changes; any other names the sensor, and
        # a part for every role that has none of the name "none".
        "if": {"required": ["based_on"]},
        "else": {
            "required": [SENSOR, *(role for role in roles if NONE not in roles[role].names())],
            "properties": {
                role: {"if": {"type": "object"}, "then": {"required": [PART]}} for role in roles
            },
        },
    }


def dumps_scanner_schema(
    sensor: type[Part], roles: Roles, meanings: Mapping[str, str], plugins: bool = False
) -> str:
    """Text of `scanner_schema`; without plug-ins that of ``scanner.schema.json``."""
    schema = scanner_schema(sensor, roles, meanings, plugins)
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def _role(meaning: str, kinds: Mapping[str, type[Part]]) -> Schema:
    """A part by its name, or a mapping with its numbers; without `part` that of another file."""
    mappings = [
        _mapping(
            _first_line(kind),
            {PART: {"description": "The part.", "const": name}, **_properties(kind)},
            (PART,),
        )
        for name, kind in kinds.items()
    ]
    every: Schema = {}
    for kind in kinds.values():
        every |= {key: {"type": ["number", "string"]} for key in declared(kind)}
    by_name = {"description": "The part, with its own numbers.", "enum": list(kinds)}
    changed = _mapping("Numbers of the part of the configuration it is based on.", every)
    without = [changed] if every else []
    return {"description": meaning, "anyOf": [by_name, *mappings, *without]}


def _mapping(description: str, properties: Schema, required: tuple[str, ...] = ()) -> Schema:
    return {
        "description": description,
        "type": "object",
        "properties": properties,
        "required": list(required),
        "additionalProperties": False,
        "minProperties": 1,
    }


def _properties(kind: type[Part]) -> Schema:
    default = kind()
    return {key: _value(meant, getattr(default, key)) for key, meant in declared(kind).items()}


def _value(meant: Parameter | Word, default: object) -> Schema:
    if isinstance(meant, Word):
        kind: Schema = {"enum": list(meant.choices)} if meant.choices else {"type": "string"}
        return {"description": meant.meaning, **kind, "default": default}
    unit = f" ({meant.unit})" if meant.unit else ""
    found: Schema = {
        "description": f"{meant.meaning}{unit}; {meant.allowed}",
        "type": "integer" if meant.whole else "number",
        "default": default,
    }
    if meant.least > -math.inf:
        found["exclusiveMinimum" if meant.above else "minimum"] = meant.least
    if meant.most < math.inf:
        found["exclusiveMaximum" if meant.below else "maximum"] = meant.most
    return found


def _text(description: str) -> Schema:
    return {"description": description, "type": "string", "minLength": 1}


def _first_line(kind: type) -> str:
    return (kind.__doc__ or "").strip().partition("\n")[0].replace("`", "")
