import numpy as np
import pytest
from drawn_lines import lines
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.plotting import plot_track, plot_tracks


def test_two_axes_are_a_plane_of_equal_scales(result, flight):
    _, truth, z = flight
    _, ax = plot_track(result, truth)
    drawn = lines(ax)
    for label, expected in (
        ("true", truth),
        ("plots", z),
        ("predicted", result.predicted),
        ("filtered", result.filtered),
        ("coasted", result.filtered[8:10]),
    ):
        np.testing.assert_array_equal(drawn[label], expected)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (m)")
    assert ax.get_aspect() == 1.0
    assert {t.get_text() for t in ax.get_legend().get_texts()} == set(drawn)


def test_legend_covers_no_data(result, flight):
    figure, ax = plot_track(result, flight[1])
    figure.canvas.draw()
    legend, plane = ax.get_legend().get_window_extent(), ax.get_window_extent()
    assert legend.y1 < plane.y0
    label = ax.xaxis.label.get_window_extent()
    assert legend.y1 <= label.y0 + 1


def test_one_axis_is_over_time(tracker, flight):
    t, truth, z = flight
    result = tracker.run(t, np.nan_to_num(z[:, 1]))
    _, ax = plot_track(result, truth[:, 1], axes_names=["height"], unit="km")
    drawn = lines(ax)
    np.testing.assert_array_equal(drawn["true"], np.stack([t, truth[:, 1]], axis=-1))
    assert "coasted" not in drawn
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time (s)", "height (km)")


@pytest.mark.parametrize(("n_axes", "names"), [(4, "x1 x2 x3 x4"), (5, "x1 x2 x3 x4 x5")])
def test_more_axes_are_panels_over_time(tracker, flight, n_axes, names):
    t, _, z = flight
    many = np.repeat(z[:, :1], n_axes, axis=1) + np.arange(n_axes)
    _, axes = plot_track(tracker.run(t, many), unit="")
    assert [ax.get_ylabel() for ax in axes] == names.split()
    for k, ax in enumerate(axes):
        np.testing.assert_array_equal(lines(ax)["plots"], np.stack([t, many[:, k]], axis=-1))
    assert axes[-1].get_xlabel() == "time (s)"
    given = Figure().subplots(n_axes)
    _, axes = plot_track(tracker.run(t, many), ax=given)
    assert axes[0] is given[0]


def test_one_track_of_a_batch(batch, flight):
    _, truth, _ = flight
    for actual in (truth, np.broadcast_to(truth[:, None, None], batch.measured.shape)):
        _, ax = plot_track(batch, actual, track=(1, -1))
        np.testing.assert_array_equal(lines(ax)["filtered"], batch.filtered[:, 1, 2])
        np.testing.assert_array_equal(lines(ax)["true"], truth)


def test_times_of_its_own(tracker, flight):
    t, _, z = flight
    times = np.stack([t, t + 0.5], axis=1)
    result = tracker.run(times, np.stack([z, z], axis=1)[..., :1])
    _, ax = plot_track(result, track=1)
    np.testing.assert_array_equal(lines(ax)["plots"][:, 0], t + 0.5)


def test_three_axes_are_a_plane_and_the_third_over_time(tracker, flight):
    t, truth, z = flight
    height = np.stack([*z.T, 400 - z[:, 0]], axis=1)
    actual = np.stack([*truth.T, 400 - truth[:, 0]], axis=1)
    figure, axes = plot_track(tracker.run(t, height), actual, gains=True)
    plane, third, gains = axes
    np.testing.assert_array_equal(lines(plane)["plots"], height[:, :2])
    np.testing.assert_array_equal(lines(third)["plots"], np.stack([t, height[:, 2]], axis=1))
    np.testing.assert_array_equal(lines(third)["true"], np.stack([t, actual[:, 2]], axis=1))
    assert plane.get_aspect() == 1.0
    assert third.get_aspect() == "auto"
    assert gains.get_ylabel() == "gains"
    assert [ax.get_xlabel() for ax in axes] == ["x (m)", "time (s)", "time (s)"]
    assert plane.get_legend() is None
    assert figure.axes == [*axes]


def test_positions_far_apart_are_in_kilometers(tracker, flight):
    t, truth, z = flight
    result = tracker.run(t, 100 * z)
    _, ax = plot_track(result, 100 * truth)
    assert ax.get_xlabel() == "x (km)"
    np.testing.assert_allclose(lines(ax)["filtered"], result.filtered / 1000)
    np.testing.assert_allclose(lines(ax)["true"], truth / 10)
    _, ax = plot_track(result, unit="m")
    assert ax.get_xlabel() == "x (m)"
    np.testing.assert_array_equal(lines(ax)["plots"], 100 * z)


def test_units_that_differ_have_no_equal_scales(result):
    _, ax = plot_track(result, unit=("m", "ft"))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (ft)")
    assert ax.get_aspect() == "auto"


