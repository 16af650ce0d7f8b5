import numpy as np

from fuzzytrack.recordings.ragged import batches, run_tracks
from fuzzytrack.trackers.catalog import make_tracker


def test_many_tracks_run_as_one_by_one():
    rng = np.random.default_rng(2)
    tracks = []
    for length in (9, 1, 10, 40, 9, 2, 0, 33, 38):
        t = 1e12 + np.cumsum(rng.uniform(1, 2, length))
        z = rng.normal(size=(length, 2)).cumsum(axis=0)
        z[rng.random(length) < 0.2] = np.nan
        tracks.append((t, z))
    shares = []
    tracker = make_tracker("stiffness-damping")
    results = run_tracks(tracker, tracks, 1.0, shares.append)
    for (t, z), result in zip(tracks, results, strict=True):
        alone = tracker.run(t, z)
        for name in ("time", "measured", "predicted", "filtered", "velocity", "innovation"):
            np.testing.assert_array_equal(getattr(result, name), getattr(alone, name))
        np.testing.assert_array_equal(result.gains.beta, alone.gains.beta)
    assert shares[-1] == 1
    assert len(shares) < len(tracks)
    assert run_tracks(tracker, []) == []


def test_batches_hold_each_track_once_and_waste_little():
    lengths = [5, 100, 90, 70, 100, 1]
    found = batches([np.arange(float(n)) for n in lengths])
    assert sorted(k for b in found for k in b.members) == list(range(6))
    assert [sorted(b.members.tolist()) for b in found] == [[1, 2, 4], [3], [0], [5]]
    assert all((np.diff(b.times, axis=0) > 0).all() for b in found)
