import json

import numpy as np
import pytest
from rulebase_texts import LIST, ODD

from fuzzytrack import FuzzySystem, alpha_beta_from_w, load_rulebase
from fuzzytrack.cli.rulebase_tables import _cell
from fuzzytrack.fuzzy.schema import dumps_schema
from fuzzytrack.schedulers import review as reviewing
from fuzzytrack.schedulers.settings import scheduler_schema


@pytest.fixture
def typo(mine):
    mine.write_text(mine.read_text().replace("Z-M, Z-S]", "Z-M, Q-S]", 1))
    return mine


def test_list(run):
    result = run("rulebase", "list")
    assert "stiffness-damping" in result.stdout
    assert max(map(len, result.stdout.splitlines())) <= 80
    found = json.loads(run("rulebase", "list", "--json").stdout)
    assert "valve" in [r["name"] for r in found]


def test_show(run):
    text = run("rulebase", "show", "stiffness-damping").stdout
    assert "nl       S-L   M-L   L-L   L-L   S-L   Z-M   Z-S" in text.replace(
        "nl     ", "nl     "
    ) or ("nl      S-L  M-L  L-L  L-L  S-L  Z-M  Z-S" in text)
    assert "normalized error rate" in text
    found = json.loads(run("rulebase", "show", "stiffness-damping", "--json").stdout)
    assert len(found["rules"]) == 49
    assert found["outputs"][0]["universe"] == [0.25, 0.35, 41]


def test_show_draws(run, fails, csv, tmp_path):
    picture = tmp_path / "r.png"
    result = run("rulebase", "show", "valve", "--plot", picture)
    assert f"wrote {picture}" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert json.loads(run("rulebase", "show", "valve", "--plot", picture, "--json").stdout)
    assert "cannot draw .gif" in fails("rulebase", "show", "valve", "--plot", "a.gif")


def test_show_a_list_of_rules(run, csv):
    text = run("rulebase", "show", csv(LIST, "a.yaml")).stdout
    assert "if a is lo then out is small\n" in text
    assert "where no rule fires: 0.5" in text
    assert "midpoints" in text


def test_cells_with_shares(csv):
    rules = load_rulebase(csv(LIST, "a.yaml"))
    assert _cell(rules.rules[1], ("out",)) == "small@0.3+large@0.7"
    assert _cell(rules.rules[0], ("out", "other")) == "small-·"


def test_check(run):
    result = run("rulebase", "check", "stiffness-damping", "valve")
    assert result.exit_code == 0
    for text in (
        "stiffness-damping: ok",
        "49; 49 of 49 combinations",
        "a rule fires everywhere",
        "alpha reaches      0.4053 to 0.7138",
        "symmetric: the outputs stay when all inputs change sign",
        "normalization chan, gains w-domain",
        "schedules no gains",
    ):
        assert text in result.stdout


def test_check_says_where(run, fails, typo):
    line = fails("rulebase", "check", typo)
    assert line.startswith(f"{typo}:52:")
    assert "unknown set of stiffness 'Q'; allowed: Z, S, M, L" in line
    both = run("rulebase", "check", typo, "valve", "--json")
    assert both.exit_code == 2
    wrong, right = json.loads(both.stdout)
    assert (wrong["ok"], right["ok"]) == (False, True)
    assert right["ranges"]["opening"] == pytest.approx([0.325, 2.675], abs=1e-3)
    assert fails("track", typo, "--tracker", typo).startswith(f"{typo}:52:")


def test_check_names_the_file_of_any_mistake(fails, mine):
    text = mine.read_text().replace("universe: [0.25, 0.35", "universe: [-0.25, 0.35", 1)
    mine.write_text(text.replace("trimf: [0.25, 0.25, 0.28", "trimf: [-0.25, -0.25, 0.28", 1))
    line = text.split("universe: [-0.25, 0.35")[0].count("\n") + 1
    assert fails("rulebase", "check", mine).startswith(f"{mine}:{line}:")


