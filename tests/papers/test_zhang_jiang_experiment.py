"""The experiment with vessels around a radar, small; its figures are those of `reproduce`."""

import numpy as np
import pytest

from fuzzytrack.papers.zhang_jiang import experiment
from fuzzytrack.papers.zhang_jiang.experiment import published, safe, savings, track_errors
from fuzzytrack.papers.zhang_jiang.vessels import Traffic
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.track_reports import TrackReports


@pytest.fixture(scope="module")
def turning():
    return Traffic(vessels=60, scans=150, clutter=15).record(1.0, seed=3)


def test_vessels_keep_their_speed_and_turn_no_faster_than_said(turning):
    steps = np.diff(turning.truth, axis=0) / 3.0
    speed = np.hypot(steps[..., 0], steps[..., 1])
    assert speed.min() > 3.9
    assert speed.max() < 12.01
    heading = np.unwrap(np.arctan2(steps[..., 1], steps[..., 0]), axis=0)
    turned = abs(np.diff(heading, axis=0)) / 3.0
    assert np.degrees(turned.max()) < 1.001
    assert np.degrees(turned.max()) > 0.8
    assert (turned > 1e-9).mean() > 0.05


def test_plots_are_those_of_their_vessels(turning):
    errors, seen = [], 0
    for scan, vessel, truth in zip(turning.scans, turning.vessel, turning.truth, strict=True):
        mine = vessel >= 0
        assert (~mine).sum() == 15
        seen += mine.sum()
        errors.append(np.hypot(*scan.positions[mine].T) - np.hypot(*truth[vessel[mine]].T))
    assert seen / (60 * 150) == pytest.approx(0.95, abs=0.01)
    assert np.concatenate(errors).std() == pytest.approx(15.0, rel=0.05)


def test_the_safe_gate_loses_fewer_vessels_that_turn(turning):
    lost = track_errors(turning, published().run(turning.scans))
    kept = track_errors(turning, safe().run(turning.scans))
    assert kept[2] < 0.4 * lost[2]
    assert kept[0] < lost[0]
    assert kept[0] == pytest.approx(9.1, abs=1.0)


def test_sectors_save_nearly_half_their_number(turning):
    saved = savings(turning, published(), (8, 32))
    assert saved[8] == pytest.approx(4.0, abs=0.2)
    assert 13.0 < saved[32] < 16.0


def test_errors_and_breaks_by_hand():
    """One vessel that stands still at 2 km; its track is 3 m farther, and is replaced once."""
    traffic = Traffic(vessels=1, scans=24, clutter=0).record(0.0, seed=0)
    traffic.truth[:] = [2000.0, 0.0]
    for k in range(24):
        traffic.vessel[k] = np.zeros(1, np.int64)
    n = 24
    scan = np.arange(n)
    reports = TrackReports(
        scan, 3.0 * scan, np.where(scan < 22, 1, 2), np.full((n, 2), [2003.0, 0.0]),
        np.zeros((n, 2)), np.zeros((n, 4)), np.ones(n, np.uint8), np.ones(n, np.uint8),
        np.full(n, np.nan), np.zeros(n), np.zeros(n, np.int64),
    )  # fmt: skip
    result = ScanResult.of(reports, list(3.0 * scan), [(0.0, 0.0)] * n, [1] * n, "by hand")
    error, bearing, breaks = track_errors(traffic, result)
    assert error == pytest.approx(3.0)
    assert bearing == pytest.approx(0.0, abs=1e-9)
    assert breaks == 1.0


def test_rows_of_a_small_run():
    shares = []
    rows = experiment.experiment_rows(Traffic(20, 40, 5), 1, 0, shares.append)
    assert len(rows) == 3 * len(experiment.CASES) + 4
    same = [row for row in rows if "those of all pairs" in row.quantity]
    assert [row.verdict for row in same] == ["matches", "matches"]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
