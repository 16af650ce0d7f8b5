"""Gates of a scan: their outlines against what the session itself accepts."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from fuzzytrack.scan import Scan, ScanTracker
from fuzzytrack.scan.gate import gates
from fuzzytrack.scan.scan_gates import scan_gates

PERIOD = 1.7


def session_after(count, covariances=None, gate="covariance"):
    """A target that is seen in so many scans."""
    session = replace(ScanTracker(), gate=gates.get(gate)()).start()
    for k in range(count):
        place = np.array([[300.0 + 4.0 * k, 200.0 - 3.0 * k]])
        given = None if covariances is None else np.array([covariances])
        session.step(Scan(PERIOD * k, place, given))
    return session


def takes(session, time, place, covariances=None):
    """Whether the only track of a session takes a plot."""
    (id,) = session.tracks().track_id
    given = None if covariances is None else np.array([covariances])
    after = pickle.loads(pickle.dumps(session)).step(
        Scan(time, np.array([place]), given), tentative=True
    )
    return after.plot[after.track_id == id].tolist() == [0]


@pytest.mark.parametrize("covariances", [None, (30.0, 12.0, 9.0)])
@pytest.mark.parametrize(("count", "wait"), [(1, 1), (2, 1), (12, 1), (12, 3)])
def test_a_plot_is_taken_inside_of_the_outline_and_not_outside(count, wait, covariances):
    session = session_after(count, covariances)
    time = PERIOD * (count - 1 + wait)
    given = None if covariances is None else np.array([covariances])
    found = scan_gates(session, Scan(time, np.array([[9e3, 9e3]]), given), directions=8)
    (middle,), (outline,) = found.predicted, found.outlines
    for corner in outline:
        assert np.hypot(*(corner - middle)) > 1
        assert takes(session, time, middle + 0.98 * (corner - middle), covariances)
        assert not takes(session, time, middle + 1.02 * (corner - middle), covariances)


@pytest.mark.parametrize("gate", ["round", "box"])
def test_outlines_are_those_of_the_gate_whatever_its_part(gate):
    session = session_after(8, gate=gate)
    time = 8 * PERIOD
    found = scan_gates(session, Scan(time, np.array([[9e3, 9e3]])), directions=8)
    (middle,), (outline,) = found.predicted, found.outlines
    for corner in outline:
        assert takes(session, time, middle + 0.98 * (corner - middle))
        assert not takes(session, time, middle + 1.02 * (corner - middle))


def test_the_session_stays_as_it_is():
    session = session_after(5)
    before = pickle.dumps(session)
    scan_gates(session, Scan(20.0, np.array([[320.0, 185.0]])))
    assert pickle.dumps(session) == before


def test_taken_plots_are_named_by_their_place_in_the_scan():
    tracker = ScanTracker()
    session = tracker.start()
    places = np.array([[0.0, 100.0], [400.0, 100.0], [0.0, -300.0]])
    for k in range(6):
        session.step(Scan(PERIOD * k, places + np.array([0.0, 2.0 * k])))
    moved = np.array([0.0, 12.0])
    plots = np.array([[5e3, 5e3], places[2] + moved, places[1] + moved])
    for rows in (None, np.array([70, 30, 50])):
        found = scan_gates(session, Scan(PERIOD * 6, plots, rows=rows))
        assert found.tracks.track_id.tolist() == [1, 2, 3]
        assert found.taken.tolist() == [-1, 2, 1]
    found = scan_gates(session, Scan(PERIOD * 6, np.empty((0, 2)), rows=np.empty(0, np.int64)))
    assert found.taken.tolist() == [-1, -1, -1]


def test_without_a_track_there_is_no_gate():
    found = scan_gates(ScanTracker().start(), Scan(0.0, np.array([[1.0, 2.0]])))
    assert found.predicted.shape == (0, 2)
    assert found.outlines.shape == (0, 96, 2)
    assert repr(found) == "<ScanGates: tracks=0, taken=0>"


def test_a_scan_with_rows_but_without_a_plot_is_a_miss():
    session = session_after(6)
    after = session.step(Scan(6 * PERIOD, np.empty((0, 2)), rows=np.empty(0, np.int64)))
    assert after.plot.tolist() == [-1]
