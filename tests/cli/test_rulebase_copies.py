"""`rulebase new` and `rulebase convert`: rule bases copied to files, and to other formats."""

import json
import shlex

import pytest
from rulebase_texts import LIST

from fuzzytrack import FuzzySystem, load_rulebase
from fuzzytrack.fuzzy.schema import dumps_schema
from fuzzytrack.schedulers.settings import scheduler_schema


def test_new_writes_a_copy_its_schema_and_the_next_steps(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("rulebase", "new", "stiffness-damping", "-o", "my rules.yaml")
    assert result.exit_code == 0, result.stderr
    copy = load_rulebase(tmp_path / "my rules.yaml")
    assert copy.name == "my rules"
    assert copy.rules == load_rulebase("stiffness-damping").rules
    schema = tmp_path / "rulebase.schema.json"
    assert json.loads(schema.read_text()) == json.loads(dumps_schema(scheduler_schema()))
    steps = [line.strip() for line in result.stdout.splitlines() if line.startswith("  ")]
    assert [step.split("'")[0] for step in steps] == [
        "fuzzytrack rulebase check ",
        "fuzzytrack surface ",
        "fuzzytrack track plots.csv --tracker ",
    ]
    for step in steps[:2]:
        assert run(*shlex.split(step)[1:]).exit_code == 0


def test_a_rule_base_that_gives_no_gains_is_not_said_to_track(run, tmp_path):
    result = run("rulebase", "new", "tipper", "-o", tmp_path / "mine.yaml")
    assert "surface" in result.stdout
    assert "track plots.csv" not in result.stdout


def test_inputs_after_the_second_get_a_value_in_the_next_steps(run, csv):
    three = csv(LIST, "three.yaml")
    result = run("rulebase", "new", three, "-o", three.parent / "mine.yaml")
    assert "--at c=0 -o surface.png" in result.stdout


def test_new_overwrites_nothing_unless_forced(run, fails, tmp_path):
    mine, schema = tmp_path / "mine.yaml", tmp_path / "rulebase.schema.json"
    mine.write_text("mine")
    assert fails("rulebase", "new", "tipper", "-o", mine) == (
        f"error: {mine}: exists; name another file, or replace it with --force"
    )
    assert mine.read_text() == "mine"
    assert not schema.exists()
    schema.write_text("{}")
    other = tmp_path / "other.yaml"
    assert f"kept {schema}, which differs" in run("rulebase", "new", "tipper", "-o", other).stdout
    assert schema.read_text() == "{}"
    found = json.loads(run("rulebase", "new", "tipper", "-o", mine, "--force", "--json").stdout)
    assert (found["file"], found["kept"]) == (str(mine), False)
    assert load_rulebase(mine).name == "mine"
    assert schema.read_text() == dumps_schema(scheduler_schema())
    # The schema of this version is no obstacle.
    again = run("rulebase", "new", "tipper", "-o", tmp_path / "third.yml")
    assert f"wrote {schema}" in again.stdout


@pytest.mark.parametrize(
    ("origin", "output", "message"),
    [
        ("tiper", "mine.yaml", "unknown rule base 'tiper'; did you mean 'tipper'?"),
        ("tipper", "mine.txt", "--output: mine.txt must end in .yaml, the suffix of rule bases"),
        ("tipper", "no/mine.yaml", "there is no folder"),
        ("no.yaml", "mine.yaml", "cannot read rule base 'no.yaml'"),
    ],
)
def test_a_mistake_in_new_is_one_line(fails, tmp_path, monkeypatch, origin, output, message):
    monkeypatch.chdir(tmp_path)
    assert message in fails("rulebase", "new", origin, "-o", output)
    assert list(tmp_path.iterdir()) == []


def test_convert(run, fails, tmp_path):
    fis, fll, back = (tmp_path / name for name in ("tip.fis", "tip.fll", "back.yaml"))
    assert run("rulebase", "convert", "tipper", str(fis)).stdout.endswith(f"wrote {fis}\n")
    run("rulebase", "convert", str(fis), str(fll))
    run("rulebase", "convert", str(fll), str(back))
    point = {"service": 3.3, "food": 7.9}
    expected = FuzzySystem("tipper")(**point)["tip"]
    for file in (fis, fll, back):
        assert FuzzySystem(str(file))(**point)["tip"] == pytest.approx(expected, abs=1e-12)
    assert "exists" in fails("rulebase", "convert", "tipper", str(fis))
    before = fis.read_bytes()
    run("rulebase", "convert", "valve", str(fis), "--force")
    assert fis.read_bytes() != before
    assert "must end in one of .yaml, .yml, .fis, .fll" in fails(
        "rulebase", "convert", "tipper", str(tmp_path / "tip.txt")
    )


def test_convert_says_where_the_other_program_computes_otherwise(run, tmp_path):
    found = json.loads(
        run("rulebase", "convert", "valve", str(tmp_path / "v.fll"), "--json").stdout
    )
    (note,) = found["notes"]
    assert note.startswith("opening is summed over 121 points with both ends; fuzzylite takes")


def test_convert_writes_nothing_that_the_format_lacks(fails, mine, tmp_path):
    text = mine.read_text(encoding="utf-8")
    assert "and: product" in text
    mine.write_text(text.replace("and: product", "and: einstein-product"), encoding="utf-8")
    out = tmp_path / "x.fis"
    said = fails("rulebase", "convert", str(mine), str(out))
    assert "and einstein-product has no counterpart in FIS" in said
    assert not out.exists()


def test_other_formats_are_checked_shown_and_explained_but_not_edited(run, fails, tmp_path):
    fis = tmp_path / "sd.fis"
    run("rulebase", "convert", "stiffness-damping", str(fis))
    assert "sd.fis: ok" in run("rulebase", "check", str(fis)).stdout
    assert "normalization chan" in run("rulebase", "check", str(fis)).stdout
    run("rulebase", "show", str(fis), "--plot", str(tmp_path / "sd.png"))
    run("rulebase", "explain", str(fis), "--at", "E=0.3,dE=-0.1")
    run("surface", str(fis), "-o", str(tmp_path / "surface.png"))
    for command in (
        ["set", str(fis), "M-Z", "--cell", "dE=ns,E=pl"],
        ["new", str(fis), "-o", str(tmp_path / "new.yaml")],
    ):
        said = fails("rulebase", *command)
        assert "only YAML is edited; first convert it, fuzzytrack rulebase convert" in said
    broken = tmp_path / "broken.fis"
    broken.write_text(fis.read_text("utf-8").replace("'constant',[0.25]", "'constant',[x]"))
    assert f"{broken}:" in fails("rulebase", "check", str(broken))
    assert "must be a finite number" in fails("track", "p.csv", "--tracker", str(broken))
