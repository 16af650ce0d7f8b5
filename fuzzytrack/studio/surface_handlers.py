"""Commands about surfaces: values, points, gains, certificate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.certificate import Certificate
from fuzzytrack.gains.covariance_certificate import CovarianceCertificate
from fuzzytrack.gains.polygons import convex_hull
from fuzzytrack.schedulers.gain_outputs import find_gain_outputs, gains_of
from fuzzytrack.schedulers.reachable_gains import certify, sequence_steps
from fuzzytrack.studio.arguments import Arguments, renamed
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MOST_POINTS
from fuzzytrack.studio.messages import Layers
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.state import cell_place
from fuzzytrack.studio.visits import visited_cells, visited_gains

__all__ = ["HANDLERS"]

Answer = Mapping[str, Any]

# Points on each axis of the grid over which gains are gathered.
_FINE = 101
_MOST_MISSED = 100


def surface(page: Page, given: Arguments) -> Later:
    """Values of outputs and gains over a grid, or their difference to another rule base."""
    names = given.texts("outputs")
    columns = given.whole("columns", 2, MOST_POINTS, 61)
    if given.whole("rows", 2, MOST_POINTS, columns) != columns:
        raise ValueError(f"rows: must be as many as columns, {columns}")
    inputs = given.texts("inputs", None)
    at = given.numbers_by_name("at") if "at" in given else None
    less = given.text("against", None)
    session = page.session

    def work() -> Layers:
        with renamed(names="outputs", less="against", name="against"):
            found = session.surfaces(names, columns, inputs=inputs, at=at, less=less)
        return Layers(np.stack([found.values[name].T for name in names]))

    return Later(work)


def explain(page: Page, given: Arguments) -> Answer:
    """Memberships, rules that fire, outputs and gains at a point."""
    system = page.session.reading.system
    rules = system.rules
    point = given.numbers_by_name("inputs")
    if set(point) != set(rules.input_names):
        names = ", ".join(rules.input_names)
        raise ValueError(f"inputs: needs a number for each of {names}")
    return explanation_of(system, point)


def explanation_of(system: FuzzySystem, point: Mapping[str, float]) -> dict[str, Any]:
    """What a rule base makes of a point."""
    rules = system.rules
    outputs = system.evaluate(np.array([[point[name] for name in rules.input_names]]))
    gains = gains_of(outputs) if find_gain_outputs(rules.output_names) else None
    if gains == {}:
        gains = outputs
    return {
        "memberships": {v.name: _grades(rules, v.name, point[v.name]) for v in rules.inputs},
        "rules": [
            {
                "index": fired.number - 1,
                "place": cell_place(rules, dict(fired.rule.conditions)),
                "text": str(fired.rule),
                "strength": fired.strength,
            }
            for fired in system.explain(**point)
        ],
        "outputs": {name: values[0] for name, values in outputs.items()},
        "gains": None if gains is None else {name: v[0] for name, v in gains.items()},
    }


def _grades(rules: RuleBase, name: str, value: float) -> dict[str, float]:
    variable = rules.input(name)
    grades = variable.memberships(variable.universe.clip(np.array([value])))
    return dict(zip(variable.set_names, grades[:, 0].tolist(), strict=True))


# -------------------------------------------------------------------- gain plane


def gains(page: Page, given: Arguments) -> Later:
    """Gains that the rules reach, and those that the last run used, in the stability triangle."""
    system, run = page.session.reading.system, page.run

    def work() -> Answer:
        reached = _reached(system)
        with renamed(truth=None):
            gains_seen = [] if run is None else visited_gains(run, system.rules)
        return {
            # α = 0, β = 0 and β = 4 - 2α bound the stable gains.
            "triangle": [[0.0, 0.0], [2.0, 0.0], [0.0, 4.0]],
            "reachable": reached,
            "hull": convex_hull(reached) if len(reached) > 2 else reached,
            "visited": gains_seen,
        }

    return Later(work)


def _reached(system: FuzzySystem) -> Array:
    """Pairs (α, β) over a grid of the inputs, shape (n, 2)."""
    rules = system.rules
    if find_gain_outputs(rules.output_names) is None:
        return np.empty((0, 2))
    count = _FINE if len(rules.inputs) < 3 else 11
    axes = [v.nodes(count) for v in rules.inputs]
    grid = np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")], axis=1)
    outputs = system.evaluate(grid)
    found = outputs | gains_of(outputs)
    pairs = np.stack([found["alpha"], found["beta"]], axis=1)
    return np.unique(pairs[~np.isnan(pairs).any(axis=1)].round(5), axis=0)


def prove(page: Page, given: Arguments) -> Later:
    """Whether tracks stay stable in whatever order the gains are used."""
    page.session.check_loads("rules")
    rules = page.session.reading.rules
    steps = given.numbers("steps", None)
    if steps is not None and len(steps) != 2:
        raise ValueError("steps: needs two times, the shortest and the longest between plots")
    missed = given.whole("missed", 0, _MOST_MISSED, 0)

    def work() -> Answer:
        found = certify(rules, steps=None if steps is None else (steps[0], steps[1]), missed=missed)
        sequence = None
        if isinstance(found, Certificate) and found.verdict == "refuted":
            sequence = sequence_steps(rules, found)
        return {
            "verdict": found.verdict,
            "sentence": _sentence(found),
            "covered": found.covered,
            "counter_example": sequence,
        }

    return Later(work)


def _sentence(found: Certificate | CovarianceCertificate) -> str:
    if isinstance(found, CovarianceCertificate):
        if found.verdict == "certified":
            return "The error shrinks exponentially, whatever noise the rules choose."
        return f"Nothing was shown: {found.missing}"
    if found.verdict == "certified":
        return (
            "For all gains that the rule base can have, in any order, the error shrinks at every "
            f"plot to {found.rate:.4f} of what it was, or less."
        )
    if found.verdict == "refuted":
        return (
            "The gains of the counter-example, repeated in their order, make the error grow by a "
            f"factor of {found.growth:.4f} a plot."
        )
    return (
        "No measure of the error was found that always shrinks, nor a sequence of gains that makes "
        "the error grow."
    )


def visits(page: Page, given: Arguments) -> Later:
    """How often the last run had inputs in each cell of a grid."""
    run, rules = page.run, page.session.reading.rules

    def work() -> Answer:
        with renamed(truth=None):
            return visited_cells(run, rules)

    return Later(work)


HANDLERS = {
    "surface": Handler(surface, ("outputs", "columns", "rows", "against", "inputs", "at")),
    "explain": Handler(explain, ("inputs",)),
    "gains": Handler(gains),
    "certify": Handler(prove, ("steps", "missed")),
    "visits": Handler(visits),
}
