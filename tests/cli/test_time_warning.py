"""One line on stderr where the gains of a run do not suit the times of its plots."""

import json

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.saving import dumps_rulebase


@pytest.fixture
def pairs(csv):
    """Plots 20 ms and 980 ms apart in turn, of two targets."""
    times = np.cumsum(np.tile([0.02, 0.98], 40))
    random = np.random.default_rng(1)
    rows = [f"{t:.2f},{name},{3 * t + random.normal():.3f}" for name in ("a", "b") for t in times]
    return csv("\n".join(["t,id,x", *rows]))


def test_track_says_it_once(run, pairs):
    words = ("--tracker", "fixed:alpha=0.5:beta=0.2", "--id", "id", "--gate", "none")
    result = run("track", pairs, *words)
    assert result.exit_code == 0
    (line,) = result.stderr.splitlines()
    assert line.startswith("warning: AlphaBetaTracker(FixedGains(0.5, 0.2)): its gains do not suit")
    # Again in the next command of this process, and beside JSON.
    result = run("track", pairs, *words, "--json")
    assert len(result.stderr.splitlines()) == 1
    assert len(json.loads(result.stdout)["tracks"]) == 2


@pytest.mark.parametrize(
    "tracker", ["fixed:alpha=0.5:beta=0.2:period=0.5", "stiffness-damping:period=0.5"]
)
def test_with_a_period_nothing_is_said(run, pairs, tracker):
    result = run("track", pairs, "--tracker", tracker, "--id", "id")
    assert (result.exit_code, result.stderr) == (0, "")


def test_compare_says_it_once_for_each_tracker(run, pairs):
    names = "fixed:alpha=0.5:beta=0.2,stiffness-damping,kalman-cv:sigma_v=0.5:sigma_w=1"
    result = run(
        "compare", pairs, "--noise", "1", "--trackers", names, "--runs", "30", "--id", "id"
    )
    assert result.exit_code == 0, result.stderr
    lines = result.stderr.splitlines()
    assert len(lines) == 2
    assert "FixedGains(0.5, 0.2)" in lines[0]
    assert 'load_rulebase("stiffness-damping")' in lines[1]


def test_a_wrong_period_is_one_line(fails, pairs, tmp_path):
    line = fails("track", pairs, "--tracker", "fixed:alpha=1.2:beta=0.2:period=4")
    assert "period: gains with a negative real pole" in line
    assert "period must be" in fails("track", pairs, "--tracker", "chan-style:period=0")
    text = dumps_rulebase(ft.load_rulebase("stiffness-damping-wide"))
    path = tmp_path / "my.yaml"
    path.write_text(text.replace("gains: w-domain", "gains: w-domain, period: 60"))
    line = fails("track", pairs, "--tracker", path)
    assert line.startswith(f"{path}:")
    assert "period: at stiffness=0.8, damping=1.3" in line
