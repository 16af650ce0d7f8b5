"""Fuzzy engines, evaluating the same 49 rules."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stdout
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fuzzytrack as ft
from benchmarks.peers import need
from benchmarks.report import NotMeasured, Row
from benchmarks.scale import Scale
from benchmarks.timing import ratio, take_turns

__all__ = ["arrays", "points"]

SECTION = "Fuzzy engines, 49 rules, two inputs and two outputs (evaluations a second)"
UNIT = "/s"

Array = NDArray[np.float64]
#: From two inputs to stiffness and damping.
Engine = Callable[[Any, Any], tuple[Any, Any]]


def _rules() -> ft.RuleBase:
    return ft.load_rulebase("stiffness-damping")


def _terms(rule: Any) -> tuple[dict[str, str], dict[str, str]]:
    conditions = dict(rule.conditions)
    return conditions, {c.output: c.set_name for c in rule.consequents}


def fuzzytrack_points() -> Engine:
    system = ft.FuzzySystem(_rules())

    def evaluate(error: Any, rate: Any) -> tuple[Any, Any]:
        found = system(E=error, dE=rate)
        return found["stiffness"], found["damping"]

    return evaluate


def pyfuzzylite() -> Engine:
    fl = need("fuzzylite", "pyfuzzylite")
    rules = _rules()
    shapes = {"trimf": fl.Triangle, "trapmf": fl.Trapezoid}
    inputs = [
        fl.InputVariable(
            name=v.name, minimum=v.universe.low, maximum=v.universe.high,
            terms=[shapes[s.shape](s.name, *s.parameters) for s in v.sets],
        )
        for v in rules.inputs
    ]  # fmt: skip
    outputs = [
        fl.OutputVariable(
            name=v.name, minimum=v.universe.low, maximum=v.universe.high,
            defuzzifier=fl.WeightedAverage(), aggregation=None,
            terms=[fl.Constant(n, c) for n, c in zip(v.set_names, v.centers(), strict=True)],
        )
        for v in rules.outputs
    ]  # fmt: skip
    texts = []
    for rule in rules.rules:
        conditions, conclusions = _terms(rule)
        given = " and ".join(f"{name} is {term}" for name, term in conditions.items())
        then = " and ".join(f"{name} is {term}" for name, term in conclusions.items())
        texts.append(fl.Rule.create(f"if {given} then {then}"))
    block = fl.RuleBlock(
        "", conjunction=fl.AlgebraicProduct(), implication=None, activation=fl.General(),
        rules=texts,
    )  # fmt: skip
    engine = fl.Engine("", input_variables=inputs, output_variables=outputs, rule_blocks=[block])

    def evaluate(error: Any, rate: Any) -> tuple[Any, Any]:
        engine.input_variable("E").value = error
        engine.input_variable("dE").value = rate
        engine.process()
        return tuple(engine.output_variable(name).value for name in ("stiffness", "damping"))

    return evaluate


def simpful() -> Engine:
    sf = need("simpful", "simpful")
    rules = _rules()
    system = sf.FuzzySystem(operators=["AND_PRODUCT"], show_banner=False, verbose=False)
    shapes = {"trimf": sf.TriangleFuzzySet, "trapmf": sf.TrapezoidFuzzySet}
    for v in rules.inputs:
        sets = [shapes[s.shape](*s.parameters, term=s.name) for s in v.sets]
        universe = [v.universe.low, v.universe.high]
        variable = sf.LinguisticVariable(sets, concept=v.name, universe_of_discourse=universe)
        system.add_linguistic_variable(v.name, variable)
    for v in rules.outputs:
        # It prints what kind of system it takes this for.
        with redirect_stdout(None):
            for name, center in zip(v.set_names, v.centers(), strict=True):
                system.set_crisp_output_value(f"{v.name}_{name}", float(center))
    texts = []
    for rule in rules.rules:
        conditions, conclusions = _terms(rule)
        given = " AND ".join(f"({name} IS {term})" for name, term in conditions.items())
        texts += [f"IF {given} THEN ({n} IS {n}_{t})" for n, t in conclusions.items()]
    system.add_rules(texts)

    def evaluate(error: Any, rate: Any) -> tuple[Any, Any]:
        system.set_variable("E", error)
        system.set_variable("dE", rate)
        found = system.Sugeno_inference(["stiffness", "damping"])
        return found["stiffness"], found["damping"]

    return evaluate


def scikit_fuzzy() -> Engine:
    control = need("skfuzzy.control", "scikit-fuzzy")
    rules = _rules()
    known: dict[str, Any] = {}
    for kind, variables in (
        (control.Antecedent, rules.inputs),
        (control.Consequent, rules.outputs),
    ):
        for v in variables:
            known[v.name] = kind(v.universe.values, v.name)
            for s in v.sets:
                known[v.name][s.name] = s.membership(v.universe.values)
    listed = []
    for rule in rules.rules:
        conditions, conclusions = _terms(rule)
        first, second = (known[name][term] for name, term in conditions.items())
        then = [known[name][term] for name, term in conclusions.items()]
        listed.append(control.Rule(first & second, then, and_func=np.multiply))
    simulation = control.ControlSystemSimulation(control.ControlSystem(listed), cache=False)

    def evaluate(error: Any, rate: Any) -> tuple[Any, Any]:
        simulation.input["E"] = error
        simulation.input["dE"] = rate
        simulation.compute()
        return simulation.output["stiffness"], simulation.output["damping"]

    return evaluate


SAME = "The same sets, product and weighted centers"
PEERS: dict[str, tuple[Callable[[], Engine], str]] = {
    "pyfuzzylite": (pyfuzzylite, SAME),
    "simpful": (simpful, SAME),
    "scikit-fuzzy": (
        scikit_fuzzy,
        "Not the same: it has no weighted centers, so the centroid of sets cut off and joined by "
        "max on the rule base's grid of 41 points is taken",
    ),
}


def _inputs(count: int) -> tuple[Array, Array]:
    error, rate = np.random.default_rng(3).uniform(-1.0, 1.0, (2, count))
    return error, rate


def points(scale: Scale) -> list[Row]:
    """One pair of inputs at a time."""
    error, rate = (values.tolist() for values in _inputs(min(20, scale.evaluations)))
    return _compare(
        "one pair at a time", scale, PEERS,
        lambda engine: [engine(e, r) for e, r in zip(error, rate, strict=True)], len(error),
    )  # fmt: skip


def arrays(scale: Scale) -> list[Row]:
    """Arrays of inputs, with those that take them."""
    error, rate = _inputs(scale.evaluations)
    able = {name: peer for name, peer in PEERS.items() if name == "pyfuzzylite"}
    rows = _compare(
        f"array of {scale.evaluations:,}", scale, able,
        lambda engine: [engine(error, rate)], scale.evaluations,
    )  # fmt: skip
    without = ", ".join(name for name in PEERS if name not in able)
    return [*rows, Row(SECTION, f"array, against {without}", why="they take one pair at a time")]


def _outputs(found: list[tuple[Any, Any]]) -> Array:
    """All outputs in one row; a peer may give numbers as arrays of one."""
    return np.concatenate(
        [np.ravel(np.asarray(value, dtype=float)) for pair in found for value in pair]
    )


def _compare(
    what: str,
    scale: Scale,
    peers: dict[str, tuple[Callable[[], Engine], str]],
    feed: Callable[[Engine], list[tuple[Any, Any]]],
    count: int,
) -> list[Row]:
    engines, missing = {"ours": fuzzytrack_points()}, []
    for name, (make, _) in peers.items():
        try:
            engines[name] = make()
        except NotMeasured as why:
            missing.append(Row(SECTION, f"{what}, against {name}", why=str(why)))
    works = {name: lambda engine=engine: feed(engine) for name, engine in engines.items()}
    found = take_turns(works, max(2, scale.repeats // 2))
    expected = _outputs(feed(engines["ours"]))
    rows = []
    for name in engines:
        if name == "ours":
            continue
        apart = np.abs(_outputs(feed(engines[name])) - expected).max()
        rows.append(
            Row(SECTION, what, count / found["ours"].median, UNIT, name,
                count / found[name].median, ratio(found[name], found["ours"]),
                note=f"{peers[name][1]}; outputs differ by {apart:.1g} at most.")
        )  # fmt: skip
    return rows + missing
