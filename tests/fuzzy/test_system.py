import itertools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from builders import (
    ALGEBRAS,
    FOUR,
    SEVEN,
    asymmetric_base,
    is_set,
    random_points,
    rule,
    table_base,
    tipper,
    triangles,
    whole_triangles,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator

from fuzzytrack.errors import NoRuleFiresWarning, RuleBaseError
from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import DEFUZZIFICATIONS, Operators
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import METHODS, FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable

TABLE = np.random.default_rng(5).integers(0, 4, (7, 7))


def seven_by_seven(output, defuzzification):
    e = Variable("e", Universe(-1, 1, 41), triangles(SEVEN, (-1.0, -0.4, -0.1, 0.0, 0.2, 0.5, 1.0)))
    d = Variable("d", Universe(-2, 3, 41), triangles(SEVEN, np.linspace(-2, 3, 7) ** 3 / 9))
    d = replace(d, universe=Universe(d.sets[0].parameters[1], d.sets[-1].parameters[1], 41))
    return table_base(TABLE, e, d, output, Operators("product", "sum", defuzzification))


# ------------------------------------------------------------ closed forms


@pytest.mark.parametrize("path", ["weighted-centers", "centroid"])
def test_product_and_sum_on_a_partition_is_bilinear_interpolation(path):
    if path == "centroid":
        # Whole triangles symmetric on the grid: every set has one area and its peak for centroid.
        output = Variable("w", Universe(-0.5, 2.0, 501), whole_triangles(FOUR, 0.0, 1.5))
        levels = np.array([0.0, 0.5, 1.0, 1.5])
    else:
        levels = np.array([0.1, 0.35, 0.8, 1.3])
        output = Variable("w", Universe(0.1, 1.3, 11), triangles(FOUR, levels))
    base = seven_by_seven(output, path)
    nodes = [[s.center(v.universe.low, v.universe.high) for s in v.sets] for v in base.inputs]
    assert not np.array_equal(TABLE, TABLE.T)
    interpolate = RegularGridInterpolator(nodes, levels[TABLE])
    points = random_points(base, 2000)
    np.testing.assert_allclose(
        FuzzySystem(base)(**points)["w"],
        interpolate(np.stack([points["e"], points["d"]], axis=-1)),
        rtol=0,
        atol=1e-12,
    )


@pytest.mark.parametrize(("conjunction", "disjunction"), [("product", "sum"), ("min", "sum")])
def test_weighted_centers_are_the_weights_of_eq_3_13(conjunction, disjunction):
    base = asymmetric_base(conjunction, disjunction, "weighted-centers")
    points = random_points(base, 300)
    answer = FuzzySystem(base)(**points)
    grades = {v.name: v.memberships(points[v.name]) for v in base.inputs}
    together = np.prod if conjunction == "product" else np.min
    for output in base.outputs:
        total, weighted = 0.0, 0.0
        for r in base.rules:
            strength = together(
                [grades[n][base.input(n).index(term)] for n, term in r.conditions], axis=0
            )
            for c in r.consequents:
                if c.output == output.name:
                    center = output.centers()[output.index(c.set_name)]
                    level = together([strength, np.full(300, c.confidence)], axis=0)
                    total = total + level
                    weighted = weighted + level * center
        np.testing.assert_allclose(answer[output.name], weighted / total, rtol=0, atol=1e-12)


@pytest.mark.parametrize("algebra", ALGEBRAS)
@pytest.mark.parametrize("shape", ["trimf", "gaussmf"])
def test_many_rules_at_many_points_are_those_at_one_point_after_another(algebra, shape):
    def sets(names, low, high):
        peaks = whole_triangles(names, low, high)
        if shape == "trimf":
            return peaks
        step = (high - low) / len(names)
        return tuple(FuzzySet(s.name, "gaussmf", (s.parameters[1], step)) for s in peaks)

    names = [f"s{k}" for k in range(9)]
    e = Variable("e", Universe(-1, 1, 41), sets(names, -1.0, 1.0))
    d = Variable("d", Universe(-2, 3, 41), sets(names, -2.0, 3.0))
    output = Variable("out", Universe(0, 1, 51), triangles(FOUR, (0.0, 0.2, 0.5, 1.0)))
    table = np.random.default_rng(6).integers(0, 4, (9, 9))
    base = table_base(table, e, d, output, Operators(*algebra))
    points = np.stack(list(random_points(base, 5_000).values()), axis=1)
    system = FuzzySystem(base)
    answer, silent = system.evaluate(points)["out"], system.is_silent(points)
    infer = infer_function(system)
    for row in [0, 4_095, 4_096, *range(7, 5_000, 211)]:
        assert answer[row] == pytest.approx(infer(tuple(points[row].tolist()))[0], rel=0, abs=1e-12)
        assert not silent[row]


def test_points_at_which_no_rule_fires_are_silent():
    base = asymmetric_base()
    rules = tuple(r for r in base.rules[:49] if dict(r.conditions)["e"] != "nl")
    points = np.stack(list(random_points(base, 5_000).values()), axis=1)
    # nl alone is above 0 where nm begins, and below.
    alone = points[:, 0] <= base.input("e").sets[1].parameters[0]
    assert alone.any()
    silent = FuzzySystem(replace(base, rules=rules, layout=None)).is_silent(points)
    np.testing.assert_array_equal(silent, alone)


def test_identity_of_centroid_and_weights():
    """y = Σ μᵢ cᵢⱼ Aⱼ ȳⱼ / Σ μᵢ cᵢⱼ Aⱼ for product, sum and centroid, whatever the sets."""
    base = asymmetric_base()
    points = random_points(base, 300)
    system = FuzzySystem(base)
    strength = system.strengths(np.stack([points["e"], points["d"]], axis=-1))
    for output in base.outputs:
        y, grades = output.universe.values, output.memberships()
        area, middle = grades.sum(axis=1), grades @ y / grades.sum(axis=1)
        total, weighted = 0.0, 0.0
        for k, r in enumerate(base.rules):
            for c in r.consequents:
                if c.output == output.name:
                    j = output.index(c.set_name)
                    total = total + strength[:, k] * c.confidence * area[j]
                    weighted = weighted + strength[:, k] * c.confidence * area[j] * middle[j]
        np.testing.assert_allclose(
            system(**points)[output.name], weighted / total, rtol=0, atol=1e-12
        )


@pytest.mark.parametrize(
    ("conjunction", "disjunction", "expected"),
    [
        # Strengths at x = 0.4 are 0.6, 0.4 and 0.25 for sets at 0, 0 and 1.
        ("product", "sum", 0.25 / (0.6 + 0.4 + 0.25)),
        ("min", "sum", 0.25 / (0.6 + 0.4 + 0.25)),
        ("product", "max", 0.25 / (0.6 + 0.25)),
        ("min", "max", 0.25 / (0.6 + 0.25)),
    ],
)
def test_rules_with_one_consequent_do_not_overwrite_each_other(conjunction, disjunction, expected):
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    z = Variable("z", Universe(0, 1, 11), (FuzzySet("on", "trapmf", (0, 0, 1, 1)),))
    out = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)))
    rules = [
        rule({"x": "a"}, is_set("out", "s")),
        rule({"z": "on"}, is_set("out", "t", 0.25)),
        rule({"x": "b"}, is_set("out", "s")),
    ]
    for order in itertools.permutations(rules):
        base = RuleBase(
            "r", (x, z), (out,), order, Operators(conjunction, disjunction, "weighted-centers")
        )
        assert FuzzySystem(base)(x=0.4, z=0.5)["out"] == pytest.approx(expected, abs=1e-15)


