"""Tracks, truth and detections there and back, and their metrics on our tracks."""

from datetime import UTC, datetime

import numpy as np
import pytest
from stonesoup.models.measurement.nonlinear import CartesianToBearingRange
from stonesoup.types.detection import Detection
from stonesoup.types.groundtruth import GroundTruthPath, GroundTruthState
from stonesoup.types.state import GaussianState, State
from stonesoup.types.track import Track
from stonesoup_scenes import EPOCH, at, components, detected, followed, linear, plots, states

import fuzzytrack as ft
from fuzzytrack.interop.stonesoup import from_stonesoup, stonesoup_metrics, to_stonesoup
from fuzzytrack.scan import Scan, ScanTracker
from fuzzytrack.scan.track_reports import TrackReports

MODEL = linear((0, 2), 4)


def by_id(tracks):
    return {track.id: track for track in tracks}


# ------------------------------------------------------------------- tracks to Stone Soup


def test_a_batch_becomes_tracks():
    t, z = plots(1, steps=12)
    batch = np.stack([z, z + 500.0, np.full_like(z, np.nan)], axis=1)
    batch[:4, 1] = np.nan
    result = ft.AlphaBetaTracker("fixed:alpha=0.5:beta=0.2").run(t, batch)
    found = by_id(to_stonesoup(result, epoch=EPOCH))
    # The third track has no plot.
    assert set(found) == {"0", "1"}
    for number in (0, 1):
        rows = ~np.isnan(result.filtered[:, number, 0])
        wanted = np.stack([result.filtered[:, number], result.velocity[:, number]], axis=-1)
        np.testing.assert_array_equal(states(found[str(number)]), wanted.reshape(-1, 4)[rows])
        assert [state.timestamp for state in found[str(number)]] == [at(s) for s in t[rows]]
    assert len(found["1"]) < len(t)


def test_tracks_with_times_of_their_own():
    t = np.array([[0.0, 10.0], [1.0, 12.0]])
    result = ft.AlphaBetaTracker("fixed:alpha=0.5:beta=0.2").run(
        t, [[[1.0], [2.0]], [[3.0], [4.0]]]
    )
    found = by_id(to_stonesoup(result, epoch=EPOCH))
    assert [state.timestamp for state in found["1"]] == [at(10), at(12)]
    np.testing.assert_array_equal(states(found["1"]), [[2.0, 0.0], [4.0, 1.0]])


def test_one_axis_alone_is_a_track():
    result = ft.AlphaBetaTracker("fixed:alpha=0.5:beta=0.2").run([0, 1], [5, 7])
    (track,) = to_stonesoup(result)
    np.testing.assert_array_equal(states(track), [[5.0, 0.0], [7.0, 2.0]])
    assert track[0].timestamp == datetime(1970, 1, 1)


def scans(seed):
    rng = np.random.default_rng(seed)
    for k in range(12):
        place = np.array([[3.0 * k, 50.0], [-80.0, 4.0 * k]])
        yield Scan(1.5 * k, place + rng.normal(0.0, 1.0, place.shape))


def test_reports_have_their_variances():
    result = ScanTracker().run(scans(2))
    found = by_id(to_stonesoup(result, epoch=EPOCH))
    assert set(found) == {"1", "2"}
    last = result.of_track(2)
    state = found["2"][-1]
    assert isinstance(state, GaussianState)
    x, y, vx, vy = last.deviation[-1] ** 2
    np.testing.assert_array_equal(state.covar, np.diag([x, vx, y, vy]))
    np.testing.assert_array_equal(
        states(found["2"])[-1], np.stack([last.position[-1], last.velocity[-1]], axis=-1).ravel()
    )


def test_a_row_that_coasts_beside_a_plot_is_left_out():
    reports = ScanTracker().run(scans(2)).reports
    plot = int(np.flatnonzero(reports.status > 0)[-1])
    doubled = TrackReports.joined([reports, reports.where(np.array([plot]))])
    doubled.plot[-1], doubled.deviation[-1] = -1, 99.0
    one, two = (
        by_id(to_stonesoup(each))[str(reports.track_id[plot])] for each in (reports, doubled)
    )
    assert len(one) == len(two)
    np.testing.assert_array_equal(one.covar, two.covar)


