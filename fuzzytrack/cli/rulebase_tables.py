"""Rule bases, explanations and reviews as a terminal prints them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fuzzytrack.cli.output import print_table, say, show
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.schedulers.review import Review

__all__ = ["print_explanation", "print_rulebase", "review_lines"]


def print_rulebase(rules: RuleBase, heading: str) -> None:
    """Print a rule base: its variables, their sets, its rules."""
    say(heading)
    for text in filter(None, (rules.description, rules.source and f"Source: {rules.source}")):
        _print_prose(text)
    say()
    for role in ("inputs", "outputs"):
        _print_variables(role, rules)
    for line in rules.algebra():
        say(line)
    if rules.scheduler:
        say(f"scheduler: {', '.join(f'{key} {value}' for key, value in rules.scheduler)}")
    say()
    if rules.layout:
        _print_rule_table(rules, rules.layout)
    else:
        for rule in rules.rules:
            say(f"  {rule}")


def _print_prose(text: str) -> None:
    from rich.console import Console

    Console(highlight=False, markup=False).print(text)


def _print_variables(role: str, rules: RuleBase) -> None:
    rows: list[list[str]] = []
    for variable in getattr(rules, role):
        universe = variable.universe
        what = f"[{universe.low:g}, {universe.high:g}], {universe.points} points"
        if universe.grid != "ends":
            what += f", {universe.grid}"
        label = variable.axis_label if variable.label or variable.unit else ""
        rows += [[]] if rows else []
        for number, fuzzy_set in enumerate(variable.sets):
            first = [variable.name, what] if number == 0 else ["", label if number == 1 else ""]
            parameters = ", ".join(f"{p:.4g}" for p in fuzzy_set.parameters)
            rows.append([*first, fuzzy_set.name, fuzzy_set.shape, parameters])
        if variable.default is not None:
            rows.append(["", f"where no rule fires: {variable.default:g}", "", "", ""])
    print_table([role, "universe", "set", "shape", "parameters"], rows, words=5)
    say()


def _print_rule_table(rules: RuleBase, layout: TableLayout) -> None:
    columns, rows = rules.input(layout.columns), rules.input(layout.rows)
    width = len(columns.sets)
    cells = [_cell(rule, layout.cells) for rule in rules.rules]
    body = [
        [name, *cells[number * width : (number + 1) * width]]
        for number, name in enumerate(rows.set_names)
    ]
    title = f"{'-'.join(layout.cells)} by {layout.rows} (down) and {layout.columns} (across)"
    print_table([f"{layout.rows} \\ {layout.columns}", *columns.set_names], body, title=title)


def _cell(rule: Rule, order: tuple[str, ...]) -> str:
    """Sets for each output in order, joined by hyphens; several of one output by plus signs."""
    words = []
    for output in order:
        mine = [c for c in rule.consequents if c.output == output]
        sure = [f"@{c.confidence:g}" if c.confidence != 1.0 else "" for c in mine]
        words.append("+".join(c.set_name + s for c, s in zip(mine, sure, strict=True)) or "·")
    return "-".join(words)


# -------------------------------------------------------------------- reasons


def print_explanation(system: FuzzySystem, found: dict[str, Any]) -> None:
    """Print what `fuzzytrack.schedulers.review.explanation` found; the strongest rule first."""
    for name, value in found["at"].items():
        universe = system.rules.input(name).universe
        if not universe.low <= value <= universe.high:
            end = universe.low if value < universe.low else universe.high
            say(f"{name} = {value:g} is outside its universe; {end:g} is used")
    rules = system.rules.rules
    rows = [
        [str(f["number"]), f"{f['strength']:.4f}", str(rules[f["number"] - 1])]
        for f in found["rules"]
    ]
    if rows:
        print_table(["rule", "strength", "text"], rows, words=3)
    else:
        point = np.array([found["at"][name] for name in system.rules.input_names])
        lost = any(system.underflows(name, point) for name in system.rules.output_names)
        say("the strengths of all rules underflow to 0 here" if lost else "no rule fires here")
    say()
    for name, value in {**found["outputs"], **found["gains"]}.items():
        unit = system.rules.output(name).unit if name in found["outputs"] else ""
        say(f"{name} = {show(value, 6)}{' ' + unit if unit and unit != '1' else ''}")


def review_lines(review: Review) -> Iterator[tuple[str, str]]:
    """Review as a terminal prints it: what, and how it is."""
    rules = review.rules
    for role, variables in (("input", rules.inputs), ("output", rules.outputs)):
        for variable in variables:
            yield f"{role} {variable.name}", _variable(variable)
    written = ""
    if review.written:
        written = f"; {review.written[0]} of {review.written[1]} combinations of sets have one"
    yield "rules", f"{len(rules.rules)}{written}"
    yield from _coverage(review)
    for name, (low, high) in review.ranges.items():
        yield f"{name} reaches", f"{show(low)} to {show(high)}"
    yield "signs", review.symmetry
    if review.table_bounds:
        bounds = ", ".join(
            f"{name} jumps to NaN" if math.isinf(bound) else f"{name} at most {show(bound, 2)}"
            for name, bound in review.table_bounds.items()
        )
        yield "table error", f"{bounds} (method table)"
    yield "tracker", review.schedules or "schedules no gains"


def _coverage(review: Review) -> Iterator[tuple[str, str]]:
    if not review.silent and not review.holes:
        yield "coverage", "a rule fires everywhere"
    if review.silent:
        share = f"{review.silent:.1%}" if review.silent >= 0.001 else "< 0.1 %"
        yield "coverage", f"no rule fires on {share} of the inputs"
    for hole in review.holes:
        if not hole.stretches:
            yield "coverage", f"{hole.output}: too many rules to find where none fires"
            continue
        default = review.rules.output(hole.output).default
        value = "NaN" if default is None else f"{default:g}"
        yield "coverage", f"{hole}; it is then {value}"


def _variable(variable: Variable) -> str:
    universe = variable.universe
    return (
        f"{len(variable.sets)} sets on [{universe.low:g}, {universe.high:g}], "
        f"{universe.points} points"
    )
