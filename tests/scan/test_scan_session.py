"""A session: plain as compiled, errors that change nothing, pickles, parts of scans."""

import pickle

import numpy as np
import pytest

from fuzzytrack.errors import DataError
from fuzzytrack.scan import UNKNOWN_PLACE, Scan, ScanSession, ScanTracker, TrackReports
from fuzzytrack.scan.candidates import SectorCandidates
from fuzzytrack.scan.gate import BoxGate

COLUMNS = TrackReports.__dataclass_fields__


def scans(n=14, seed=1, clutter=3):
    """Two targets on straight courses, one of which is missed once, and clutter."""
    rng = np.random.default_rng(seed)
    for k in range(n):
        z = np.array([[3.0 * k, 50.0], [-80.0, 4.0 * k]]) + rng.normal(0, 0.5, (2, 2))
        z = z[:1] if k == 5 else z
        yield Scan(1.7 * k, np.concatenate([z, rng.uniform(-200, 200, (clutter, 2))]))


def assert_same(one, other):
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


def test_two_targets_become_two_tracks():
    result = ScanTracker().run(scans())
    assert result.track_ids.tolist() == [1, 2]
    last = result.reports.where(result.reports.scan == 13)
    np.testing.assert_allclose(last.velocity, [[3 / 1.7, 0], [0, 4 / 1.7]], atol=0.5)
    np.testing.assert_allclose(last.position, [[39, 50], [-80, 52]], atol=1.5)
    missed = result.reports.where(result.reports.scan == 5)
    assert missed.status.tolist() == [1, 2]
    assert missed.plot.tolist() == [0, -1]
    assert missed.since_last.tolist() == [0, pytest.approx(1.7)]


def test_parts_that_need_the_place_of_the_radar_refuse_a_scan_without_it():
    tracker = ScanTracker(gate=BoxGate(), candidates=SectorCandidates())
    session = tracker.start()
    session.step(Scan(0.0, np.ones((1, 2))))
    with pytest.raises(DataError, match=r"own: .* not known, and candidates and gate of this"):
        session.step(Scan(1.0, np.ones((1, 2)), own=UNKNOWN_PLACE))
    assert session.scans == 1


def test_plain_python_gives_the_same_bits():
    compiled, plain = ScanTracker().start(), ScanSession(ScanTracker(), plain=True)
    for scan in scans():
        assert_same(compiled.step(scan, tentative=True), plain.step(scan, tentative=True))


def test_a_session_pickles_and_goes_on():
    whole, cut = ScanTracker().start(), ScanTracker().start()
    for scan in scans():
        cut = pickle.loads(pickle.dumps(cut))
        assert_same(whole.step(scan, tentative=True), cut.step(scan, tentative=True))


@pytest.mark.parametrize(
    ("scan", "said"),
    [
        (Scan(50.0, np.array([[1.0, 2.0], [np.nan, 0.0]])), "plot 1"),
        (Scan(1.0, np.empty((0, 2))), "does not follow"),
        (Scan(np.nan, np.empty((0, 2))), "does not follow"),
        (Scan(50.0, np.zeros((1, 3))), "shape"),
        (Scan(50.0, np.zeros((1, 2)), times=np.array([51.0])), "later"),
        (Scan(50.0, np.zeros((1, 2)), covariances=np.array([[1.0, 2.0, 1.0]])), "covariance"),
    ],
)
def test_a_scan_that_cannot_be_used_changes_nothing(scan, said):
    session, other = ScanTracker().start(), ScanTracker().start()
    for each in scans():
        session.step(each)
        other.step(each)
    with pytest.raises(DataError, match=said):
        session.step(scan)
    later = Scan(60.0, np.array([[100.0, 50.0]]))
    assert_same(session.step(later, tentative=True), other.step(later, tentative=True))
    assert session.scans == other.scans


def test_new_tracks_are_numbered_in_the_order_of_their_plots():
    """Also where one takes the row of a track that ended with a plot in the same scan."""
    rng, session, last = np.random.default_rng(0), ScanTracker().start(), 0
    places = rng.uniform(0, 224, (50, 2))
    for k in range(60):
        seen = places[rng.random(50) < 0.93] + rng.normal(0, 1.2, 2)
        plots = rng.permutation(np.concatenate([seen, rng.uniform(0, 224, (100, 2))]))
        session.step(Scan(1.678 * k, plots, np.tile([1.44, 0, 1.44], (len(plots), 1))))
        tracks = session.tracks()
        new = tracks.plot[tracks.track_id > last]
        assert (np.diff(new) > 0).all()
        last = max(tracks.track_id.max(), last)
