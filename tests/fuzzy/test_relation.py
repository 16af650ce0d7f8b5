"""The report's relational matrix, the exact path, and independent loops against each other."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import skfuzzy
from builders import ALGEBRAS, asymmetric_base, is_set, random_points, rule, triangles

from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import DEFUZZIFICATIONS, Operators
from fuzzytrack.fuzzy.relation import MAX_ELEMENTS, compose, relation
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable

FACTORIZING = [a for a in ALGEBRAS if a != ("min", "sum")]
FUZZY_INPUTS = [
    Fuzzification("gaussian", {"x": 0.4, "y": 1.3}),
    Fuzzification("triangular", {"x": 0.9, "y": 2.1}),
]


def tiny_base(conjunction="product", disjunction="sum", defuzzification="centroid"):
    """Two inputs, two outputs, few points, one rule that names one input only, confidences."""
    x = Variable("x", Universe(0, 2, 6), triangles("pq", (0.3, 1.8)))
    y = Variable("y", Universe(-1, 4, 5, "midpoints"), triangles("rst", (-1.0, 1.5, 4.0)))
    u = Variable("u", Universe(0, 1, 4), triangles("lmh", (0.0, 0.4, 1.0)))
    v = Variable("v", Universe(-5, 5, 3), triangles("lh", (-5.0, 5.0)))
    rules = (
        rule({"x": "p", "y": "r"}, is_set("u", "l"), is_set("v", "h", 0.6)),
        rule({"x": "p", "y": "s"}, is_set("u", "m", 0.25), is_set("u", "h", 0.75)),
        rule({"y": "t", "x": "q"}, is_set("u", "l", 0.9)),
        rule({"x": "q", "y": "s"}, is_set("v", "l")),
        rule({"y": "s"}, is_set("v", "h", 0.5), is_set("u", "h", 0.5)),
    )
    operators = Operators(conjunction, disjunction, defuzzification)
    return RuleBase("tiny", (x, y), (u, v), rules, operators)


# ------------------------------------------------------------ oracle: Eqs. 3.3 to 3.10 in loops


def triangle(point, parameters):
    a, b, c = parameters
    if point == b:
        return 1.0
    if point <= a or point >= c:
        return 0.0
    return (point - a) / (b - a) if point < b else (c - point) / (c - b)


def grid(universe):
    n = universe.points
    if universe.grid == "ends":
        return [universe.low + k * (universe.high - universe.low) / (n - 1) for k in range(n)]
    return [universe.low + (k + 0.5) * (universe.high - universe.low) / n for k in range(n)]


class Oracle:
    def __init__(self, base):
        self.base = base
        product = base.operators.conjunction == "product"
        self.conjoin = (lambda a, b: a * b) if product else min
        plain_sum = base.operators.disjunction == "sum"
        self.disjoin = (lambda a, b: a + b) if plain_sum else max

    def grade(self, variable, name, point):
        return triangle(point, variable.sets[variable.set_names.index(name)].parameters)

    def relation(self, output, point, y):
        """Eqs. 3.3 to 3.5 at one point and one output value."""
        total = 0.0
        for r in self.base.rules:
            for consequent in r.consequents:
                if consequent.output != output.name:
                    continue
                member = self.conjoin(
                    self.grade(output, consequent.set_name, y), consequent.confidence
                )
                for name, term in r.conditions:
                    member = self.conjoin(
                        member, self.grade(self.base.input(name), term, point[name])
                    )
                total = self.disjoin(total, member)
        return total

    def composed(self, output, fuzzy_inputs, y):
        """Eq. 3.8 with the base's own AND and OR, over the whole input grid."""
        names = self.base.input_names
        grids = [grid(v.universe) for v in self.base.inputs]
        total = 0.0
        for cell in itertools.product(*(range(len(g)) for g in grids)):
            member = self.relation(
                output, {n: g[k] for n, g, k in zip(names, grids, cell, strict=True)}, y
            )
            for name, k in zip(names, cell, strict=True):
                member = self.conjoin(member, fuzzy_inputs[name][k])
            total = self.disjoin(total, member)
        return total

    def centroid(self, output, membership):
        """Eq. 3.10."""
        ys = grid(output.universe)
        grades = [membership(y) for y in ys]
        total = sum(grades)
        if total == 0:
            return np.nan
        return sum(y * g for y, g in zip(ys, grades, strict=True)) / total


@pytest.mark.parametrize(("conjunction", "disjunction"), ALGEBRAS)
def test_exact_is_the_definition(conjunction, disjunction):
    base = tiny_base(conjunction, disjunction)
    oracle, system = Oracle(base), FuzzySystem(base)
    points = np.array(list(itertools.product((0.0, 0.31, 0.77, 1.8, 2.0), (-1.0, -0.2, 1.5, 2.9))))
    answer = system.evaluate(points)
    for output in base.outputs:
        # NaN where no rule fires, as at x = 0
        expected = [
            oracle.centroid(
                output, lambda v, o=output, p={"x": x, "y": y}: oracle.relation(o, p, v)
            )
            for x, y in points.tolist()
        ]
        assert 0 < np.isnan(expected).sum() < len(points)
        np.testing.assert_allclose(answer[output.name], expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("conjunction", "disjunction"), ALGEBRAS)
