"""Tables at break points are exact, and the numbers of C are what is measured."""

import re

import numpy as np
import pytest
from c99_bases import COMPILERS, TYPES, built, partition_base, straight_bases
from hypothesis import given, settings

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.fuzzy.rulebase import Consequent
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.interop.c99.error_bound import error_bound
from fuzzytrack.interop.c99.export import export_c
from fuzzytrack.interop.c99.float_lookup import float_lookup
from fuzzytrack.interop.c99.grid_table import GridTable, breakpoint_table, even_table
from fuzzytrack.interop.c99.number_types import number_type
from fuzzytrack.interop.c99.q15_lookup import q15_lookup, q15_place, q15_value
from fuzzytrack.interop.c99.vectors import library_values, vectors

compiled = pytest.mark.skipif(not COMPILERS, reason="needs gcc or clang")


def random_rows(rules, number, count, seed=5):
    """Inputs over the universes, and for floating-point numbers a little beyond."""
    kind, random = number_type(number), np.random.default_rng(seed)
    columns = [kind.random(v.universe, count, random) for v in rules.inputs]
    rows = np.stack(columns, axis=1)
    if not kind.whole:
        rows[::50] = rows[::50] * kind.dtype(1.5)
    return rows


@pytest.mark.parametrize("name", shipped_rulebases())
def test_where_ramps_are_found_a_table_without_totals_is_exact(name):
    rules = ft.load_rulebase(name)
    if find_ramps(rules) is not None:
        assert breakpoint_table(rules).totals == {}


@given(straight_bases())
def test_the_table_at_break_points_is_the_library(rules):
    table = breakpoint_table(rules)
    assert table is not None
    assert table.exact
    random = np.random.default_rng(1)
    points = np.stack([random.uniform(-1.5, 1.9, 300) for _ in rules.inputs], axis=1)
    points[::3] = np.round(points[::3] * 4 - 0.8) / 4 + 0.2  # the corners of the sets
    points[0, 0] = np.nan
    expected = ft.FuzzySystem(rules).evaluate(points)
    defaults = {v.name: np.nan if v.default is None else v.default for v in rules.outputs}
    lookup = float_lookup(table, defaults, np.float64)
    found = lookup(points)
    whole = GridTable(table.nodes, table.totals, {}, exact=True)
    totals = float_lookup(whole, defaults, np.float64)(points)
    for name, values in found.items():
        # At the edge of a hole, rounding decides whether a rule fires.
        total = totals.get(name, np.ones(len(points)))
        known = ~(total < 1e-12)
        known[np.arange(len(points)) % 3 != 0] |= (total == 0)[np.arange(len(points)) % 3 != 0]
        assert known.any()
        np.testing.assert_allclose(values[known], expected[name][known], rtol=0, atol=1e-12)


