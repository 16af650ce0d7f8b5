"""Kinds of faults in rule bases that users of such software have reported, one property each."""

import warnings

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.gains import kalata
from fuzzytrack.schedulers.reachable_gains import certify, reachable_gains
from fuzzytrack.schedulers.review import review

#: One input x on [-1, 1] and one output u; what differs is filled in.
TEXT = """\
rulebase: 1
name: case
inputs:
  x: {{universe: [-1, 1, 21], sets: {{n: {n}, p: {p}}}}}
outputs:
  u: {{universe: [{low}, {high}, {points}], {default}sets: {{l: {l}, r: {r}}}}}
operators: {{and: {algebra[0]}, or: {algebra[1]}, defuzzification: {method}}}
rules:
  - {{if: {{x: n}}, then: {{u: l}}}}
  - {{if: {{x: p}}, then: {{u: r}}}}
"""
PLAIN = {
    "n": "{trimf: [-1, -1, 1]}",
    "p": "{trimf: [-1, 1, 1]}",
    "low": -2,
    "high": 2,
    "points": 5,
    "default": "",
    "l": "{trapmf: [-2, -2, -1, 0]}",
    "r": "{trapmf: [0, 1, 2, 2]}",
    "algebra": ("min", "max"),
    "method": "centroid",
}


def text(**changed):
    return TEXT.format(**{**PLAIN, **changed})


def quietly(system, **inputs):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ft.NoRuleFiresWarning)
        return system(**inputs)


ALGEBRAS = st.sampled_from([("min", "max"), ("product", "sum"), ("product", "max"), ("min", "sum")])


# ------------------------------------------------------------------ inputs out of range


@given(st.floats(-50, 50))
def test_an_input_out_of_range_counts_as_its_nearest_end_and_gives_no_default(x):
    gap = text(n="{trapmf: [-1, -1, -0.5, -0.2]}", p="{trapmf: [0.2, 0.5, 1, 1]}",
               default="default: 2, ")  # fmt: skip
    system = ft.FuzzySystem(loads_rulebase(gap))
    at_end = system(x=min(max(x, -1), 1))["u"]
    assert system(x=x)["u"] == at_end
    assert (at_end == 2) == (abs(x) <= 0.2)


def test_files_of_other_programs_are_read_or_named_as_such(tmp_path):
    with pytest.raises(ft.RuleBaseError, match="IEC 61131-7, which is not read"):
        ft.load_rulebase("rise.fcl")
    half = tmp_path / "rise.FIS"
    half.write_text("[System]\nName='rise'\nType='mamdani'\n[Input1]\nName='ratio'\nRange=[0 1]\n")
    with pytest.raises(ft.RuleBaseError, match=r"rise\.FIS:1:1: AndMethod is missing"):
        ft.load_rulebase(half)
    with pytest.raises(ft.RuleBaseError, match=r"cannot read rule base 'deep/rise\.FLL'"):
        ft.load_rulebase("deep/rise.FLL")


# ------------------------------------------------------------------ sparse rules

TWO = """\
rulebase: 1
name: two
inputs:
  x: {{universe: [0, 1, 11],
    sets: {{lo: {{trapmf: [0, 0, 0.1, {a}]}}, hi: {{trapmf: [{b}, 0.9, 1, 1]}}}}}}
  y: {{universe: [0, 2, 11],
    sets: {{lo: {{trapmf: [0, 0, 0.1, {c}]}}, hi: {{trapmf: [{d}, 1.9, 2, 2]}}}}}}
outputs:
  alpha: {{universe: [0.2, 0.8, 11],
    sets: {{S: {{trimf: [0.2, 0.2, 0.8]}}, L: {{trimf: [0.2, 0.8, 0.8]}}}}}}
  beta: {{universe: [0.1, 0.4, 11],
    sets: {{S: {{trimf: [0.1, 0.1, 0.4]}}, L: {{trimf: [0.1, 0.4, 0.4]}}}}}}
operators: {{and: product, or: sum, defuzzification: centroid}}
rules:
  - {{if any: {{x: lo, y: lo}}, then: {{alpha: S, beta: S}}}}
  - {{if any: {{x: hi, y: hi}}, then: {{alpha: L, beta: L}}}}
scheduler: {{normalization: chan, gains: direct}}
"""


@settings(max_examples=10, deadline=None)
@given(*[st.floats(0.15, 0.85)] * 4, st.booleans(), st.booleans())
def test_a_hole_is_named_whatever_its_size(a, b, c, d, x_touches, y_touches):
    """Between the feet no rule fires: a rectangle, a line or a point; or there is no hole."""
    a, b = (a, a) if x_touches else (a, b)
    c, d = (2 * c, 2 * c) if y_touches else (2 * c, 2 * d)
    rules = loads_rulebase(TWO.format(a=a, b=b, c=c, d=d))
    if a > b or c > d:
        ft.FuzzyScheduler(rules)
        return
    for hole in (find_hole(rules, name) for name in ("alpha", "beta")):
        assert hole.stretches == (("x", a, b), ("y", c, d))
        x, y = hole.point
        assert np.isnan(quietly(ft.FuzzySystem(rules), x=x, y=y)[hole.output])
    with pytest.raises(ft.RuleBaseError, match="no rule about alpha fires"):
        ft.FuzzyScheduler(rules)