# ------------------------------------------------------------ calling


@pytest.mark.parametrize("method", METHODS)
def test_scalars_give_floats_and_arrays_broadcast(method):
    base = asymmetric_base()
    system = FuzzySystem(base, method, table_nodes=21)
    for scalar in (system(e=0.3, d=1.0), system(e=np.array(0.3), d=np.float32(1.0))):
        assert all(type(v) is float for v in scalar.values())
    assert list(system(d=1.0, e=0.3)) == ["w", "z"]
    e, d = np.linspace(-1, 1, 5), np.linspace(-2, 3, 3)
    grid = system(e=e[:, None], d=d)
    for name in base.output_names:
        assert grid[name].shape == (5, 3)
        for i, j in itertools.product(range(5), range(3)):
            one = system(e=float(e[i]), d=float(d[j]))[name]
            assert grid[name][i, j] == pytest.approx(one, abs=1e-14)
    assert system(e=[0.3], d=1)["w"].shape == (1,)
    assert system(e=[], d=0.0)["w"].shape == (0,)
    assert system(e=np.empty((3, 0, 2)), d=0.0)["w"].shape == (3, 0, 2)


@pytest.mark.parametrize("method", METHODS)
def test_nan_in_nan_out_without_a_warning(method):
    system = FuzzySystem(asymmetric_base(), method, table_nodes=21)
    answer = system(e=[0.1, np.nan, 0.2, 0.3], d=[0.0, 0.0, np.nan, 1.0])
    for values in answer.values():
        np.testing.assert_array_equal(np.isnan(values), [False, True, True, False])
    assert np.isnan(system(e=np.nan, d=0.0)["w"])


