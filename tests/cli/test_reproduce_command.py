"""`fuzzytrack reproduce`, on the paper that takes no time."""

import json
import re

import pytest

from fuzzytrack.papers import zhang_jiang
from fuzzytrack.papers.zhang_jiang import experiment


@pytest.fixture(autouse=True)
def without_experiment(monkeypatch):
    """The experiment of Zhang & Jiang takes a minute, and is tested by itself."""
    monkeypatch.setattr(experiment, "experiment_rows", lambda *given: [])


def test_a_table_of_published_and_own_numbers(run):
    result = run("reproduce", "zhang-jiang")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("Zhang & Jiang")
    (alpha,) = [line for line in lines if "α at N = 1 " in line]
    assert alpha.split()[-3:] == ["0.833333", "0.8333", "matches"]
    assert any("differs (2)" in line for line in lines)
    assert any(re.match(r"matches: \d+, .*differs: \d+", line) for line in lines)
    assert any(line.startswith("(2) of 30 constants") for line in lines)
    assert any("Table 1 cannot be reproduced" in line for line in lines)


def test_json_is_what_was_promised(run):
    found = json.loads(run("reproduce", "zhang-jiang", "--json").stdout)
    assert found["paper"] == "zhang-jiang"
    assert set(found["rows"][0]) >= {
        "table", "quantity", "published", "ours", "se", "runs", "verdict"
    }  # fmt: skip
    assert {row["verdict"] for row in found["rows"]} <= {"matches", "differs", "not stated"}
    # An infinite number is none in JSON.
    assert [r["ours"] for r in found["rows"] if "N = 1, largest" in r["quantity"]] == [None]


def test_files_are_written(run, tmp_path):
    result = run("reproduce", "zhang-jiang", "-o", tmp_path / "out")
    assert result.exit_code == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"results.json", "zhang-jiang-gains-and-gates.png"}
    assert json.loads((tmp_path / "out" / "results.json").read_text())["rows"]


def test_all_papers_in_one_list(run, monkeypatch):
    papers = {"zhang-jiang": "zhang_jiang"}
    monkeypatch.setattr("fuzzytrack.cli.reproduce.PAPERS", papers)
    found = json.loads(run("reproduce", "all", "--json").stdout)
    assert [each["paper"] for each in found["papers"]] == ["zhang-jiang"]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("kim-le",), "no such paper 'kim-le'; did you mean 'kim-lee'?"),
        (("kim-lee", "--runs", "0"), "--runs"),
        (("kim-lee", "--seed", "-1"), "--seed"),
    ],
)
def test_bad_input_is_one_line(fails, words, line):
    assert line in fails("reproduce", *words)


def test_the_folder_must_be_one(fails, tmp_path):
    path = tmp_path / "file"
    path.write_text("")
    assert "is not a folder" in fails("reproduce", "zhang-jiang", "-o", path)


def test_runs_and_seed_reach_the_paper(run, monkeypatch):
    asked = []
    original = zhang_jiang.reproduce

    def noted(runs, seed, progress):
        asked.append((runs, seed))
        return original(runs, seed, progress)

    monkeypatch.setattr(zhang_jiang, "reproduce", noted)
    run("reproduce", "zhang-jiang", "--runs", "7", "--seed", "3")
    assert asked == [(7, 3)]
