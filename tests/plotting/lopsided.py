"""A rule base in which nothing is symmetric."""

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable


def sets(*centers):
    names = "abcdefg"[: len(centers)]
    ends = (centers[0], *centers, centers[-1])
    return tuple(FuzzySet(name, "trimf", ends[k : k + 3]) for k, name in enumerate(names))


def lopsided(extra_input=False):
    """Two inputs of different range and an asymmetric table, so that no transposition passes."""
    x = Variable("x", Universe(0, 10, 11), sets(0, 4, 10), label="distance", unit="m")
    y = Variable("y", Universe(-1, 1, 21), sets(-1, 0.2, 1))
    u = Variable("u", Universe(0, 8, 81), sets(0, 2, 3, 6, 8), unit="s")
    table = ("abc", "dde", "bea")
    rules = tuple(
        Rule((("x", i), ("y", j)), (Consequent("u", table[a][b]),))
        for a, i in enumerate("abc")
        for b, j in enumerate("abc")
    )
    inputs = (x, y)
    if extra_input:
        inputs = (*inputs, Variable("w", Universe(0, 1, 11), sets(0, 1)))
        rules = (*rules, Rule((("w", "b"),), (Consequent("u", "e"),)))
    return RuleBase("lopsided", inputs, (u,), rules)
