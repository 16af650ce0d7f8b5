import math
import pickle
from dataclasses import replace

import builders
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES
from fuzzytrack.fuzzy.variable import Universe, Variable


def expect_equal(system, points, tolerance=1e-12):
    infer = infer_function(system)
    expected = system.evaluate(points)
    answers = np.array([infer(tuple(point)) for point in points.tolist()])
    for k, name in enumerate(system.rules.output_names):
        np.testing.assert_allclose(answers[:, k], expected[name], rtol=0, atol=tolerance)


def points_of(rules, count=300, seed=3):
    """Random points, also a little outside of the universes, and some on the grid."""
    random = np.random.default_rng(seed)
    columns = []
    for variable in rules.inputs:
        u = variable.universe
        width = u.high - u.low
        anywhere = random.uniform(u.low - 0.1 * width, u.high + 0.1 * width, count)
        columns.append(np.concatenate([anywhere, random.choice(u.values, count // 4)]))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("algebra", builders.ALGEBRAS)
@pytest.mark.parametrize("defuzzification", ["centroid", "weighted-centers"])
def test_the_exact_function_equals_the_array_engine(algebra, defuzzification):
    rules = builders.asymmetric_base(*algebra, defuzzification)
    expect_equal(ft.FuzzySystem(rules), points_of(rules))


@pytest.mark.parametrize("defuzzification", ["centroid", "weighted-centers", "bisector", "mom"])
def test_the_relation_as_a_table_of_cells(defuzzification):
    rules = builders.asymmetric_base("min", "max", defuzzification)
    expect_equal(ft.FuzzySystem(rules, "relation"), points_of(rules), tolerance=1e-15)


@pytest.mark.parametrize("n_inputs", [1, 2, 3])
def test_the_interpolated_table(n_inputs):
    names = "abc"[:n_inputs]
    sets = builders.triangles(("low", "high"), (-1.0, 2.0))
    inputs = tuple(Variable(name, Universe(-1, 2, 7), sets) for name in names)
    output = Variable("y", Universe(0, 9, 10), builders.triangles(("p", "q", "r"), (0, 2, 9)))
    rules = tuple(
        Rule(
            tuple(zip(names, terms, strict=True)),
            (Consequent("y", "pqr"[sum(t == "high" for t in terms) % 3]),),
        )
        for terms in np.array(np.meshgrid(*[["low", "high"]] * n_inputs, indexing="ij"))
        .reshape(n_inputs, -1)
        .T.tolist()
    )
    base = RuleBase("base", inputs, (output,), rules)
    expect_equal(ft.FuzzySystem(base, "table", table_nodes=6), points_of(base))


# One example of every shape on [-1, 1]; a shape without one fails the test below.
EXAMPLES = {
    "trimf": (-0.5, 0.1, 0.9),
    "trapmf": (-1.0, -1.0, 0.2, 0.6),
    "gaussmf": (0.2, 0.3),
    "gauss2mf": (-0.2, 0.3, 0.4, 0.2),
    "gbellmf": (0.4, 2.5, 0.1),
    "sigmf": (0.1, 7.0),
    "smf": (-0.5, 0.7),
    "zmf": (-0.4, 0.3),
    "pimf": (-0.8, -0.1, 0.2, 0.9),
    "singleton": (0.25,),
    "linsmf": (-0.4, 0.3),
    "linzmf": (-0.4, 0.3),
    "dsigmf": (-0.4, 6.0, 0.3, 9.0),
    "psigmf": (-0.4, 6.0, 0.3, -9.0),
    "discrete": (-0.5, 0.25, -0.1, 0.75, 0.2, 0.5, 0.4, 1.0, 0.9, 0.125),
    "cosine": (0.1, 1.5),
    "spike": (0.1, 1.5),
    "concave": (0.5, -0.3),
    "arc": (-0.3, 0.5),
    "ellipse": (-0.3, 0.5),
    "not trimf": (-0.4, 0.1, 0.8),
    "very seldom gaussmf": (0.2, 0.3),
}


@pytest.mark.parametrize("shape", EXAMPLES)
def test_every_shape_is_written_out(shape):
    sets = (FuzzySet("always", "trapmf", (-1, -1, 1, 1)), FuzzySet("this", shape, EXAMPLES[shape]))
    x = Variable("x", Universe(-1, 1, 9), sets)
    y = Variable("y", Universe(0, 1, 5), builders.triangles(("p", "q"), (0, 1)))
    rules = (
        Rule((("x", "always"),), (Consequent("y", "p"),)),
        Rule((("x", "this"),), (Consequent("y", "q", 0.7),)),
    )
    base = RuleBase("shapes", (x,), (y,), rules)
    expect_equal(ft.FuzzySystem(base), np.array([*points_of(base).tolist(), [0.25]]))


def test_every_shape_has_an_example():
    assert set(SHAPES) - {LINEAR} <= set(EXAMPLES)


def sparse_base(default=None, count=3):
    """`count` narrow sets with gaps between them, each with a rule of its own."""
    sets = tuple(FuzzySet(f"s{k}", "trimf", (k - 0.3, k, k + 0.3)) for k in range(count))
    x = Variable("x", Universe(0, count - 1, 2 * count - 1), sets)
    y = Variable("y", Universe(0, 1, 5), builders.triangles(("p", "q"), (0, 1)), default=default)
    rules = tuple(
        Rule(((("x", s.name)),), (Consequent("y", "pq"[k % 2]),)) for k, s in enumerate(sets)
    )
    return RuleBase("sparse", (x,), (y,), rules)


def test_silence_is_nan_or_the_default():
    assert math.isnan(infer_function(ft.FuzzySystem(sparse_base()))((0.5,))[0])
    assert infer_function(ft.FuzzySystem(sparse_base(default=0.25)))((0.5,)) == (0.25,)


def test_many_rules():
    rules = sparse_base(count=400)
    expect_equal(ft.FuzzySystem(rules), points_of(rules))


def test_what_cannot_be_written_out_says_what_can():
    base = sparse_base()
    blurred = ft.Fuzzification("gaussian", 0.5)
    with pytest.raises(ValueError, match="only method='table' can be written"):
        infer_function(ft.FuzzySystem(base, fuzzification=blurred))
    bisector = replace(base, operators=Operators(defuzzification="bisector"))
    with pytest.raises(ValueError, match="for bisector use method='relation' or 'table'"):
        infer_function(ft.FuzzySystem(bisector))
    huge = replace(base.inputs[0], universe=Universe(0, 2, 1001))
    two = RuleBase("two", (huge, replace(huge, name="z")), base.outputs, base.rules, base.operators)
    with pytest.raises(ValueError, match="at most 1000000"):
        infer_function(ft.FuzzySystem(two, "relation"))


@pytest.mark.parametrize("defuzzification", ["bisector", "mom"])
def test_ramps_are_for_means_alone(defuzzification):
    # Output sets of one area, and inputs that share out every point.
    sets = builders.triangles(("low", "high"), (0.0, 1.0))
    output = tuple(FuzzySet(s, "trimf", p) for s, p in (("p", (0, 1, 2)), ("q", (4, 4.5, 6))))
    rules = RuleBase(
        name="even",
        inputs=(Variable("x", Universe(0, 1, 11), sets),),
        outputs=(Variable("y", Universe(0, 6, 61), output),),
        operators=Operators("product", "sum", "centroid"),
        rules=(
            Rule((("x", "low"),), (Consequent("y", "p"),)),
            Rule((("x", "high"),), (Consequent("y", "q"),)),
        ),
    )
    expect_equal(ft.FuzzySystem(rules), np.linspace(0, 1, 21)[:, None])
    other = replace(rules, operators=Operators("product", "sum", defuzzification))
    with pytest.raises(ValueError, match=f"for {defuzzification} use method='relation'"):
        infer_function(ft.FuzzySystem(other))


@given(st.floats(-5, 5), st.floats(-5, 5))
def test_names_of_a_rule_base_stay_out_of_the_source(x, z):
    base = sparse_base(default=0.5)
    odd = "__import__('os')"
    sets = tuple(replace(s, name=f"{odd}{k}") for k, s in enumerate(base.inputs[0].sets))
    rules = tuple(Rule(((odd, sets[k].name),), r.consequents) for k, r in enumerate(base.rules))
    renamed = RuleBase(odd, (replace(base.inputs[0], name=odd, sets=sets),), base.outputs, rules)
    infer = infer_function(ft.FuzzySystem(renamed))
    assert infer((x,)) == infer_function(ft.FuzzySystem(base))((x,))
    assert not set(infer.__code__.co_names) - {"min", "max", "exp", "nan"}


def test_systems_pickle():
    system = pickle.loads(pickle.dumps(ft.FuzzySystem(sparse_base(), "table")))
    assert system(x=1.0) == ft.FuzzySystem(sparse_base(), "table")(x=1.0)
