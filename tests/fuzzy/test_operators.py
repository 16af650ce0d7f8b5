"""Operators, alternatives and linear conclusions, against a slow evaluation rule by rule."""

import math
import random
import warnings
from dataclasses import replace

import numpy as np
import pytest
from random_bases import random_base

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.as_json import rulebase_as_json
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.fuzzy.set_edits import rename_set
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.fuzzy.variable import Universe, Variable


# By the additive generator of a norm, T(a, b) = f⁻¹(f(a) + f(b)), and its dual,
# S(a, b) = 1 - T(1 - a, 1 - b).
def generated(f, inverse):
    def norm(a, b):
        if a == 0 or b == 0:
            return 0.0
        return inverse(f(a) + f(b))

    return norm


AND = {
    "product": generated(lambda a: -math.log(a), lambda t: math.exp(-t)),
    "min": lambda a, b: a if a < b else b,
    "einstein-product": generated(lambda a: math.log((2 - a) / a), lambda t: 2 / (1 + math.exp(t))),
    "hamacher-product": generated(lambda a: (1 - a) / a, lambda t: 1 / (1 + t)),
}
OR = {
    "sum": lambda a, b: a + b,
    "max": lambda a, b: a if a > b else b,
    "bounded-sum": lambda a, b: a + b if a + b < 1 else 1.0,
    "algebraic-sum": lambda a, b: 1 - AND["product"](1 - a, 1 - b),
    "einstein-sum": lambda a, b: 1 - AND["einstein-product"](1 - a, 1 - b),
    "hamacher-sum": lambda a, b: 1 - AND["hamacher-product"](1 - a, 1 - b),
}


def test_every_norm_has_an_oracle():
    assert set(AND) == set(T_NORMS)
    assert set(OR) == set(S_NORMS)


@pytest.mark.parametrize("name", [*T_NORMS, *S_NORMS])
def test_norms_are_those_of_their_generators(name):
    norm, oracle = ({**T_NORMS, **S_NORMS}[name], {**AND, **OR}[name])
    grades = [0.0, 1e-100, 1e-9, 0.1, 0.25, 0.5, 0.7, 1.0 - 1e-9, 1.0 - 2**-53, 1.0]
    for a in grades:
        for b in grades:
            value = float(norm.values(np.float64(a), np.float64(b)))
            assert 0.0 <= value <= (2.0 if name == "sum" else 1.0)
            assert value == pytest.approx(oracle(a, b), rel=1e-6, abs=1e-12), (a, b)
            scalar = eval(norm.expression("a", "b"), {"min": min, "max": max, "a": a, "b": b})
            assert scalar == value


def slow(rules, output, point):
    """The centroid of one output at a point, rule by rule and point by point of the grid."""
    operators, own = rules.operators, rules.operators_of(output)
    values = dict(zip(rules.input_names, point, strict=True))

    def grade(name, term):
        variable = rules.input(name)
        x = min(max(values[name], variable.universe.low), variable.universe.high)
        return float(variable.sets[variable.index(term)].membership(x))

    levels = []
    for rule in rules.rules:
        strength = None
        for group in rule.groups:
            joint = None
            for name, term in group:
                g = grade(name, term)
                joint = g if joint is None else AND[operators.conjunction](joint, g)
            strength = joint if strength is None else OR[operators.alternatives](strength, joint)
        for c in rule.consequents:
            if c.output == output.name:
                levels.append((AND[own.weighing](strength, c.confidence), c.set_name))
    moment = total = 0.0
    if own.defuzzification == "weighted-centers":
        clipped = [min(max(values[v.name], v.universe.low), v.universe.high) for v in rules.inputs]
        for fuzzy_set in output.sets:
            *slopes, y = fuzzy_set.parameters
            y += sum(a * x for a, x in zip(slopes, clipped, strict=True)) if slopes else 0.0
            joined = 0.0
            for level, term in levels:
                if term == fuzzy_set.name:
                    joined = OR[own.disjunction](joined, level)
            moment, total = moment + joined * y, total + joined
    else:
        for y in output.universe.values.tolist():
            joined = 0.0
            for level, term in levels:
                g = float(output.sets[output.index(term)].membership(y))
                joined = OR[own.disjunction](joined, AND[own.implying](level, g))
            moment, total = moment + joined * y, total + joined
    return moment / total if total > 0 else output.default


CENTROIDS = ("centroid", "weighted-centers")


