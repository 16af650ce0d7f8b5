"""The rule base of a session as the page shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fuzzytrack.errors import FileError
from fuzzytrack.fuzzy.rule_edits import OPERATORS
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.saving import cell_text, consequents_text
from fuzzytrack.fuzzy.shapes import SHAPES
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.schedulers.gain_outputs import find_gain_outputs
from fuzzytrack.studio.symmetry import DRAWN
from fuzzytrack.yamltree import Document
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = ["cell_place", "rulebase_state", "shared_sets"]

_MOST_CELLS = 10_000
_CELLS: dict[object, str] = {}


def rulebase_state(rules: RuleBase, shared: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """A rule base in the types of JSON.

    Parameters
    ----------
    rules : RuleBase
    shared : mapping of str to sequence of str
        Other variables that share the sets of a variable, by its name, see `shared_sets`.
    """
    settings = dict(rules.scheduler)
    gains = find_gain_outputs(rules.output_names)
    return {
        "name": rules.name,
        "description": rules.description,
        "source": rules.source,
        "inputs": [_variable(v, shared) for v in rules.inputs],
        "outputs": [_variable(v, shared) for v in rules.outputs],
        "operators": {
            word: {"value": getattr(rules.operators, attribute), "choices": allowed}
            for word, (attribute, allowed) in OPERATORS.items()
        },
        "rules": _list(rules) if rules.layout is None else _table(rules, rules.layout),
        "shapes": {name: list(SHAPES[name].parameters) for name in DRAWN},
        "gains": gains is not None,
        "surfaces": [
            *rules.output_names,
            *(g for g in (gains.gain_names if gains else ()) if g not in rules.output_names),
        ],
        "schedules": bool(settings),
        "normalization": settings.get("normalization"),
        "conversion": settings.get("gains"),
    }


def _variable(variable: Variable, shared: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    universe = variable.universe
    return {
        "name": variable.name,
        "label": variable.axis_label,
        "universe": [universe.low, universe.high, universe.points],
        "default": variable.default,
        "shared_with": shared.get(variable.name, ()),
        "sets": [
            {"name": s.name, "shape": s.shape, "parameters": s.parameters} for s in variable.sets
        ],
    }


def _table(rules: RuleBase, layout: TableLayout) -> dict[str, Any]:
    columns, rows = rules.input(layout.columns), rules.input(layout.rows)
    width = len(columns.sets)
    cells = [{"text": _cell(rule, rules, layout), **_consequents(rule)} for rule in rules.rules]
    return {
        "form": "table",
        "columns": layout.columns,
        "rows": layout.rows,
        "column_sets": columns.set_names,
        "row_sets": rows.set_names,
        "outputs": layout.cells,
        "cells": [cells[k : k + width] for k in range(0, len(cells), width)],
    }


def _cell(rule: Rule, rules: RuleBase, layout: TableLayout) -> str:
    """Text of a cell; most cells are those of the state before."""
    key = rule.consequents, layout.cells, tuple(v.set_names for v in rules.outputs)
    found = _CELLS.get(key)
    if found is None:
        if len(_CELLS) >= _MOST_CELLS:
            _CELLS.clear()
        found = _CELLS[key] = cell_text(rule, layout.cells, rules)
    return found


def _list(rules: RuleBase) -> dict[str, Any]:
    return {
        "form": "list",
        "rules": [
            {
                "if": dict(rule.conditions),
                "text": consequents_text(rule.consequents),
                **_consequents(rule),
            }
            for rule in rules.rules
        ],
    }


def _consequents(rule: Rule) -> dict[str, Any]:
    """Conclusions of a rule; of several about one output the surest stands for all."""
    surest = sorted(rule.consequents, key=lambda c: c.confidence)
    confidences = {c.confidence for c in rule.consequents}
    return {
        "consequents": {c.output: c.set_name for c in surest},
        "weight": confidences.pop() if len(confidences) == 1 else None,
        "parts": [
            {"output": c.output, "set": c.set_name, "confidence": c.confidence}
            for c in rule.consequents
        ],
    }


def cell_place(rules: RuleBase, where: Mapping[str, str]) -> list[int] | None:
    """Row and column of the cell of a table with some conditions; None if there is none."""
    layout = rules.layout
    if layout is None or set(where) != {layout.columns, layout.rows}:
        return None
    row, column = where[layout.rows], where[layout.columns]
    names = rules.input(layout.rows).set_names, rules.input(layout.columns).set_names
    if row not in names[0] or column not in names[1]:
        return None
    return [names[0].index(row), names[1].index(column)]


def shared_sets(text: str) -> dict[str, list[str]]:
    """Variables of a text that share their sets by an anchor, each with the others.

    Parameters
    ----------
    text : str
        A rule base in YAML; what cannot be read shares nothing.
    """
    try:
        document = Document(text.removeprefix("\ufeff"), "<text>")
    except FileError:
        return {}
    root = document.root
    groups: dict[int, list[str]] = {}
    for role in ("inputs", "outputs"):
        variables = root.entries.get(role) if isinstance(root, MappingNode) else None
        if variables is None or not isinstance(variables[1], MappingNode):
            continue
        for name, (_, variable) in variables[1].entries.items():
            sets = variable.entries.get("sets") if isinstance(variable, MappingNode) else None
            if sets is not None and isinstance(sets[1], MappingNode):
                # What an alias repeats has the same entries.
                groups.setdefault(id(sets[1].entries), []).append(name)
    return {
        name: [other for other in names if other != name]
        for names in groups.values()
        for name in names
        if len(names) > 1
    }
