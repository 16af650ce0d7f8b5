"""Trackers compared on recorded plots."""

import json
import math

import numpy as np
import pytest

from fuzzytrack.errors import DataError
from fuzzytrack.json_types import plain
from fuzzytrack.testbed import compare_recorded
from fuzzytrack.testbed.block_bootstrap import rms_change
from fuzzytrack.trackers.catalog import make_tracker

FIXED, QUICK = "fixed:alpha=0.4:beta=0.1", "fixed:alpha=0.8:beta=0.6"
TIMES = np.arange(80.0)


def path(t, k=0):
    return np.stack([8 * t + 40 * np.sin(t / 12 + k), 30 * np.cos(t / 15 - k)], axis=1)


def recording(tracks=3, sigma=2.0, seed=1, missed=(7, 30)):
    """Columns of plots, and the true positions, of some tracks."""
    rng = np.random.default_rng(seed)
    truth = np.concatenate([path(TIMES, k) for k in range(tracks)])
    z = truth + sigma * rng.standard_normal(truth.shape)
    z[list(missed)] = np.nan
    columns = {"t": np.tile(TIMES, tracks), "id": np.repeat(np.arange(tracks), len(TIMES))}
    return {**columns, "x": z[:, 0], "y": z[:, 1]}, truth


def alone(name, columns, k):
    rows = columns["id"] == k
    z = np.stack([columns["x"][rows], columns["y"][rows]], axis=1)
    return z, make_tracker(name).run(columns["t"][rows], z, 2.0)


def test_innovations_are_those_of_each_track_alone():
    columns, _ = recording()
    found = compare_recorded([FIXED, QUICK], columns, id="id", sigma=2.0)
    squares = {}
    for name in (FIXED, QUICK):
        each = []
        for k in range(3):
            z, result = alone(name, columns, k)
            seen = ~np.isnan(z[:, 0])
            each.append(((z - result.predicted) ** 2).sum(axis=1)[seen & (np.cumsum(seen) > 2)])
        squares[name] = np.concatenate(each)
        whose = np.repeat(np.arange(3), [len(one) for one in each])
    assert (found.tracks, found.plots, found.scored) == (3, 238, 232)
    for score in found.scores:
        assert score.rms == pytest.approx(math.sqrt(squares[score.name].mean()))
    expected = rms_change(squares[FIXED], squares[QUICK], whose)
    assert found.scores[0].change is None
    assert found.scores[1].change.change == pytest.approx(expected.change)
    assert found.scores[1].change.low == pytest.approx(expected.low)


def test_the_plot_before_is_that_of_the_same_track():
    columns, _ = recording(tracks=2)
    found = compare_recorded([FIXED], columns, id="id", sigma=2.0)
    steps = []
    for k in range(2):
        z, _ = alone(FIXED, columns, k)
        z = z[~np.isnan(z[:, 0])]
        steps.append(((z[2:] - z[1:-1]) ** 2).sum(axis=1))
    assert found.before == pytest.approx(math.sqrt(np.concatenate(steps).mean()))
    assert found.marks == [""]


def test_a_tracker_that_predicts_worse_than_the_plot_before_is_marked():
    t = np.arange(300.0)
    z = np.random.default_rng(3).standard_normal((300, 1))
    names = ["fixed:alpha=1:beta=1", "growing-memory"]
    found = compare_recorded(names, (t, z), sigma=1.0)
    assert found.marks == ["worse", "best"]
    told = json.loads(json.dumps(plain(found.to_json_dict())))
    assert [one["worse_than_plots"] for one in told["trackers"]] == [True, False]
    assert told["best"] == names[1]
    assert told["trackers"][1]["change"]["high"] < 0
    assert told["trackers"][0]["true"] is None


def written(folder, columns, truth, lag=0.0, step=1.0):
    """The truth in a file of its own, at times of a clock that is ahead."""
    name = folder / "truth.csv"
    rows = ["t,id,x,y"]
    for k in range(int(columns["id"].max()) + 1):
        t = np.arange(-10.0, 95.0, step)
        rows += [f"{a - lag},{k},{x},{y}" for a, (x, y) in zip(t, path(t, k), strict=True)]
    name.write_text("\n".join(rows))
    return name


