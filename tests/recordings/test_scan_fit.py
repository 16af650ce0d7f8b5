"""What is noted when plots do not suit the configuration of a scan tracker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.recordings.scan_fit import ScanFit
from fuzzytrack.recordings.scan_run import ScannedScan
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scanners import make_scanner
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.simulation.scene.files import as_scene
from fuzzytrack.simulation.scene.simulate import simulate_scans


def movers(speed, *, period=2.0, scans=20, number=6, clutter=0, deviation=None, seed=1):
    """Targets on one course at one speed, far from each other, with clutter on their square."""
    rng = np.random.default_rng(seed)
    side = 400 * speed * period
    start = rng.uniform(0, side, (number, 2))
    found = []
    for k in range(scans):
        places = start + np.array([k * period * speed, 0.0])
        plots = np.vstack([places, rng.uniform(0, side, (clutter, 2))])
        given = None if deviation is None else np.tile([1.0, 0.0, 1.0], (len(plots), 1))
        scaled = None if given is None else given * deviation**2
        found.append(Scan(k * period, plots, covariances=scaled))
    return found


def notes(scans, config="default", *, confirmed=True, whole=True):
    """Notes about scans, as if a track had been confirmed or none."""
    fit = ScanFit(make_scanner(config), whole=whole)
    reports = TrackReports.none() if not confirmed else _CONFIRMED
    for scan in scans:
        fit.add(ScannedScan("", scan, reports))
    return list(fit.notes())


_CONFIRMED = ft.track_scans(
    {"t": np.arange(12.0) * 1.7, "x": np.arange(12.0) * 3, "y": np.full(12, 50.0)}
).result.reports


def test_plots_that_are_too_far_apart():
    (told,) = notes(movers(100.0))
    assert told == (
        "neighboring plots of successive scans are typically 200 m apart, as at 100 m/s; default "
        "lets a new track have at most 7.0 m/s: use config air (at most 350 m/s), or raise "
        "initiation.greatest_speed"
    )
    (told,) = notes(movers(15.0, period=60.0))
    assert "900 m apart, as at 15 m/s" in told
    assert "use config vessels" in told
    (told,) = notes(movers(2000.0))
    assert "config" not in told
    assert told.endswith("7.0 m/s: raise initiation.greatest_speed")


@pytest.mark.parametrize(
    ("config", "speed"),
    [("default", 5.0), ("vessels", 20.0), ("air", 300.0), ("zhang-jiang", 100.0)],
)
def test_plots_that_are_near_enough(config, speed):
    """The gate, and not a speed, decides in zhang-jiang."""
    assert notes(movers(speed), config) == []


def test_clutter_that_is_sparse_is_not_taken_for_fast_targets():
    assert notes(movers(100.0, number=0, clutter=30, scans=60)) == []
    assert notes(movers(5.0, number=6, clutter=30, scans=60)) == []
    assert len(notes(movers(100.0, number=6, clutter=6, scans=60))) == 1


def test_sectors_are_not_compared_with_the_next_one():
    assert notes(movers(100.0), whole=False) == []


def test_given_deviations_far_from_those_of_the_configuration():
    (told,) = notes(movers(3.0, deviation=20.0))
    assert told.startswith(
        "given standard deviations of plots are 20 m in range (median); default is made for "
        "0.99 m (sensor.range_noise): use config vessels (16 m), or"
    )
    (told,) = notes(movers(3.0, deviation=2000.0))
    assert "config " not in told
    (told,) = notes(movers(3.0, deviation=0.01))
    assert "are 0.010 m in range" in told
    assert notes(movers(3.0, deviation=2.0)) == []
    assert notes(movers(30.0, deviation=60.0), "air") == []


def test_deviations_across_are_compared_in_their_own_direction():
    """Wide in bearing only, of plots to the north and to the east."""
    places = np.array([[0.0, 1000.0], [1000.0, 0.0]])
    given = np.array([[40.0**2, 0.0, 1.0], [1.0, 0.0, 40.0**2]])
    scans = [Scan(2.0 * k, places, covariances=given) for k in range(12)]
    (told,) = notes(scans)
    assert "40 m in bearing (median); default is made for 6.0 m (sensor.bearing_noise)" in told


def test_no_track():
    scans = movers(3.0, number=2)
    (told,) = notes(scans, confirmed=False)
    assert told.startswith(
        "no track was confirmed in 20 scans: default expects plots exact to 0.99 m in range "
        "(sensor.range_noise), seen in 62 of 100 scans (sensor.detection), at most 7.0 m/s "
        "(initiation.greatest_speed)"
    )
    assert "config vessels or air" in told
    assert notes(scans[:5], confirmed=False) == []
    assert len(notes(movers(100.0), confirmed=False)) == 2


def test_empty_scans_and_single_plots():
    empty = [Scan(float(k), np.empty((0, 2))) for k in range(30)]
    assert notes(empty, confirmed=False) == []
    one = [Scan(2.0 * k, np.array([[3.0 * k, 0.0]])) for k in range(30)]
    assert notes([each for pair in zip(one, one, strict=True) for each in pair]) == []
    at_radar = [Scan(2.0 * k, np.zeros((1, 2)), covariances=np.ones((1, 3))) for k in range(30)]
    assert notes(at_radar) == []


@pytest.mark.parametrize("scene", ["harbor", "crossing", "dense-traffic:traffic.ships.count=100"])
def test_scenes_for_the_default_suit_it(scene):
    assert notes(simulate_scans(as_scene(scene), 3).scans) == []


def test_aircraft_suit_their_configuration_only():
    scans = simulate_scans(as_scene("air-surveillance"), 3).scans
    assert notes(scans, "air") == []
    for name in ("default", "vessels"):
        (told,) = notes(scans, name)
        assert "use config air" in told


def test_turns_that_take_longer_or_less():
    rng = np.random.default_rng(7)
    t = np.sort(rng.uniform(0, 200, 120))
    clutter = {"t": t, "x": rng.normal(0, 1e3, 120), "y": rng.normal(0, 1e3, 120)}
    for period, said in (
        (60.0, "120 plots are only 4 scans of 60 s, too few for a track; `period` is"),
        (0.05, "scans of 0.05 s have no plot, and most of the others one; `period` is"),
    ):
        notes = ft.track_scans(clutter, period=period).job.plots.findings.notes
        assert len(notes) == 2
        assert said in notes[1]


def test_the_notes_are_those_of_the_recording():
    rows = [(each.time, *place) for each in movers(100.0) for place in each.positions]
    t, x, y = np.array(rows).T
    found = ft.track_scans({"t": t, "x": x, "y": y}, sigma=30.0)
    told = found.job.plots.findings.notes
    assert [each.split(" ")[0] for each in told[-3:]] == ["neighboring", "given", "no"]
    assert "neighboring plots" in found._repr_html_()


def test_other_units_are_asked_for():
    scans = movers(3.0, clutter=10)
    (told,) = notes([replace(scan, time=1000 * scan.time) for scan in scans])
    assert told == (
        "scans are typically 2000 s apart; default is made for 1.678 s (sensor.period): are times "
        "in another unit than s?"
    )
    (told,) = notes([replace(scan, positions=scan.positions / 1000) for scan in scans])
    assert told.startswith("all plots are within 3.")
    assert told.endswith("(sensor.range_noise): are positions in another unit than m?")
    assert notes(scans) == []


def test_a_plot_of_another_time_is_counted():
    scans = [replace(scan, times=np.full(len(scan), scan.time)) for scan in movers(3.0)]
    assert notes(scans) == []
    wrong = scans[9].times.copy()
    wrong[2] = 3.0
    (told,) = notes([*scans[:9], replace(scans[9], times=wrong), *scans[10:]])
    assert told == (
        "earlier than the scan two before theirs, and so used for no track: 1 plot; look at their "
        "times"
    )
