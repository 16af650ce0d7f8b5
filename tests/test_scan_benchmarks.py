"""Benchmarks of scan trackers: their judge, their scenes and their tables, on little work."""

import json

import numpy as np
import pytest

from benchmarks import (
    aircraft,
    autoferry,
    dense_traffic,
    scan_rivals,
    scan_speed,
    stonesoup_clutter,
)
from benchmarks.scan_judge import Rule, fast_rows, judged, mean_judgment
from benchmarks.scan_peers import (
    Followed,
    Setting,
    followed,
    plot_covariances,
    shipped,
    stonesoup,
)
from benchmarks.scan_speed import Cost, exponents
from benchmarks.scan_traffic import traffic
from fuzzytrack.scan.scan import Scan


def tracks_of(*rows):
    """Tracks of rows (time, identity, x, y)."""
    values = np.array(rows, float).reshape(-1, 4)
    return Followed(values[:, 0], values[:, 1].astype(np.int64), values[:, 2:], np.full(4, 0.002))


TIMES = [0.0, 1.0, 2.0, 3.0]
PATH = {7: np.array([[0.0, 0.0, 0.0], [3.0, 30.0, 0.0]])}


def test_a_track_that_is_late_lost_and_taken_over():
    found = tracks_of((1, 4, 10, 3), (2, 4, 20, 80), (3, 5, 30, 4))
    figures = judged(found, TIMES, PATH, 1.0, complete=True)
    # Nothing, 3 m, a false track 80 m away, and 4 m.
    assert figures.ospa == pytest.approx((20 + 3 + 20 + 4) / 4)
    assert figures.tracked == 0.5
    assert figures.delay == 1.0
    assert (figures.switches, figures.breaks) == (1, 1)
    assert figures.false == pytest.approx(60 / 4)
    assert figures.false_tracks == 0.0
    assert figures.rmse == pytest.approx(np.sqrt((9 + 16) / 2))
    assert figures.milliseconds == pytest.approx(2.0)


def test_what_is_far_from_known_targets_counts_only_where_the_truth_is_complete():
    near = [(t, 1, 10 * t, 0) for t in range(4)]
    still = tracks_of(*near, *((t, 2, 500, 500) for t in range(4)))
    assert judged(still, TIMES, PATH, 1.0, complete=False).ospa == 0.0
    # One track too many: sqrt(20²/2).
    counted = judged(still, TIMES, PATH, 1.0, complete=True)
    assert counted.ospa == pytest.approx(np.sqrt(200))
    assert (counted.fast, counted.false) == (0.0, 60.0)
    assert counted.false_tracks == pytest.approx(15.0)


def test_a_false_track_that_moves_is_fast():
    near = [(t, 1, 10 * t, 0) for t in range(4)]
    moving = tracks_of(*near, *((t, 2, 500 + 3 * t, 0) for t in range(4)))
    figures = judged(moving, TIMES, PATH, 1.0, complete=False)
    # At its first scan it has no path yet.
    assert figures.fast == pytest.approx(45.0)
    assert figures.ospa == 0.0
    assert figures.ospa_fast == pytest.approx(3 * np.sqrt(200) / 4)
    assert fast_rows(moving, Rule(fast=2.0, window=8.0)).tolist() == [
        False, True, True, True, False, False, False, True
    ]  # fmt: skip


def test_nothing_reported():
    figures = judged(tracks_of(), TIMES, PATH, 1.0, complete=True)
    assert (figures.ospa, figures.tracked, figures.delay) == (20.0, 0.0, 4.0)
    assert np.isnan(figures.rmse)


def test_pairs_are_one_to_one_and_as_many_as_can_be():
    """Near both tracks, the first target takes the one that the second cannot."""
    path = {1: np.array([[0, 0, 0], [3, 0, 0.0]]), 2: np.array([[0, 14, 0], [3, 14, 0.0]])}
    found = tracks_of((0, 1, 1, 0), (0, 2, -14, 0))
    assert judged(found, [0.0], path, 1.0, complete=True).tracked == 1.0


def test_means():
    one = judged(tracks_of(), TIMES, PATH, 1.0, complete=True)
    two = judged(tracks_of((1, 4, 10, 3)), TIMES, PATH, 1.0, complete=True)
    assert mean_judgment([one, two]).tracked == pytest.approx(0.125)


