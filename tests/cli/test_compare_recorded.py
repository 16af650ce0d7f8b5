"""`fuzzytrack compare` on recorded plots, with and without truth."""

import json
import math
import re

import numpy as np
import pytest

from fuzzytrack.cli.compare import DEFAULT_TRACKERS
from fuzzytrack.testbed import compare_recorded

TWO = "fixed:alpha=0.5377:beta=0.2018,kalman-cv:sigma_v=0.5"


@pytest.fixture
def files(csv):
    """Plots of two turning targets, and their true positions by a clock 3 s ahead."""
    rng = np.random.default_rng(4)
    lines, truth = ["t,id,x,y"], ["t,id,x,y"]
    for k, name in enumerate("ab"):
        for t in range(-10, 130):
            x, y = 9 * t + 60 * math.sin(t / 9 + k), 50 * math.cos(t / 11 - k)
            truth.append(f"{t - 3},{name},{x},{y}")
            if 0 <= t < 100:
                dx, dy = 2 * rng.standard_normal(2)
                lines.append(f"{t},{name},{x + dx},{y + dy}")
    return csv("\n".join(lines)), csv("\n".join(truth), "truth.csv")


def test_without_truth(run, files):
    words = ("compare", files[0], "--id", "id", "--trackers", TWO, "--sigma", 2)
    result = run(*words)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[:2] == ["columns: time t; id id; position x, y", "sigma: 2"]
    assert "2 tracks, 196 of 200 plots scored: all after the start of their track" in lines
    told = json.loads(run(*words, "--json").stdout)
    first, second = told["trackers"]
    (row,) = [line for line in lines if re.match(r"kalman-cv:sigma_v=0.5 +\d", line)][:1]
    cells = row.split()
    assert float(cells[1]) == pytest.approx(second["rms"], rel=1e-3)
    assert float(cells[2]) == pytest.approx(100 * second["change"]["change"], abs=0.06)
    assert ("best" in row) == (told["best"] == "kalman-cv:sigma_v=0.5")
    assert any(line.startswith("the plot before ") for line in lines)
    assert any(line.startswith("expected ") and "0.5 %" in line for line in lines)
    assert "no variance of its predictions, for fixed:alpha=0.5377:beta=0.2018." in result.stdout
    assert max(map(len, lines)) <= 80
    assert first["log_likelihood"] is None
    assert told["sigma"] == {"x": 2, "y": 2}


def test_json_is_what_the_library_says(run, files):
    words = ("--id", "id", "--sigma", 2, "--trackers", TWO, "--seed", 3)
    told = json.loads(run("compare", files[0], *words, "--json").stdout)
    found = compare_recorded(TWO.split(","), str(files[0]), id="id", sigma=2.0, seed=3)
    assert [one["rms"] for one in told["trackers"]] == [one.rms for one in found.scores]
    assert told["trackers"][1]["change"]["low"] == found.scores[1].change.low
    assert told["before"] == found.before


def test_with_truth(run, files):
    words = ("--truth", files[1], "--id", "id", "--trackers", TWO, "--sigma", 2)
    result = run("compare", files[0], *words)
    assert (result.exit_code, result.stderr) == (0, "")
    (clock,) = re.findall(r"the plots are (\S+) ± \S+ s behind the truth", result.stdout)
    assert float(clock) == pytest.approx(3, abs=0.2)
    told = json.loads(run("compare", files[0], *words, "--json").stdout)
    assert told["lag"]["taken_off"] == told["lag"]["lag"] == pytest.approx(float(clock), abs=0.01)
    assert told["measured_rmse"] == pytest.approx(2 * math.sqrt(2), rel=0.15)
    assert "\nthe plots themselves " in result.stdout
    for one in told["trackers"]:
        assert one["worse_than_plots"] == (one["true"]["filtered"] > told["measured_rmse"])


