"""The rule base of a session as the page shows it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rule_edits import OPERATORS
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.saving import cell_text, consequents_text
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.schedulers.gain_outputs import find_gain_outputs
from fuzzytrack.studio.places import Places
from fuzzytrack.studio.symmetry import DRAWN

__all__ = ["cell_place", "rulebase_state"]

# Points of the curve of a set that a page cannot draw from its parameters.
_CURVE = 201
# Parameters of a set that are edited as numbers; more are edited in the text.
_MOST_NUMBERS = 6
_MOST_CELLS = 10_000
_CELLS: dict[object, str] = {}


def rulebase_state(rules: RuleBase, places: Places) -> dict[str, Any]:
    """A rule base in the types of JSON.

    Parameters
    ----------
    rules : RuleBase
    places : Places
        Of its text.
    """
    settings = dict(rules.scheduler)
    gains = find_gain_outputs(rules.output_names)
    return {
        "name": rules.name,
        "description": rules.description,
        "source": rules.source,
        "inputs": [_variable(v, rules, places) for v in rules.inputs],
        "outputs": [_variable(v, rules, places) for v in rules.outputs],
        "operators": {
            word: {"value": getattr(rules.operators, attribute), "choices": allowed}
            for word, (attribute, allowed) in OPERATORS.items()
        },
        "rules": _list(rules, places) if rules.layout is None else _table(rules, rules.layout),
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


def _variable(variable: Variable, rules: RuleBase, places: Places) -> dict[str, Any]:
    universe, own = variable.universe, variable.operators
    operators = None
    if own is not None:
        words = [own.conjunction, own.disjunction, own.defuzzification]
        operators = {"words": words, "line": places.operators.get(variable.name)}
    return {
        "name": variable.name,
        "label": variable.axis_label,
        "universe": [universe.low, universe.high, universe.points],
        "default": variable.default,
        "shared_with": places.shared.get(variable.name, ()),
        "operators": operators,
        "sets": [_set(each, variable, rules, places) for each in variable.sets],
    }


def _set(each: FuzzySet, variable: Variable, rules: RuleBase, places: Places) -> dict[str, Any]:
    """A set; with its curve and its line in the text where a page does not know its shape."""
    found = {"name": each.name, "shape": each.shape, "parameters": each.parameters}
    if each.shape in DRAWN:
        return found
    low, high = variable.universe.low, variable.universe.high
    is_curve = each.base != LINEAR
    names = SHAPES[each.shape].parameters if is_curve else (*rules.input_names, "constant")
    fits = len(each.parameters) == len(names) <= _MOST_NUMBERS
    return {
        **found,
        "names": names if fits else (),
        "grades": each.membership(np.linspace(low, high, _CURVE)) if is_curve else (),
        "universe": [low, high],
        "core": each.core(low, high) if each.has_core else None,
        "line": places.sets.get((variable.name, each.name)),
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


def _list(rules: RuleBase, places: Places) -> dict[str, Any]:
    """Rules of a list; a text that does not load now may have other lines than the rules."""
    known = len(places.rules) == len(rules.rules)
    lines = places.rules if known else [(None, 1)] * len(rules.rules)
    return {
        "form": "list",
        "rules": [
            {
                "if": dict(rule.conditions),
                "or": [dict(group) for group in rule.alternatives],
                "line": line,
                "together": together,
                "text": consequents_text(rule.consequents),
                **_consequents(rule),
            }
            for rule, (line, together) in zip(rules.rules, lines, strict=True)
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