def test_covariances_of_plots():
    setting = Setting(1.0, range_noise=3.0, bearing_noise=0.01, extra_noise=1.0)
    east, north = plot_covariances(Scan(0.0, np.array([[500.0, 0], [0, 200.0]])), setting)
    np.testing.assert_allclose(east, np.diag([10.0, 26.0]))
    np.testing.assert_allclose(north, np.diag([5.0, 10.0]))
    told = Scan(0.0, np.zeros((1, 2)), covariances=np.array([[4.0, 1.0, 9.0]]))
    np.testing.assert_allclose(plot_covariances(told, setting)[0], [[4, 1], [1, 9]])


def test_traffic_has_the_density_that_is_asked():
    world = traffic(500, 5000.0, scans=6, clutter=2.0, detection=0.9, seed=3)
    counts = [len(scan) for scan in world.scans]
    assert np.mean(counts) == pytest.approx(500 * 2.9, rel=0.03)
    assert world.truth.shape == (6, 500, 2)
    speed = np.linalg.norm(np.diff(world.truth, axis=0), axis=2) / 1.678
    assert speed.min() >= 1
    assert speed.max() <= 6
    # Plots of ships are near them.
    nearest = np.linalg.norm(world.truth[2][:, None] - world.scans[2].positions, axis=2).min(axis=1)
    assert (nearest < 5).mean() > 0.85


def test_ships_that_are_found():
    assert dense_traffic.matched(np.empty((0, 2)), np.zeros((3, 2))) == 0
    ships = np.array([[0.0, 0], [14, 0], [100, 0]])
    assert dense_traffic.matched(np.array([[1.0, 0], [-14, 0], [300, 0]]), ships) == 2


def test_exponents_of_growth():
    sizes = [Cost("default", n, n**1.1, 0, 0, 0) for n in (2, 100, 1000, 10_000)]
    found = exponents([*sizes, Cost("norfair", 100, 5, 0, 0, 0)])
    assert list(found) == ["100 to 1,000", "1,000 to 10,000", "100 to 10,000"]
    assert list(found.values()) == pytest.approx([1.1, 1.1, 1.1])


def test_a_mean_has_its_error():
    mean, error = scan_rivals.mean_and_error(np.array([1.0, 2.0, 3.0]))
    assert (mean, error) == pytest.approx((2.0, 1 / np.sqrt(3)))
    assert np.isnan(scan_rivals.mean_and_error(np.array([1.0]))[1])


def harbor(folder):
    """A boat and a buoy as the tables of the data set have them, and a scan without a plot."""
    folder.mkdir()
    plots, scans, truth = [], [], []
    for scenario, lag in autoferry.LAGS.items():
        for k in range(25):
            t = 1.678 * k
            scans.append(f"{scenario},{k},{t},0,0,2")
            truth.append(f"{scenario},1,{t - lag},{50 + 3 * t},20")
            if k != 9:
                plots += [f"{scenario},{k},{t},0,0,{50 + 3 * t},{20 + k % 2}"]
                plots += [f"{scenario},{k},{t},0,0,-60,{5 + k % 3}"]
    heads = {
        "radar_detections.csv": ("scenario,scan,t_s,rel_north_m,rel_east_m,north_m,east_m", plots),
        "radar_scans.csv": ("scenario,scan,t_s,own_north_m,own_east_m,n_detections", scans),
        "ground_truth.csv": ("scenario,target_id,t_s,north_m,east_m", truth),
    }
    for name, (head, rows) in heads.items():
        (folder / name).write_text("\n".join([head, *rows, ""]))