def test_check_other_shapes(run, csv, monkeypatch):
    three = run("rulebase", "check", csv(LIST, "three.yaml")).stdout
    assert "2; 6 of 8 combinations of sets have one" in three
    assert "no rule fires on" in three
    assert "table error" not in three
    odd = run("rulebase", "check", csv(ODD, "odd.yaml")).stdout
    assert (
        "u: symmetric: the outputs change sign with the inputs; w: symmetric: the outputs st" in odd
    )
    lopsided = ODD.replace("{x: p}, then: {u: p, w: n}", "{x: p}, then: {u: p, w: p@0.5}")
    lopsided = lopsided.replace("{u: n, w: n}", "{u: n@0.5, w: n}").replace("name: odd", "name: l")
    assert "not symmetric: an output changes by up to" in run(
        "rulebase", "check", csv(lopsided, "l.yaml")).stdout  # fmt: skip
    monkeypatch.setattr(reviewing, "_MAX_CELLS", 1)
    assert "combinations" not in run("rulebase", "check", csv(ODD, "odd.yaml")).stdout


def test_parity_with_gaps():
    nan = np.nan
    assert reviewing._parity(np.array([nan, 1.0]), np.array([1.0, nan])) == "not symmetric"


def test_explain(run):
    at = ("--at", "E=.3,dE=-.2")
    text = run("rulebase", "explain", "stiffness-damping", *at).stdout
    assert "if E is pm and dE is nm then stiffness is Z, damping is S" in text
    found = json.loads(run("rulebase", "explain", "stiffness-damping", *at, "--json").stdout)
    values = FuzzySystem(load_rulebase("stiffness-damping"))(E=0.3, dE=-0.2)
    assert found["outputs"] == values
    alpha, beta = alpha_beta_from_w(values["stiffness"], values["damping"])
    assert found["gains"] == {"alpha": alpha, "beta": beta}
    assert f"alpha = {alpha:.6g}" in text
    assert sum(r["strength"] for r in found["rules"]) == pytest.approx(1)


def test_explain_outside_and_silent(run, csv):
    text = run("rulebase", "explain", csv(LIST, "a.yaml"), "--at", "a=-3,b=7,c=0").stdout
    assert "a = -3 is outside its universe; 0 is used" in text
    assert "b = 7 is outside its universe; 1 is used" in text
    assert "out = 0.3" in text
    silent = run("rulebase", "explain", csv(LIST, "a.yaml"), "--at", "a=1,b=0,c=0").stdout
    assert "no rule fires here" in silent
    assert "out = 0.5 m" in silent


@pytest.mark.parametrize(
    ("at", "message"),
    [
        ("E=.3", "needs dE too"),
        ("E=.3,de=1", "no such input 'de'; did you mean 'dE'"),
        ("E=.3,dE=x", "dE must be a finite number, got 'x'"),
        ("E=.3,dE=nan", "dE must be a finite number"),
        ("E=.3,E=.4", "'E' is given twice"),
        ("E", "expected NAME=VALUE"),
        ("", "expected NAME=VALUE"),
    ],
)
def test_bad_points(fails, at, message):
    assert message in fails("rulebase", "explain", "stiffness-damping", "--at", at)


def test_set_changes_one_cell_in_place(run, mine):
    mine.write_bytes(mine.read_bytes().replace(b"\n", b"\r\n"))
    before = mine.read_bytes()
    result = run("rulebase", "set", mine, "--cell", "dE=ns,E=pl", "M-L")
    assert "was  if E is pl and dE is ns then stiffness is M, damping is Z" in result.stdout
    assert "now  if E is pl and dE is ns then stiffness is M, damping is L" in result.stdout
    after = mine.read_bytes()
    assert [k for k in range(len(before)) if before[k] != after[k]] == [
        before.index(b"S-Z, M-Z]") + 7
    ]


def test_set_to_what_is_there_changes_nothing(run, mine, tmp_path):
    before = mine.stat().st_mtime_ns
    cell = ("--cell", "dE=ns,E=pl", "M-Z")
    same = "no change: if E is pl and dE is ns then stiffness is M, damping is Z\n"
    assert run("rulebase", "set", mine, *cell).stdout == same
    assert mine.stat().st_mtime_ns == before
    out = tmp_path / "out.yaml"
    assert run("rulebase", "set", mine, *cell, "-o", out).stdout == f"{same}wrote {out}\n"
    assert out.read_bytes() == mine.read_bytes()