def test_truth_and_positions_without_velocity():
    (path,) = to_stonesoup(([1, 0], ["a", "a"], [[3, 4, 5], [0, 1, 2]]), truth=True, epoch=EPOCH)
    assert isinstance(path, GroundTruthPath)
    assert isinstance(path[0], GroundTruthState)
    assert path.id == "a"
    np.testing.assert_array_equal(states(path), [[0, 1, 2], [3, 4, 5]])


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        (3, TypeError, "tracks: int; expected a result of a tracker or scan tracker"),
        (
            {"time": [0.0], "id": [1], "position": [[1.0]], "group": ["a"]},
            ValueError,
            "have groups; give those of one recording",
        ),
        (([1e18], ["a"], [[1.0, 2.0]]), ValueError, r"1e\+18 s after .* years 1 to 9999"),
    ],
)
def test_what_is_no_tracks_is_refused(given, error, message):
    with pytest.raises(error, match=message):
        to_stonesoup(given)


# ------------------------------------------------------------------- from Stone Soup


def test_tracks_of_stone_soup_are_scored():
    t, z = plots(3, steps=30)
    track = followed(components("omega-schedule"), detected(t, z, MODEL))
    found = from_stonesoup({track}, velocity_mapping=(1, 3), epoch=EPOCH)
    np.testing.assert_array_equal(found.time, t)
    np.testing.assert_array_equal(found.position, states(track)[:, [0, 2]])
    np.testing.assert_array_equal(found.velocity, states(track)[:, [1, 3]])
    np.testing.assert_array_equal(found.coasting, np.isnan(z[:, 0]))
    assert set(found.id) == {track.id}
    scores = ft.score(found, (t, np.zeros(len(t)), found.position), scans=t)
    assert scores.groups[0].metrics["ospa"] == 0.0


def test_there_and_back():
    t, z = plots(4, steps=10, missed=0.0)
    result = ft.AlphaBetaTracker("omega-schedule").run(t, np.stack([z, z + 9.0], axis=1), 2.0)
    found = from_stonesoup(to_stonesoup(result), velocity_mapping=(1, 3))
    for number in range(2):
        rows = found.id == str(number)
        np.testing.assert_allclose(found.time[rows], t, atol=1e-6)
        np.testing.assert_array_equal(found.position[rows], result.filtered[:, number])
        np.testing.assert_array_equal(found.velocity[rows], result.velocity[:, number])


def test_of_states_at_one_time_the_last_counts():
    track = Track([State([k, 0.0], timestamp=at(1)) for k in (1.0, 2.0)])
    found = from_stonesoup(track, position_mapping=(0,), epoch=EPOCH)
    np.testing.assert_array_equal(found.position, [[2.0]])


def test_times_with_a_zone():
    begin = datetime(2030, 1, 1, tzinfo=UTC)
    track = Track([State([1.0, 0.0], timestamp=begin.replace(second=7))])
    assert from_stonesoup(track, position_mapping=(0,), epoch=EPOCH).time == [7.0]
    assert from_stonesoup(track, position_mapping=(0,), epoch=begin).time == [7.0]


def test_no_track_is_no_position():
    for items in (set(), [Track([])]):
        assert from_stonesoup(items).position.shape == (0, 2)


def test_detections_become_scans():
    t, z = plots(5, steps=20)
    given = list(detected(t, z, MODEL))
    found = from_stonesoup(given, epoch=EPOCH)
    assert [scan.time for scan in found] == t.tolist()
    for scan, plot in zip(found, z, strict=True):
        expected = plot[None] if not np.isnan(plot).any() else np.empty((0, 2))
        np.testing.assert_array_equal(scan.positions, expected)
        noise = np.tile([4.0, 0.0, 4.0], (len(expected), 1))
        np.testing.assert_array_equal(scan.covariances, noise)
    # Without the empty scans.
    every = [each for _, detections in given for each in detections]
    for again in (every, set(every)):
        scans = from_stonesoup(again, epoch=EPOCH)
        assert [scan.time for scan in scans] == t[~np.isnan(z[:, 0])].tolist()
        assert np.concatenate([scan.rows for scan in scans]).tolist() == list(range(len(every)))


def test_polar_detections_have_their_covariance():
    model = CartesianToBearingRange(4, (0, 2), np.diag([0.01**2, 4.0]))
    seen = Detection([np.pi / 2, 1000.0], timestamp=at(1))
    (scan,) = from_stonesoup({seen}, measurement_model=model, epoch=EPOCH)
    np.testing.assert_allclose(scan.positions, [[0.0, 1000.0]], atol=1e-9)
    # Across the line of sight 1000 m · 0.01, along it 2 m.
    np.testing.assert_allclose(scan.covariances, [[100.0, 0.0, 4.0]], atol=1e-5)


