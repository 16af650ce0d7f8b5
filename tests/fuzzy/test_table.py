import itertools
from dataclasses import replace

import numpy as np
import pytest
from builders import asymmetric_base, is_set, random_points, rule, triangles
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import interpn

from fuzzytrack.errors import NoRuleFiresWarning
from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Operators, RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.table import build_table
from fuzzytrack.fuzzy.variable import Universe, Variable


def smooth_base():
    def gaussians(names, centers, sigma):
        return tuple(
            FuzzySet(n, "gaussmf", (c, sigma)) for n, c in zip(names, centers, strict=True)
        )

    x = Variable("x", Universe(0, 1, 11), gaussians("abc", (0.1, 0.4, 0.9), 0.2))
    y = Variable("y", Universe(-3, 3, 11), gaussians("abc", (-3.0, 0.5, 2.0), 1.1))
    out = Variable("out", Universe(0, 10, 101), gaussians("lmh", (1.0, 4.0, 9.0), 1.5))
    rules = tuple(
        rule({"x": i, "y": j}, is_set("out", "lmh"[(2 * k + 1) % 3], 0.5 + k / 20))
        for k, (i, j) in enumerate(itertools.product("abc", "abc"))
    )
    return RuleBase("smooth", (x, y), (out,), rules, Operators())


def base_of_one_input():
    x = Variable("x", Universe(-1, 2, 11), triangles("abc", (-1.0, 0.3, 2.0)))
    out = Variable("out", Universe(0, 1, 51), triangles("st", (0.0, 1.0)))
    rules = tuple(rule({"x": i}, is_set("out", t)) for i, t in zip("abc", "sts", strict=True))
    return RuleBase("one", (x,), (out,), rules, Operators("min", "max"))


def base_of_three_inputs():
    inputs = tuple(
        Variable(n, Universe(0, 1, 11), triangles("ab", c, plateau=True))
        for n, c in (("x", (0.0, 1.0)), ("y", (0.2, 0.7)), ("z", (0.1, 1.0)))
    )
    out = Variable("out", Universe(0, 1, 31), triangles("stu", (0.0, 0.3, 1.0)))
    rules = tuple(
        rule(dict(zip("xyz", terms, strict=True)), is_set("out", "stu"[k * k % 3]))
        for k, terms in enumerate(itertools.product("ab", repeat=3))
    )
    return RuleBase("three", inputs, (out,), rules, Operators("product", "max"))


CASES = {
    "weighted-centers": (lambda: asymmetric_base(defuzzification="weighted-centers"), 201),
    "product-sum": (lambda: asymmetric_base("product", "sum"), 201),
    "min-max": (lambda: asymmetric_base("min", "max"), 201),
    "smooth": (smooth_base, 61),
    "one input": (base_of_one_input, 201),
    "three inputs": (base_of_three_inputs, 36),
}


@pytest.mark.parametrize("case", CASES)
def test_error_is_within_the_stated_bound(case):
    build, nodes = CASES[case]
    base = build()
    points = random_points(base, 10_000)
    table = FuzzySystem(base, "table", table_nodes=nodes)
    answer, truth = table(**points), FuzzySystem(base)(**points)
    for output in base.outputs:
        error = np.abs(answer[output.name] - truth[output.name])
        bound = table.table_bounds[output.name]
        assert error.max() <= bound
        # A bound that says something: not the whole range, and not far above the error.
        assert bound < 0.1 * (output.universe.high - output.universe.low)
        assert bound <= 10 * error.max() + 1e-12


