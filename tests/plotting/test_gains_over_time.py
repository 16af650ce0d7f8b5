import numpy as np
import pytest
from drawn_lines import lines

from fuzzytrack.plotting import plot_gains_over_time
from fuzzytrack.trackers.catalog import make_tracker


def run(spec, steps=20, axes=2, sigma=1.0, seed=1):
    t = np.arange(float(steps))
    return make_tracker(spec).run(t, np.random.default_rng(seed).normal(size=(steps, axes)), sigma)


def test_gains_that_all_axes_share_are_one_line_each():
    result = run("maneuver:level=1")
    _, ax = plot_gains_over_time(result)
    assert list(lines(ax)) == ["α", "β", "γ"]
    for symbol, name in (("α", "alpha"), ("β", "beta"), ("γ", "gamma")):
        gains = getattr(result.gains, name)[:, 0]
        np.testing.assert_array_equal(lines(ax)[symbol], np.stack([result.time, gains], axis=1))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time (s)", "gains")
    assert ax.get_ylim()[0] == 0


def test_gains_that_differ_have_a_line_for_each_axis():
    result = run("stiffness-damping")
    _, ax = plot_gains_over_time(result, axes_names=("east", "north"))
    assert list(lines(ax)) == ["α of east", "α of north", "β of east", "β of north"]
    np.testing.assert_array_equal(lines(ax)["β of north"][:, 1], result.gains.beta[:, 1])
    assert len({line.get_linestyle() for line in ax.lines}) == 2


def test_of_a_few_tracks_alpha_has_a_line_each():
    results = [run("stiffness-damping", seed=k) for k in range(2)]
    _, ax = plot_gains_over_time(results, ["A7", "B2"])
    mean = results[1].gains.alpha.mean(axis=1)
    np.testing.assert_allclose(lines(ax)["α of B2"][:, 1], mean)
    assert ax.get_ylabel() == "α"
    assert ax.get_legend().get_title().get_text() == ""
    _, ax = plot_gains_over_time([run("stiffness-damping", 500, seed=k) for k in range(2)])
    assert ax.get_legend().get_title().get_text() == "running median"
    assert len(lines(ax)["α of 0"]) == 60


def test_of_many_tracks_the_median_and_quartiles_are_drawn():
    results = [run(f"fixed:alpha={a}:beta=0.1") for a in (0.1, 0.2, 0.6, 0.7, 0.9)]
    _, ax = plot_gains_over_time(results)
    assert list(lines(ax)) == ["α", "β"]
    np.testing.assert_allclose(lines(ax)["α"][:, 1], 0.6)
    title = ax.get_legend().get_title().get_text()
    assert title == "running median and quartiles of all tracks"
    (band, _) = ax.collections
    edges = band.get_paths()[0].vertices[:, 1]
    assert {round(y, 9) for y in edges} == {0.2, 0.7}


def test_ragged_gains_of_a_long_track_are_a_band():
    _, ax = plot_gains_over_time(run("stiffness-damping", 500))
    assert len(lines(ax)["α"]) == 60
    assert ax.get_legend().get_title().get_text() == "running median and quartiles"


def test_one_track_of_a_batch_with_maneuvers(batch):
    _, ax = plot_gains_over_time(batch, track=(1, 2), maneuvers=[(3.0, 8.0)])
    np.testing.assert_array_equal(lines(ax)["α of x1"][:, 1], batch.gains.alpha[:, 1, 2, 0])
    assert [(p.get_x(), p.get_width()) for p in ax.patches] == [(3.0, 5.0)]
    with pytest.raises(ValueError, match="track: must be"):
        plot_gains_over_time(batch, track=(2, 2))
    with pytest.raises(ValueError, match="result: must be a TrackResult, got list"):
        plot_gains_over_time([batch], track=0)


def test_no_gains_are_said():
    _, ax = plot_gains_over_time(run("stiffness-damping", 1))
    assert ax.get_title() == "no gains: a track needs two plots"
    assert ax.get_legend() is None
