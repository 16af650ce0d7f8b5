"""JSON Schema of scenes, with which editors complete and check them; their settings as tables."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import MISSING, fields
from typing import Any

from fuzzytrack.simulation.scene.clutter_kinds import CLUTTER
from fuzzytrack.simulation.scene.radar import OwnShip, Radar, ScanTimes
from fuzzytrack.simulation.scene.reader import FORMAT_VERSION
from fuzzytrack.simulation.scene.region import SHAPES, Region
from fuzzytrack.simulation.scene.settings import Setting, Settings, settings_of
from fuzzytrack.simulation.scene.targets import TargetGroup

__all__ = ["dumps_scene_schema", "scene_schema", "setting_rows"]

Schema = dict[str, Any]


def scene_schema() -> Schema:
    """JSON Schema (2020-12) of the format, from the settings that the parts declare.

    It has the words, the structure and the limits of numbers; whether the parts fit each other is
    checked when a file is loaded.
    """
    kinds = [
        {
            "properties": {
                "kind": {"const": name, "description": f"Clutter {part.summary}."},
                **_properties(part),
            },
            "required": ["kind", *_required(part)],
            "additionalProperties": False,
        }
        for name, part in CLUTTER.items()
    ]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "fuzzytrack scene of many targets",
        "type": "object",
        "properties": {
            "scenario": {"description": "Version of the format.", "const": int(FORMAT_VERSION)},
            "name": {"description": "Name of the scene.", "type": ["string", "number"]},
            "source": {"description": "Paper, or other origin.", "type": ["string", "number"]},
            "scans": _mapping("When the radar scans.", ScanTimes),
            "radar": _mapping("What the radar sees.", Radar),
            "own": _mapping("Where the radar is.", OwnShip),
            "region": {
                **_region("Where targets appear and clutter lies unless they say otherwise."),
            },
            "traffic": {
                "description": "Groups of targets, by name.",
                "type": "object",
                "minProperties": 1,
                "additionalProperties": _mapping("A group of targets.", TargetGroup),
            },
            "clutter": {
                "description": "Clutter, by name.",
                "type": "object",
                "minProperties": 1,
                "additionalProperties": {"type": "object", "oneOf": kinds},
            },
        },
        "required": ["scenario", "name", "scans", "radar", "traffic"],
        "additionalProperties": False,
    }


def dumps_scene_schema() -> str:
    """The schema as text, which ends in a line break."""
    return json.dumps(scene_schema(), indent=2, ensure_ascii=False) + "\n"


def setting_rows(part: type[Settings]) -> list[tuple[str, str, str, str]]:
    """Settings of a part for a table: name, meaning, allowed values with their unit, default."""
    defaults = {each.name: each.default for each in fields(part)}
    return [
        (name, declared.meaning, _allowed(declared), _default(declared, defaults[name]))
        for name, declared in settings_of(part).items()
    ]


def _allowed(declared: Setting) -> str:
    """Form, limits and unit in words."""
    words = {
        "word": " or ".join(f"`{word}`" for word in declared.words),
        "part": "region",
        "point": "`[x, y]`",
        "points": "`[[x, y], …]`" if declared.columns == (2,) else "`[[t, x, y], …]`",
    }
    found = words.get(declared.form)
    if found is None:
        found = declared.limits_in_file().allowed
        found += {"interval": ", or two", "curve": ", or pairs"}.get(declared.form, "")
    return f"{found} ({declared.file_unit})" if declared.file_unit else found


def _default(declared: Setting, value: Any) -> str:
    if value is MISSING:
        return "required"
    if value is None or value == math.inf:
        return ""
    if declared.form == "curve":
        return f"{value[0][1]:g}"
    if declared.form in ("number", "whole"):
        return _shown(declared, value)
    if declared.form == "interval" and value[0] == value[1]:
        return _shown(declared, value[0])
    if declared.form in ("interval", "point"):
        ends = [_shown(declared, each) for each in value]
        return "" if "inf" in ends else f"[{', '.join(ends)}]"
    return str(value)


def _shown(declared: Setting, number: float) -> str:
    return f"{round(number / declared.in_file, 9):g}"


def _mapping(description: str, part: type[Settings]) -> Schema:
    found: Schema = {
        "description": description,
        "type": "object",
        "properties": _properties(part),
        "additionalProperties": False,
    }
    required = _required(part)
    return {**found, "required": required} if required else found


def _region(description: str) -> Schema:
    return {
        **_mapping(description, Region),
        "oneOf": [{"required": [shape]} for shape in SHAPES],
    }


def _required(part: type[Settings]) -> list[str]:
    return [each.name for each in fields(part) if each.default is MISSING]


def _properties(part: type[Settings]) -> Schema:
    return {name: _property(declared) for name, declared in settings_of(part).items()}


def _property(declared: Setting) -> Schema:
    unit = f" ({declared.file_unit})" if declared.file_unit else ""
    description = f"{declared.meaning[:1].upper()}{declared.meaning[1:]}{unit}."
    if declared.form == "part":
        return _region(description)
    if declared.form == "word":
        # Editors read yes and no as truth values.
        allowed: list[str | bool] = list(declared.words)
        allowed += [word == "yes" for word in declared.words if word in ("yes", "no")]
        return {"description": description, "enum": allowed}
    number = _number(declared)
    forms: dict[str, Schema] = {
        "number": number,
        "whole": number,
        "interval": {"anyOf": [number, _list(number, (2,))]},
        "point": _list(number, declared.columns),
        "points": {"type": "array", "minItems": 1, "items": _list(number, declared.columns)},
        "curve": {
            "anyOf": [
                number,
                {
                    "type": "array",
                    "minItems": 1,
                    "items": {
                        "type": "array",
                        "prefixItems": [{"type": "number"}, number],
                        "minItems": 2,
                        "maxItems": 2,
                    },
                },
            ]
        },
    }
    return {"description": description, **forms[declared.form]}


def _list(items: Schema, lengths: Iterable[int]) -> Schema:
    least, most = min(lengths), max(lengths)
    return {"type": "array", "items": items, "minItems": least, "maxItems": most}


def _number(declared: Setting) -> Schema:
    limits = declared.limits_in_file()
    found: Schema = {"type": "integer" if limits.whole else "number"}
    if limits.least > -math.inf:
        found["exclusiveMinimum" if limits.above else "minimum"] = limits.least
    if limits.most < math.inf:
        found["exclusiveMaximum" if limits.below else "maximum"] = limits.most
    return found