# ------------------------------------------------------------------ maxima with negative universes


@given(
    st.floats(-1, 1), st.integers(-40, 20), st.integers(1, 30), st.integers(3, 30),
    st.sampled_from(["som", "lom", "mom", "bisector", "centroid"]), ALGEBRAS,
)  # fmt: skip
def test_defuzzification_by_hand_on_universes_of_any_sign(x, low, width, points, method, algebra):
    high = low + width
    third = width / 3
    left, right = (f"{{trapmf: [{low + k * third}, {low + k * third}, {low + (k + 1) * third}, "
            f"{low + (k + 2) * third}]}}" for k in (0, 1))  # fmt: skip
    rules = loads_rulebase(
        text(low=low, high=high, points=points, l=left, r=right, algebra=algebra, method=method)
    )
    y = np.linspace(low, high, points)
    product, total = algebra[0] == "product", algebra[1] == "sum"
    parts = []
    for k, strength in ((0, (1 - x) / 2), (1, (1 + x) / 2)):
        grades = rules.outputs[0].sets[k].membership(y)
        parts.append(strength * grades if product else np.minimum(strength, grades))
    fuzzy = parts[0] + parts[1] if total else np.maximum(*parts)
    assume(fuzzy.max() > 1e-6)
    top = y[fuzzy >= fuzzy.max() * (1 - 1e-12)]
    running = np.cumsum(fuzzy)
    expected = {
        "som": top.min(), "lom": top.max(), "mom": top.mean(),
        "bisector": y[np.argmax(running >= running[-1] / 2 * (1 - 1e-12))],
        "centroid": (fuzzy @ y) / fuzzy.sum(),
    }[method]  # fmt: skip
    # Half of the total may be met up to rounding.
    close = np.abs(running - running[-1] / 2).min() < 1e-9 * running[-1]
    assume(method != "bisector" or not close)
    assert ft.FuzzySystem(rules)(x=x)["u"] == pytest.approx(expected, abs=1e-9)


# ------------------------------------------------------------------ several rules, one conclusion

SAME = """\
rulebase: 1
name: same
inputs:
  x: {{universe: [0, 1, 11],
    sets: {{a: {{trimf: [0, 0, 1]}}, b: {{trimf: [0, 0.5, 1]}}, c: {{trimf: [0, 1, 1]}}}}}}
outputs:
  u: {{universe: [-8, 8, 161], sets: {{down: {{trimf: [-8, -4, 0]}}, up: {{trimf: [-2, 3, 8]}}}}}}
operators: {{and: {0}, or: {1}, defuzzification: centroid}}
rules:
  - {{if: {{x: a}}, then: {{u: down}}}}
  - {{if: {{x: b}}, then: {{u: down}}}}
  - {{if: {{x: c}}, then: {{u: up}}}}
"""


@given(st.floats(0, 1), ALGEBRAS)
def test_equal_conclusions_are_joined_and_none_is_lost(x, algebra):
    rules = loads_rulebase(SAME.format(*algebra))
    points = np.linspace(-8, 8, 161).tolist()
    down, up = (s.membership(points).tolist() for s in rules.outputs[0].sets)
    rows = (1 - x, down), (max(0.0, 1 - abs(x - 0.5) * 2), down), (x, up)
    moment = total = 0.0
    for k, y in enumerate(points):
        if algebra[0] == "product":
            members = [strength * grades[k] for strength, grades in rows]
        else:
            members = [min(strength, grades[k]) for strength, grades in rows]
        member = sum(members) if algebra[1] == "sum" else max(members)
        moment, total = moment + y * member, total + member
    assert ft.FuzzySystem(rules)(x=x)["u"] == pytest.approx(moment / total, abs=1e-9)


# ------------------------------------------------------------------ kinds of inputs

SPARSE = text(p="{trapmf: [0.2, 0.5, 1, 1]}", n="{trapmf: [-1, -1, -0.5, -0.2]}",
              default="default: 0.5, ")  # fmt: skip


@given(st.lists(st.floats(-2, 2), min_size=1, max_size=5), st.data())
def test_numbers_arrays_and_masks_give_the_same_values(values, data):
    system = ft.FuzzySystem(loads_rulebase(SPARSE))
    together = system(x=values)["u"]
    assert together.shape == (len(values),)
    for value, expected in zip(values, together, strict=True):
        for given_as in (value, np.float64(value), np.array(value)):
            found = system(x=given_as)["u"]
            assert type(found) is float
            assert found == expected
        assert (expected == 0.5) or abs(value) > 0.2
    mask = data.draw(st.lists(st.booleans(), min_size=len(values), max_size=len(values)))
    hidden = system(x=np.ma.array(values, mask=mask))["u"]
    np.testing.assert_array_equal(hidden, np.where(mask, np.nan, together))


