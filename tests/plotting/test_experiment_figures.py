import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.colors import same_color
from matplotlib.figure import Figure

from fuzzytrack.plotting import (
    plot_consistency,
    plot_error_distribution,
    plot_error_over_time,
    plot_trajectories,
)

TIME = np.array([0.0, 2.0, 5.0, 6.0])
ONE = np.array([np.nan, 3.0, 4.0, 6.0])
TWO = np.array([np.nan, 5.0, np.nan, 2.0])


def labeled(ax):
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def drawn(line):
    return np.array(line.get_data()).T


def names(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_errors_over_time():
    bands = {"one": (ONE - 1, ONE + 2)}
    _, ax = plot_error_over_time(
        TIME, {"one": ONE, "two": TWO}, bands, measured=[7, 7, 8, 7], scored_from=2.0, unit="km"
    )
    lines = labeled(ax)
    np.testing.assert_array_equal(drawn(lines["one"]), np.stack([TIME, ONE], axis=-1))
    np.testing.assert_array_equal(drawn(lines["two"])[:, 1], TWO)
    np.testing.assert_array_equal(drawn(lines["plots"])[:, 1], [7, 7, 8, 7])
    (band,) = ax.collections
    assert same_color(band.get_facecolor()[0][:3], lines["one"].get_color())
    corners = band.get_paths()[0].vertices
    for point in [(2.0, 2.0), (2.0, 5.0), (6.0, 5.0), (6.0, 8.0)]:
        assert (corners == point).all(axis=1).any()
    assert names(ax) == ["one", "two", "plots", "not scored"]
    assert ax.get_ylabel() == "prediction error, RMS over runs (km)"
    assert ax.get_xlabel() == "time (s)"
    assert ax.get_ylim()[0] == 0
    assert ax.get_ylim()[1] > 8


def test_nothing_is_shaded_where_all_scans_count():
    _, ax = plot_error_over_time(TIME, {"one": ONE}, scored_from=0.0)
    assert names(ax) == ["one"]


@pytest.mark.parametrize(("worse", "scale"), [(5.0, "linear"), (1000.0, "log")])
def test_a_tracker_that_is_far_worse_leaves_the_others_to_be_seen(worse, scale):
    curves = {"good": ONE, "bad": worse * ONE}
    assert plot_error_over_time(TIME, curves)[1].get_yscale() == scale
    assert plot_error_distribution(curves)[1].get_xscale() == scale
    assert plot_consistency(TIME, curves)[1].get_yscale() == scale


def test_eight_trackers_look_different_and_the_same_in_every_picture():
    curves = {f"tracker {k}": ONE + k for k in range(8)}
    tracks = {name: curve[:, None] for name, curve in curves.items()}
    pictures = [
        plot_error_over_time(TIME, curves)[1],
        plot_error_distribution(curves)[1],
        plot_consistency(TIME, curves)[1],
        plot_trajectories(TIME, ONE[:, None], ONE[:, None], tracks)[1],
    ]
    looks = [
        [(labeled(ax)[name].get_color(), labeled(ax)[name].get_linestyle()) for name in curves]
        for ax in pictures
    ]
    assert len(set(looks[0])) == 8
    assert all(look == looks[0] for look in looks)


def test_maneuvers_are_shaded():
    _, ax = plot_error_over_time(TIME, {"one": ONE}, maneuvers=[(1.0, 2.0)])
    assert [(p.get_x(), p.get_width()) for p in ax.patches] == [(1.0, 1.0)]
    assert names(ax) == ["one", "target maneuvers"]
    with pytest.raises(ValueError, match="maneuvers: must be pairs of times"):
        plot_error_over_time(TIME, {"one": ONE}, maneuvers=[(2.0, 1.0)])


@pytest.mark.parametrize("curve", [np.full(4, np.nan), np.full(4, np.inf), np.zeros(4)])
def test_a_tracker_without_errors_to_show_is_still_named(curve):
    for ax in (
        plot_error_over_time(TIME, {"one": curve})[1],
        plot_error_distribution({"one": curve})[1],
        plot_consistency(TIME, {"one": curve})[1],
        plot_trajectories(TIME, ONE[:, None], TWO[:, None], {"one": curve[:, None]})[1],
    ):
        ax.figure.canvas.draw()
        assert "one" in names(ax)


@pytest.fixture
def run():
    """Truth, plots and two tracks; scan 2 missed on one axis, scan 0 before any prediction."""
    truth = np.stack([10 * TIME, TIME**2], axis=-1)
    plots = truth + 1.0
    plots[2, 1] = np.nan
    late = truth - 1.0
    late[0] = np.nan
    return truth, plots, {"near": truth + 0.5, "late": late}


def test_a_run_in_the_plane(run):
    truth, plots, tracks = run
    _, ax = plot_trajectories(TIME, truth, plots, tracks)
    lines = labeled(ax)
    np.testing.assert_array_equal(drawn(lines["true"]), truth)
    np.testing.assert_array_equal(drawn(lines["plots"]), plots)
    hollow = [x for x in ax.lines if x.get_markerfacecolor() == "white" and len(x.get_xdata())]
    assert len(hollow) == 2
    for (label, track), marks in zip(tracks.items(), hollow, strict=True):
        np.testing.assert_array_equal(drawn(lines[label]), track)
        assert lines[label].get_markevery() == [0, 1, 3]
        np.testing.assert_array_equal(drawn(marks)[[0, 1, 3]], np.full((3, 2), np.nan))
        np.testing.assert_array_equal(drawn(marks)[2], track[2])
        assert marks.get_color() == lines[label].get_color()
    assert names(ax) == ["true", "plots", "near", "late", "hollow: coasted (no plot)"]
    assert ax.get_aspect() == 1.0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (m)")


def test_no_word_of_coasting_where_no_plot_is_missed(run):
    truth, _, tracks = run
    _, ax = plot_trajectories(TIME, truth, truth, tracks)
    assert names(ax) == ["true", "plots", "near", "late"]


@pytest.mark.parametrize(("unit", "size"), [(None, 1000.0), ("m", 1.0)])
def test_far_runs_are_in_kilometers(run, unit, size):
    truth, plots, tracks = run
    _, ax = plot_trajectories(
        TIME, 200 * truth, plots, tracks, unit=unit, axes_names=["east", "north"]
    )
    np.testing.assert_array_equal(drawn(labeled(ax)["true"]), 200 * truth / size)
    np.testing.assert_array_equal(drawn(labeled(ax)["plots"]), plots / size)
    assert ax.get_xlabel() == f"east ({unit or 'km'})"


@pytest.mark.parametrize("n_axes", [1, 3, 4])
def test_other_than_two_axes_are_over_time(n_axes):
    truth = np.arange(4.0)[:, None] + np.arange(n_axes)
    _, axes = plot_trajectories(TIME, truth, truth, {"one": truth + 0.5})
    for k, ax in enumerate(np.atleast_1d(axes)):
        np.testing.assert_array_equal(
            drawn(labeled(ax)["one"]), np.stack([TIME, truth[:, k] + 0.5], axis=-1)
        )
        assert ax.get_ylabel() == ("xyz"[k] if n_axes <= 3 else f"x{k + 1}") + " (m)"
    assert np.atleast_1d(axes)[-1].get_xlabel() == "time (s)"


def test_marks_of_many_scans_do_not_run_into_each_other():
    time = np.arange(400.0)
    track = time[:, None]
    _, ax = plot_trajectories(time, track, track, {"one": track})
    assert labeled(ax)["one"].get_markevery() == []


def test_distribution_of_errors():
    errors = np.array([[4.0, 1.0, np.nan], [3.0, np.inf, 2.0]])
    _, ax = plot_error_distribution({"one": errors}, marked=(0.5, 0.75))
    line = labeled(ax)["one"]
    np.testing.assert_allclose(drawn(line), [[1, 25], [2, 50], [3, 75], [4, 100]])
    assert line.get_drawstyle() == "steps-post"
    (marks,) = [x for x in ax.lines if x.get_marker() == "o"]
    np.testing.assert_allclose(drawn(marks), [[2, 50], [3, 75]])
    assert ax.get_xlabel() == "prediction error (m)"


def test_distribution_of_many_errors_has_few_points_all_on_the_curve():
    sample = np.random.default_rng(0).rayleigh(10.0, 50_000)
    _, ax = plot_error_distribution({"one": sample})
    points = drawn(labeled(ax)["one"])
    assert len(points) <= 400
    share = np.searchsorted(np.sort(sample), points[:, 0], side="right") / len(sample)
    np.testing.assert_allclose(points[:, 1], 100 * share)
    assert points[-1, 0] == sample.max()
    # Outliers are left out of sight, not the body.
    assert np.mean(sample <= ax.get_xlim()[1]) > 0.99
    assert ax.get_xlim()[1] < sample.max()


def test_consistency_band():
    _, ax = plot_consistency(TIME, {"one": ONE}, (1.5, [2.5, 2.5, 3.0, 2.5]), expected=2.0)
    corners = ax.collections[0].get_paths()[0].vertices
    for point in [(0.0, 1.5), (6.0, 1.5), (5.0, 3.0), (6.0, 2.5)]:
        assert (corners == point).all(axis=1).any()
    (mean,) = [line for line in ax.lines if list(line.get_ydata()) == [2.0, 2.0]]
    assert mean.get_label().startswith("_")
    assert names(ax) == ["consistent", "one"]
    assert ax.get_ylabel() == "NIS, mean over runs"


def test_drawn_into_axes_that_are_given(run):
    truth, plots, tracks = run
    calls = [
        lambda ax: plot_error_over_time(TIME, {"one": ONE}, ax=ax),
        lambda ax: plot_trajectories(TIME, truth, plots, tracks, ax=ax),
        lambda ax: plot_error_distribution({"one": ONE}, ax=ax),
        lambda ax: plot_consistency(TIME, {"one": ONE}, ax=ax),
    ]
    for call in calls:
        mine = Figure().subplots()
        assert call(mine) == (mine.figure, mine)
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t, p: plot_error_over_time(TIME, {}), "errors: must be a mapping"),
        (lambda t, p: plot_error_over_time(TIME, ONE), "errors: must be a mapping"),
        (lambda t, p: plot_error_over_time([], {"a": []}), r"time: needs shape \(n_steps,\)"),
        (lambda t, p: plot_error_over_time([0, np.nan], {"a": ONE}), "time must be finite"),
        (lambda t, p: plot_error_over_time(TIME, {"a": ONE[1:]}), r"errors: 'a': .*\(4,\), got"),
        (
            lambda t, p: plot_error_over_time(TIME, {"a": ONE}, {"b": (ONE, ONE)}),
            "bands: unknown 'b'; one of a",
        ),
        (
            lambda t, p: plot_error_over_time(TIME, {"a": ONE}, {"a": (ONE, 3)}),
            r"bands: 'a': needs shape \(4,\), got \(\)",
        ),
        (lambda t, p: plot_error_over_time(TIME, {"a": ONE}, measured=[1]), "measured: needs"),
        (lambda t, p: plot_trajectories(TIME, t[:, 0], p, {"a": t}), r"truth: needs shape \(4, n"),
        (lambda t, p: plot_trajectories(TIME, t, p[1:], {"a": t}), r"plots: needs shape \(4, 2\)"),
        (lambda t, p: plot_trajectories(TIME, t, p, {"a": t[1:]}), "predicted: 'a': needs shape"),
        (lambda t, p: plot_trajectories(TIME, t, p, {}), "predicted: must be a mapping"),
        (lambda t, p: plot_trajectories(TIME, t, p, {"a": t}, unit="mi"), "unit: unknown 'mi'"),
        (lambda t, p: plot_trajectories(TIME, t, p, {"a": t}, axes_names="x"), "axes_names: needs"),
        (lambda t, p: plot_trajectories(TIME, t, p, {"a": t}, ax=[]), "ax: needs 1"),
        (lambda t, p: plot_error_distribution({}), "errors: must be a mapping"),
        (lambda t, p: plot_error_distribution({"a": ONE}, marked=[2]), "marked: must be shares"),
        (lambda t, p: plot_consistency(TIME, {}), "statistics: must be a mapping"),
        (lambda t, p: plot_consistency(TIME, {"a": ONE}, ([1, 2], 3)), r"band: needs shape \(4,\)"),
    ],
)
def test_wrong_arguments(call, message, run):
    with pytest.raises(ValueError, match=message):
        call(*run[:2])
    assert plt.get_fignums() == []
