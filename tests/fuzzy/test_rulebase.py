import pickle

import numpy as np
import pytest
from builders import asymmetric_base, is_set, rule, triangles
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.variable import Universe, Variable

X = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
Y = Variable("y", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
OUT = Variable("out", Universe(0, 1, 11), triangles("st", (0.0, 1.0)))
RULE = rule({"x": "a", "y": "b"}, is_set("out", "s"))


def base(rules=(RULE,), inputs=(X, Y), outputs=(OUT,)):
    return RuleBase("small", inputs, outputs, rules)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("and",), ("and", "'and'", "product, min")),
        (("min", "probor"), ("or", "'probor'", "sum, max")),
        (
            ("min", "max", "cog"),
            ("defuzzification", "'cog'", "centroid, bisector, mom, som, lom, weighted-centers"),
        ),
    ],
)
def test_operator_errors(arguments, words):
    with pytest.raises(RuleBaseError) as error:
        Operators(*arguments)
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize("confidence", [-0.01, 1.01, float("nan")])
def test_confidence_errors(confidence):
    with pytest.raises(RuleBaseError, match=rf"confidence .*\[0, 1\], got {confidence}"):
        Consequent("out", "s", confidence)


def test_rule_errors():
    with pytest.raises(RuleBaseError, match="at least one condition"):
        Rule((), (is_set("out", "s"),))
    with pytest.raises(RuleBaseError, match="at least one consequent"):
        Rule((("x", "a"),), ())
    with pytest.raises(RuleBaseError, match="names an input twice: x, x"):
        Rule((("x", "a"), ("x", "b")), (is_set("out", "s"),))
    with pytest.raises(RuleBaseError, match=r"consequent twice: if x is a then out is s, out is s"):
        rule({"x": "a"}, is_set("out", "s"), is_set("out", "s", 0.5))


def test_a_rule_reads_as_it_is_written():
    text = str(rule({"x": "a", "y": "b"}, is_set("out", "s", 0.25), is_set("out", "t")))
    assert text == "if x is a and y is b then out is s @ 0.25, out is t"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rules": ()}, ("1 to 10000 rules", "got 0")),
        ({"inputs": ()}, ("1 to 8 inputs",)),
        ({"outputs": ()}, ("1 output or more",)),
        ({"inputs": (X, X)}, ("two variables of one name", "'x'")),
        ({"inputs": (X, Y, OUT)}, ("two variables of one name", "'out'")),
        ({"rules": (rule({"z": "a"}, is_set("out", "s")),)}, ("input 'z'", "x, y")),
        ({"rules": (rule({"x": "c"}, is_set("out", "s")),)}, ("x has no set 'c'", "a, b")),
        ({"rules": (rule({"x": "a"}, is_set("in", "s")),)}, ("output 'in'", "out")),
        ({"rules": (rule({"x": "a"}, is_set("out", "u")),)}, ("out has no set 'u'", "s, t")),
        (
            {"rules": (RULE, rule({"y": "b", "x": "a"}, is_set("out", "t")))},
            (
                "two rules with the same conditions: if y is b and x is a then out is t",
                "if x is a and y is b",
            ),
        ),
        (
            {"outputs": (OUT, Variable("unused", OUT.universe, OUT.sets))},
            ("no rule concludes", "'unused'"),
        ),
    ],
)
def test_rule_base_errors(change, words):
    with pytest.raises(RuleBaseError) as error:
        base(**change)
    for word in words:
        assert word in str(error.value)


def test_too_many_inputs_or_rules():
    inputs = [Variable(f"x{k}", X.universe, X.sets) for k in range(9)]
    with pytest.raises(RuleBaseError, match="1 to 8 inputs"):
        base((rule({"x0": "a"}, is_set("out", "s")),), inputs)
    with pytest.raises(RuleBaseError, match="got 10001"):
        base((RULE,) * 10_001)


def test_names_and_look_up():
    small = base()
    assert small.input_names == ("x", "y")
    assert small.output_names == ("out",)
    assert small.input("y") is Y
    assert small.output("out") is OUT
    with pytest.raises(RuleBaseError, match="unknown input 'out'; one of x, y"):
        small.input("out")
    with pytest.raises(RuleBaseError, match="unknown output 'x'; one of out"):
        small.output("x")


def test_rule_bases_are_values():
    assert asymmetric_base() == asymmetric_base()
    assert asymmetric_base() != asymmetric_base(seed=8)
    assert hash(asymmetric_base()) == hash(asymmetric_base())
    assert pickle.loads(pickle.dumps(asymmetric_base())) == asymmetric_base()


def test_error_says_where_and_can_be_pickled():
    error = RuleBaseError("unknown word", Location("rules.yaml", 12, 3))
    assert str(error) == "rules.yaml:12:3: unknown word"
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.location, copy.message) == (
        str(error),
        error.location,
        "unknown word",
    )


def uncovered(*sets, low=0.0, high=10.0, points=11):
    variable = Variable("x", Universe(low, high, points), sets)
    rules = (rule({"x": sets[0].name}, is_set("out", "s")),)
    return list(RuleBase("r", (variable,), (OUT,), rules).uncovered("x"))


def test_a_partition_leaves_nothing_uncovered():
    assert uncovered(*triangles("abc", (0.0, 3.3, 10.0))) == []
    assert list(asymmetric_base().uncovered("e")) == []
    assert list(asymmetric_base().uncovered("d")) == []


