"""Rule bases as mappings, lists, words and numbers, for JSON."""

from __future__ import annotations

from typing import Any

from fuzzytrack.fuzzy.rulebase import Rule, RuleBase

__all__ = ["rule_as_json", "rulebase_as_json"]


def rulebase_as_json(rules: RuleBase) -> dict[str, Any]:
    """Rule base as JSON prints it."""

    def variables(role: str) -> list[dict[str, Any]]:
        return [
            {
                "name": v.name,
                "label": v.label,
                "unit": v.unit,
                "universe": [v.universe.low, v.universe.high, v.universe.points],
                "grid": v.universe.grid,
                "default": v.default,
                "sets": {s.name: {s.shape: list(s.parameters)} for s in v.sets},
                **({"operators": v.operators.words()} if v.operators else {}),
            }
            for v in getattr(rules, role)
        ]

    return {
        "name": rules.name,
        "description": rules.description,
        "source": rules.source,
        "inputs": variables("inputs"),
        "outputs": variables("outputs"),
        "operators": rules.operators.words(),
        "rules": [rule_as_json(rule) for rule in rules.rules],
        "scheduler": dict(rules.scheduler),
    }


def rule_as_json(rule: Rule) -> dict[str, Any]:
    """Rule as JSON prints it: sets of inputs, and sets of outputs with their confidences."""
    then = [
        {"output": c.output, "set": c.set_name, "confidence": c.confidence}
        for c in rule.consequents
    ]
    others = {"or": [dict(group) for group in rule.alternatives]} if rule.alternatives else {}
    return {"if": dict(rule.conditions), **others, "then": then}
