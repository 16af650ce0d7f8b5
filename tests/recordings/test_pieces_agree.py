"""A recording that is tracked whole, in pieces or in partitions gives the same rows."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.large_jobs import LargeJob
from fuzzytrack.recordings.preparation import prepare
from fuzzytrack.recordings.tracking import track_recording
from fuzzytrack.trackers.catalog import make_tracker

pq = pytest.importorskip("pyarrow.parquet")

POSITIONS = {
    "cartesian": ("x,y", {}),
    "polar": ("range,azimuth", {"polar": ("range", "azimuth")}),
    "geodetic": ("lat,lon", {"geodetic": ("lat", "lon")}),
    "angle": ("bearing", {"angle": "bearing"}),
}


def placed(kind, t, rng):
    """Positions of a target that moves straight on; bearings pass north, longitudes the date
    line."""
    noise = rng.normal(size=2)
    if kind == "cartesian":
        return 20 * t + 3 * noise[0], 500 - 8 * t + 3 * noise[1]
    if kind == "polar":
        return 5000 + 10 * t + 3 * noise[0], (357 + 0.3 * t + 0.05 * noise[1]) % 360
    if kind == "geodetic":
        lon = 179.998 + 2e-4 * t + 2e-5 * noise[1]
        return -40 + 1e-4 * t + 2e-5 * noise[0], (lon + 180) % 360 - 180
    return ((357 + 0.4 * t + 0.1 * noise[0]) % 360,)


@st.composite
def recordings(draw):
    """Text of a file with the faults of real ones, and how it is read."""
    kind = draw(st.sampled_from(sorted(POSITIONS)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    names, options = POSITIONS[kind]
    count, tracks = draw(st.integers(1, 120)), draw(st.integers(1, 4))
    share = {
        name: draw(st.sampled_from([0.0, 0.05, 0.3]))
        for name in ("missed", "spike", "gap", "equal", "copy", "stale", "near", "unnamed")
    }
    rows, time, last = [], dict.fromkeys(range(tracks), 0.0), {}
    for _ in range(count):
        one = int(rng.integers(tracks))
        happens = {name: bool(rng.random() < p) for name, p in share.items()}
        step = 1e-3 if happens["near"] else 1.0
        step = 700.0 * int(rng.integers(1, 3)) if happens["gap"] else step
        time[one] += 0.0 if happens["equal"] else step
        position = [f"{value:.7f}" for value in placed(kind, time[one] % 600, rng)]
        if happens["stale"]:
            position = last.get(one, position)
        last[one] = position
        if happens["spike"]:
            position = [f"{float(value) * 1.02 + 0.01:.7f}" for value in position]
        if happens["missed"]:
            position = [""] * len(position)
        row = ",".join(["" if happens["unnamed"] else f"k{one}", repr(time[one]), *position])
        rows += [row] * (2 if happens["copy"] else 1)
    options = dict(options, id="id", duplicates=draw(st.sampled_from(["first", "last", "mean"])))
    if draw(st.booleans()):
        options |= {"stale": math.inf, "max_coast": 5.0}
    if draw(st.booleans()):
        options |= {"max_gap": draw(st.sampled_from([None, 3.0, 500.0]))}
    if kind in ("cartesian", "geodetic") and draw(st.booleans()):
        options |= {"sigma": draw(st.sampled_from([3.0, (3.0, 5.0)]))}
    return f"id,t,{names}\n" + "\n".join(rows) + "\n", options


def by_track(path):
    """Rows of a table, track by track in order of time."""
    return pq.read_table(path).sort_by([(name, "ascending") for name in ("id", "t", "segment")])


# Of gains that do not suit the times, which the recordings change.
@pytest.mark.untraced
@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.TrackWarning")
@settings(
    max_examples=15,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    recording=recordings(),
    tracker=st.sampled_from([None, "stiffness-damping", "kalman-cv:sigma_v=1"]),
    gate=st.sampled_from(["auto", None, 4.0]),
    rows=st.sampled_from([1, 7, 1000]),
)
def test_whole_pieces_and_partitions_give_the_same(tmp_path, recording, tracker, gate, rows):
    text, options = recording
    path, at_once, in_pieces = (tmp_path / name for name in ("in.csv", "a.parquet", "b.parquet"))
    path.write_text(text)
    reading = Reading.of(**options)
    tracker = None if tracker is None else make_tracker(tracker)
    refused = None
    try:
        whole = track_recording(path, tracker, reading, gate=gate)
    except (ValueError, ArithmeticError) as error:
        refused = error
    if refused is not None:
        # Without noise there is no gate and no covariance, without a place no frame.
        assert any(word in str(refused) for word in ("sigma", "identity", "latitude"))
        with pytest.raises(type(refused)):
            in_pieces_of(path, tracker, reading, gate, rows, in_pieces)
        assert not in_pieces.exists()
        return
    whole.write(at_once)
    totals = in_pieces_of(path, tracker, reading, gate, rows, in_pieces)
    assert by_track(in_pieces) == by_track(at_once)
    assert totals.findings.sentences() == whole.findings.sentences()
    assert totals.plots == whole.totals.plots
    in_pieces.unlink()


def in_pieces_of(path, tracker, reading, gate, rows, output):
    prepared = prepare(path, tracker, reading, gate)
    job = LargeJob(prepared.files, prepared.tracker, rows, prepared.judge)
    return job.track(output)