@pytest.mark.parametrize("method", METHODS)
def test_inputs_outside_are_taken_at_the_end(method):
    system = FuzzySystem(asymmetric_base(), method, table_nodes=21)
    assert system(e=7.0, d=-np.inf) == system(e=1.0, d=-2.0)


def test_more_points_than_a_chunk():
    base = asymmetric_base("min", "max")
    points = random_points(base, 10_000)
    points["e"][::97] = np.nan
    system = FuzzySystem(base)
    whole = system(**points)
    for part in np.array_split(np.arange(10_000), 7):
        some = system(**{n: x[part] for n, x in points.items()})
        for name, values in some.items():
            np.testing.assert_allclose(values, whole[name][part], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("inputs", "got"),
    [({}, "none"), ({"e": 1.0}, "e"), ({"e": 1.0, "d": 1.0, "f": 1.0}, "e, d, f")],
)
def test_wrong_inputs_are_named(inputs, got):
    with pytest.raises(TypeError, match=rf"^inputs: expected e, d; got {got}$"):
        FuzzySystem(asymmetric_base())(**inputs)


def test_unknown_method_is_named():
    with pytest.raises(ValueError, match="unknown 'fast'; one of exact, relation, table"):
        FuzzySystem(asymmetric_base(), "fast")


def test_width_of_fuzzy_inputs_is_checked_when_built():
    with pytest.raises(ValueError, match=r"width of d must be .* got None"):
        FuzzySystem(asymmetric_base(), fuzzification=Fuzzification("gaussian", {"e": 0.2}))


def test_repr_names_the_rule_base_and_the_method():
    shown = repr(FuzzySystem(asymmetric_base(), "relation"))
    assert shown.startswith('FuzzySystem(<RuleBase "asymmetric": ')
    assert shown.endswith(' rules>, method="relation")')


# ------------------------------------------------------------ nothing fires


def corner_base(default=None):
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 0.4)))
    y = Variable("y", Universe(0, 1, 11), triangles("ab", (0.0, 0.5)))
    out = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)), default=default)
    always = Variable("always", Universe(0, 1, 11), triangles("st", (0.0, 1.0)))
    rules = (
        rule({"x": "a"}, is_set("out", "s"), is_set("always", "s")),
        rule({"y": "b", "x": "b"}, is_set("out", "t"), is_set("always", "t")),
    )
    rules += (rule({"x": "b"}, is_set("always", "s")),)
    return RuleBase("corner", (x, y), (out, always), rules)