@pytest.mark.parametrize("seed", range(40))
def test_outputs_are_those_of_a_slow_evaluation(seed):
    rules = random_base(seed, defuzzifications=CENTROIDS)
    rng = random.Random(seed)
    points = [
        [rng.uniform(v.universe.low - 0.1, v.universe.high + 0.1) for v in rules.inputs]
        for _ in range(6)
    ]
    system = ft.FuzzySystem(rules)
    values = system.evaluate(np.array(points))
    infer = infer_function(system)
    for row, point in enumerate(points):
        expected = [slow(rules, output, point) for output in rules.outputs]
        found = [values[name][row] for name in rules.output_names]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7)
        np.testing.assert_allclose(infer(tuple(point)), found, rtol=0, atol=1e-11)


@pytest.mark.parametrize("seed", range(40))
def test_the_relation_is_exact_on_grid_points(seed):
    rules = random_base(seed)
    rng = random.Random(seed)
    points = np.array(
        [[rng.choice(v.universe.values.tolist()) for v in rules.inputs] for _ in range(20)]
    )
    exact = ft.FuzzySystem(rules).evaluate(points)
    relation = ft.FuzzySystem(rules, "relation").evaluate(points)
    for output in rules.outputs:
        name, step = output.name, output.universe.step
        own = rules.operators_of(output).defuzzification
        # A grade more or less by rounding moves a bisector or a maximum by whole steps.
        if own in CENTROIDS:
            np.testing.assert_allclose(relation[name], exact[name], rtol=0, atol=1e-9)
        else:
            close = np.abs(relation[name] - exact[name]) <= step * 1.001
            assert np.mean(close) > 0.9


@pytest.mark.parametrize("seed", range(60))
def test_written_as_yaml_and_read_again_it_is_equal(seed):
    rules = random_base(seed)
    text = dumps_rulebase(rules)
    assert loads_rulebase(text) == rules
    assert rulebase_as_json(loads_rulebase(text)) == rulebase_as_json(rules)


def two_rules(**options):
    x = Variable("x", Universe(0, 1, 11), (FuzzySet("a", "linzmf", (0, 1)),
                                           FuzzySet("b", "linsmf", (0, 1))))  # fmt: skip
    z = replace_name(x, "z")
    y = Variable("y", Universe(0, 4, 5), (FuzzySet("p", LINEAR, (2, 0, 1)),
                                          FuzzySet("q", LINEAR, (0, -1, 3))))  # fmt: skip
    rules = (
        Rule((("x", "a"),), (Consequent("y", "p"),), ((("z", "a"),),)),
        Rule((("x", "b"), ("z", "b")), (Consequent("y", "q", 0.5),)),
    )
    return RuleBase(
        "two", (x, z), (y,), rules, Operators("min", "max", "weighted-centers", **options)
    )


def replace_name(variable, name):
    return Variable(name, variable.universe, variable.sets)


def test_by_hand():
    # At x = 0.25 and z = 0.5: p is 1.5 at max(0.75, 0.5), q is 2.5 at min(min(0.25, 0.5), 0.5).
    value = ft.FuzzySystem(two_rules())(x=0.25, z=0.5)["y"]
    assert value == pytest.approx((0.75 * 1.5 + 0.25 * 2.5) / 1.0, abs=1e-15)
    # Weighted by the product q is at 0.125; the algebraic sum of 0.75 and 0.5 is 0.875.
    other = two_rules(weighting="product", alternatives="algebraic-sum")
    value = ft.FuzzySystem(other)(x=0.25, z=0.5)["y"]
    assert value == pytest.approx((0.875 * 1.5 + 0.125 * 2.5) / 1.0, abs=1e-15)


def summed(conjunction, disjunction, **options):
    """One rule, if x is a or z is a then y is p, another if x is b; alternatives are summed."""
    x = Variable("x", Universe(0, 1, 11), (FuzzySet("a", "linzmf", (0, 1)),
                                           FuzzySet("b", "linsmf", (0, 1))))  # fmt: skip
    z = replace_name(x, "z")
    y = Variable("y", Universe(0, 4, 5), (FuzzySet("p", "trimf", (0, 1, 3)),
                                          FuzzySet("q", "trimf", (1, 3, 4))))  # fmt: skip
    rules = (
        Rule((("x", "a"),), (Consequent("y", "p"),), ((("z", "a"),),)),
        Rule((("x", "b"),), (Consequent("y", "q"),)),
    )
    operators = Operators(conjunction, disjunction, "centroid", alternatives="sum", **options)
    return RuleBase("summed", (x, z), (y,), rules, operators)


@pytest.mark.parametrize(
    ("disjunction", "due"),
    # On the grid from 0 to 4: p is 0, 1, 1/2, 0, 0 and q is 0, 0, 1/2, 1, 0; strengths 1.5, 0.25.
    [("sum", (1.5 * 1 + 0.875 * 2 + 0.25 * 3) / 2.625), ("max", (1.5 + 0.75 * 2 + 0.75) / 2.5)],
)
def test_a_sum_of_alternatives_may_exceed_1(disjunction, due):
    system = ft.FuzzySystem(summed("product", disjunction))
    assert system.explain(x=0.25, z=0.25)[0].strength == 1.5
    assert system(x=0.25, z=0.25)["y"] == pytest.approx(due, abs=1e-15)
    assert infer_function(system)((0.25, 0.25))[0] == pytest.approx(due, abs=1e-15)


