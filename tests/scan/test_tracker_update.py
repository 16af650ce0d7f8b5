"""Trackers of the package as the update of a scan tracker."""

import pickle

import numpy as np
import pytest

from fuzzytrack.scan import Scan, ScanSession, ScanTracker
from fuzzytrack.scan.update import TrackerUpdate
from fuzzytrack.trackers.catalog import as_tracker

TEXTS = ["fixed:alpha=0.5:beta=0.2", "kalman-cv:sigma_v=0.1", "maneuver"]


def ship(n=16, gap=(6,)):
    rng = np.random.default_rng(2)
    covariance = np.array([[1.0, 0.0, 1.0]])
    for k in range(n):
        z = np.array([[4.0 * k, 30.0 + 2.0 * k]]) + rng.normal(0, 0.6, (1, 2))
        seen = slice(0, 0 if k in gap else 1)
        yield Scan(1.678 * k, z[seen], covariances=covariance[seen])


def session_of(text):
    return ScanSession(ScanTracker(update=TrackerUpdate(text)), plain=True)


@pytest.mark.parametrize("text", TEXTS)
def test_a_track_is_that_of_the_tracker_alone(text):
    tracker, state, session = as_tracker(text), None, session_of(text)
    for scan in ship():
        reports = session.step(scan, tentative=True)
        assert reports.track_id.tolist() == [1]
        if len(scan) and state is None:
            state = tracker.start(scan.positions[0], scan.time, 1.0)
        elif len(scan):
            state = tracker.step(state, scan.positions[0], scan.time, 1.0)
        if len(scan):
            np.testing.assert_array_equal(reports.position[0], state.position)
            np.testing.assert_array_equal(reports.velocity[0], state.velocity)
        else:
            ahead = tracker.predict(state, scan.time)
            np.testing.assert_allclose(reports.position[0], ahead.position, rtol=1e-12)
    assert reports.status.tolist() == [1]


def test_it_pickles_and_forgets_tracks_that_ended():
    whole, cut = session_of(TEXTS[1]), session_of(TEXTS[1])
    rng = np.random.default_rng(4)
    for k, scan in enumerate(ship()):
        clutter = rng.uniform(-300, 300, (5, 2))
        z = np.concatenate([scan.positions, clutter])
        cut = pickle.loads(pickle.dumps(cut))
        one = whole.step(Scan(scan.time, z), tentative=True)
        other = cut.step(Scan(scan.time, z), tentative=True)
        np.testing.assert_array_equal(one.position, other.position)
        np.testing.assert_array_equal(one.track_id, other.track_id)
        assert len(whole._companion._store) == whole.n_tracks, k


def test_a_text_that_names_no_tracker_is_refused_at_once():
    with pytest.raises(ValueError, match="no such tracker"):
        TrackerUpdate("nobody")