def test_start_and_end_are_marked(result):
    _, ax = plot_track(result)
    np.testing.assert_array_equal(lines(ax)["start"], result.filtered[:1])
    np.testing.assert_array_equal(lines(ax)["end"], result.filtered[-1:])


def test_an_axis_that_starts_later_moves_the_start(tracker, flight):
    t, _, z = flight
    late = z.copy()
    late[:4, 1] = np.nan
    result = tracker.run(t, late)
    _, ax = plot_track(result)
    np.testing.assert_array_equal(lines(ax)["start"], result.filtered[4:5])


def test_long_tracks_are_lines_with_faint_plots(tracker):
    t = np.arange(300.0)
    z = np.stack([t, np.sin(t / 20)], axis=1)
    _, ax = plot_track(tracker.run(t, z))
    drawn = {line.get_label(): line for line in ax.lines}
    assert set(drawn) == {"plots", "filtered", "start", "end"}
    assert drawn["filtered"].get_marker() == "None"
    assert drawn["plots"].get_alpha() < 1
    # In the legend they are as anywhere.
    handles = dict(
        zip(
            [x.get_text() for x in ax.get_legend().get_texts()],
            ax.get_legend().legend_handles,
            strict=True,
        )
    )
    assert handles["plots"].get_alpha() == 1.0


def test_one_plot_and_none(tracker):
    _, ax = plot_track(tracker.run([1.0], [[3.0, 4.0]]), gains=False)
    assert set(lines(ax)) == {"plots", "filtered", "start"}
    for t, z in (([0.0, 1.0], np.full((2, 2), np.nan)), ([], np.empty((0, 2)))):
        _, axes = plot_track(tracker.run(t, z), gains=True)
        assert axes[0].get_title() == "no plots"
        assert axes[1].get_title().startswith("no gains")
        assert lines(axes[0]) == {}
        axes[0].figure.canvas.draw()


def test_target_maneuvers_are_shaded_under_the_gains(tracker):
    t = np.arange(40.0)
    truth = np.where(t < 20, 0, (t - 20) ** 2)
    _, (_, ax) = plot_track(tracker.run(t, truth + t % 2), truth, gains=True)
    shaded = [p for p in ax.patches if p.get_label() == "target maneuvers"]
    assert [(p.get_x(), p.get_x() + p.get_width()) for p in shaded] == [(19.0, 39.0)]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r, b, x: plot_track(7), "result: must be a TrackResult, got int"),
        (lambda r, b, x: plot_track(r, track=0), "track: must be None.* got 0"),
        (lambda r, b, x: plot_track(b), r"track: .*batch of shape \(2, 3\); got None"),
        (lambda r, b, x: plot_track(b, track=1), r"track: .*batch of shape \(2, 3\); got 1"),
        (lambda r, b, x: plot_track(b, track=(1, 3)), "track: "),
        (lambda r, b, x: plot_track(r, x[:-1]), r"truth: shape \(19, 2\) .* \(20, 2\)"),
        (lambda r, b, x: plot_track(b, x[:-1], track=(0, 0)), r"needed is \(20, 2, 3, 2\) or \(20"),
        (lambda r, b, x: plot_track(r, axes_names=["x"]), "axes_names: needs 2 names, got 1: x"),
        (lambda r, b, x: plot_track(r, ax=[]), "ax: needs 1"),
    ],
)
def test_wrong_arguments(call, message, result, batch, flight):
    with pytest.raises(ValueError, match=message):
        call(result, batch, flight[1])
    assert plt.get_fignums() == []


@pytest.mark.parametrize("steps", [12, 200])
def test_a_track_is_dotted_over_a_gap(tracker, steps):
    t = np.arange(steps, dtype=float)
    t[5:] += 4.0
    t[9:] += 40.0
    z = np.stack([t, -t], axis=1)
    result = tracker.run(t, z)
    _, ax = plot_track(result, z)
    # Five steps are no gap yet, 41 are.
    for name, drawn in (("filtered", result.filtered), ("true", z)):
        expected = np.insert(drawn, 9, np.nan, axis=0)
        np.testing.assert_array_equal(lines(ax)[name], expected)
    (gaps,) = ax.collections
    np.testing.assert_array_equal(gaps.get_segments(), [result.filtered[8:10]])
    assert gaps.get_linestyle()[0][1] is not None


def test_nothing_joins_the_ends_of_a_gap_in_which_an_angle_passes_north():
    t = np.array([0.0, 1, 2, 3, 40, 41, 42, 80, 81])
    angle = np.array([350.0, 352, 354, 356, 2, 4, 6, 20, 22])
    result = AlphaBetaTracker("fixed:alpha=1:beta=0.001").run(t, angle)
    _, ax = plot_tracks([result], period=360.0, unit="deg")
    (gaps,) = ax.collections
    np.testing.assert_allclose(np.array(gaps.get_segments())[:, :, 0], [[42.0, 80.0]])
