"""The command `surface`: pictures, tables and ranges."""

import csv as csvlib

import pytest
from rulebase_texts import LIST

from fuzzytrack import FuzzySystem, alpha_beta_from_w, load_rulebase


def test_surface(run, tmp_path):
    picture, table = tmp_path / "s.png", tmp_path / "s.csv"
    result = run(
        "surface", "stiffness-damping", "-o", picture, "--csv", table, "--points", "5", "--even"
    )
    assert f"wrote {picture}" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    with open(table, newline="") as stream:
        rows = list(csvlib.DictReader(stream))
    assert len(rows) == 25
    values = FuzzySystem(load_rulebase("stiffness-damping"))(E=-0.5, dE=1.0)
    (row,) = [r for r in rows if (r["E"], r["dE"]) == ("-0.5", "1.0")]
    assert float(row["stiffness"]) == values["stiffness"]
    assert float(row["beta"]) == alpha_beta_from_w(values["stiffness"], values["damping"])[1]


def test_surface_has_the_corners_of_the_sets(run, tmp_path):
    table = tmp_path / "s.csv"
    run("surface", "stiffness-damping", "--csv", table, "--points", "2")
    with open(table, newline="") as stream:
        found = {float(row["E"]) for row in csvlib.DictReader(stream)}
    sets = load_rulebase("stiffness-damping").input("E").sets
    assert found == {p for each in sets for p in each.breakpoints() if -1 <= p <= 1}


def test_contours_instead_of_surfaces(run, tmp_path, monkeypatch):
    from fuzzytrack.cli import surface as command

    drawn = []
    monkeypatch.setattr(command, "save_picture", lambda path, draw, inputs=(): drawn.append(draw()))
    for name, panels in (("stiffness-damping", 4), ("tipper", 1)):
        run("surface", name, "--contour", "-o", tmp_path / "s.png", "--points", "5")
        axes = [ax for ax in drawn[-1].axes if ax.get_xlabel()]
        assert [ax.name for ax in axes] == ["rectilinear"] * panels


def test_surface_without_files_gives_ranges(run):
    text = run("surface", "stiffness-damping", "--method", "relation").stdout
    assert "alpha" in text
    assert "wrote" not in text


def test_surface_of_a_schedule_of_stiffness_has_gains(run, tmp_path):
    picture, table = tmp_path / "s.png", tmp_path / "s.csv"
    result = run("surface", "omega-schedule", "-o", picture, "--csv", table, "--points", "5")
    assert result.exit_code == 0
    assert "alpha      0.5572   0.8778" in result.stdout
    assert table.read_text().splitlines()[0] == "lag,stiffness,alpha,beta"
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_surface_of_one_and_of_three_inputs(run, fails, csv, tmp_path):
    assert run("surface", "valve", "-o", tmp_path / "v.png", "--points", "5").exit_code == 0
    three = csv(LIST, "three.yaml")
    assert f"{three} has 3 inputs; give the others a value with --at c=..." in fails(
        "surface", three
    )
    result = run("surface", three, "--at", "c=.5", "-o", tmp_path / "t.png", "--points", "5")
    assert result.exit_code == 0
    assert "did you mean" not in fails("surface", three, "--at", "d=.5")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--points", "1"], "--points"),
        (["--method", "exakt"], "method: unknown 'exakt'; one of exact"),
        (["--at", "x=1"], "stiffness-damping has 2 inputs; --at has no use"),
        (["-o", "a.gif"], "cannot draw .gif"),
        (["--csv", "a.png"], "cannot write .png"),
        (["--csv", "no/a.csv"], "there is no folder"),
        (["--contour"], "--contour needs -o FILE"),
        (["--even"], "--even needs --csv FILE"),
    ],
)
def test_bad_surfaces(fails, words, message):
    assert message in fails("surface", "stiffness-damping", *words)


def test_unknown_rule_base(fails):
    assert "did you mean 'valve'" in fails("surface", "valvee")