@pytest.mark.parametrize("method", ["exact", "relation"])
def test_where_nothing_fires_it_says_so(method):
    system = FuzzySystem(corner_base(), method)
    with pytest.warns(NoRuleFiresWarning) as caught:
        answer = system(x=[0.4, 0.2, 0.4, np.nan], y=[0.0, 0.0, 0.7, 0.0])
    np.testing.assert_array_equal(np.isnan(answer["out"]), [True, False, True, True])
    np.testing.assert_array_equal(np.isnan(answer["always"]), [False, False, False, True])
    (warning,) = caught
    text = str(warning.message)
    assert "corner: no rule about out fires at x=0.4, y=0 and at 1 more points: NaN" in text
    assert warning.filename == __file__


def test_the_default_is_used_where_nothing_fires():
    answer = FuzzySystem(corner_base(default=0.3))(x=[0.4, 0.2, np.nan], y=0.0)
    assert answer["out"][0] == 0.3
    assert answer["out"][1] == FuzzySystem(corner_base())(x=0.2, y=0.0)["out"]
    assert np.isnan(answer["out"][2])


def test_evaluate_gives_no_warning():
    answer = FuzzySystem(corner_base()).evaluate(np.array([[0.4, 0.0]]))
    assert np.isnan(answer["out"][0])
    assert not np.isnan(answer["always"][0])


# ------------------------------------------------------------ explain


def test_explain_sorts_the_rules_that_fire():
    base = tipper(101, "ends")
    fired = FuzzySystem(base).explain(service=4.0, food=7.5)
    strengths = {
        1: np.exp(-(4.0**2) / 4.5),
        3: np.exp(-1 / 4.5),
        4: np.exp(-36 / 4.5),
        5: 0.25,
    }
    assert [f.number for f in fired] == sorted(strengths, key=lambda n: -strengths[n])
    for f in fired:
        assert f.strength == pytest.approx(strengths[f.number], abs=1e-15)
        assert f.rule is base.rules[f.number - 1]
    assert str(fired[0]) == "0.8007  if service is good then tip is average"


def test_explain_keeps_the_order_of_equal_strengths():
    base = corner_base()
    assert [f.number for f in FuzzySystem(base).explain(x=0.2, y=0.5)] == [1, 2, 3]
    assert [f.number for f in FuzzySystem(base).explain(x=0.2, y=0.0)] == [1, 3]


def test_explain_takes_one_point():
    system = FuzzySystem(corner_base())
    with pytest.raises(TypeError, match="one point"):
        system.explain(x=[0.1, 0.2], y=0.0)
    with pytest.raises(TypeError, match="expected x, y; got x"):
        system.explain(x=0.1)
    assert system.explain(x=np.nan, y=0.0) == []


# ------------------------------------------------------------ surface


def test_surface_is_indexed_by_x_then_y():
    base = asymmetric_base()
    system = FuzzySystem(base)
    surface = system.surface("z", 9)
    assert (surface.x_name, surface.y_name, surface.output) == ("e", "d", "z")
    assert surface.values.shape == (9, 9)
    np.testing.assert_array_equal(surface.x, np.linspace(-1, 1, 9))
    np.testing.assert_array_equal(surface.y, np.linspace(-2, 3, 9))
    for i, j in itertools.product(range(9), range(9)):
        value = system(e=surface.x[i], d=surface.y[j])["z"]
        assert surface.values[i, j] == pytest.approx(value, abs=1e-14)
    assert np.abs(surface.values - surface.values.T).max() > 0.1
    swapped = system.surface("z", 9, inputs=("d", "e"))
    assert (swapped.x_name, swapped.y_name) == ("d", "e")
    np.testing.assert_allclose(swapped.values, surface.values.T, rtol=0, atol=1e-14)


def three_inputs():
    inputs = tuple(Variable(n, Universe(0, 1, 11), triangles("ab", (0.0, 1.0))) for n in "xyz")
    out = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)))
    rules = (
        rule({"x": "a", "y": "b"}, is_set("out", "s")),
        rule({"z": "b", "x": "b"}, is_set("out", "t")),
        rule({"y": "a"}, is_set("out", "s", 0.5)),
    )
    return FuzzySystem(RuleBase("three", inputs, (out,), rules))