@pytest.mark.parametrize("algebra", [
    ("min", "sum", {}), ("einstein-product", "sum", {}), ("product", "algebraic-sum", {}),
    ("product", "bounded-sum", {}), ("product", "sum", {"implication": "hamacher-product"}),
    ("product", "max", {"weighting": "min"}),
])  # fmt: skip
def test_norms_that_are_for_grades_do_not_take_sums_of_alternatives(algebra):
    conjunction, disjunction, options = algebra
    with pytest.raises(RuleBaseError, match=r"alternatives 'sum'.* y has others; .*bounded-sum"):
        summed(conjunction, disjunction, **options)


def test_alternatives_close_holes_and_explain():
    rules = two_rules()
    assert find_hole(rules, "y") is None
    (first, second) = ft.FuzzySystem(rules).explain(x=0.25, z=0.5)
    assert str(first) == "0.7500  if x is a or z is a then y is p"
    assert second.strength == 0.25
    assert rulebase_as_json(rules)["rules"][0]["or"] == [{"z": "a"}]


def test_renaming_reaches_alternatives():
    text = dumps_rulebase(two_rules())
    changed = loads_rulebase(rename_set(text, "z", "a", "zero"))
    assert str(changed.rules[0]) == "if x is a or z is zero then y is p"


def test_linear_sets_belong_to_outputs_with_weighted_centers():
    rules = two_rules()
    (x, z), (y,) = rules.inputs, rules.outputs
    with pytest.raises(RuleBaseError, match="linear sets need weighted-centers"):
        RuleBase("b", (x, z), (y,), rules.rules, Operators("min", "max", "centroid"))
    with pytest.raises(RuleBaseError, match="'p' of y: linear takes a coefficient for each"):
        RuleBase("b", (x,), (y,), (Rule((("x", "a"),), (Consequent("y", "p"),)),),
                 rules.operators)  # fmt: skip
    with pytest.raises(RuleBaseError, match="input 'y'"):
        RuleBase("b", (y,), (x,), (Rule((("y", "p"),), (Consequent("x", "a"),)),))
    hedged = Variable("y", y.universe, (FuzzySet("p", "not trimf", (0, 1, 2)),))
    with pytest.raises(RuleBaseError, match="not trimf has no center"):
        RuleBase("b", (x,), (hedged,), (Rule((("x", "a"),), (Consequent("y", "p"),)),),
                 rules.operators)  # fmt: skip


def test_wide_inputs_need_one_of_the_four_algebras():
    wide = Fuzzification("gaussian", 0.5)
    base = random_base(3, alternatives=False, linear=False)
    rules = RuleBase(
        "b", base.inputs, (base.outputs[0],),
        tuple(Rule(r.conditions, r.consequents[:1]) for r in base.rules),
        Operators("einstein-product", "max", base.operators.defuzzification),
    )  # fmt: skip
    with pytest.raises(ValueError, match="product or min for and"):
        ft.FuzzySystem(rules, fuzzification=Fuzzification("gaussian", 2.0))
    assert wide.shape == "gaussian"


@pytest.mark.parametrize(
    ("word", "allowed"),
    [("and", "einstein-product"), ("implication", "min"), ("alternatives", "algebraic-sum")],
)
def test_unknown_operators_are_named(word, allowed):
    names = {"and": "conjunction"}
    with pytest.raises(RuleBaseError, match=f"unknown {word} 'bad'.*{allowed}"):
        Operators(**{names.get(word, word): "bad"})


def test_the_table_is_near_the_exact_values():
    rules = two_rules()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = ft.FuzzySystem(rules, "table")
    points = np.random.default_rng(1).uniform(0, 1, (50, 2))
    gap = np.abs(table.evaluate(points)["y"] - ft.FuzzySystem(rules).evaluate(points)["y"])
    assert gap.max() <= table.table_bounds["y"]


def test_what_adds_products():
    assert ft.load_rulebase("stiffness-damping").adds_products
    assert not ft.load_rulebase("tipper").adds_products
    base = ft.load_rulebase("chan-style")
    assert base.adds_products
    first = base.rules[0]
    other = Rule(first.conditions, first.consequents, (base.rules[-1].conditions,))
    assert not replace(base, rules=(other, *base.rules[1:]), layout=None).adds_products
    own = replace(base.outputs[0], operators=replace(base.operators, disjunction="max"))
    assert not replace(base, outputs=(own, *base.outputs[1:])).adds_products
