"""Our reader of FLL against pyfuzzylite's systems and answers, and our writer against its engine.

pyfuzzylite is under the GPL and no part of this package: install it by hand with
``pip install --no-deps pyfuzzylite``. Its files are read where they lie, and its engine is run.
"""

import sys
from dataclasses import dataclass, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.formats.fll_writer import dumps_fll
from fuzzytrack.fuzzy.loading import load_rulebase, shipped_rulebases
from fuzzytrack.fuzzy.system import FuzzySystem

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fuzzy"))
from random_bases import random_base

TOLERANCE = 1e-6
DOCUMENT = Path(__file__).parents[2] / "docs" / "referee.md"

SPEC = find_spec("fuzzylite")
if SPEC is None or not SPEC.submodule_search_locations:
    pytest.skip(
        "pyfuzzylite is not installed (pip install --no-deps pyfuzzylite)", allow_module_level=True
    )
ROOT = Path(SPEC.submodule_search_locations[0]) / "examples"
FILES = {p.relative_to(ROOT).with_suffix("").as_posix(): p for p in sorted(ROOT.rglob("*.fll"))}
if not FILES:
    pytest.skip("this pyfuzzylite carries no examples", allow_module_level=True)

# Systems that are refused, and what they need.
REFUSED = {
    "takagi_sugeno/approximation": "lock-previous",
    "takagi_sugeno/octave/sugeno_tip_calculator": "hedge in a conclusion",
    "terms/function": "Function term",
    "tsukamoto/tsukamoto": "Tsukamoto",
}
# Systems whose answers differ, and by how much at the most.
DIFFERENT = {"terms/discrete": 1e-4}


@dataclass(frozen=True)
class Result:
    """Outcome of one file; the error is infinite where a NaN has no counterpart."""

    name: str
    rows: int
    error: float
    reason: str = ""


def compared(name, text):
    """Compare a system with the answers of a file."""
    path = FILES[name]
    rows = np.loadtxt(path.with_suffix(".fld"), skiprows=1, ndmin=2, encoding="utf-8")
    try:
        rules = loads_fll(text, path.name)
    except RuleBaseError as error:
        return Result(name, len(rows), np.nan, str(error))
    count = len(rules.inputs)
    # Without lock-range, inputs of the language may lie outside of their range.
    inputs = [
        replace(v, universe=replace(v.universe, low=min(v.universe.low, np.nanmin(column)),
                                    high=max(v.universe.high, np.nanmax(column))))
        for v, column in zip(rules.inputs, rows.T, strict=False)
    ]  # fmt: skip
    values = FuzzySystem(replace(rules, inputs=tuple(inputs))).evaluate(rows[:, :count])
    gap = gaps(np.stack([values[o] for o in rules.output_names], axis=1), rows[:, count:])
    return Result(name, len(rows), float(gap.max()))


def gaps(answer, expected):
    gap = np.abs(answer - expected)
    gap[np.isnan(answer) & np.isnan(expected)] = 0.0
    gap[np.isnan(gap)] = np.inf
    return gap


@cache
def result(name):
    return compared(name, FILES[name].read_bytes())


@pytest.mark.parametrize("name", FILES)
def test_system(name):
    outcome = result(name)
    assert outcome.rows > 100
    if name in REFUSED:
        assert REFUSED[name] in outcome.reason
    elif name in DIFFERENT:
        assert not outcome.reason
        assert TOLERANCE < outcome.error < DIFFERENT[name]
    else:
        assert not outcome.reason
        assert outcome.error <= TOLERANCE


def test_most_of_the_systems_match():
    results = [result(name) for name in FILES]
    rest = [r for r in results if not r.error <= TOLERANCE]
    for r in rest:
        print(f"{r.name:45} {r.reason or f'differs by up to {r.error:.1e}'}")
    print(f"{len(results) - len(rest)} of {len(results)} match to {TOLERANCE:g}")
    assert len(results) - len(rest) >= 56