def test_surface_at_a_value_of_the_other_inputs():
    system = three_inputs()
    surface = system.surface("out", 5, inputs=("z", "x"), at={"y": 0.25})
    for i, j in itertools.product(range(5), range(5)):
        value = system(z=surface.x[i], x=surface.y[j], y=0.25)["out"]
        assert surface.values[i, j] == pytest.approx(value, abs=1e-14)
    assert np.abs(surface.values - system.surface("out", 5, at={"z": 0.5}).values).max() > 0.01


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "at must give z; got nothing"),
        ({"at": {"y": 0.5}}, "at must give z; got y"),
        ({"at": {"z": 0.5, "x": 0.5}}, "at must give z; got z, x"),
        ({"inputs": ("x", "x")}, "two different inputs"),
        ({"inputs": ("x",)}, "two different inputs"),
        ({"inputs": ("x", "q")}, "unknown input 'q'; one of x, y, z"),
        ({"points": 1, "at": {"z": 0.5}}, "points must be at least 2, got 1"),
        ({"output": "speed"}, "unknown output 'speed'; one of out"),
    ],
)
def test_surface_errors(arguments, message):
    with pytest.raises(ValueError, match=message):
        three_inputs().surface(**{"output": "out", **arguments})


def test_a_surface_needs_two_inputs():
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    out = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)))
    base = RuleBase("line", (x,), (out,), (rule({"x": "a"}, is_set("out", "s")),))
    with pytest.raises(ValueError, match="surface: line has one input; a surface needs two"):
        FuzzySystem(base).surface("out")


def test_unknown_output_of_the_relation():
    with pytest.raises(RuleBaseError, match="unknown output 'q'; one of w, z"):
        FuzzySystem(asymmetric_base()).relation("q")


# ------------------------------------------------------------ properties

algebras = st.sampled_from(ALGEBRAS)
defuzzifications = st.sampled_from(DEFUZZIFICATIONS)
unit = st.floats(0, 1)


@st.composite
def bases(draw):
    """Random 3x4 bases, not complete, with confidences; and a point."""
    x = Variable("x", Universe(0, 1, 11), triangles("abc", (0.0, draw(st.floats(0.1, 0.9)), 1.0)))
    y = Variable(
        "y", Universe(0, 1, 9), triangles("abcd", (0.0, 0.2, draw(st.floats(0.3, 0.9)), 1))
    )
    points = draw(st.integers(2, 30))
    out = Variable("out", Universe(-0.35, 0.25, points), triangles(FOUR, (-0.35, -0.2, 0.1, 0.25)))
    cells = draw(
        st.lists(
            st.tuples(st.sampled_from("abc"), st.sampled_from("abcd")), min_size=1, unique=True
        )
    )
    rules = tuple(
        rule(
            {"x": i, "y": j},
            is_set("out", draw(st.sampled_from(FOUR)), draw(st.sampled_from([0.0, 0.3, 0.7, 1.0]))),
        )
        for i, j in cells
    )
    operators = Operators(*draw(algebras), draw(defuzzifications))
    return RuleBase("random", (x, y), (out,), rules, operators)


def value(base, x, y):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NoRuleFiresWarning)
        return FuzzySystem(base)(x=x, y=y)["out"]


@given(bases(), unit, unit)
def test_an_output_is_inside_its_universe_or_no_rule_fires(base, x, y):
    answer = value(base, x, y)
    if np.isnan(answer):
        # A grid of a few points can miss a whole set, and the smallest floats vanish in products.
        fired = FuzzySystem(base).explain(x=x, y=y)
        heard = [f for f in fired if f.strength * f.rule.consequents[0].confidence > 1e-300]
        assert not heard or base.outputs[0].universe.points < 5
    else:
        assert -0.35 - 1e-15 <= answer <= 0.25 + 1e-15