def test_a_clock_that_is_ahead_is_said_to_be(run, csv):
    shape = "".join(f"{k},{50 * math.sin(k / 5)}\n" for k in range(90))
    truth = "".join(f"{k + 2},{50 * math.sin(k / 5)}\n" for k in range(-40, 150))
    words = ("--truth", csv("t,x\n" + truth, "truth.csv"), "--trackers", "maneuver", "--sigma", 1)
    said = run("compare", csv("t,x\n" + shape), *words).stdout
    (ahead,) = re.findall(r"the plots are (\S+) ± \S+ s ahead of the truth", said)
    assert float(ahead) == pytest.approx(2, abs=0.01)


def test_plots_as_their_own_truth_have_no_lag(run, csv):
    path = csv("t,x\n" + "".join(f"{k},{50 * math.sin(k / 5)}\n" for k in range(90)))
    told = run("compare", path, "--truth", path, "--trackers", "maneuver", "--sigma", 1).stdout
    assert "clock: plots and truth agree" in told


def test_a_target_that_stands_still_has_no_nan_in_its_table(run, csv):
    said = run("compare", csv("t,x\n" + "".join(f"{k},5\n" for k in range(30)))).stdout
    assert "nan" not in said
    assert "–" in said


def test_a_lag_that_cannot_be_told_is_said(run, csv):
    lines = "t,x\n" + "".join(f"{k},{5 * k + (-1) ** k}\n" for k in range(60))
    truth = csv("t,x\n" + "".join(f"{k},{5 * k}\n" for k in range(-40, 99)), "truth.csv")
    words = ("--truth", truth, "--trackers", "fixed:alpha=.5:beta=.2", "--sigma", 1)
    assert "no lag of the plots behind the truth was taken off:" in " ".join(
        run("compare", csv(lines), *words).stdout.split()
    )


def test_without_noise_the_default_tracker_is_left_out(run, csv):
    plots = csv("t,x,y\n0,0,0\n1,10,5\n2,20,11\n3,31,15\n4,39,21\n")
    result = run("compare", plots)
    assert result.exit_code == 0
    assert "note: compared without maneuver, which needs the noise" in result.stderr
    names = [line.split()[0] for line in result.stdout.splitlines() if line]
    assert names.count("chan-style") == 2
    assert "maneuver" not in names
    assert "–: the noise of the plots is not known." in result.stdout


def test_it_reads_what_track_reads(run, csv):
    rng = np.random.default_rng(1)
    t = np.arange(60)
    ranges, azimuth = 9000 + 90 * t + rng.normal(0, 20, 60), 10 + 0.5 * t + rng.normal(0, 0.1, 60)
    rows = zip(t, ranges, azimuth, strict=True)
    plots = csv("time,range,azimuth\n" + "".join(f"{a},{b},{c}\n" for a, b, c in rows))
    words = ("--polar", "range,azimuth", "--sigma-range", 20, "--sigma-azimuth", 0.1)
    told = json.loads(run("compare", plots, *words, "--json").stdout)
    assert [one["name"] for one in told["trackers"]] == DEFAULT_TRACKERS.split(",")
    assert told["trackers"][0]["log_likelihood"] < 0
    bearing = run("compare", plots, "--angle", "azimuth", "--sigma", 0.1)
    assert "RMS of innovations (deg)" in bearing.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--noise", "1", "--truth", "t.csv"], "--truth: with --noise the file is the truth"),
        (["--noise", "1", "--sigma", "2"], "--sigma: with --noise the file is the truth"),
        (["--noise", "1", "--sigma-range", "2"], "--sigma-range: with --noise"),
        (["--noise", "1", "--gate", "5"], "--gate: with --noise"),
        (["--runs", "5"], "--runs: is the number of simulated runs; it needs --noise SIGMA"),
        (["--truth", "none.csv"], "there is no file none.csv"),
        (["--gate", "0"], "--gate: expected a number > 0"),
    ],
)
def test_bad_comparisons(fails, plots, words, message):
    assert message in fails("compare", plots, *words)
