"""Random rule bases with everything that a rule base may have."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np

from fuzzytrack.fuzzy.formats import fis_words
from fuzzytrack.fuzzy.hedges import HEDGES
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import CONJUNCTIONS, DISJUNCTIONS, Operators
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable

GRID = ("centroid", "bisector", "mom", "som", "lom")


def parameters_of(rng: random.Random, shape: str, low: float, high: float) -> tuple[float, ...]:
    """Parameters with the core of the shape on [low, high]."""
    width = high - low

    def places(count: int) -> list[float]:
        return sorted(rng.uniform(low, high) for _ in range(count))

    def widths() -> float:
        return width * rng.uniform(0.1, 0.5)

    def slope() -> float:
        return rng.choice((-1, 1)) * rng.uniform(4, 15) / width

    if shape in ("trimf", "trapmf", "pimf", "smf", "zmf", "linsmf", "linzmf", "ellipse"):
        return tuple(places(len(SHAPES[shape].parameters)))
    if shape in ("gaussmf", "cosine", "spike"):
        return places(1)[0], widths()
    if shape == "gauss2mf":
        first, second = places(2)
        return first, widths(), second, widths()
    if shape == "gbellmf":
        return widths(), rng.uniform(0.6, 4), places(1)[0]
    if shape == "sigmf":
        return places(1)[0], slope()
    if shape == "dsigmf":
        first, second = places(2)
        return first, abs(slope()), second, abs(slope())
    if shape == "psigmf":
        first, second = places(2)
        return first, abs(slope()), second, -abs(slope())
    if shape == "discrete":
        xs = places(rng.randint(2, 6))
        ys = [rng.choice((0.0, 1.0, rng.random())) for _ in xs]
        ys[rng.randrange(len(ys))] = 1.0
        return tuple(x for pair in zip(xs, ys, strict=True) for x in pair)
    if shape in ("concave", "arc"):
        ends = places(2)
        rng.shuffle(ends)
        return tuple(ends)
    return (places(1)[0],)


def sets_of(
    rng: random.Random, count: int, shapes: list[str], low: float, high: float, hedges: bool
) -> tuple[FuzzySet, ...]:
    """Sets in the order of their centers; some after hedges."""
    sets = []
    for _ in range(count):
        shape = rng.choice(shapes)
        parameters = parameters_of(rng, shape, low, high)
        if hedges and rng.random() < 0.25:
            words = rng.choices([h for h in HEDGES if h != "any"], k=rng.choice((1, 1, 2)))
            shape = " ".join([*words, shape])
        sets.append(FuzzySet("s", shape, parameters))
    sets.sort(key=lambda s: s.center(low, high))
    return tuple(FuzzySet(f"s{k}", s.shape, s.parameters) for k, s in enumerate(sets))


def random_operators(rng: random.Random, defuzzification: str, algebras: bool) -> Operators:
    """Any operators; without `algebras` the product or the minimum, and sum or max."""
    ands = CONJUNCTIONS if algebras else CONJUNCTIONS[:2]
    ors = DISJUNCTIONS if algebras else DISJUNCTIONS[:2]
    return Operators(
        rng.choice(ands),
        rng.choice(ors),
        defuzzification,
        rng.choice(ands),
        rng.choice((*ands, "product")),
        rng.choice(DISJUNCTIONS[1:] if algebras else ("max",)),
    )


def random_base(
    seed: int,
    *,
    shapes: list[str] | None = None,
    hedges: bool = True,
    algebras: bool = True,
    alternatives: bool = True,
    linear: bool = True,
    own_operators: bool = True,
    defuzzifications: tuple[str, ...] = (*GRID, "weighted-centers"),
    grids: tuple[str, ...] = ("ends", "midpoints"),
) -> RuleBase:
    """A random rule base, the same for the same arguments."""
    rng = random.Random(seed)
    shapes = shapes or [s for s in SHAPES if s not in (LINEAR, "singleton")]
    inputs = []
    for k in range(rng.randint(1, 3)):
        low = rng.uniform(-3, 1)
        high = low + rng.uniform(0.5, 4)
        sets = sets_of(rng, rng.randint(2, 4), shapes, low, high, hedges)
        # One set that is above zero everywhere, so that rules fire at all inputs.
        wide = FuzzySet("wide", "gaussmf", ((low + high) / 2, high - low))
        sets = tuple(sorted((*sets, wide), key=lambda s: s.center(low, high)))
        inputs.append(Variable(f"x{k}", Universe(low, high, rng.randint(5, 9)), sets))
    operators = random_operators(rng, rng.choice(defuzzifications), algebras)
    outputs = []
    for k in range(rng.randint(1, 2)):
        own = None
        if own_operators and k == 1 and rng.random() < 0.5:
            own = random_operators(rng, rng.choice(defuzzifications), algebras)
        outputs.append(_output(rng, f"y{k}", own, own or operators, len(inputs), shapes, hedges,
                               linear, grids))  # fmt: skip
    rules: dict[object, Rule] = {}
    for number in range(rng.randint(3, 8)):
        groups = [_group(rng, inputs, every=number == 0)]
        while alternatives and rng.random() < 0.3 and len(groups) < 3:
            groups.append(_group(rng, inputs, every=False))
        consequents = [
            Consequent(
                output.name,
                rng.choice(output.set_names),
                1.0 if rng.random() < 0.6 else round(rng.uniform(0.2, 1), 3),
            )
            for output in outputs
        ]
        rule = Rule(groups[0], tuple(consequents), tuple(dict.fromkeys(groups[1:])))
        rules.setdefault(rule.key, rule)
    return RuleBase("random", tuple(inputs), tuple(outputs), tuple(rules.values()), operators)


def _group(
    rng: random.Random, inputs: list[Variable], *, every: bool
) -> tuple[tuple[str, str], ...]:
    if every:
        return tuple((v.name, "wide") for v in inputs)
    chosen = rng.sample(inputs, rng.randint(1, len(inputs)))
    chosen.sort(key=lambda v: v.name)
    return tuple((v.name, rng.choice(v.set_names)) for v in chosen)


def _output(
    rng: random.Random,
    name: str,
    own: Operators | None,
    operators: Operators,
    n_inputs: int,
    shapes: list[str],
    hedges: bool,
    linear: bool,
    grids: tuple[str, ...],
) -> Variable:
    low = rng.uniform(-2, 2)
    high = low + rng.uniform(0.5, 3)
    universe = Universe(low, high, rng.randint(80, 120), rng.choice(grids))
    if operators.defuzzification != "weighted-centers":
        sets = sets_of(rng, rng.randint(2, 4), shapes, low, high, hedges)
    elif linear and rng.random() < 0.5:
        sets = tuple(
            FuzzySet(f"s{k}", LINEAR, tuple(rng.uniform(-2, 2) for _ in range(n_inputs + 1)))
            for k in range(rng.randint(2, 4))
        )
    else:
        sets = sets_of(rng, rng.randint(2, 4), ["singleton"], low, high, False)
    return Variable(name, universe, sets, default=rng.choice((None, low)), operators=own)


def expressible(seed: int, suffix: str) -> RuleBase:
    """A random rule base that a format can have, ``.fis`` or ``.fll``."""
    fis = suffix == ".fis"
    rules = random_base(
        seed,
        shapes=[*fis_words.SHAPES] if fis else None,
        hedges=False,
        algebras=not fis,
        alternatives=not fis,
        own_operators=not fis,
    )

    def fitting(operators: Operators) -> Operators:
        sums = fis and operators.defuzzification == "weighted-centers"
        disjunction = "sum" if sums else operators.disjunction
        return replace(operators, weighting="product", disjunction=disjunction)

    outputs = [replace(v, operators=v.operators and fitting(v.operators)) for v in rules.outputs]
    return replace(rules, operators=fitting(rules.operators), outputs=tuple(outputs))


def largest_gap(rules: RuleBase, other: RuleBase, count: int) -> float:
    """Largest difference of two rule bases at points inside and outside of their universes."""
    rng = np.random.default_rng(5)
    ends = [(v.universe.low, v.universe.high) for v in rules.inputs]
    points = np.stack([rng.uniform(a - 0.1, b + 0.1, count) for a, b in ends], axis=1)
    first, second = (FuzzySystem(r).evaluate(points) for r in (rules, other))
    assert list(first) == list(second)
    gaps = []
    for name, values in first.items():
        assert np.array_equal(np.isnan(values), np.isnan(second[name]))
        gaps.append(float(np.nanmax(np.abs(values - second[name]), initial=0.0)))
    return max(gaps)