@given(bases(), unit, unit, st.randoms(use_true_random=False))
def test_the_order_of_the_rules_does_not_matter(base, x, y, random):
    rules = list(base.rules)
    random.shuffle(rules)
    assert value(replace(base, rules=tuple(rules)), x, y) == pytest.approx(
        value(base, x, y), rel=0, abs=1e-12, nan_ok=True
    )


@given(bases(), unit, unit)
@settings(max_examples=60)
def test_a_rule_of_confidence_zero_is_no_rule(base, x, y):
    present = tuple(r for r in base.rules if r.consequents[0].confidence > 0)
    if present:
        without = value(replace(base, rules=present), x, y)
        assert value(base, x, y) == pytest.approx(without, rel=0, abs=1e-12, nan_ok=True)
    else:
        assert np.isnan(value(base, x, y))


@given(bases(), unit, unit)
@settings(max_examples=60)
def test_a_default_replaces_nan_only(base, x, y):
    output = replace(base.outputs[0], default=0.125)
    without = value(base, x, y)
    expected = 0.125 if np.isnan(without) else without
    assert value(replace(base, outputs=(output,)), x, y) == expected


# ------------------------------------------------------------------ singletons between grid points


def spikes(places, defuzzification="centroid", algebra=("product", "sum"), points=11):
    """Two sets of an input; each rule concludes a spike of its own."""
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    sets = tuple(FuzzySet(w, "singleton", (p,)) for w, p in zip("st", places, strict=True))
    out = Variable("out", Universe(0, 10, points), sets)
    rules = (rule({"x": "a"}, is_set("out", "s")), rule({"x": "b"}, is_set("out", "t")))
    return RuleBase("spikes", (x,), (out,), rules, Operators(*algebra, defuzzification))


@settings(max_examples=100)
@given(
    st.tuples(st.floats(0, 10), st.floats(0, 10)).map(sorted),
    st.floats(0, 1),
    st.sampled_from(ALGEBRAS),
    st.integers(2, 12),
)
def test_the_centroid_of_singletons_does_not_depend_on_the_grid(places, x, algebra, points):
    base = spikes(places, algebra=algebra, points=points)
    expected = (1 - x) * places[0] + x * places[1]
    if places[0] == places[1]:
        expected = places[0]
    # Up to 1e-9 steps away, a place is on a grid point.
    assert FuzzySystem(base)(x=x)["out"] == pytest.approx(expected, abs=1e-7)
    (scalar,) = infer_function(FuzzySystem(base))((x,))
    assert scalar == pytest.approx(expected, abs=1e-7)


def test_singletons_between_grid_points_keep_their_place_with_every_method():
    places = (3.21, 7.77)
    for method in ("centroid", "bisector", "mom", "som", "lom"):
        for name in ("exact", "relation"):
            system = FuzzySystem(spikes(places, method), name)
            assert system(x=0.0)["out"] == 3.21
            assert system(x=1.0)["out"] == 7.77
    assert FuzzySystem(spikes(places, "som"))(x=0.5)["out"] == 3.21
    assert FuzzySystem(spikes(places, "mom"))(x=0.5)["out"] == pytest.approx(5.49)


def test_other_sets_are_summed_over_the_grid_alone():
    base = spikes((3.21, 7.77))
    triangle = FuzzySet("s", "trimf", (0.0, 3.0, 4.0))
    mixed = replace(
        base, outputs=(replace(base.outputs[0], sets=(triangle, *base.outputs[0].sets[1:])),)
    )
    y = base.outputs[0].universe.values
    weights = triangle.membership(y)
    assert FuzzySystem(mixed)(x=0.0)["out"] == pytest.approx(weights @ y / weights.sum())
    # A spike weighs 1, as the peak of the triangle does on its point of the grid.
    expected = (weights @ y + 7.77) / (weights.sum() + 1)
    assert FuzzySystem(mixed)(x=0.5)["out"] == pytest.approx(expected)
