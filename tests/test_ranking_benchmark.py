"""The scripts that rank trackers, at sizes of no meaning."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.trackers.catalog import as_trackers, catalog, make_tracker
from fuzzytrack.tuning import rank

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module", autouse=True)
def the_scripts_can_be_imported():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield


def test_every_tracker_of_the_package_is_ranked():
    from benchmarks.ranked import Conditions, ranked

    specs = [Path(spec.partition(":")[0]).stem for spec in ranked(Conditions()).values()]
    known = {each.name for each in catalog() if each.kind != "normalization"}
    # Two are given by what they contain.
    assert known - {"fuzzy", "alpha-beta"} <= set(specs)


def test_numbers_follow_the_conditions():
    from benchmarks.ranked import Conditions, ranked

    usual = as_trackers(ranked(Conditions()))
    scaled = as_trackers(ranked(Conditions(level=12.0, sigma=16.0, period=2.0)))
    # a0 = 4 m/s² and τ0 = 2 s: the same in other units.
    times, plots = np.arange(30.0), np.random.default_rng(3).normal(size=(30, 2)).cumsum(axis=0)
    for name, tracker in usual.items():
        predicted = tracker.run(times, plots, 1.0).predicted
        other = scaled[name].run(2 * times, 16 * plots, 16.0).predicted
        np.testing.assert_allclose(other, 16 * predicted, rtol=1e-6, err_msg=name)


def test_the_ranking_is_printed_and_written(tmp_path, capsys):
    from benchmarks.ranking import main

    file = tmp_path / "r.json"
    options = ["--trackers", "IMM CV/CA,growing memory", "--variants", "constant T,T=2,jitter"]
    assert main(["--tracks", "3", "--others", "2", "--seed", "4", *options, "-o", str(file)]) == 0
    found = json.loads(file.read_text())
    trackers = ["IMM CV/CA", "growing memory", "fixed .543 .548", "Kalman CV"]
    assert list(found["trackers"]) == trackers
    constant, others, weaving = found["rankings"]
    assert (constant["tracks"], others["tracks"], weaving["tracks"]) == (3, 2, 2)
    assert weaving["sets"] == ["weaving"]
    assert list(weaving["variants"]) == ["constant T", "jitter"]
    expected = rank(found["trackers"], 3, 4, ["constant T"])
    change = expected.change("IMM CV/CA", "fixed .543 .548", "constant T")
    assert constant["changes"]["fixed .543 .548"]["IMM CV/CA"]["constant T"] == [
        pytest.approx(change.value, rel=1e-5), pytest.approx(change.error, rel=1e-5)
    ]  # fmt: skip
    text = capsys.readouterr().out
    row = next(line for line in text.splitlines() if line.startswith("IMM CV/CA"))
    assert f"{100 * abs(change.value):.1f} ± {100 * change.error:.1f}" in row
    assert "against IMM CV/CA, %" in text
    assert "weaving, jitter" in text


def test_figures_as_they_are_shown():
    from benchmarks.ranking import lines, markdown, shown

    assert shown([-0.1234, 0.01]) == "−12.3 ± 1.0"
    assert shown([0.5, None], 2) == "+50.00"
    assert shown([3.0, 1.0]) == "×4"
    assert shown([1e5, 1.0]) == shown([None, None]) == "diverges"
    table = [["", "a"], ["long", "+1"]]
    assert list(lines(table)) == ["       a", "long  +1"]
    assert markdown(table) == "|  | a |\n| --- | --: |\n| long | +1 |\n"


def test_what_the_page_says_of_its_figures():
    from benchmarks.ranking import FIXED, KALMAN, changes, described, summary

    text = (ROOT / "docs" / "ranking.json").read_text()
    found = json.loads(text)
    assert described(found) == (ROOT / "docs" / "ranking-tables.txt").read_text()
    assert summary(found) == (ROOT / "docs" / "ranking-summary.txt").read_text()
    assert summary(found) in (ROOT / "README.md").read_text()
    table = {name: changes(found, name) for name in (FIXED, KALMAN, "maneuver", "IMM CV/CA")}
    constant = {name: each["constant T"][0] for name, each in table[FIXED].items()}
    assert min(constant, key=constant.get) == "imm-three"
    assert constant["maneuver"] <= -0.13
    assert constant["maneuver-two-rules"] <= -0.12
    assert constant["imm-three"] <= -0.138
    # In every variant, weaving targets apart, by more than the error of the difference.
    for rival in ("Kalman CV", "Kalman CA", "IMM CV/CV", "IMM CV/CA"):
        for column, (value, error) in table["maneuver"][rival].items():
            assert value > 2 * error or "weaving" in column, (rival, column)
    behind = table["maneuver"]["imm-three"]
    assert -0.015 < behind["constant T"][0] < -0.005
    assert all(behind[column][0] > 0 for column in ("burst", "outliers", "told x.5"))
    assert all(value > -0.035 for value, _ in behind.values())
    for rival in ("imm-two", "imm-three", "IMM CV/CA"):
        assert -0.02 < table["maneuver"][rival]["weaving, constant T"][0] < -0.005
    assert abs(constant["stiffness-damping (tuned)"]) < 0.01
    assert constant["stiffness-damping"] > 0.3
    assert constant["omega-schedule"] < min(constant["Kalman CA"], constant["bank"])
    alternating = "alternate 1:10"
    assert table[KALMAN][FIXED][alternating][0] > 1000
    assert table[KALMAN][f"{FIXED} + period"][alternating][0] < 0.15


def test_unknown_names(capsys):
    from benchmarks.ranking import main

    with pytest.raises(SystemExit, match=r"error: --variants: unknown 'jiter'; did you mean"):
        main(["--variants", "jiter"])


@pytest.fixture
def folder(tmp_path):
    t = np.arange(0.0, 90.0)
    rows = [f"{x},{100 * x},{300 * math.sin(x / 9)}" for x in t]
    for name in ("adsb_turns/truth_1s.csv", "uav_gps/uav_enu.csv"):
        file = tmp_path / name
        file.parent.mkdir()
        file.write_text("\n".join(["t_s,x_m,y_m", *rows]))
    return tmp_path


def test_recorded_tracks(folder, tmp_path, capsys, monkeypatch):
    from benchmarks import recorded

    chosen = {"Kalman CV": "kalman-cv:sigma_v=2", "IMM CV/CA": "imm:quiet_sigma=1:maneuver_sigma=3"}
    monkeypatch.setattr(recorded, "ranked", lambda conditions: chosen)
    file = tmp_path / "r.json"
    assert recorded.main([str(folder), "--runs", "5", "-o", str(file)]) == 0
    found = json.loads(file.read_text())
    case = found["cases"]["ADS-B"]
    assert case["scans"] == 23
    assert found["cases"]["UAV"]["scans"] == 90
    imm, kalman = case["rmse"]["IMM CV/CA"], case["rmse"]["Kalman CV"]
    assert case["changes"]["Kalman CV"]["IMM CV/CA"][0] == pytest.approx(imm / kalman - 1, abs=1e-5)
    assert case["changes"]["Kalman CV"]["IMM CV/CA"][1] > 0
    assert case["changes"]["Kalman CV"]["Kalman CV"] == [0, 0]
    assert f"{imm:.4g}" in capsys.readouterr().out
    (folder / "uav_gps" / "uav_enu.csv").unlink()
    with pytest.raises(SystemExit, match=r"error: .*uav_enu.csv: No such file"):
        recorded.main([str(folder), "--runs", "2"])


def test_straight_tracks_that_are_lost():
    from benchmarks.straight import lost

    assert lost(make_tracker("kalman-cv:sigma_v=0.87"), 6, 3) == (0.0, False)
    assert lost(make_tracker("fixed:alpha=1.3:beta=1.2"), 6, 3) == (1.0, True)


def test_straight_tracks_as_a_table(tmp_path, capsys, monkeypatch):
    from benchmarks import straight

    chosen = {"fixed": "fixed:alpha=1.3:beta=1.2", "Kalman CV": "kalman-cv:sigma_v=0.87"}
    monkeypatch.setattr(straight, "ranked", lambda conditions: chosen)
    file = tmp_path / "s.json"
    assert straight.main(["--tracks", "3", "-o", str(file)]) == 0
    found = json.loads(file.read_text())
    assert found["lost"]["fixed"]["share"] == 1.0
    text = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[0] for line in text[1:]] == ["Kalman CV", "fixed"]
    assert "100.0" in text[2]


def test_plots_at_very_different_times(capsys, monkeypatch):
    from benchmarks import stress

    monkeypatch.setattr(stress, "TRACKS", 5)
    monkeypatch.setattr(stress, "with_level", lambda conditions: {})
    shares = []
    worst, broken = stress.stressed(make_tracker("kalman-cv:sigma_v=0.87"), 40, 3, shares.append)
    assert broken == 0
    assert 1.5 < worst < 5.5
    assert shares[-1] == 1.0
    # Without a covariance there is no variance of a prediction.
    assert stress.stressed(make_tracker("fixed:alpha=.5:beta=.2"), 4, 3, shares.append) == (0.0, 20)
    assert stress.main(["--plots", "20"]) == 0
    assert capsys.readouterr().out.startswith("Kalman CV ")