def test_a_scan_tracker_runs_on_them():
    given = [
        (
            at(scan.time),
            {
                Detection(p, timestamp=at(scan.time), measurement_model=MODEL)
                for p in scan.positions
            },
        )
        for scan in scans(3)
    ]
    result = ScanTracker().run(from_stonesoup(given, epoch=EPOCH))
    assert result.track_ids.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("items", "options", "error", "message"),
    [
        (3, {}, TypeError, "items: int; expected tracks, true paths or detections"),
        (
            Track([State([1.0, 0.0], timestamp=at(0))], id="a"),
            {},
            ValueError,
            r"position_mapping: \(0, 2\) does not fit the state vectors of a, which have 2 places",
        ),
        (
            Track([State([1.0, 0.0, 2.0, 0.0], timestamp=at(0))]),
            {"position_mapping": (0, 0)},
            ValueError,
            r"position_mapping: \(0, 0\) has a place twice",
        ),
        (
            Track([State([1.0, 0.0, 2.0, 0.0], timestamp=at(0))]),
            {"epoch": datetime(2030, 1, 1, tzinfo=UTC)},
            ValueError,
            "epoch: 2030-01-01 00:00:00.00:00 has a time zone, but",
        ),
        (
            Track([State([1.0, 0.0, 2.0, 0.0])]),
            {},
            ValueError,
            "items: a state or detection has no timestamp",
        ),
        (
            [
                Detection([1.0, 2.0], timestamp=when, measurement_model=MODEL)
                for when in (None, at(0))
            ],
            {},
            ValueError,
            "items: a state or detection has no timestamp",
        ),
        ([3], {}, TypeError, "items: int; expected tracks and true paths only"),
        ([(1, 2, 3)], {}, TypeError, "a mixture of detections and pairs"),
        (
            [Detection([1.0], timestamp=at(0), measurement_model=linear((0,), 2))],
            {"position_mapping": (0,)},
            ValueError,
            "scans have two axes",
        ),
    ],
)
def test_other_items_are_refused(items, options, error, message):
    with pytest.raises(error, match=message):
        from_stonesoup(items, **options)


# ------------------------------------------------------------------- metrics


def scene(seed, share=0.8):
    """Tracks near objects, some missing and some false, at common times."""
    rng = np.random.default_rng(seed)
    time = np.repeat(np.arange(30.0), 4)
    id = np.tile(np.arange(4), 30)
    course = np.stack([100.0 * id, 3.0 * time], axis=-1)
    speed = np.tile([0.0, 3.0], (len(time), 1))
    seen = rng.random(len(time)) < share
    tracks = {
        "time": time[seen],
        "id": id[seen],
        "position": (course + rng.normal(0.0, 4.0, course.shape))[seen],
        "velocity": speed[seen] + rng.normal(0.0, 1.0, (int(seen.sum()), 2)),
    }
    truth = {"time": time, "id": id, "position": course, "velocity": speed}
    return tracks, truth


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("order", [1, 2])
def test_metrics_agree_where_both_define_the_same(seed, order):
    tracks, truth = scene(seed)
    settings = {"cutoff": 10.0, "order": order, "families": ("ospa", "gospa")}
    theirs = stonesoup_metrics(tracks, truth, **settings)
    ours = ft.score(tracks, truth, cutoff=10.0, order=order, scans=np.arange(30.0))
    ours = ours.groups[0].metrics
    assert theirs["gospa"] == pytest.approx(ours["gospa"], rel=1e-9)
    if order == 1:
        assert theirs["ospa"] == pytest.approx(ours["ospa"], rel=1e-9)
    else:
        assert theirs["ospa"] >= ours["ospa"] * (1 - 1e-12)
    assert set(theirs) == {"ospa", "gospa"}


@pytest.mark.parametrize("seed", range(3))
def test_the_air_picture_is_near_ours(seed):
    """Associations are others, but both follow four objects without ambiguity."""
    tracks, truth = scene(seed, share=1.0)
    theirs = stonesoup_metrics(tracks, truth, cutoff=10.0, match=15.0)
    ours = ft.score(tracks, truth, match=15.0, scans=np.arange(30.0)).groups[0].metrics
    for name in ("completeness", "ambiguity", "position_accuracy", "velocity_accuracy"):
        assert theirs[name] == pytest.approx(ours[name], rel=0.02)
    assert set(theirs) <= set(ours)