def test_values_are_exact_at_the_nodes_and_multilinear_between():
    base = asymmetric_base()
    system = FuzzySystem(base, "table", table_nodes=23)
    axes = [np.linspace(v.universe.low, v.universe.high, 23) for v in base.inputs]
    nodes = dict(zip(base.input_names, np.meshgrid(*axes, indexing="ij"), strict=True))
    truth = FuzzySystem(base)(**nodes)
    points = random_points(base, 500)
    for name in base.output_names:
        assert not np.allclose(truth[name], truth[name].T, atol=1e-3)
        np.testing.assert_allclose(system(**nodes)[name], truth[name], rtol=0, atol=1e-13)
        expected = interpn(axes, truth[name], np.stack([points["e"], points["d"]], axis=-1))
        np.testing.assert_allclose(system(**points)[name], expected, rtol=0, atol=1e-13)
        assert system.table.values[name].shape == (23, 23)


def test_more_nodes_a_smaller_bound():
    base = smooth_base()
    coarse, fine = (
        FuzzySystem(base, "table", table_nodes=n).table_bounds["out"] for n in (26, 101)
    )
    # Bilinear interpolation of a smooth function: error of the order of the step squared.
    assert coarse / fine == pytest.approx(16, rel=0.25)


def test_a_function_that_is_multilinear_has_a_bound_of_rounding():
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    out = Variable("out", Universe(2, 5, 11), triangles("st", (2.0, 5.0)))
    rules = (rule({"x": "a"}, is_set("out", "t")), rule({"x": "b"}, is_set("out", "s")))
    base = RuleBase("line", (x,), (out,), rules, Operators("product", "sum", "weighted-centers"))
    system = FuzzySystem(base, "table", table_nodes=7)
    assert 0 < system.table_bounds["out"] < 1e-12
    assert system(x=0.25)["out"] == pytest.approx(4.25, abs=1e-13)


def test_progress_goes_to_the_whole():
    base = asymmetric_base()
    shares = []
    table = build_table(base, FuzzySystem(base).evaluate, 23, shares.append)
    assert table.bounds == FuzzySystem(base, "table", table_nodes=23).table_bounds
    assert len(shares) > 3
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_outside_and_nan_inputs():
    base = asymmetric_base()
    system = FuzzySystem(base, "table", table_nodes=11)
    assert system(e=9.0, d=-9.0) == system(e=1.0, d=-2.0)
    assert np.isnan(system(e=np.nan, d=0.0)["w"])
    assert system(e=[], d=[])["w"].shape == (0,)


def test_fuzzy_inputs_are_tabulated_too():
    base = asymmetric_base()
    fuzzy = Fuzzification("gaussian", {"e": 0.1, "d": 0.3})
    points = random_points(base, 300)
    table = FuzzySystem(base, "table", fuzzification=fuzzy, table_nodes=81)
    truth = FuzzySystem(base, fuzzification=fuzzy)(**points)
    for name in base.output_names:
        assert np.abs(table(**points)[name] - truth[name]).max() <= table.table_bounds[name]
        assert table.table_bounds[name] < 0.01


def holed_base(default=None):
    sets = (FuzzySet("a", "trimf", (0.0, 0.0, 0.4)), FuzzySet("b", "trimf", (0.6, 1.0, 1.0)))
    x = Variable("x", Universe(0, 1, 11), sets)
    out = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)), default=default)
    rules = (rule({"x": "a"}, is_set("out", "t")), rule({"x": "b"}, is_set("out", "s")))
    return RuleBase("holed", (x,), (out,), rules)


def test_no_bound_is_stated_for_a_table_with_a_hole():
    system = FuzzySystem(holed_base(), "table", table_nodes=24)
    assert system.table_bounds == {"out": np.inf}
    assert system(x=0.1)["out"] == pytest.approx(FuzzySystem(holed_base())(x=0.1)["out"])
    with pytest.warns(NoRuleFiresWarning):
        assert np.isnan(system(x=0.5)["out"])


def test_a_jump_to_the_default_is_in_the_bound():
    bound = FuzzySystem(holed_base(0.5), "table", table_nodes=24).table_bounds["out"]
    assert 0.1 < bound < 1.0


