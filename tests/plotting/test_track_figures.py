import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from fuzzytrack.plotting import plot_errors, plot_track


def lines(ax):
    return {line.get_label(): np.array(line.get_data()).T for line in ax.lines}


def test_two_axes_are_a_plane_of_equal_scales(result, flight):
    _, truth, z = flight
    _, ax = plot_track(result, truth)
    drawn = lines(ax)
    for label, expected in (
        ("true", truth),
        ("measured", z),
        ("predicted", result.predicted),
        ("filtered", result.filtered),
        ("coasted (no plot)", result.filtered[8:10]),
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
    assert "coasted (no plot)" not in drawn
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time (s)", "height (km)")


@pytest.mark.parametrize(("n_axes", "names"), [(3, "x y z"), (4, "x1 x2 x3 x4")])
def test_more_axes_are_panels_over_time(tracker, flight, n_axes, names):
    t, _, z = flight
    many = np.repeat(z[:, :1], n_axes, axis=1) + np.arange(n_axes)
    _, axes = plot_track(tracker.run(t, many), unit="")
    assert [ax.get_ylabel() for ax in axes] == names.split()
    for k, ax in enumerate(axes):
        np.testing.assert_array_equal(lines(ax)["measured"], np.stack([t, many[:, k]], axis=-1))
    assert axes[-1].get_xlabel() == "time (s)"
    given = Figure().subplots(n_axes)
    _, axes = plot_track(tracker.run(t, many), ax=given)
    assert axes[0] is given[0]


@pytest.fixture
def batch(tracker, flight):
    t, truth, _ = flight
    z = truth[:, None, None, :] + np.random.default_rng(3).normal(0, 9, (len(t), 2, 3, 2))
    z[5, 1, 2] = np.nan
    return tracker.run(t, z)


def test_one_track_of_a_batch(batch, flight):
    _, truth, _ = flight
    for actual in (truth, np.broadcast_to(truth[:, None, None], batch.measured.shape)):
        _, ax = plot_track(batch, actual, track=(1, -1))
        np.testing.assert_array_equal(lines(ax)["filtered"], batch.filtered[:, 1, 2])
        np.testing.assert_array_equal(lines(ax)["true"], truth)


def test_times_of_its_own(tracker, flight):
    t, truth, z = flight
    times = np.stack([t, t + 0.5], axis=1)
    result = tracker.run(times, np.stack([z, z], axis=1)[..., :1])
    _, ax = plot_track(result, track=1)
    np.testing.assert_array_equal(lines(ax)["measured"][:, 0], t + 0.5)
    _, ax = plot_errors(result, truth[:, :1], track=1)
    np.testing.assert_array_equal(lines(ax)["prediction"][:, 0], t + 0.5)
    with pytest.raises(ValueError, match="track: tracks with times of their own"):
        plot_errors(result, truth[:, :1])


def test_error_is_the_distance_of_the_prediction(result, flight):
    t, truth, _ = flight
    _, ax = plot_errors({"one": result, "two": result}, truth, unit="km")
    expected = np.linalg.norm(result.predicted - truth, axis=1)
    for label in ("one", "two"):
        time, error = lines(ax)[label].T
        np.testing.assert_array_equal(time, t)
        np.testing.assert_allclose(error, expected)
    assert ax.get_xlabel() == "time (s)"
    assert ax.get_ylabel() == "prediction error (km)"
    assert [x.get_text() for x in ax.get_legend().get_texts()] == ["one", "two"]
    assert len({line.get_color() for line in ax.lines}) == 2


def test_error_of_one_axis(tracker, flight):
    t, truth, z = flight
    result = tracker.run(t, z[:, 0])
    _, ax = plot_errors(result, truth[:, 0], unit="")
    expected = np.abs(result.predicted - truth[:, 0])
    np.testing.assert_allclose(lines(ax)["prediction"][:, 1], expected)
    assert ax.get_ylabel() == "prediction error"


def test_error_of_a_batch_is_the_mean_square_over_its_tracks(batch, flight):
    _, truth, _ = flight
    full = np.broadcast_to(truth[:, None, None], batch.measured.shape)
    squares = ((batch.predicted - full) ** 2).sum(axis=-1)
    expected = np.sqrt(squares[2:].mean(axis=(1, 2)))
    for actual in (truth, full):
        _, ax = plot_errors({"batch": batch}, actual)
        error = lines(ax)["batch"][:, 1]
        assert np.isnan(error[:2]).all()
        np.testing.assert_allclose(error[2:], expected)
        assert ax.get_ylabel() == "prediction error, RMS over tracks (m)"
    _, ax = plot_errors({"batch": batch}, truth, track=(0, 1))
    np.testing.assert_allclose(lines(ax)["batch"][2:, 1] ** 2, squares[2:, 0, 1])
    assert ax.get_ylabel() == "prediction error (m)"


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
        (lambda r, b, x: plot_errors({}, x), "results: must be a TrackResult or a mapping"),
        (lambda r, b, x: plot_errors(7, x), "results: must be a TrackResult or a mapping"),
        (lambda r, b, x: plot_errors({"a": 7}, x), "results: 'a' must be a TrackResult, got 7"),
        (lambda r, b, x: plot_errors(b, x[:-1]), "truth: shape"),
        (lambda r, b, x: plot_errors(b, x, track=9), "track: "),
    ],
)
def test_wrong_arguments(call, message, result, batch, flight):
    with pytest.raises(ValueError, match=message):
        call(result, batch, flight[1])
    assert plt.get_fignums() == []