def test_metrics_of_perfect_tracks():
    _, truth = scene(0)
    found = stonesoup_metrics(truth, truth)
    assert found["ospa"] == found["gospa"] == found["position_accuracy"] == 0.0
    assert found["completeness"] == found["longest_segment"] == 1.0
    assert found["velocity_accuracy"] == 0.0


def test_metrics_of_a_run_and_of_tracks_of_stone_soup_are_the_same():
    t, z = plots(6, steps=20, missed=0.0)
    result = ft.AlphaBetaTracker("omega-schedule").run(t, z, 2.0)
    truth = {"time": t, "id": np.zeros(len(t)), "position": z, "velocity": np.ones_like(z)}
    track = followed(components("omega-schedule"), detected(t, z, MODEL))
    one = stonesoup_metrics(result, truth, epoch=EPOCH)
    for theirs in (track, {track}, [track]):
        assert stonesoup_metrics(theirs, truth, epoch=EPOCH) == pytest.approx(one, rel=1e-9)
    assert one["ospa"] > 0.0


def test_velocities_that_one_side_lacks_are_left_out():
    t, z = plots(7, steps=20, missed=0.0)
    result = ft.AlphaBetaTracker("omega-schedule").run(t, z, 2.0)
    found = stonesoup_metrics(result, (t, np.zeros(len(t)), z))
    assert "velocity_accuracy" not in found
    errors = np.hypot(*(result.filtered - z).T)
    assert found["position_accuracy"] == pytest.approx(errors.mean())


def test_at_a_single_instant():
    tracks, truth = ([0.0], [1], [[3.0, 4.0]]), ([0.0], [1], [[0.0, 0.0]])
    found = stonesoup_metrics(tracks, truth, families=("ospa", "gospa"))
    assert found == {"ospa": 5.0, "gospa": 5.0}
    with pytest.raises(ValueError, match="SIAP needs two instants or more"):
        stonesoup_metrics(tracks, truth)


def test_a_gap_in_a_track_is_told():
    tracks, truth = scene(1)
    with pytest.raises(ValueError, match=r"tracks: \d has no state at 1970-01-01 00:00:.*coasting"):
        stonesoup_metrics(tracks, truth)


def test_unknown_families_are_refused():
    tracks, truth = scene(1)
    for families in ("hota", ["hota"]):
        with pytest.raises(ValueError, match="families: unknown 'hota'; some of ospa, gospa, siap"):
            stonesoup_metrics(tracks, truth, families=families)
    assert set(stonesoup_metrics(tracks, truth, families="gospa")) == {"gospa"}


@pytest.mark.parametrize(("name", "value"), [("cutoff", 0.0), ("order", 0.5), ("match", -1.0)])
def test_settings_of_metrics_are_checked(name, value):
    with pytest.raises(ValueError, match=f"{name}: must be"):
        stonesoup_metrics(*scene(1), **{name: value})


def test_nothing_at_all_is_refused():
    with pytest.raises(ValueError, match="tracks and truth: both are empty"):
        stonesoup_metrics(set(), set(), families="ospa")


def test_without_tracks_every_object_is_missed():
    _, truth = scene(1)
    found = stonesoup_metrics(set(), truth, cutoff=10.0)
    assert (found["ospa"], found["gospa"], found["completeness"]) == (10.0, 20.0, 0.0)


def test_velocities_of_stone_soup_are_left_out_too():
    t, z = plots(8, steps=5, missed=0.0)
    track = followed(components("omega-schedule"), detected(t, z, MODEL))
    found = stonesoup_metrics(track, (t, np.zeros(len(t)), z), epoch=EPOCH)
    errors = np.hypot(*(states(track)[:, [0, 2]] - z).T)
    assert found["ospa"] == pytest.approx(errors.mean())


@pytest.mark.parametrize(
    ("tracks", "error", "message"),
    [
        (([0.0], [1], [[1.0]]), ValueError, "positions have 1 and 2 axes"),
        (
            [Detection([1.0, 2.0], timestamp=at(0), measurement_model=MODEL)],
            TypeError,
            "tracks: detections",
        ),
    ],
)
def test_other_tracks_are_refused(tracks, error, message):
    with pytest.raises(error, match=message):
        stonesoup_metrics(tracks, scene(0)[1])
