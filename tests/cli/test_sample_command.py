import json
import shlex

import numpy as np
import pytest

from fuzzytrack.simulation import SAMPLES, make_sample


def test_without_a_name_the_samples_and_their_commands_are_listed(run):
    lines = run("sample").stdout.splitlines()
    assert [line.split()[0] for line in lines if not line.startswith(" ")] == list(SAMPLES)
    assert "       fuzzytrack sample radar -o radar.csv" in lines
    assert any(
        line.endswith("(needs the extra geo: pip install 'fuzzytrack[geo]')") for line in lines
    )


def test_the_list_as_json(run):
    found = json.loads(run("sample", "--json").stdout)["samples"]
    assert [(each["name"], each["extra"]) for each in found] == [
        ("radar", None),
        ("ais", "geo"),
        ("adsb", "geo"),
        ("sonar", None),
        ("scans", None),
    ]


@pytest.mark.parametrize("name", [n for n, kind in SAMPLES.items() if kind.command == "track"])
def test_the_command_that_is_listed_tracks_the_sample(run, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    told = json.loads(run("sample", name, "-o", f"{name}.csv", "--json").stdout)
    assert told["rows"] == len(make_sample(name).plots["time"])
    program, *words = shlex.split(told["track"])
    assert program == "fuzzytrack"
    done = run(*words)
    assert done.exit_code == 0, done.stderr
    columns = make_sample(name).plots
    tracks = (
        set(columns[SAMPLES[name].reading["id"]]) if "id" in SAMPLES[name].reading else {"track"}
    )
    first = {line.split()[0] for line in done.stdout.splitlines() if line}
    assert tracks <= first


def test_scans_are_tracked_by_the_command_that_is_listed_and_scored(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ("sample", "scans", "-o", "scans.csv", "--truth", "truth.csv", "--json")
    program, *listed = shlex.split(json.loads(run(*words).stdout)["track"])
    assert (program, listed[0]) == ("fuzzytrack", "scan")
    assert run(*listed, "-o", "tracks.csv").exit_code == 0
    done = run("score", "tracks.csv", "--truth", "truth.csv", "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["mean"]["share_tracked"] > 0.7


def test_plots_and_truth_are_written(run, tmp_path):
    file, true = tmp_path / "a.csv", tmp_path / "b.csv"
    result = run("sample", "sonar", "-o", file, "--truth", true, "--seed", 5)
    assert result.stdout.splitlines() == [
        f"wrote {file}",
        f"wrote {true}",
        f"track it with: fuzzytrack track {file} --sigma 2",
    ]
    for path, columns in (
        (file, make_sample("sonar", 5).plots),
        (true, make_sample("sonar", 5).truth),
    ):
        head, *rows = path.read_text().splitlines()
        assert head == "time,x,y"
        np.testing.assert_array_equal(
            np.array([row.split(",") for row in rows], float), np.stack(list(columns.values()), 1)
        )


def test_a_dash_prints_the_plots_alone(run):
    result = run("sample", "radar", "-o", "-")
    assert result.stdout.splitlines()[0] == "time,track,range,azimuth"
    assert len(result.stdout.splitlines()) == 1 + len(make_sample("radar").plots["time"])
    assert result.stderr.startswith("track it with: fuzzytrack track - --polar range,azimuth")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("sonar",), "error: sample sonar: needs -o, as in -o sonar.csv; -o - prints it"),
        (("-o", "a.csv"), "error: -o a.csv: of which sample? one of radar, ais, adsb, sonar"),
        (("sonr",), "error: no such sample 'sonr'; did you mean 'sonar'?"),
        (("sonar", "-o", "-", "--json"), "error: --json: -o - prints the plots; name a file"),
        (("sonar", "-o", "a.csv", "--truth", "a.csv"), "error: --truth: a.csv is the file of the"),
        (("sonar", "-o", "a.xlsx"), "error: a.xlsx: cannot write .xlsx; .csv or .parquet"),
    ],
)
def test_a_mistake_is_one_line(fails, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    assert fails("sample", *words).startswith(message)
    assert list(tmp_path.iterdir()) == []