def test_a_copy_goes_by_its_file(run, fails, mine, csv):
    assert load_rulebase(mine).name == "stiffness-damping"
    assert run("certify", mine).stdout.startswith(f"{mine}: certified\n")
    assert run("rulebase", "show", mine).stdout.startswith(f"{mine}: stiffness-damping\n")
    assert run("rulebase", "show", "valve").stdout.startswith("valve\n")
    assert run("rulebase", "check", mine).stdout.startswith(f"{mine}: ok\n")
    three = csv(LIST, "a.yaml")
    assert f"{three} has 3 inputs" in fails("surface", three)


def test_set_elsewhere(run, fails, tmp_path):
    out = tmp_path / "out.yaml"
    cell = ("--cell", "dE=ns,E=pl", "M-L")
    assert "comes with fuzzytrack; write your own with -o" in fails(
        "rulebase", "set", "stiffness-damping", *cell)  # fmt: skip
    assert run("rulebase", "set", "stiffness-damping", *cell, "-o", out).exit_code == 0
    assert load_rulebase(out) != load_rulebase("stiffness-damping")
    assert "there is no folder" in fails(
        "rulebase", "set", out, *cell, "-o", tmp_path / "no" / "a.yaml")  # fmt: skip


@pytest.mark.parametrize(
    ("cell", "says", "message"),
    [
        ("dE=ns,E=pl", "M-Q", "unknown set of damping 'Q'"),
        ("dE=nss,E=pl", "M-Z", "dE has no set 'nss'"),
        ("dE=ns", "M-Z", "no rule has exactly the conditions dE=ns"),
        ("dE", "M-Z", "--cell: expected NAME=VALUE"),
    ],
)
def test_bad_cells(fails, mine, cell, says, message):
    before = mine.read_bytes()
    assert message in fails("rulebase", "set", mine, "--cell", cell, says)
    assert mine.read_bytes() == before


def test_set_on_what_is_no_rule_base(fails, tmp_path):
    cell = ("--cell", "dE=ns,E=pl", "M-L")
    assert "No such file" in fails("rulebase", "set", tmp_path / "no.yaml", *cell)
    assert "Is a directory" in fails("rulebase", "set", tmp_path, *cell)
    (tmp_path / "a.yaml").write_bytes(b"\xff")
    assert "a.yaml" in fails("rulebase", "set", tmp_path / "a.yaml", *cell)


def test_set_that_cannot_write_leaves_the_file(fails, mine, monkeypatch):
    before = mine.read_bytes()

    def fail(*paths):
        raise OSError(5, "Input/output error", str(mine))

    monkeypatch.setattr("os.replace", fail)
    assert "Input/output error" in fails("rulebase", "set", mine, "--cell", "dE=ns,E=pl", "M-L")
    assert mine.read_bytes() == before
    assert [p.name for p in mine.parent.iterdir()] == ["mine.yaml"]


def test_schema(run, tmp_path):
    assert run("rulebase", "schema").stdout == dumps_schema(scheduler_schema())
    assert run("rulebase", "schema", "-o", tmp_path / "s.json").exit_code == 0
    assert (tmp_path / "s.json").read_text() == dumps_schema(scheduler_schema())


# -------------------------------------------------------------------- surface


TOUCHING = """\
rulebase: 1
name: touching
inputs:
  p: {universe: [0, 8, 9], sets: {lo: {trapmf: [0, 0, 2, 4]}, hi: {trapmf: [4, 6, 8, 8]}}}
  q: {universe: [0, 16, 9], sets: {lo: {trapmf: [0, 0, 2, 8]}, hi: {trapmf: [8, 9, 16, 16]}}}
outputs:
  u: {universe: [0, 1, 11], sets: {S: {trimf: [0, 0, 1]}, L: {trimf: [0, 1, 1]}}}
operators: {and: min, or: max, defuzzification: centroid}
rules:
  - {if any: {p: lo, q: lo}, then: {u: S}}
  - {if any: {p: hi, q: hi}, then: {u: L}}
"""