def test_relation_is_the_definition(conjunction, disjunction):
    base = tiny_base(conjunction, disjunction)
    oracle, system = Oracle(base), FuzzySystem(base)
    xs, ys = (grid(v.universe) for v in base.inputs)
    for output in base.outputs:
        expected = [
            [
                [oracle.relation(output, {"x": x, "y": y}, z) for z in grid(output.universe)]
                for y in ys
            ]
            for x in xs
        ]
        assert system.relation(output.name).shape == (6, 5, output.universe.points)
        np.testing.assert_allclose(system.relation(output.name), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("conjunction", "disjunction", "method"),
    [(*a, "relation") for a in ALGEBRAS] + [(*a, "exact") for a in FACTORIZING],
)
@pytest.mark.parametrize("fuzzification", FUZZY_INPUTS, ids=lambda f: f.shape)
def test_fuzzy_inputs_are_composed_by_definition(conjunction, disjunction, fuzzification, method):
    base = tiny_base(conjunction, disjunction)
    oracle, system = Oracle(base), FuzzySystem(base, method, fuzzification=fuzzification)
    for x, y in ((0.0, -1.0), (0.9, 1.37), (1.93, 3.2)):
        spread = {}
        for variable, point in zip(base.inputs, (x, y), strict=True):
            width = fuzzification.width[variable.name]
            away = [abs(g - point) / width for g in grid(variable.universe)]
            if fuzzification.shape == "gaussian":
                spread[variable.name] = [np.exp(-d * d / 2) for d in away]
            else:
                spread[variable.name] = [max(0.0, 1 - d) for d in away]
        answer = system(x=x, y=y)
        for output in base.outputs:
            expected = oracle.centroid(
                output, lambda v, o=output, s=spread: oracle.composed(o, s, v)
            )
            assert answer[output.name] == pytest.approx(expected, rel=1e-12, abs=1e-12)


# ------------------------------------------------------------ exact against relation


def grid_inputs(base):
    axes = np.meshgrid(*(v.universe.values for v in base.inputs), indexing="ij")
    return dict(zip(base.input_names, axes, strict=True))


@pytest.mark.parametrize("defuzzification", DEFUZZIFICATIONS)
@pytest.mark.parametrize(("conjunction", "disjunction"), ALGEBRAS)
def test_relation_equals_exact_on_grid_points(conjunction, disjunction, defuzzification):
    base = asymmetric_base(conjunction, disjunction, defuzzification)
    points = grid_inputs(base)
    exact, literal = (FuzzySystem(base, m)(**points) for m in ("exact", "relation"))
    for output in base.outputs:
        name = output.name
        assert np.ptp(exact[name]) > 0.1 * (output.universe.high - output.universe.low)
        np.testing.assert_allclose(literal[name], exact[name], rtol=0, atol=1e-12)


def test_relation_reads_the_nearest_grid_point():
    base = asymmetric_base()
    points = random_points(base, 200)
    nearest = {
        v.name: v.universe.values[np.abs(points[v.name][:, None] - v.universe.values).argmin(1)]
        for v in base.inputs
    }
    literal = FuzzySystem(base, "relation")(**points)
    at_nearest, at_points = FuzzySystem(base)(**nearest), FuzzySystem(base)(**points)
    for name in base.output_names:
        np.testing.assert_allclose(literal[name], at_nearest[name], rtol=0, atol=1e-12)
        assert np.abs(at_nearest[name] - at_points[name]).max() > 1e-3


@pytest.mark.parametrize("fuzzification", FUZZY_INPUTS, ids=lambda f: f.shape)
@pytest.mark.parametrize(("conjunction", "disjunction"), FACTORIZING)
def test_factorized_composition_on_the_asymmetric_base(conjunction, disjunction, fuzzification):
    base = asymmetric_base(conjunction, disjunction)
    fuzzification = Fuzzification(fuzzification.shape, {"e": 0.08, "d": 0.35})
    points = random_points(base, 40)
    exact, brute, crisp = (
        FuzzySystem(base, method, fuzzification=f)(**points)
        for method, f in (("exact", fuzzification), ("relation", fuzzification), ("exact", None))
    )
    for name in base.output_names:
        np.testing.assert_allclose(exact[name], brute[name], rtol=0, atol=1e-12)
        assert np.abs(exact[name] - crisp[name]).max() > 1e-3


