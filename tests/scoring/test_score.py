"""Scores in one call: groups, kinds, lags, and what the truth lists."""

import json
import math
import pickle

import numpy as np
import pytest
from matplotlib.figure import Figure

import fuzzytrack as ft
from fuzzytrack.errors import DataError
from fuzzytrack.plotting import plot_scores
from fuzzytrack.scoring import METRICS, Positions, Scores

TIMES = np.arange(30.0)


def boats(offset=0.0, ids=(1, 2), times=TIMES, noise=0.0, seed=0):
    """Two boats that sail side by side: time, id, position."""
    rng = np.random.default_rng(seed)
    time, id = np.repeat(times, 2), np.tile(ids, len(times))
    position = np.stack([5 * time, np.tile([0.0, 200.0], len(times))], axis=1)
    return time, id, position + offset + rng.normal(0, noise, position.shape)


def test_perfect_tracks():
    found = ft.score(boats(ids=("a", "b")), boats())
    for name, metric in METRICS.items():
        if name in ("position_accuracy", "velocity_accuracy", "motp", "rmse"):
            assert found[name] == pytest.approx(0)
        elif metric.best == "least":
            assert found[name] == pytest.approx(0, abs=1e-6), name
        else:
            assert found[name] == pytest.approx(1), name


def test_every_metric_is_a_number_by_name():
    found = ft.score(boats(noise=2.0), boats())
    assert list(found.means) == list(METRICS)
    assert all(isinstance(value, float) for value in found.means.values())
    assert found["motp"] == pytest.approx(found["position_accuracy"])
    with pytest.raises(KeyError, match="'speed'; expected one of ospa"):
        found["speed"]


def test_tracks_of_nothing_and_no_tracks():
    none = ft.score((np.empty(0), np.empty(0), np.empty((0, 2))), boats())
    assert (none["ospa"], none["share_tracked"], none["never_matched"]) == (20, 0, 2)
    assert none["first_match"] == pytest.approx(29)
    assert math.isnan(none["motp"])
    wrong = ft.score(boats(offset=1000.0), boats())
    assert wrong["false_per_minute"] == pytest.approx(120)


def with_a_buoy(kind="static", far=500.0):
    time, id, position = boats(noise=1.0)
    buoy = np.column_stack([np.full(30, -far), np.full(30, -far)])
    return {
        "time": np.concatenate([time, TIMES]),
        "id": np.concatenate([id, np.full(30, 7)]),
        "position": np.concatenate([position, buoy]),
        "kind": np.array(["moving"] * 60 + [kind] * 30),
    }


@pytest.mark.parametrize("kind", ["static", "undecided"])
def test_objects_that_the_truth_does_not_list(kind):
    every = ft.score(with_a_buoy(kind), boats())
    listed = ft.score(with_a_buoy(kind), boats(), truth_lists="moving")
    assert every["ospa"] > 10 > 3 > listed["ospa"]
    assert listed.groups[0].left_out == 30
    assert "30 rows of static tracks far from the truth left out" in listed.notes
    # It is a false track that does not move, whatever the truth lists.
    for found in (every, listed):
        assert found["static_false_per_minute"] == pytest.approx(60)
        assert found["moving_false_per_minute"] == 0
    assert list(every.groups[0].by_kind) == ["moving", kind]
    assert every.means_by_kind["moving"]["ospa"] == pytest.approx(listed["ospa"])
    assert every.means_by_kind[kind]["share_tracked"] == 0


def test_a_static_track_beside_a_true_object_counts():
    tracks = with_a_buoy(far=0.0)
    tracks["position"][60:] = [5 * 15.0, 10.0]
    found = ft.score(tracks, boats(), truth_lists="moving")
    assert 0 < found.groups[0].left_out < 30