def test_errors_against_the_truth(tmp_path):
    columns, truth = recording()
    names = [FIXED, QUICK, "fixed:alpha=0.1:beta=0.01"]
    found = compare_recorded(
        names, columns, truth=written(tmp_path, columns, truth), id="id", sigma=2.0
    )
    squares = []
    for k in range(3):
        z, result = alone(QUICK, columns, k)
        seen = ~np.isnan(z[:, 0])
        rows = seen & (np.cumsum(seen) > 2)
        off = result.filtered - truth[columns["id"] == k]
        squares.append((off**2).sum(axis=1)[rows])
    true = found.scores[1].true
    assert true.filtered == pytest.approx(math.sqrt(np.concatenate(squares).mean()))
    assert true.change.change == pytest.approx(true.predicted / found.scores[0].true.predicted - 1)
    assert found.known == found.scored
    assert found.measured_rmse == pytest.approx(2 * math.sqrt(2), rel=0.15)
    assert found.lag.taken_off == 0
    # Gains that small are late in these turns by more than the noise.
    assert found.marks == ["best", "", "worse"]


def test_a_late_clock_is_found_and_taken_off(tmp_path):
    columns, truth = recording()
    name = written(tmp_path, columns, truth, lag=2.5, step=0.25)
    found = compare_recorded([FIXED], columns, truth=name, id="id", sigma=2.0)
    assert found.lag.lag == pytest.approx(2.5, abs=4 * found.lag.error)
    assert found.measured_rmse == pytest.approx(2 * math.sqrt(2), rel=0.15)


def test_truth_in_columns_beside_the_plots_has_their_clock():
    columns, truth = recording()
    columns |= {"true_x": truth[:, 0], "true_y": truth[:, 1]}
    found = compare_recorded(
        [FIXED], columns, truth="true_x,true_y", id="id", axes=("x", "y"), sigma=2.0
    )
    assert found.lag is None
    assert found.measured_rmse == pytest.approx(2 * math.sqrt(2), rel=0.15)


def test_rejected_plots_are_missed_by_all():
    columns, _ = recording(tracks=1, missed=())
    columns["x"][40] += 1000
    found = compare_recorded([FIXED, "maneuver"], columns, id="id", sigma=2.0)
    assert found.plots == 79
    assert any("gate" in note for note in found.notes)
    assert found.scores[0].rms < 20
    assert compare_recorded([FIXED], columns, id="id", sigma=2.0, gate=None).scores[0].rms > 100


def test_without_noise_there_is_no_likelihood():
    columns, _ = recording(tracks=1)
    short = {name: values[:6] for name, values in columns.items()}
    found = compare_recorded([FIXED, QUICK], short, id="id")
    assert not found.has_sigma
    assert all(math.isnan(one.log_likelihood) for one in found.scores)
    with pytest.raises(ValueError, match="sigma"):
        compare_recorded(["maneuver"], short, id="id")


def test_a_bearing_has_no_jump():
    t = np.arange(100.0)
    angle = (340 + 0.9 * t + np.random.default_rng(2).normal(0, 0.2, 100)) % 360
    found = compare_recorded([FIXED], {"t": t, "bearing": angle}, angle="bearing")
    assert found.scores[0].rms < 1
    assert found.before < 2


class Lost:
    """A tracker whose numbers become too large for the computer."""

    def __init__(self, raises):
        self.raises, self.inner = raises, make_tracker(FIXED)

    def run(self, t, z, sigma=None):
        if self.raises:
            raise DataError("numbers became too large")
        result = self.inner.run(t, z, sigma)
        result.predicted[20:] = np.nan
        return result

    def start(self, z, t, sigma=None):
        raise AssertionError("comparisons run whole tracks")

    step = predict = start


@pytest.mark.parametrize("raises", [True, False])
def test_a_tracker_that_diverges_is_infinitely_wrong(raises):
    columns, _ = recording(tracks=1)
    trackers = {"good": FIXED, "lost": Lost(raises)}
    found = compare_recorded(trackers, columns, id="id", sigma=2.0)
    assert (found.scored, found.scores[1].rms) == (76, math.inf)
    assert found.scores[1].change.change == math.inf
    assert found.marks == ["best", "worse"]
    assert plain(found.to_json_dict())["trackers"][1]["rms"] is None


def test_too_little_is_said(tmp_path):
    with pytest.raises(DataError, match="no plot has a prediction of every tracker"):
        compare_recorded([FIXED], ([0.0, 1.0], [[0.0], [1.0]]))
    late = tmp_path / "late.csv"
    late.write_text("t,x\n1000,1\n1001,2\n")
    t = np.arange(9.0)
    with pytest.raises(DataError, match="truth: is known at none"):
        compare_recorded([FIXED], {"t": t, "x": t * 5}, truth=late, sigma=1.0)
    with pytest.raises(ValueError, match="no such tracker"):
        compare_recorded(["nothing"], {"t": t, "x": t})
