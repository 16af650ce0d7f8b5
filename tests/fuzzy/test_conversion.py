"""Rule bases there and back, through every format."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_bases import expressible, largest_gap, random_base

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.conversion import WRITERS, translated
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, shipped_rulebases
from fuzzytrack.fuzzy.saving import dumps_rulebase

READERS = {".fis": loads_fis, ".fll": loads_fll}


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("name", shipped_rulebases())
def test_shipped_rule_bases_keep_their_values_and_settings(name, suffix):
    rules = load_rulebase(name)
    again = READERS[suffix](translated(rules, f"x{suffix}").text, "x")
    assert largest_gap(rules, again, 1000) <= 1e-12
    assert dict(again.scheduler) == dict(rules.scheduler)
    assert (again.name, again.description, again.source) == (
        rules.name, rules.description, rules.source
    )  # fmt: skip
    assert [(v.label, v.unit, v.universe) for v in (*again.inputs, *again.outputs)] == [
        (v.label, v.unit, v.universe) for v in (*rules.inputs, *rules.outputs)
    ]
    assert translated(again, f"x{suffix}").text == translated(
        READERS[suffix](translated(again, f"x{suffix}").text, "x"), f"x{suffix}"
    ).text  # fmt: skip


@pytest.mark.parametrize("suffix", READERS)
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_random_rule_bases_keep_their_values(suffix, seed):
    rules = expressible(seed, suffix)
    text = translated(rules, f"x{suffix}").text
    again = READERS[suffix](text.encode(), "x")
    assert largest_gap(rules, again, 100) <= 1e-12
    assert loads_rulebase(dumps_rulebase(again)) == again


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("seed", range(60))
def test_what_is_not_refused_is_right(suffix, seed):
    rules = random_base(seed)
    try:
        text = translated(rules, f"x{suffix}").text
    except RuleBaseError as error:
        message = str(error)
    else:
        assert largest_gap(rules, READERS[suffix](text, "x"), 50) <= 1e-12
        return
    assert message.endswith(f"no counterpart in {suffix[1:].upper()}")


def test_files_are_loaded_by_their_suffix(tmp_path):
    rules = load_rulebase("valve")
    for suffix in WRITERS:
        path = tmp_path / f"valve{suffix.upper()}"
        path.write_text(translated(rules, path).text, encoding="utf-8")
        if suffix in READERS:
            again = load_rulebase(path)
            assert eval(repr(again), {"load_rulebase": load_rulebase}) == again
            assert ft.FuzzySystem(str(path)).rules == again
    with pytest.raises(ValueError, match=r"path: valve\.fcl must end in one of \.yaml"):
        translated(rules, "valve.fcl")


def test_trackers_take_such_files(tmp_path):
    path = tmp_path / "mine.fis"
    path.write_text(translated(load_rulebase("stiffness-damping"), path).text, encoding="utf-8")
    plots = np.cumsum(np.ones((30, 2)), axis=0) + np.random.default_rng(1).normal(0, 0.1, (30, 2))
    first = ft.AlphaBetaTracker(str(path)).run(np.arange(30.0), plots)
    second = ft.AlphaBetaTracker("stiffness-damping").run(np.arange(30.0), plots)
    np.testing.assert_allclose(first.filtered, second.filtered, rtol=0, atol=1e-12)


def test_a_line_lets_a_file_schedule_gains(tmp_path):
    text = translated(load_rulebase("omega-schedule"), "x.fis").text
    kept = [each for each in text.splitlines() if "% fuzzytrack" not in each]
    settings = '{"normalization": "smoothed", "rho": "0.774", "gains": "kalata"}'
    path = tmp_path / "mine.fis"
    path.write_text("\n".join(kept), encoding="utf-8")
    with pytest.raises(RuleBaseError, match="no scheduler setting 'normalization'"):
        ft.AlphaBetaTracker(str(path))
    path.write_text("\n".join([f"% fuzzytrack scheduler {settings}", *kept]), encoding="utf-8")
    x = np.cumsum(np.random.default_rng(1).normal(5.0, 1.0, 40))
    first = ft.AlphaBetaTracker(str(path)).run(np.arange(40.0), x, sigma=1.0)
    there = dumps_rulebase(load_rulebase("omega-schedule"))
    assert ", opening: growing-memory" in there
    other = loads_rulebase(there.replace(", opening: growing-memory", ""))
    second = ft.AlphaBetaTracker(ft.FuzzyScheduler(other)).run(np.arange(40.0), x, sigma=1.0)
    np.testing.assert_allclose(first.filtered, second.filtered, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('% fuzzytrack grids {"nosuch": [5, "ends"]}', "grids: no variable 'nosuch'"),
        (
            '% fuzzytrack grids {"tip": [5, "middles"]}',
            "tip needs up to 100001 points and one of",
        ),
        (f'% fuzzytrack grids {{"tip": [{"9" * 400}, "ends"]}}', "grids: tip needs up to 100001"),
        ("% fuzzytrack grids [1]", "is not the JSON that is expected"),
        ("% fuzzytrack grids {", "is not the JSON that is expected"),
        ("% fuzzytrack grids " + "[" * 5000, "is not the JSON that is expected"),
        ('% fuzzytrack defaults {"tip": "x"}', "defaults: tip needs a number or null"),
        ('% fuzzytrack labels {"tip": 5}', "labels: tip needs a text"),
        ('% fuzzytrack scheduler {"gains": 5}', "scheduler: settings are texts"),
        ('% fuzzytrack table {"columns": "food"}', "table: needs columns, rows and cells"),
        ("% fuzzytrack colors {}", "unknown part 'colors' of fuzzytrack"),
    ],
)
def test_comments_of_this_package_that_are_broken_are_named(line, said):
    text = translated(load_rulebase("tipper"), "x.fis").text
    kept = [each for each in text.splitlines() if "% fuzzytrack" not in each]
    assert loads_fis("\n".join(kept), "x").outputs[0].default == 15
    with pytest.raises(RuleBaseError, match=rf"x:{len(kept) + 1}:\d+: .*{said}"):
        loads_fis("\n".join([*kept, line]), "x")


def test_names_are_made_proper():
    text = translated(load_rulebase("tipper"), "x.fis").text
    kept = "\n".join(each for each in text.splitlines() if "% fuzzytrack" not in each)
    odd = kept.replace("'service'", "'1 class'").replace("'food'", "'class'")
    odd = odd.replace("'poor'", "'good'").replace("'rancid'", "'a, b@c'")
    rules = loads_fis(odd, "x")
    assert rules.input_names == ("x_1_class", "x_class")
    assert rules.inputs[0].set_names == ("good", "good_2", "excellent")
    assert rules.inputs[1].set_names == ("a__b_c", "delicious")
    assert loads_rulebase(dumps_rulebase(rules)) == rules


def test_sets_whose_peak_is_out_of_range_are_converted():
    text = translated(load_rulebase("tipper"), "x.fis").text
    rules = loads_fis(text.replace("[20 25 30]", "[20 31 40]"), "x")
    assert loads_rulebase(dumps_rulebase(rules)) == rules
    with pytest.raises(RuleBaseError, match="'generous' lies outside the universe of tip"):
        dumps_rulebase(loads_fis(text.replace("[20 25 30]", "[31 35 40]"), "x"))


def test_what_is_too_long_for_yaml_is_said():
    text = translated(load_rulebase("tipper"), "x.fis").text
    sets = "".join(f"MF{k}='s':'trimf',[0 5 {k}]\n" for k in range(4, 4001))
    long = text.replace("NumMFs=3\n", "", 1).replace("\n[Input2]", f"{sets}\n[Input2]")
    with pytest.raises(RuleBaseError, match="tipper: has more than 128 KiB as YAML"):
        translated(loads_fis(long.replace("[0 5 4]", "[0 5 5]"), "x"), "x.yaml")