def test_kinds_by_speed():
    tracks = {key: value for key, value in with_a_buoy().items() if key != "kind"}
    found = ft.score(tracks, boats(), truth_lists="moving", moving_above=1.0)
    assert found.groups[0].left_out == 30
    with pytest.raises(ValueError, match="truth_lists: tracks have no kind"):
        ft.score(tracks, boats(), truth_lists="moving")
    # It does not matter what the tracker says of them.
    said = ft.score(with_a_buoy("moving"), boats(), truth_lists="moving", moving_above=1.0)
    assert said.groups[0].left_out == 30
    with pytest.raises(ValueError, match="moving_above: must be a finite speed > 0 m/s, got 0"):
        ft.score(tracks, boats(), moving_above=0.0)


def grouped(values, name):
    return {**dict(zip(("time", "id", "position"), values, strict=True)), "group": [name] * 60}


def joined(*parts):
    return {key: np.concatenate([np.asarray(part[key]) for part in parts]) for key in parts[0]}


def test_groups_are_scored_by_themselves():
    first, second = boats(noise=1.0), boats(noise=4.0, seed=3)
    tracks = joined(grouped(first, "calm"), grouped(second, "rough"))
    truth = joined(grouped(boats(), "rough"), grouped(boats(), "calm"))
    both = ft.score(tracks, truth)
    assert [group.name for group in both.groups] == ["rough", "calm"]
    for group, alone in zip(both.groups, (second, first), strict=True):
        assert group.metrics == pytest.approx(ft.score(alone, boats()).means, nan_ok=True)
    values = [group.metrics["ospa"] for group in both.groups]
    assert both["ospa"] == pytest.approx(np.mean(values))
    # A truth without groups is that of each; a mean is over what is known.
    assert ft.score(tracks, boats())["ospa"] == pytest.approx(both["ospa"])
    one = ft.score(grouped(first, "calm"), truth)
    assert one.groups[0].metrics["ospa"] == 20
    assert one["motp"] == pytest.approx(one.groups[1].metrics["motp"])


def test_groups_that_do_not_fit():
    truth = grouped(boats(), "calm")
    with pytest.raises(ValueError, match="tracks: have no group, but the truth has"):
        ft.score(boats(), truth)
    with pytest.raises(DataError, match="truth: has no group 'rough', for which there are tracks"):
        ft.score(grouped(boats(), "rough"), truth)
    with pytest.raises(ValueError, match="scans: has no group 'calm'"):
        ft.score(grouped(boats(), "calm"), truth, scans={"rough": TIMES})


def test_scans_without_a_track_count():
    late = boats(times=TIMES[10:])
    told = ft.score(late, boats(), scans=TIMES)
    guessed = ft.score(late, boats())
    assert told["share_tracked"] == guessed["share_tracked"] == pytest.approx(2 / 3)
    assert (told.groups[0].at_ends, guessed.groups[0].at_ends) == (0, 10)
    assert any("10 instants before the first row" in note for note in guessed.notes)
    only = ft.score(late, boats(), scans=TIMES[10:])
    assert only["share_tracked"] == 1


def test_the_scans_of_a_result_are_known():
    class Result:
        times = TIMES
        reports = Positions.make("tracks", *boats(times=TIMES[10:]))

    assert ft.score(Result(), boats())["share_tracked"] == pytest.approx(2 / 3)
    assert ft.score(Result(), boats()).groups[0].at_ends == 0


