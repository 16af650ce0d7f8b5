"""Rule bases for the tests, in plain Python."""

from __future__ import annotations

import itertools

import numpy as np

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable

SEVEN = ("nl", "nm", "ns", "ze", "ps", "pm", "pl")
FOUR = ("z", "s", "m", "l")

ALGEBRAS = tuple(itertools.product(("product", "min"), ("sum", "max")))


def triangles(names, centers, *, plateau=False):
    """Triangles from center to center, half ones (or plateaus) at the ends: they add up to one."""
    sets = []
    for k, (name, center) in enumerate(zip(names, centers, strict=True)):
        left = centers[k - 1] if k else center
        right = centers[k + 1] if k + 1 < len(centers) else center
        if plateau and k == 0:
            sets.append(FuzzySet(name, "trapmf", (center - 10, center - 10, center, right)))
        elif plateau and k + 1 == len(centers):
            sets.append(FuzzySet(name, "trapmf", (left, center, center + 10, center + 10)))
        else:
            sets.append(FuzzySet(name, "trimf", (left, center, right)))
    return tuple(sets)


def whole_triangles(names, low, high):
    """Evenly spaced triangles of equal area, the outer ones reaching beyond [low, high]."""
    centers = np.linspace(low, high, len(names))
    step = centers[1] - centers[0]
    return tuple(
        FuzzySet(n, "trimf", (c - step, c, c + step)) for n, c in zip(names, centers, strict=True)
    )


def is_set(output, term, confidence=1.0):
    return Consequent(output, term, confidence)


def rule(conditions, *consequents):
    return Rule(tuple(conditions.items()), tuple(consequents))


def table_base(table, x, y, output, operators=None, name="table"):
    """Rules ``x is i and y is j -> output is table[i][j]`` from indices of the output's sets."""
    rules = [
        rule(
            {x.name: x.set_names[i], y.name: y.set_names[j]},
            is_set(output.name, output.set_names[table[i][j]]),
        )
        for i in range(len(x.sets))
        for j in range(len(y.sets))
    ]
    return RuleBase(name, (x, y), (output,), tuple(rules), operators or Operators())


def asymmetric_base(conjunction="product", disjunction="sum", defuzzification="centroid", seed=7):
    """Random 7x7 base with nothing symmetric: ranges, grids, centers, table, confidences.

    A quarter of the rules have a confidence below one and a quarter conclude two sets of one
    output; two more rules name one input only.
    """
    random = np.random.default_rng(seed)
    e = Variable(
        "e",
        Universe(-1.0, 1.0, 37),
        triangles(SEVEN, (-0.61, -0.33, -0.1, 0.02, 0.12, 0.3, 0.7), plateau=True),
    )
    d = Variable(
        "d", Universe(-2.0, 3.0, 31), triangles(SEVEN, (-2.0, -0.9, -0.3, 0.1, 0.6, 1.7, 3.0))
    )
    w = Variable("w", Universe(0.25, 0.35, 41), triangles(FOUR, (0.25, 0.29, 0.31, 0.35)))
    z = Variable(
        "z",
        Universe(0.0, 1.3, 53, "midpoints"),
        (
            FuzzySet("z", "zmf", (0.0, 0.5)),
            FuzzySet("s", "gaussmf", (0.4, 0.11)),
            FuzzySet("m", "gbellmf", (0.2, 2.0, 0.8)),
            FuzzySet("l", "smf", (0.7, 1.2)),
        ),
    )
    rules = []
    for first, second in itertools.product(SEVEN, SEVEN):
        a, b, c, other = random.integers(0, 4, 4)
        sure = 1.0 if random.random() < 0.75 else float(random.uniform(0.2, 0.9))
        consequents = [is_set("w", FOUR[a], sure), is_set("z", FOUR[b])]
        if random.random() < 0.25 and c != b:
            consequents[1] = is_set("z", FOUR[b], 0.7)
            consequents.append(is_set("z", FOUR[c], 0.3))
        rules.append(rule({"e": first, "d": second}, *consequents))
    rules.append(rule({"d": "pm"}, is_set("w", FOUR[other], 0.5)))
    rules.append(rule({"e": "ns"}, is_set("z", "l", 0.25)))
    return RuleBase(
        "asymmetric",
        (e, d),
        (w, z),
        tuple(rules),
        Operators(conjunction, disjunction, defuzzification),
    )


def random_points(rulebase, n, seed=1):
    random = np.random.default_rng(seed)
    return {v.name: random.uniform(v.universe.low, v.universe.high, n) for v in rulebase.inputs}


def tipper(points, grid, names=("poor", "good", "excellent")):
    """MATLAB's and fuzzylite's tipper; its ORs are written as two rules, the same under max."""
    service = Variable(
        "service",
        Universe(0, 10, 101),
        tuple(
            FuzzySet(n, "gaussmf", (c, 1.5)) for n, c in zip(names, (0.0, 5.0, 10.0), strict=True)
        ),
    )
    food = Variable(
        "food",
        Universe(0, 10, 101),
        (
            FuzzySet("rancid", "trapmf", (0, 0, 1, 3)),
            FuzzySet("delicious", "trapmf", (7, 9, 10, 10)),
        ),
    )
    tip = Variable(
        "tip",
        Universe(0, 30, points, grid),
        (
            FuzzySet("cheap", "trimf", (0, 5, 10)),
            FuzzySet("average", "trimf", (10, 15, 20)),
            FuzzySet("generous", "trimf", (20, 25, 30)),
        ),
    )
    rules = (
        rule({"service": names[0]}, is_set("tip", "cheap")),
        rule({"food": "rancid"}, is_set("tip", "cheap")),
        rule({"service": names[1]}, is_set("tip", "average")),
        rule({"service": names[2]}, is_set("tip", "generous")),
        rule({"food": "delicious"}, is_set("tip", "generous")),
    )
    return RuleBase("tipper", (service, food), (tip,), rules, Operators("min", "max", "centroid"))