def test_uncovered_stretches_between_and_beyond_sets():
    stretches = uncovered(
        FuzzySet("a", "trimf", (1.25, 2.0, 3.0)), FuzzySet("b", "trimf", (4.7, 6.0, 8.5))
    )
    assert stretches == [(0.0, 1.25), (3.0, 4.7), (8.5, 10.0)]


def test_a_single_point_between_two_feet_is_uncovered():
    assert uncovered(
        FuzzySet("a", "trimf", (-1.0, 0.0, 3.3)), FuzzySet("b", "trimf", (3.3, 9.0, 12.0))
    ) == [(3.3, 3.3)]


def test_a_gap_narrower_than_the_grid_is_found():
    assert uncovered(
        FuzzySet("a", "trapmf", (-1.0, 0.0, 4.2, 4.3)),
        FuzzySet("b", "trapmf", (4.4, 4.5, 10.0, 11.0)),
    ) == [(4.3, pytest.approx(4.4))]


def test_uncovered_names_the_inputs():
    with pytest.raises(RuleBaseError, match="unknown input 'q'; one of x, y"):
        list(base().uncovered("q"))


numbers = st.integers(-2, 12).map(float)


@given(
    st.lists(
        st.one_of(
            st.tuples(numbers, numbers, numbers).map(sorted).map(lambda p: ("trimf", tuple(p))),
            st.tuples(numbers, numbers).map(sorted).map(lambda p: ("smf", tuple(p))),
            st.tuples(numbers, numbers).map(sorted).map(lambda p: ("zmf", tuple(p))),
            st.tuples(numbers).map(lambda p: ("singleton", p)),
        ),
        min_size=1,
        max_size=5,
    )
)
def test_uncovered_is_where_every_grade_is_zero(shapes):
    sets = [FuzzySet(str(k), *s) for k, s in enumerate(shapes)]
    variable = Variable("x", Universe(0, 10, 11), sets)
    stretches = list(variable.uncovered())
    assert all(0 <= low <= high <= 10 for low, high in stretches)
    assert stretches == sorted(stretches)
    x = np.arange(0, 10.25, 0.25)
    bare = variable.memberships(x).max(axis=0) == 0
    for point, nothing in zip(x, bare, strict=True):
        if nothing:
            assert any(low <= point <= high for low, high in stretches)
        else:
            assert not any(low < point < high for low, high in stretches)
            assert (point, point) not in stretches


def test_uncovered_by_some_of_the_sets():
    variable = Variable("x", Universe(0, 1, 11), triangles("abc", (0.0, 0.5, 1.0)))
    assert list(variable.uncovered()) == []
    assert list(variable.uncovered({"a", "b"})) == [(1.0, 1.0)]
    assert list(variable.uncovered(["c"])) == [(0.0, 0.5)]
    assert list(variable.uncovered([])) == [(0.0, 1.0)]


# ------------------------------------------------------------ order and tables


def test_rules_are_kept_in_the_order_of_the_variables():
    other = Variable("other", OUT.universe, OUT.sets)
    mixed = (
        rule({"y": "b", "x": "a"}, is_set("other", "t"), is_set("out", "t"), is_set("out", "s")),
    )
    ordered = (
        rule({"x": "a", "y": "b"}, is_set("out", "s"), is_set("out", "t"), is_set("other", "t")),
    )
    assert base(mixed, outputs=(OUT, other)).rules == ordered
    assert base(mixed, outputs=(OUT, other)) == base(ordered, outputs=(OUT, other))


def cells(*pairs):
    """Rules ``x is i and y is j -> out is s`` in the given order."""
    return tuple(rule({"x": i, "y": j}, is_set("out", "s")) for i, j in pairs)


def test_a_table_is_kept_row_by_row():
    layout = TableLayout("x", "y", ("out",))
    table = RuleBase("t", (X, Y), (OUT,), cells("bb", "ab", "ba", "aa"), layout=layout)
    assert table.rules == cells("aa", "ba", "ab", "bb")
    across = RuleBase(
        "t", (X, Y), (OUT,), cells("bb", "ab", "ba", "aa"), layout=TableLayout("y", "x", ("out",))
    )
    assert across.rules == cells("aa", "ab", "ba", "bb")


@pytest.mark.parametrize(
    ("layout", "inputs", "rules", "message"),
    [
        (("x", "y"), (X, Y), cells("aa", "ab", "bb"), "no cell for y a, x b"),
        (("x", "x"), (X, Y), cells("aa"), "exactly two inputs.*there are x, y"),
        (("x", "q"), (X, Y), cells("aa"), "unknown input 'q'"),
        (
            ("x", "y"),
            (X, Y),
            (*cells("aa", "ab", "ba", "bb"), rule({"x": "a"}, is_set("out", "t"))),
            "no cell of the table: if x is a then out is t",
        ),
    ],
)
def test_table_errors(layout, inputs, rules, message):
    with pytest.raises(RuleBaseError, match=message):
        RuleBase("t", inputs, (OUT,), rules, layout=TableLayout(*layout, ("out",)))


def test_cells_name_every_output():
    with pytest.raises(RuleBaseError, match="every output once: out"):
        RuleBase(
            "t",
            (X, Y),
            (OUT,),
            cells("aa", "ab", "ba", "bb"),
            layout=TableLayout("x", "y", ("out", "out")),
        )


def test_too_many_outputs():
    outputs = [Variable(f"out{k}", OUT.universe, OUT.sets) for k in range(17)]
    rules = (rule({"x": "a"}, *(is_set(v.name, "s") for v in outputs)),)
    with pytest.raises(RuleBaseError, match="up to 16 outputs"):
        base(rules, outputs=outputs)
