"""The benchmark of comparison without truth, on few recordings."""

import json

import numpy as np
import pytest

from benchmarks import without_truth
from benchmarks.without_truth import Kind, true_changes, wandering


def test_the_script_writes_what_it_prints(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(without_truth, "TRACKERS", ("maneuver", "Kalman CV", "chan-style"))
    monkeypatch.setattr(without_truth, "COVERED", ("maneuver", "Kalman CV"))
    monkeypatch.setattr(without_truth, "KINDS", (Kind("mixed", 3), Kind("long", 1, 60)))
    monkeypatch.setattr(without_truth, "_TRUE", 4)
    monkeypatch.setattr(without_truth, "_TRACKS", 8)
    out = tmp_path / "figures.json"
    assert without_truth.main(["--recordings", "2", "--repeats", "3", "-o", str(out)]) == 0
    told, printed = json.loads(out.read_text()), capsys.readouterr().out
    assert [one["name"] for one in told["ranking"]] == ["mixed, constant T", "strong, jitter"]
    for one in told["ranking"]:
        assert -1 <= one["tau"] <= 1
        assert one["innovations"]["maneuver"] > one["errors"]["maneuver"] > 0
    assert [one["kind"] for one in told["coverage"]] == ["mixed, 3 × all", "long, 1 × 60"]
    assert "mean τ" in printed
    assert "long, 1 × 60" in printed


def test_targets_of_long_tracks_fly_straight_and_maneuver():
    path = wandering(400, 30, np.random.default_rng(1))
    bends = np.linalg.norm(np.diff(path, 2, axis=0), axis=2)
    assert bends.max() <= 3 + 1e-9
    assert 0.5 < (bends < 1e-9).mean() < 0.95


def test_true_changes_do_not_depend_on_how_they_are_divided():
    """Larger simulations agree within their chance."""
    kind = Kind("long", 2, 100)
    one, two = (true_changes(kind, 40, seed) for seed in (1, 2))
    assert one[0] == two[0] == 0
    assert one[1:] == pytest.approx(two[1:], abs=0.3)