def test_lags():
    time, id, position = boats()
    late = (time + 3.0, id, position)
    assert ft.score(late, boats())["rmse"] > 10
    assert ft.score(late, boats(), lag=3.0)["rmse"] == pytest.approx(0)
    found = ft.score(late, boats(), lag="auto")
    assert found.groups[0].lag == pytest.approx(3.0, abs=0.02)
    assert found["rmse"] < 0.2
    assert "3 s behind the truth" in found.notes[0]
    each = grouped(late, "calm")
    assert ft.score(each, boats(), lag={"calm": 3.0})["rmse"] == pytest.approx(0)
    with pytest.raises(ValueError, match="lag: has no group 'calm'; expected a lag of every"):
        ft.score(each, boats(), lag={"rough": 3.0})
    for wrong in ("late", True, np.nan):
        with pytest.raises(ValueError, match="lag: must be a finite number of seconds, 'auto'"):
            ft.score(late, boats(), lag=wrong)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cutoff": 0.0}, "cutoff: must be a finite distance > 0 m, got 0"),
        ({"within": -1.0}, "within: must be a finite distance > 0 m"),
        ({"match": math.inf}, "match: must be a finite distance > 0 m, got inf"),
        ({"order": 0.5}, "order: must be at least 1 and finite, got 0.5"),
        ({"window": 0}, "window: must be a whole number of instants >= 1, got 0"),
        ({"truth_lists": "some"}, "truth_lists: 'some'; expected all or moving"),
    ],
)
def test_arguments_out_of_range(options, message):
    with pytest.raises(ValueError, match=message):
        ft.score(boats(), boats(), **options)


def test_axes_that_differ():
    with pytest.raises(ValueError, match="positions have 2 and 1 axes"):
        ft.score(boats(), ([0.0], [1], [3.0]))


def test_one_path_and_one_array():
    with pytest.raises(TypeError, match="one is a path; expected both"):
        ft.score("tracks.csv", boats())


def test_another_gate_for_identities():
    tracks = boats(offset=8.0)
    near = ft.score(tracks, boats(), match=5.0)
    assert (near["mota"], near["share_tracked"]) == (-1.0, 1.0)
    assert ft.score(tracks, boats())["mota"] == 1.0


# -------------------------------------------------------------------- the value


@pytest.fixture(scope="module")
def scores():
    tracks = joined(grouped(boats(noise=1.0), "calm"), grouped(boats(noise=4.0), "rough"))
    truth = joined(grouped(boats(), "calm"), grouped(boats(), "rough"))
    return ft.score({**tracks, "kind": np.tile(["moving", "static"], 60)}, truth)


def test_it_is_a_value(scores):
    assert isinstance(scores, Scores)
    assert repr(scores).startswith("<Scores: groups=2, ospa=")
    assert repr(scores.groups[0]).startswith('<GroupScores: name="calm", objects=2, tracks=2')
    again = pickle.loads(pickle.dumps(scores))
    assert again.means == pytest.approx(scores.means, nan_ok=True)


def test_json(scores):
    told = json.loads(json.dumps(scores.to_json_dict()))
    assert told["mean"]["ospa"] == scores["ospa"]
    assert [group["group"] for group in told["groups"]] == ["calm", "rough"]
    assert told["groups"][1]["metrics"]["idf1"] == scores.groups[1].metrics["idf1"]
    assert set(told["mean_by_kind"]) == {"moving", "static"}
    assert told["settings"]["cutoff"] == 20
    assert told["units"]["ospa"] == "m"


def test_rows_and_html(scores):
    rows = scores.rows()
    assert len(rows) == len(METRICS)
    assert rows[0] == ("OSPA", "OSPA", "m", [group.metrics["ospa"] for group in scores.groups])
    html = scores._repr_html_()
    for word in ("calm", "rough", "mean", "OSPA (m)", "HOTA", f"{scores['ospa']:.4g}"):
        assert word in html
    alone = ft.score(boats(), boats())._repr_html_()
    assert "value" in alone
    assert "mean" not in alone.replace("mean time", "")


def test_picture(scores):
    figure = scores.plot("rough")
    assert isinstance(figure, Figure)
    above, below = figure.axes
    assert above.get_title(loc="left") == "rough"
    assert [text.get_text() for text in above.get_legend().get_texts()] == [
        "OSPA, localization", "OSPA", "OSPA(2)",
    ]  # fmt: skip
    steps = above.lines[0].get_ydata()
    assert steps == pytest.approx(scores.groups[1].curves["ospa"])
    assert below.lines[0].get_ydata() == pytest.approx(2)
    with pytest.raises(ValueError, match="group: no recording 'wild'; one of 'calm', 'rough'"):
        plot_scores(scores, "wild")