def test_the_document_lists_the_rest():
    text = DOCUMENT.read_text(encoding="utf-8")
    rest = {name for name in FILES if not result(name).error <= TOLERANCE}
    assert {name for name in FILES if f"`{name}`" in text} == rest
    assert f"{len(FILES) - len(rest)} of {len(FILES)}" in text


def test_the_comparison_can_fail():
    name, rule = "mamdani/matlab/tipper", "if service is good then tip is average"
    text = FILES[name].read_text(encoding="utf-8")
    assert rule in text
    assert compared(name, text).error <= TOLERANCE
    assert compared(name, text.replace(rule, rule.replace("average", "generous"))).error > 1.0
    assert "Function" in compared(name, text.replace("Triangle", "Function")).reason


# -------------------------------------------------------------------- what is written


def theirs(text, points):
    """Outputs of pyfuzzylite's engine, shape (n, n_outputs)."""
    import fuzzylite

    engine = fuzzylite.FllImporter().from_string(text)
    rows = []
    for point in points:
        for variable, value in zip(engine.input_variables, point, strict=True):
            variable.value = float(value)
        engine.process()
        rows.append([float(np.squeeze(variable.value)) for variable in engine.output_variables])
    return np.array(rows)


def written_and_run(rules, count):
    rng = np.random.default_rng(3)
    # Inputs beyond their range, too: they count as its ends in both.
    ends = [(v.universe.low - 0.1, v.universe.high + 0.1) for v in rules.inputs]
    points = np.stack([rng.uniform(a, b, count) for a, b in ends], axis=1)
    values = FuzzySystem(rules).evaluate(points)
    found = np.stack([values[name] for name in rules.output_names], axis=1)
    with np.errstate(all="ignore"):
        return gaps(found, theirs(dumps_fll(rules).text, points)).max()


@pytest.mark.parametrize("name", shipped_rulebases())
def test_shipped_rule_bases_are_computed_equally_there(name):
    rules = load_rulebase(name)
    centroids = tuple(
        replace(v, universe=replace(v.universe, grid="midpoints")) for v in rules.outputs
    )
    assert written_and_run(replace(rules, outputs=centroids), 40) <= 1e-9


def fitting(operators):
    """Operators of the language; its Hamacher sum loses all digits where grades are near 1."""
    words = {
        name: getattr(operators, name).replace("hamacher-sum", "bounded-sum")
        for name in ("disjunction", "alternatives")
    }
    return replace(operators, weighting="product", **words)


@pytest.mark.parametrize("seed", range(100))
def test_random_rule_bases_are_computed_equally_there(seed):
    rules = random_base(
        seed,
        hedges=False,
        grids=("midpoints",),
        defuzzifications=("centroid", "weighted-centers"),
    )
    outputs = [replace(v, operators=v.operators and fitting(v.operators)) for v in rules.outputs]
    rules = replace(rules, outputs=tuple(outputs), operators=fitting(rules.operators))
    assert written_and_run(rules, 20) <= 1e-9


HEDGED = """\
Engine: hedged
InputVariable: x
  range: 0 1
  lock-range: true
  term: lo Ramp 1 0
  term: hi Sigmoid 0.4 9
OutputVariable: y
  range: 0 10
  aggregation: Maximum
  defuzzifier: Centroid 100
  term: small Triangle 0 2 5
  term: large Bell 7 1.5 2
RuleBlock:
  conjunction: AlgebraicProduct
  disjunction: Maximum
  implication: AlgebraicProduct
  activation: General
  rule: if x is HEDGE lo then y is small
  rule: if x is HEDGE hi or x is lo then y is large with 0.7
"""


@pytest.mark.parametrize(
    "hedge", ["not", "very", "somewhat", "seldom", "extremely", "not very", "seldom not"]
)
def test_hedges_are_computed_equally_there(hedge):
    rules = loads_fll(HEDGED.replace("HEDGE", hedge))
    assert written_and_run(rules, 50) <= 1e-9