def test_three_inputs():
    rules = partition_base(3)
    table = breakpoint_table(rules)
    points = random_rows(rules, "double", 400)
    found = float_lookup(table, {"y": np.nan}, np.float64)(points)["y"]
    expected = ft.FuzzySystem(rules).evaluate(points)["y"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def changed(rules, sets):
    first = rules.inputs[0]
    inputs = (type(first)(first.name, first.universe, tuple(sets)), *rules.inputs[1:])
    return type(rules)(rules.name, inputs, rules.outputs, rules.rules, rules.operators)


@pytest.mark.parametrize(
    ("shape", "parameters"),
    [
        ("trapmf", (0.1, 0.1, 0.45, 2.0)),  # rises at once
        ("trimf", (-0.35, 0.45, 0.45)),  # falls at once
        ("trimf", (2.0, 2.0, 3.0)),  # a single point of the universe
        ("gaussmf", (0.1, 0.3)),
        ("singleton", (0.1,)),
    ],
)
def test_jumps_and_curves_have_no_exact_table(shape, parameters):
    rules = partition_base(1)
    sets = list(rules.inputs[0].sets)
    sets[2] = FuzzySet("s2", shape, parameters)
    assert breakpoint_table(rules) is not None
    assert breakpoint_table(changed(rules, sets)) is None


def test_other_algebras_and_tables_that_are_too_large_are_not_exact():
    rules = partition_base(1)
    for words in (("min", "sum", "centroid"), ("product", "sum", "mom")):
        operators = type(rules.operators)(*words)
        other = type(rules)("other", rules.inputs, rules.outputs, rules.rules, operators)
        assert breakpoint_table(other) is None
    sets = tuple(FuzzySet(f"s{k}", "trimf", (k - 1, k, k + 1)) for k in range(300))
    first = rules.inputs[0]
    universe = type(first.universe)(0, 299, 300)
    inputs = tuple(type(first)(name, universe, sets) for name in "ab")
    rule = type(rules.rules[0])((("a", "s1"),), rules.rules[0].consequents)
    large = type(rules)("large", inputs, rules.outputs, (rule,), rules.operators)
    assert breakpoint_table(large) is None


def test_a_table_has_no_gaps():
    rules = partition_base(1)
    sets = list(rules.inputs[0].sets)
    sets[2] = FuzzySet("s2", "gaussmf", (0.1, 0.3))
    whole = changed(rules, sets)
    gaps = type(whole)("gaps", whole.inputs, whole.outputs, whole.rules[:1], whole.operators)
    with pytest.raises(RuleBaseError, match=r"gaps: no rule about y fires at a=-0\.3.*gaps"):
        export_c(gaps, number="q15", random=10)


def test_flat_ends_are_left_out_of_a_table():
    table = breakpoint_table(ft.load_rulebase("stiffness-damping"))
    assert [nodes.tolist() for nodes in table.nodes] == [[-0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6]] * 2


def test_an_approximate_table_is_the_library_at_its_nodes():
    system = ft.FuzzySystem("tipper")
    table = even_table(system, 9)
    nodes = np.stack([a.ravel() for a in np.meshgrid(*table.nodes, indexing="ij")], axis=1)
    found = float_lookup(table, {"tip": np.nan}, np.float64)(nodes)["tip"]
    np.testing.assert_allclose(found, system.evaluate(nodes)["tip"], rtol=1e-14)
    # The corners of the sets are nodes too.
    assert {1.0, 3.0, 7.0, 9.0} <= set(table.nodes[1].tolist())


@pytest.mark.parametrize("nodes", [1, 300])
def test_the_number_of_nodes_is_limited(nodes):
    with pytest.raises(ValueError, match=f"nodes: {nodes} on each of 2 inputs; at least 2"):
        even_table(ft.FuzzySystem("tipper"), nodes)


def test_integers_of_16_bits_reach_both_ends():
    universe = ft.load_rulebase("valve").inputs[0].universe
    ends = np.array([-32768, 0, 32767])
    assert q15_value(ends, universe).tolist() == [0.0, 1.5, 3.0 - 3.0 / 65_536]
    assert q15_place(q15_value(ends, universe), universe).tolist() == ends.tolist()


def test_break_points_that_integers_cannot_tell_apart_are_refused():
    rules = partition_base(1)
    near = 0.1 + 3e-8 * 3.0
    sets = [
        FuzzySet("s0", "trapmf", (-2, -2, 0.1, near)),
        FuzzySet("s1", "trapmf", (0.1, near, 3, 3)),
    ]
    kept = tuple(r for r in rules.rules if r.conditions[0][1] in ("s0", "s1"))
    first = rules.inputs[0]
    narrow = type(rules)(
        "narrow", (type(first)("a", first.universe, tuple(sets)),), rules.outputs, kept,
        rules.operators,
    )  # fmt: skip
    assert len(breakpoint_table(narrow).nodes[0]) == 2
    with pytest.raises(ValueError, match=r"number: the break points 0\.1 and 0\.1\d+ of an input"):
        export_c(narrow, number="q15", random=10)


def test_numbers_that_are_too_large_for_floats_are_refused():
    whole = partition_base(1)
    first = whole.inputs[0]
    small = tuple(
        FuzzySet(s.name, s.shape, tuple(p * 1e-45 for p in s.parameters)) for s in first.sets
    )
    universe = type(first.universe)(-1e-45, 2e-45, 31)
    inputs = (type(first)("a", universe, small),)
    tiny = type(whole)("tiny", inputs, whole.outputs, whole.rules, whole.operators)
    assert export_c(tiny, random=10).figures["errors"]["y"]["bound"] < 1e-14
    with pytest.raises(ValueError, match="number: break points are too close, or outputs too larg"):
        export_c(tiny, number="float", random=10)


def test_no_rule_may_be_silent_with_integers():
    whole = partition_base()
    holes = type(whole)("holes", whole.inputs, whole.outputs, whole.rules[1:], whole.operators)
    with pytest.raises(RuleBaseError, match=r"holes: .* and integers have no NaN: add a rule, or"):
        export_c(holes, number="q15", random=10)
    made = export_c(holes, random=100)
    assert np.isfinite(made.figures["errors"]["y"]["bound"])
    assert "y: 0.1 to 1.3; NaN where no rule fires" in made.header


# -------------------------------------------------------------------- what C computes


@compiled
@pytest.mark.parametrize("number", list(TYPES))
@pytest.mark.parametrize("name", shipped_rulebases())
def test_c_computes_what_was_measured_to_the_bit(name, number, tmp_path):
    made = export_c(name, number=number, table=True, random=100)
    system = ft.FuzzySystem(name)
    rows = np.concatenate(
        [random_rows(system.rules, number, 10_000), vectors(system, number_type(number)).inputs]
    )
    found = built(made, tmp_path)(rows)
    np.testing.assert_array_equal(found, lookup_of(system.rules, number, rows))


@compiled
@pytest.mark.parametrize("number", list(TYPES))
def test_c_of_three_inputs_computes_what_was_measured(number, tmp_path):
    rules = partition_base(3)
    rows = random_rows(rules, number, 2_000)
    found = built(export_c(rules, number=number, random=100), tmp_path)(rows)
    np.testing.assert_array_equal(found, lookup_of(rules, number, rows))


def lookup_of(rules, number, rows):
    table = breakpoint_table(rules) or even_table(ft.FuzzySystem(rules), 65)
    defaults = {v.name: np.nan if v.default is None else v.default for v in rules.outputs}
    if number == "q15":
        universes = {v.name: v.universe for v in rules.outputs}
        inputs = tuple(v.universe for v in rules.inputs)
        lookup = q15_lookup(table, inputs, universes, defaults)
    else:
        lookup = float_lookup(table, defaults, TYPES[number])
    return np.stack(list(lookup(rows).values()), axis=1)


@compiled
@settings(max_examples=5)
@given(straight_bases(defaults=(True,)))
def test_c_of_any_rule_base_is_within_its_bound(tmp_path_factory, rules):
    for number in TYPES:
        made = export_c(rules, number=number, random=2_000)
        evaluate = built(made, tmp_path_factory.mktemp("c"))
        rows = random_rows(rules, number, 1_000, seed=9)
        system = ft.FuzzySystem(rules)
        apart = np.abs(evaluate(rows) - library_values(system, number_type(number), rows))
        for k, v in enumerate(rules.outputs):
            bound = np.full(len(rows), made.figures["errors"][v.name]["bound"])
            if number == "q15" and v.name in (totals := breakpoint_table(rules).totals):
                share = strengths(rules, totals[v.name], rows)
                # An output that jumps is as steep as the strength is small.
                bound = np.maximum(bound, len(rules.inputs) / np.maximum(share, 1e-9))
            assert (apart[:, k] <= bound).all()


def strengths(rules, total, rows):
    """Total strength of the rules at numbers of 16 bits, as a part of its largest value."""
    places = [q15_value(rows[:, k], v.universe) for k, v in enumerate(rules.inputs)]
    table = GridTable(breakpoint_table(rules).nodes, {"s": total}, {}, exact=True)
    return float_lookup(table, {}, np.float64)(np.stack(places, axis=1))["s"]


def with_a_hole(n_inputs):
    """Rules that leave two neighboring cells out: between them an output has its default."""
    whole = partition_base(n_inputs)
    (output,) = whole.outputs
    silent = Variable("y", output.universe, output.sets, default=1.2)
    holes = {("s2",) * n_inputs, (*("s2",) * (n_inputs - 1), "s3")}
    kept = tuple(r for r in whole.rules if tuple(w for _, w in r.conditions) not in holes)
    return type(whole)("holes", whole.inputs, (silent,), kept, whole.operators)


def beside_the_hole(rules, random):
    """Inputs of 16 bits within three steps of a node of every input."""
    kind, nodes = number_type("q15"), breakpoint_table(rules).nodes
    columns = [
        random.choice(kind.given(axis, v.universe), 20_000) + random.integers(-3, 4, 20_000)
        for axis, v in zip(nodes, rules.inputs, strict=True)
    ]
    return np.clip(np.stack(columns, axis=1), -32_768, 32_767)


@pytest.mark.parametrize("n_inputs", [1, 2, 3])
def test_integers_beside_a_hole_are_never_beyond_their_neighbors(n_inputs):
    rules = with_a_hole(n_inputs)
    universe = rules.outputs[0].universe
    rows = beside_the_hole(rules, np.random.default_rng(6))
    found = lookup_of(rules, "q15", rows)[:, 0]
    table = breakpoint_table(rules)
    fires = table.totals["y"] > 0
    values = np.where(fires, table.moments["y"], np.nan) / np.where(fires, table.totals["y"], 1)
    values = q15_place(values, universe)
    places = [q15_value(rows[:, k], v.universe) for k, v in enumerate(rules.inputs)]
    cells = [
        np.clip(np.searchsorted(axis, x, "right") - 1, 0, len(axis) - 2)
        for axis, x in zip(table.nodes, places, strict=True)
    ]
    corners = np.stack(
        [values[tuple(c + s for c, s in zip(cells, step, strict=True))]
         for step in np.ndindex(*[2] * n_inputs)]
    )  # fmt: skip
    low = np.fmin.reduce(corners, axis=0, initial=np.inf) - 2
    high = np.fmax.reduce(corners, axis=0, initial=-np.inf) + 2
    default = np.rint(q15_place(np.array(1.2), universe))
    at_default = found == default
    assert ((found >= low) & (found <= high) | at_default).all()
    # The default is there where no rule fires, or a share is less than half of a part in 65,536.
    strength = strengths(rules, table.totals["y"], rows)
    assert (strength[at_default & ((found < low) | (found > high))] < 2.0**-16).all()
    assert at_default[strength == 0].all()


def test_a_single_input_beside_a_hole_errs_by_roundings_only():
    figures = export_c(with_a_hole(1), number="q15").figures
    assert figures["random_inputs"] == "all"
    assert figures["errors"]["y"]["largest"] < 3.0


@compiled
@pytest.mark.parametrize("n_inputs", [2, 3])
def test_c_beside_a_hole_computes_what_was_measured(n_inputs, tmp_path):
    rules = with_a_hole(n_inputs)
    made = export_c(rules, number="q15", random=100)
    rows = np.concatenate(
        [beside_the_hole(rules, np.random.default_rng(7)), random_rows(rules, "q15", 10_000)]
    )
    found = built(made, tmp_path)(rows)
    np.testing.assert_array_equal(found, lookup_of(rules, "q15", rows))
    assert made.figures["operations"] == operations(made.header)
    assert "is never beyond its values at these corners" in " ".join(made.header.split("\n * "))


def test_integers_that_cannot_tell_whether_a_rule_fires_are_refused():
    shape = (2, 2, 2, 2)
    universe = ft.load_rulebase("valve").inputs[0].universe
    table = GridTable(
        (np.array([universe.low, universe.high]),) * 4,
        {"y": np.eye(16)[0].reshape(shape)}, {"y": np.eye(16)[0].reshape(shape)}, exact=True,
    )  # fmt: skip
    with pytest.raises(ValueError, match="number: there are inputs at which no rule about y fires"):
        q15_lookup(table, (universe,) * 4, {"y": universe}, {"y": 0.0})
    rules = with_a_hole(2)
    faint = tuple(
        type(r)(r.conditions, tuple(Consequent("y", c.set_name, 1e-6) for c in r.consequents))
        if r is rules.rules[0] else r
        for r in rules.rules
    )  # fmt: skip
    faint = type(rules)("faint", rules.inputs, rules.outputs, faint, rules.operators)
    with pytest.raises(ValueError, match=r"number: at a break point rules about y fire at less"):
        export_c(faint, number="q15", random=10)


def exact_names():
    return [n for n in shipped_rulebases() if breakpoint_table(ft.load_rulebase(n)) is not None]


@compiled
@pytest.mark.parametrize("name", exact_names())
def test_floats_are_within_four_units_in_the_last_place(name, tmp_path):
    system = ft.FuzzySystem(name)
    rows = random_rows(system.rules, "float", 10_000, seed=11)
    evaluate = built(export_c(name, number="float", random=100), tmp_path)
    expected = library_values(system, number_type("float"), rows).astype(np.float32)
    ulps = np.abs(evaluate(rows).view(np.int32) - expected.view(np.int32))
    assert ulps.max() <= 4


def test_near_zero_floats_are_as_precise_as_elsewhere():
    """The output runs from 0 to 0 through 1, so that its relative error shows every digit lost."""
    rules = ft.load_rulebase("stiffness-damping-wide")
    table = breakpoint_table(rules)
    lookup = float_lookup(table, {}, np.float32)
    corner = np.float32(-0.6)
    steps = np.array([0, 1, 2, 5, 20, 300], np.float32) * np.spacing(np.float32(0.6))
    rows = np.stack([corner + steps, np.zeros(6, np.float32)], axis=1)
    found = lookup(rows)["damping"]
    expected = ft.FuzzySystem(rules).evaluate(rows.astype(float))["damping"]
    np.testing.assert_allclose(found, expected, rtol=4 * 2**-23)


def test_the_bound_is_infinite_where_a_program_has_no_value():
    system = ft.FuzzySystem("valve")
    kind = number_type("double")
    checked = vectors(system, kind)
    bound = error_bound(
        system, kind, lambda rows: np.full((len(rows), 1), np.nan), checked, random=10
    )
    assert bound.largest.tolist() == [np.inf]


def test_a_single_input_of_16_bits_is_tried_at_all_its_values():
    figures = export_c("omega-schedule", number="q15").figures
    assert figures["random_inputs"] == "all"
    error = figures["errors"]["stiffness"]
    assert error["bound"] == error["largest"]


# -------------------------------------------------------------------- operations


def operations(text):
    """Operators in the functions of a header, loops and calls of the helper counted as they run."""
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    helpers = re.findall(r"(_between|_weighed)\([^)]*\)\n{(.*?)\n}", code, re.DOTALL)
    body = re.search(r"_infer\([^)]*\)\n{(.*)\n}", code, re.DOTALL)[1]
    body = re.sub(r"static const[^;]*;", "", body)
    counts = dict.fromkeys(
        ("additions", "multiplications", "divisions", "comparisons", "shifts"), 0
    )

    def count(part, times):
        part = re.sub(r"\((?:u?int\d+_t|float|double)\)|\bu?int\d+_t\b", "", part)
        for kind, pattern in (
            ("shifts", r"<<|>>"), ("comparisons", r"<=|>=|==|(?<![<>])[<>](?![<>=])"),
            ("additions", r"\+\+|(?<!\+)\+(?!\+)|-"), ("multiplications", r"\*"),
            ("divisions", r"/"),
        ):  # fmt: skip
            counts[kind] += times * len(re.findall(pattern, part))

    # Of a choice, one side is computed.
    for name, helper in helpers:
        count(helper.partition(" : ")[0], len(re.findall(rf"{name}\(", body)))
    for loop in re.findall(r"for \(.*?\n    }\n", body, re.DOTALL):
        turns = int(re.search(r"k < (\d+)U", loop)[1]) - 1
        body = body.replace(loop, "", 1)
        head, _, inside = loop.partition("\n")
        count(inside, turns)
        count(head, turns)
        counts["comparisons"] += 1  # the one that ends it
    count(body, 1)
    return counts


@pytest.mark.parametrize("number", list(TYPES))
@pytest.mark.parametrize("name", ["stiffness-damping-cog", "valve", "tipper", "maneuver-two-rules"])
def test_operations_are_those_of_the_text(name, number):
    made = export_c(name, number=number, table=True, random=10)
    assert made.figures["operations"] == operations(made.header)


def test_bytes_of_constants_are_those_of_the_arrays():
    sizes = {"float": 4, "uint16_t": 2, "uint32_t": 4}
    for number in ("float", "q15"):
        made = export_c("stiffness-damping", number=number, random=10)
        arrays = re.findall(r"static const (\w+) \w+\[(\d+)\] = {([^}]*)}", made.header)
        assert all(len(body.split(",")) == int(count) for _, count, body in arrays)
        total = sum(sizes[c_type] * int(count) for c_type, count, _ in arrays)
        assert made.figures["rom_bytes"] == total