@pytest.mark.parametrize("nodes", [1, 0, 2001])
def test_number_of_nodes_is_checked(nodes):
    message = rf"table: {nodes} nodes on each of 2 inputs; at least 2 .* at most 4000000 in all"
    with pytest.raises(ValueError, match=message):
        FuzzySystem(asymmetric_base(), "table", table_nodes=nodes)


# ------------------------------------------------------------------ jumps

POINTS = st.integers(-2, 14).map(lambda k: k / 12)
FLANKS = st.sampled_from([(0, 1, 2, 3), (0, 0, 2, 3), (0, 1, 3, 3), (0, 0, 3, 3), (0, 1, 1, 3)])


@st.composite
def jumping_bases(draw):
    """Rule bases whose sets have vertical flanks, with gaps where the default holds."""
    inputs = []
    for name in "ab"[: draw(st.integers(1, 2))]:
        sets = []
        for k in range(draw(st.integers(1, 3))):
            corners = sorted(draw(st.lists(POINTS, min_size=4, max_size=4)))
            flank = draw(FLANKS)
            # Often narrower than a cell of the table, and than the probes in it.
            width = draw(st.sampled_from([1.0, 0.01]))
            near = [corners[0] + width * (c - corners[0]) for c in corners]
            sets.append(FuzzySet(f"s{k}", "trapmf", tuple(near[j] for j in flank)))
        inputs.append(Variable(name, Universe(0, 1, 11), tuple(sets)))
    rows = draw(
        st.lists(
            st.tuples(
                st.fixed_dictionaries({v.name: st.sampled_from(v.set_names) for v in inputs}),
                st.sampled_from("pqr"),
            ),
            min_size=1,
            max_size=4,
            unique_by=lambda row: frozenset(row[0].items()),
        )
    )
    out = Variable(
        "out", Universe(0, 1, 21), triangles("pqr", (0.0, 0.3, 1.0)), draw(st.floats(0, 1))
    )
    operators = Operators(
        draw(st.sampled_from(["product", "min"])),
        draw(st.sampled_from(["sum", "max"])),
        draw(st.sampled_from(["centroid", "weighted-centers", "mom", "som", "bisector"])),
    )
    rules = tuple(rule(conditions, is_set("out", term)) for conditions, term in rows)
    return RuleBase("jumps", tuple(inputs), (out,), rules, operators)


@settings(max_examples=30, deadline=None)
@given(jumping_bases(), st.integers(5, 40))
def test_the_bound_holds_on_both_sides_of_a_jump(base, nodes):
    table = FuzzySystem(base, "table", table_nodes=nodes)
    axes = []
    for variable in base.inputs:
        corners = np.array([p for s in variable.sets for p in s.breakpoints()])
        beside = np.add.outer(corners, [0.0, 1e-9, -1e-9, 1e-4, -1e-4, 1e-3, -1e-3]).ravel()
        axes.append(np.clip(np.concatenate([np.linspace(0, 1, 33), beside]), 0, 1))
    points = dict(zip(base.input_names, np.meshgrid(*axes), strict=True))
    error = np.abs(table(**points)["out"] - FuzzySystem(base)(**points)["out"])
    assert error.max() <= table.table_bounds["out"]


def test_a_narrow_gap_between_two_probes_is_in_the_bound():
    sets = (
        FuzzySet("a", "trapmf", (0.0, 0.0, 0.501, 0.501)),
        FuzzySet("b", "trapmf", (0.502, 0.502, 1.0, 1.0)),
    )
    base = replace(holed_base(0.5), inputs=(Variable("x", Universe(0, 1, 11), sets),))
    system = FuzzySystem(base, "table", table_nodes=11)
    truth = FuzzySystem(base)(x=0.5015)["out"]
    assert truth == 0.5
    assert abs(system(x=0.5015)["out"] - truth) <= system.table_bounds["out"]
    alone = FuzzySystem(replace(base, outputs=holed_base().outputs), "table", table_nodes=11)
    assert alone.table_bounds == {"out": np.inf}