def test_the_harbor_script(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(autoferry, "CONFIGURATIONS", ("default",))
    monkeypatch.setattr(autoferry, "TRACKERS", {})
    harbor(tmp_path / "data")
    out = tmp_path / "figures.json"
    assert autoferry.main([str(tmp_path / "data"), "-o", str(out)]) == 0
    told, printed = json.loads(out.read_text()), capsys.readouterr().out
    assert list(told) == ["default"]
    for each in told.values():
        assert list(each) == ["2", "4", "16", "mean"]
        assert each["mean"]["tracked"] > 0.7
        assert each["mean"]["fast"] == 0
    assert "with fast" in printed


def test_the_script_of_crowded_water(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(scan_rivals, "CONFIGURATIONS", ("default", "default:sensor.period=1.678"))
    monkeypatch.setattr(
        scan_rivals, "traffic", lambda seed, real=scan_rivals.traffic: real(seed, 8, 12)
    )
    monkeypatch.setattr(scan_rivals, "TOLD", "default")
    out, kept = tmp_path / "figures.json", tmp_path / "kept"
    arguments = ["--seeds", "2", "--keep", str(kept), "-o", str(out)]
    assert scan_rivals.main(arguments) == 0
    first = out.read_text()
    names = ("default", "default-sensor-period-1-678", "default-told")
    assert {each.name for each in kept.iterdir()} == {
        f"{name}-{seed}.npz" for name in names for seed in (0, 1)
    }
    assert "minus default" in capsys.readouterr().out
    # From what is kept, the same comes out.
    monkeypatch.setattr(scan_rivals, "shipped", lambda _name: None)
    assert scan_rivals.main(arguments) == 0
    assert out.read_text() == first


def test_the_script_of_trackers_within_stone_soup(capsys):
    pytest.importorskip("stonesoup", reason="Stone Soup is not installed")
    trackers = "kalman-cv:sigma_v=0.2,maneuver:level=0.3"
    assert stonesoup_clutter.main(["--seeds", "1", "--scans", "10", "--trackers", trackers]) == 0
    means, changes = capsys.readouterr().out.split("minus Stone Soup Kalman")
    for name in ("Stone Soup Kalman", *trackers.split(",")):
        row = next(line for line in means.splitlines() if line.startswith(name))
        ospa, tracked = row[len(name) :].split()[:2]
        # Half of the scans are before the fourth plot.
        assert 2.0 < float(ospa) < 16.0
        assert float(tracked) > 0.4
        assert (name in changes) == (name != "Stone Soup Kalman")


def test_the_script_of_dense_traffic(monkeypatch, tmp_path):
    monkeypatch.setattr(dense_traffic, "CONFIGURATIONS", ("default",))
    out = tmp_path / "figures.json"
    arguments = ["--ships", "40", "--seeds", "2", "-o", str(out)]
    assert dense_traffic.main(arguments) == 0
    assert all(one["confirmed"] > 0.9 for one in json.loads(out.read_text())["default"])


def test_the_cost_of_a_scan():
    found = scan_speed.cost("default", 20, 5000.0, 10, True)
    assert found.milliseconds > 0
    assert found.worst >= found.milliseconds
    text = scan_speed.described([found, "norfair: missing"], {"processor": "some"}, True)
    assert "| default | 20 |" in text
    assert "- norfair: missing" in text


def test_the_aircraft(tmp_path):
    rng, rows = np.random.default_rng(1), ["scan,t_s,truth_id,range_m,az_deg"]
    path = [[4 * k, 20_000 + 600 * k, 30_000] for k in range(40)]
    for k, (t, x, y) in enumerate(path):
        if k != 20:
            azimuth = np.degrees(np.arctan2(x, y)) + 0.1 * rng.standard_normal()
            rows.append(f"{k},{t},a,{np.hypot(x, y) + 50 * rng.standard_normal()},{azimuth}")
        rows.append(f"{k},{t},,{120_000 * rng.random()},{360 * rng.random()}")
    (tmp_path / "radar_plots_sim.csv").write_text("\n".join([*rows, ""]))
    truth = "\n".join(f"{t},{x},{y}" for t, x, y in path)
    (tmp_path / "truth_1s.csv").write_text(f"t_s,x_m,y_m\n{truth}\n")
    figures, tracks = aircraft.judge(tmp_path)
    assert tracks == 1
    assert figures.tracked > 0.85
    assert figures.rmse < 150


def test_peers_follow_a_ship():
    pytest.importorskip("stonesoup")
    world = traffic(3, 50_000.0, scans=12, clutter=0.0, detection=1.0)
    setting = Setting(1.678, range_noise=1.0, bearing_noise=0.0)
    times = [scan.time for scan in world.scans]
    peers = {name: stonesoup(name) for name in ("GNN", "JPDA", "JPDA by propagation")}
    for peer in (*peers.values(), shipped("default")):
        found = followed(peer, world.scans, setting)
        figures = judged(found, times, world.paths(), 1.678, complete=True)
        assert figures.tracked > 0.6
        assert figures.rmse < 3
        assert len(found.seconds) == 12
