"""Rule bases to YAML and back."""

from __future__ import annotations

import itertools
import os
import re
import stat
from dataclasses import replace

import pytest
from builders import asymmetric_base
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_loading import LIST, TABLE

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy import saving
from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import CONJUNCTIONS, DEFUZZIFICATIONS, DISJUNCTIONS
from fuzzytrack.fuzzy.rulebase import (
    Consequent,
    Operators,
    Rule,
    RuleBase,
    TableLayout,
)
from fuzzytrack.fuzzy.saving import dumps_rulebase, save_rulebase
from fuzzytrack.fuzzy.variable import Universe, Variable

# ------------------------------------------------------------------ random rule bases

ODD = ["no", "on", "null", "~", "1", "-1e3", "-", "--", "a-b", "b-a", "a", "b", "<<", "=", "*", "&"]
ODD += [
    ".5",
    "{",
    "]",
    "'",
    '"',
    "#",
    ":",
    "a:",
    "!x",
    "|",
    "%",
    "?",
    "`",
    "0x1",
    "é",
    "速い",
    "\\",
]
SET_NAMES = st.one_of(
    st.sampled_from(ODD),
    st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), min_size=1, max_size=8),
).filter(lambda name: not re.search(r"[@,\s]", name))
TEXTS = st.one_of(
    st.just(""),
    st.sampled_from(
        ["null", "a: b", "# a", " a", "a ", "a\nb\n", "1", "'", "it's", "x " * 90 + "x"]
    ),
    st.text(st.characters(codec="utf-8", exclude_categories=("C", "Zl", "Zp")), max_size=200),
)
NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
SURE = st.one_of(st.just(1.0), st.sampled_from([0.5, 0.1, 1 / 3]), st.floats(1e-6, 1))


def names(count):
    return st.lists(SET_NAMES, min_size=count, max_size=count, unique=True)


@st.composite
def universes(draw):
    low = draw(NUMBERS)
    high = low + draw(st.floats(1e-2, 1e6))
    return Universe(
        low, high, draw(st.integers(3, 60)), draw(st.sampled_from(["ends", "midpoints"]))
    )


@st.composite
def inputs(draw, name):
    """Triangles from peak to peak, so that every point is covered."""
    universe = draw(universes())
    shares = sorted(draw(st.lists(st.floats(0.1, 0.9), max_size=2, unique=True)))
    width = universe.high - universe.low
    peaks = [universe.low, *(universe.low + s * width for s in shares), universe.high]
    sets = []
    for k, term in enumerate(draw(names(len(peaks)))):
        left, right = peaks[max(k - 1, 0)], peaks[min(k + 1, len(peaks) - 1)]
        sets.append(FuzzySet(term, "trimf", (left, peaks[k], right)))
    return Variable(name, universe, tuple(sets), None, draw(TEXTS), draw(TEXTS))


@st.composite
def outputs(draw, name):
    universe = draw(universes())
    width = universe.high - universe.low
    shares = sorted(draw(st.lists(st.floats(0, 1), min_size=1, max_size=4)))
    sets = []
    for term, share in zip(draw(names(len(shares))), shares, strict=True):
        # rounding may carry the upper end beyond it
        peak = min(universe.low + share * width, universe.high)
        kind = draw(st.sampled_from(["gaussmf", "trimf", "gbellmf", "singleton"]))
        parameters = {
            "gaussmf": (peak, width),
            "trimf": (peak - width, peak, peak + width),
            "gbellmf": (width, 2.0, peak),
            "singleton": (peak,),
        }[kind]
        sets.append(FuzzySet(term, kind, parameters))
    default = draw(st.one_of(st.none(), st.floats(universe.low, universe.high)))
    return Variable(name, universe, tuple(sets), default, draw(TEXTS), draw(TEXTS))


@st.composite
def consequents(draw, variables):
    found = []
    for variable in variables:
        count = draw(st.sampled_from([1, 1, 2]))
        terms = draw(st.permutations(variable.set_names))[:count]
        sure = draw(SURE)
        found += [
            Consequent(variable.name, t, sure if k == 0 else draw(SURE))
            for k, t in enumerate(terms)
        ]
    if draw(st.booleans()):
        # what cells such as S-L@0.5 say
        found = [replace(c, confidence=found[0].confidence) for c in found]
    return tuple(draw(st.permutations(found)))


@st.composite
def rulebases(draw):
    ins = [draw(inputs(n)) for n in ("E", "no", "größe")[: draw(st.integers(1, 3))]]
    outs = [draw(outputs(n)) for n in ("u", "null_", "y")[: draw(st.integers(1, 3))]]
    rules = []
    for terms in itertools.product(*(v.set_names for v in ins)):
        conditions = [(v.name, term) for v, term in zip(ins, terms, strict=True)]
        rules.append(Rule(tuple(draw(st.permutations(conditions))), draw(consequents(outs))))
    layout = None
    if len(ins) == 2 and draw(st.booleans()):
        columns, rows = draw(st.permutations([v.name for v in ins]))
        layout = TableLayout(columns, rows, tuple(draw(st.permutations([v.name for v in outs]))))
    elif len(ins) > 1:
        some = draw(st.permutations(outs))[:1]
        rules.append(Rule(((ins[0].name, ins[0].set_names[0]),), draw(consequents(some))))
    return RuleBase(
        draw(TEXTS.filter(bool)),
        tuple(ins),
        tuple(outs),
        tuple(draw(st.permutations(rules))),
        Operators(
            *(draw(st.sampled_from(w)) for w in (CONJUNCTIONS, DISJUNCTIONS, DEFUZZIFICATIONS))
        ),
        draw(TEXTS),
        draw(TEXTS),
        (("normalization", "no"), ("gains", "1"))[: draw(st.integers(0, 2))],
        layout,
    )