# ------------------------------------------------------------------ designs


@settings(max_examples=15, deadline=None)
@given(st.floats(0.05, 10), st.sampled_from([2, 3]))
def test_designs_are_those_of_the_riccati_recursion(index, order):
    """With T = σ_w = 1: the steady gains of the filter that the index describes."""
    f = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])[:order, :order]
    g = np.array([0.5, 1, 1])[:order]
    p = np.eye(order)
    for _ in range(1500):
        p = f @ p @ f.T + index**2 * np.outer(g, g)
        k = p[:, 0] / (p[0, 0] + 1)
        p = p - np.outer(k, p[0])
    expected = [k[0], k[1], 2 * k[2]] if order == 3 else [k[0], k[1]]
    np.testing.assert_allclose(kalata(index, order=order)[:order], expected, rtol=1e-6)


# ------------------------------------------------------------------ defaults

GAINS = """\
rulebase: 1
name: gains
inputs:
  E: {{universe: [-1, 1, 21],
    sets: {{n: {{trapmf: [-1, -1, -0.9, {foot}]}}, p: {{trapmf: [0, 0.9, 1, 1]}}}}}}
outputs:
  alpha: {{universe: [0.3, 0.9, 11], default: {alpha}, sets: {{s: {{singleton: [0.5]}}}}}}
  beta: {{universe: [0.1, 0.5, 11], default: {beta}, sets: {{s: {{singleton: [0.2]}}}}}}
operators: {{and: product, or: sum, defuzzification: weighted-centers}}
rules:
  - {{if: {{E: n}}, then: {{alpha: s, beta: s}}}}
  - {{if: {{E: p}}, then: {{alpha: s, beta: s}}}}
scheduler: {{normalization: scale, gains: direct}}
"""


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.2, 1.2), st.floats(-0.2, 1.2), st.sampled_from([-0.5, 0.0, 0.25]))
def test_a_default_is_refused_or_reached_or_never_used(alpha, beta, foot):
    written = GAINS.format(alpha=alpha, beta=beta, foot=foot)
    if not (0.3 <= alpha <= 0.9 and 0.1 <= beta <= 0.5):
        with pytest.raises(ft.RuleBaseError, match=r"default of (alpha|beta) must be within") as no:
            loads_rulebase(written, "gains.yaml")
        assert str(no.value).startswith("gains.yaml:")
        return
    rules = loads_rulebase(written)
    silent = foot <= 0  # the feet touch in 0, or lie apart
    rows = reachable_gains(rules, "rules").tolist()
    assert ([alpha, beta] in rows) == (silent or [alpha, beta] == [0.5, 0.2])
    ends = review(rules).ranges["alpha"]
    assert (ends == (min(0.5, alpha), max(0.5, alpha))) if silent else ends == (0.5, 0.5)
    assert certify(rules).verdict in ("certified", "not decided")


# ------------------------------------------------------------------ numbers as words of YAML


@given(st.integers(0, 99))
def test_leading_zeros_are_no_octal_numbers(value):
    plain, zero = (
        loads_rulebase(
            text(p="{trapmf: [-1, 1, 1, 1]}", high=100, r=f"{{trimf: [0, {word}, 100]}}")
        )
        for word in (str(value), f"0{value}")
    )
    assert plain == zero


@given(st.integers(1, 9), st.integers(0, 3), st.sampled_from(["e", "E", "e+", ".0e"]))
def test_powers_of_ten_are_numbers(digit, power, mark):
    word = f"{digit}{mark}{power}"
    rules = loads_rulebase(text(high=10_000, r=f"{{trimf: [0, {word}, 10000]}}"))
    assert rules.outputs[0].sets[1].parameters[1] == digit * 10**power


@given(
    st.sampled_from(["1:30", "1_000", "0x10", "0b11", "50%", ".inf", "nan", "２", "1,5e", "yes"])
)
def test_what_is_no_decimal_number_is_refused_with_its_place(word):
    written = text(r=f'{{trimf: [0, "{word}", 2]}}') if "," in word else text(
        r=f"{{trimf: [0, {word}, 2]}}"
    )  # fmt: skip
    with pytest.raises(ft.RuleBaseError, match="finite number, not") as refused:
        loads_rulebase(written, "words.yaml")
    assert str(refused.value).startswith("words.yaml:6:")


@given(st.sampled_from(["on", "off", "null", "yes", "2", "1e3", "012", "~", "true"]))
def test_sets_have_the_names_that_are_written(name):
    rules = loads_rulebase(text().replace("l: {", f"{name}: {{").replace("u: l}", f"u: {name}}}"))
    assert rules.outputs[0].set_names[0] == name