def test_check_names_a_single_point_without_a_rule(run, csv):
    result = run("rulebase", "check", csv(TOUCHING, "touching.yaml"))
    text = result.stdout
    assert result.exit_code == 2
    assert "touching.yaml: an output is NaN at some inputs\n" in text
    assert "no rule fires on < 0.1 % of the inputs" in text
    assert "no rule about u fires at p=4, q=8; it is then NaN\n" in text
    assert "u jumps to NaN (method table)" in text
    # On no grid point: it is named all the same.
    moved = TOUCHING.replace("2, 4]", "2, 3.14159]").replace("[4, 6", "[3.14159, 6")
    text = run("rulebase", "check", csv(moved, "moved.yaml")).stdout
    assert "no rule fires on" not in text
    assert "no rule about u fires at p=3.14159, q=8" in text
    default = TOUCHING.replace("u: {universe: [0, 1, 11],", "u: {universe: [0, 1, 11], default: 1,")
    result = run("rulebase", "check", csv(default, "default.yaml"), "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)[0]
    assert found["holes"]["u"]["p"] == [4, 4]
    assert found["ranges"]["u"][1] == 1


THREE = """\
rulebase: 1
name: three
inputs:
  a: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
  b: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
  c: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
outputs:
  u: {universe: [0, 1, 11], sets: {S: {trimf: [0, 0, 1]}, L: {trimf: [0, 1, 1]}}}
operators: {and: product, or: sum, defuzzification: centroid}
rules:
  - {if: {a: lo, c: lo}, then: {u: S}}
  - {if: {a: hi, c: hi}, then: {u: L}}
  - {if: {a: hi, b: lo, c: lo}, then: {u: L}}
"""


def test_check_fails_where_an_output_of_three_inputs_is_nan(run, csv):
    file = csv(THREE, "three.yaml")
    where = "no rule about u fires for a at 0, b between 0 and 1, c at 1"
    result = run("rulebase", "check", file)
    assert result.exit_code == 2
    assert result.stderr == f"{file}:8:17: {where}; add a rule, or give u a default\n"
    found = json.loads(run("rulebase", "check", file, "--json").stdout)[0]
    assert not found["ok"]
    assert where in found["error"]
    whole = THREE + "  - {if: {a: lo, c: hi}, then: {u: S}}\n  - {if: {b: hi}, then: {u: S}}\n"
    assert run("rulebase", "check", csv(whole, "whole.yaml")).exit_code == 0


NARROW = """\
rulebase: 1
name: narrow
inputs:
  p: {universe: [0, 8, 9], sets: {lo: {gaussmf: [0, 0.1]}, hi: {gaussmf: [8, 0.1]}}}
  q: {universe: [0, 8, 9], sets: {lo: {trapmf: [0, 0, 2, 6]}, hi: {trapmf: [2, 6, 7, 8]}}}
outputs:
  u: {universe: [0, 1, 11], default: 1, sets: {S: {trimf: [0, 0, 1]}, L: {trimf: [0, 1, 1]}}}
operators: {and: product, or: sum, defuzzification: centroid}
rules:
  - {if: {p: lo, q: lo}, then: {u: S}}
  - {if: {p: hi, q: hi}, then: {u: L}}
"""


def test_explain_tells_underflow_from_a_hole(run, csv):
    file = csv(NARROW, "narrow.yaml")
    lost = run("rulebase", "explain", file, "--at", "p=4,q=3").stdout
    assert lost.startswith("the strengths of all rules underflow to 0 here\n")
    # Both sets of q are 0 at its end.
    silent = run("rulebase", "explain", file, "--at", "p=4,q=8").stdout
    assert silent.startswith("no rule fires here\n")
    hole = NARROW.replace("gaussmf: [0, 0.1]", "trimf: [0, 0, 1]")
    hole = csv(hole.replace("gaussmf: [8, 0.1]", "trimf: [7, 8, 8]"), "hole.yaml")
    silent = run("rulebase", "explain", hole, "--at", "p=4,q=3").stdout
    assert silent.startswith("no rule fires here\n")