@pytest.mark.parametrize("method", ["exact", "table"])
def test_min_and_sum_do_not_factorize(method):
    base = asymmetric_base("min", "sum")
    with pytest.raises(ValueError, match=r"method: .*min and sum .*method='relation'"):
        FuzzySystem(base, method, fuzzification=Fuzzification("gaussian", 0.5))


def one_at_a_time(base, method="exact"):
    values = FuzzySystem(base, method, fuzzification=FUZZY_INPUTS[1]).evaluate(
        np.array([[0.8, 0.25], [1.2, 2.25], [1.6, -0.75]])
    )
    return np.stack([values["u"], values["v"]])


def alternative(base, word):
    """The same with alternatives in the first rule, and what joins them."""
    first, *others = base.rules
    either = Rule(first.conditions, first.consequents, ((("x", "q"), ("y", "t")), (("y", "s"),)))
    operators = replace(base.operators, alternatives=word)
    return replace(base, rules=(either, *others), operators=operators)


@pytest.mark.parametrize(("conjunction", "disjunction"), FACTORIZING)
def test_alternatives_factorize_where_the_or_of_the_rules_joins_them(conjunction, disjunction):
    base = tiny_base(conjunction, disjunction)
    fits = alternative(base, disjunction)
    assert np.abs(one_at_a_time(fits) - one_at_a_time(base)).max() > 1e-3
    np.testing.assert_allclose(one_at_a_time(fits), one_at_a_time(fits, "relation"), atol=1e-12)
    for word in ("max", "bounded-sum"):
        if word != disjunction:
            with pytest.raises(ValueError, match="do not factorize, nor do"):
                one_at_a_time(alternative(base, word))


@pytest.mark.parametrize(("own", "common"), [*itertools.permutations(ALGEBRAS, 2)])
def test_operators_of_an_output_that_join_otherwise_do_not_factorize(own, common):
    base = tiny_base(*common)
    outputs = tuple(replace(v, operators=Operators(*own)) for v in base.outputs)
    with pytest.raises(ValueError, match="do not factorize, nor do an and or or of an output"):
        one_at_a_time(replace(base, outputs=outputs))
    assert np.isfinite(one_at_a_time(replace(base, outputs=outputs), "relation")).all()


def test_a_narrow_fuzzy_input_on_a_grid_point_is_the_crisp_one():
    base = asymmetric_base("min", "max")
    step = {v.name: v.universe.step for v in base.inputs}
    at = {v.name: float(v.universe.values[k]) for v, k in zip(base.inputs, (9, 17), strict=True)}
    fuzzy = FuzzySystem(base, fuzzification=Fuzzification("triangular", step))(**at)
    crisp = FuzzySystem(base)(**at)
    for name, value in crisp.items():
        assert fuzzy[name] == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize(
    ("conjunction", "disjunction", "composition"),
    [("min", "max", skfuzzy.maxmin_composition), ("product", "max", skfuzzy.maxprod_composition)],
)
def test_composition_is_scikit_fuzzys(conjunction, disjunction, composition):
    x = Variable("x", Universe(0, 1, 9), triangles("ab", (0.0, 1.0)))
    out = Variable("out", Universe(0, 1, 7), triangles("st", (0.0, 1.0)))
    rules = (rule({"x": "a"}, is_set("out", "t")), rule({"x": "b"}, is_set("out", "s", 0.4)))
    base = RuleBase("one", (x,), (out,), rules, Operators(conjunction, disjunction))
    matrix = relation(base, out)
    fuzzy = np.random.default_rng(2).random(9)
    np.testing.assert_allclose(
        compose(base, matrix, [fuzzy]), composition(fuzzy[None, :], matrix)[0], atol=1e-15
    )


def test_shape_of_the_matrix_and_its_protection():
    system = FuzzySystem(asymmetric_base())
    assert system.relation("w").shape == (37, 31, 41)
    assert system.relation("z").shape == (37, 31, 53)
    assert system.relation("w") is system.relation("w")
    with pytest.raises(ValueError, match="read-only"):
        system.relation("w")[0, 0, 0] = 1.0
    assert FuzzySystem(asymmetric_base(defuzzification="weighted-centers")).relation("w").shape == (
        37,
        31,
        4,
    )


def test_a_matrix_that_would_not_fit_is_refused():
    sets = (FuzzySet("a", "gaussmf", (0.5, 0.2)),)
    inputs = tuple(Variable(n, Universe(0, 1, 1001), sets) for n in ("x", "y"))
    out = Variable("out", Universe(0, 1, 101), sets)
    base = RuleBase("large", inputs, (out,), (rule({"x": "a"}, is_set("out", "a")),))
    message = f"relation of out: 1001 x 1001 x 101 elements are more than {MAX_ELEMENTS}"
    with pytest.raises(ValueError, match=message):
        FuzzySystem(base, "relation")(x=0.5, y=0.5)