@pytest.mark.untraced
@settings(
    max_examples=120,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(rulebases())
def test_round_trip(rules):
    text = dumps_rulebase(rules)
    assert loads_rulebase(text) == rules
    assert loads_rulebase(text.encode()) == rules
    # what was read is written the same
    assert dumps_rulebase(loads_rulebase(text)) == text


@pytest.mark.parametrize("name", shipped_rulebases())
def test_round_trip_of_shipped(name):
    rules = load_rulebase(name)
    assert loads_rulebase(dumps_rulebase(rules)) == rules


def test_round_trip_of_a_base_made_in_python():
    rules = asymmetric_base()
    assert loads_rulebase(dumps_rulebase(rules)) == rules


def test_the_table_reads_as_in_print():
    text = dumps_rulebase(load_rulebase("stiffness-damping"))
    table = text[text.index("  table:") : text.index("\nscheduler")]
    shipped = rulebase_path("stiffness-damping").read_text()
    assert table in shipped
    assert "      nm: {trimf: [-0.6, -0.3, -0.1]}\n" in text


def test_forms_of_cells():
    text = dumps_rulebase(loads_rulebase(TABLE))
    assert "    #    lo   hi\n    ne: [S-S, S-L]\n" in text
    assert "    po: [L-S, [S-L@0.5, L-L@0.5]]\n" in text
    uneven = TABLE.replace("[S-L@0.5, L-L@0.5]", "{power: L@0.5, grip: [S@0.25, L@0.5]}")
    assert "{power: L@0.5, grip: [S@0.25, L@0.5]}" in dumps_rulebase(loads_rulebase(uneven))
    assert "  - {if: {E: lo},        then: {u: S}}\n" in dumps_rulebase(loads_rulebase(LIST))


def test_what_a_file_may_not_hold_is_not_written():
    rules = loads_rulebase(TABLE)
    wrong = replace(rules.outputs[0], sets=rules.outputs[0].sets[::-1])
    with pytest.raises(RuleBaseError, match=r"<small>:.*ascending"):
        dumps_rulebase(replace(rules, outputs=(wrong, rules.outputs[1])))
    with pytest.raises(RuleBaseError, match=r"U\+0007"):
        dumps_rulebase(replace(rules, name="a\u0007"))
    with pytest.raises(RuleBaseError, match="scheduler setting 'model' must be a word"):
        dumps_rulebase(replace(rules, scheduler=(("model", ""),)))


def test_settings_of_a_scheduler_are_kept_whatever_they_are():
    settings = (("model", "x y"), ("no", "1e-3"), ("limit", "-2"), ("two words", "true"))
    rules = replace(loads_rulebase(TABLE), scheduler=settings)
    assert loads_rulebase(dumps_rulebase(rules)) == rules


# ------------------------------------------------------------------ files


def test_save(tmp_path):
    path = tmp_path / "mine.yaml"
    rules = loads_rulebase(TABLE)
    save_rulebase(rules, path)
    assert load_rulebase(path) == rules
    assert os.listdir(tmp_path) == ["mine.yaml"]
    assert stat.S_IMODE(path.stat().st_mode) == 0o644
    path.chmod(0o600)
    save_rulebase(loads_rulebase(LIST), str(path))
    assert load_rulebase(path).name == "list"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_save_through_a_link(tmp_path):
    (tmp_path / "real.yaml").write_text("old")
    (tmp_path / "link.yaml").symlink_to("real.yaml")
    save_rulebase(loads_rulebase(TABLE), tmp_path / "link.yaml")
    assert (tmp_path / "link.yaml").is_symlink()
    assert load_rulebase(tmp_path / "real.yaml").name == "small"


def test_save_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "mine.yaml"
    path.write_text("precious")

    def fail(*args):
        raise OSError("disk full")

    monkeypatch.setattr(saving.os, "replace", fail)
    with pytest.raises(OSError, match="disk full"):
        save_rulebase(loads_rulebase(TABLE), path)
    monkeypatch.undo()
    with pytest.raises(RuleBaseError):
        save_rulebase(replace(loads_rulebase(TABLE), name="\0"), path)
    with pytest.raises(OSError, match="No such file"):
        save_rulebase(loads_rulebase(TABLE), tmp_path / "no" / "mine.yaml")
    assert path.read_text() == "precious"
    assert os.listdir(tmp_path) == ["mine.yaml"]
