import numpy as np
import pytest
from drawn_lines import lines
from matplotlib import pyplot as plt

from fuzzytrack.plotting import plot_errors


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
    assert [x.get_text() for x in ax.get_legend().get_texts()][:2] == ["one", "two"]
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


def test_times_of_its_own(tracker, flight):
    t, truth, z = flight
    times = np.stack([t, t + 0.5], axis=1)
    result = tracker.run(times, np.stack([z, z], axis=1)[..., :1])
    _, ax = plot_errors(result, truth[:, :1], track=1)
    np.testing.assert_array_equal(lines(ax)["prediction"][:, 0], t + 0.5)
    with pytest.raises(ValueError, match="track: tracks with times of their own"):
        plot_errors(result, truth[:, :1])


def shaded(ax):
    return [(p.get_x(), p.get_x() + p.get_width()) for p in ax.patches]


def test_maneuvers_are_shaded(tracker):
    t = np.arange(40.0)
    truth = np.select([t < 20, t < 30], [0 * t, (t - 20) ** 2], 20 * t - 500)
    result = tracker.run(t, truth)
    _, ax = plot_errors(result, truth)
    # To one plot: both ends are seen in the differences of three plots.
    assert shaded(ax) == [(19.0, 31.0)]
    _, ax = plot_errors(result, truth, maneuvers=[(3, 4), (5, 9)])
    assert shaded(ax) == [(3, 4), (5, 9)]
    assert [x.get_text() for x in ax.get_legend().get_texts()] == ["prediction", "target maneuvers"]
    _, ax = plot_errors(result, truth, maneuvers=[])
    assert shaded(ax) == []


def test_targets_that_differ_have_no_common_maneuvers(tracker):
    t = np.arange(40.0)
    one = np.where(t < 20, 0, (t - 20) ** 2)
    for truth, expected in (([one, one], 1), ([one, one[::-1]], 0)):
        both = np.stack(truth, axis=1)[..., None]
        _, ax = plot_errors(tracker.run(t, both), both)
        assert len(shaded(ax)) == expected


def test_ragged_lines_are_smoothed_and_the_legend_says_so(tracker):
    t = np.arange(300.0)
    z = np.random.default_rng(5).normal(size=300)
    result = tracker.run(t, z)
    truth = np.zeros(300)
    _, ax = plot_errors(result, truth)
    assert ax.get_legend().get_title().get_text() == "root mean square of 11 plots"
    error = result.predicted[40:51]
    assert lines(ax)["prediction"][45, 1] == pytest.approx(np.sqrt(np.mean(error**2)))
    _, ax = plot_errors(result, truth, smooth=1)
    assert ax.get_legend().get_title().get_text() == ""
    np.testing.assert_allclose(lines(ax)["prediction"][:, 1], np.abs(result.predicted))


def test_more_trackers_than_can_be_told_apart_are_a_band(result, flight):
    _, truth, _ = flight
    other = np.linalg.norm(result.predicted - truth, axis=1)
    _, ax = plot_errors({str(k): result for k in range(9)}, truth)
    assert list(lines(ax)) == ["0", "1", "2", "3", "4", "4 more: median and quartiles"]
    np.testing.assert_allclose(lines(ax)["4 more: median and quartiles"][:, 1], other[2:])
    _, ax = plot_errors({str(k): result for k in range(6)}, truth)
    assert list(lines(ax)) == ["0", "1", "2", "3", "4", "5"]


def test_the_first_and_the_best_trackers_have_a_line(tracker, flight):
    t, truth, z = flight
    results = {str(k): tracker.run(t, z + 100 * (9 - k)) for k in range(9)}
    _, ax = plot_errors(results, truth)
    assert list(lines(ax))[:-1] == ["0", "5", "6", "7", "8"]
    middle = [np.linalg.norm(results[k].predicted - truth, axis=1)[2:] for k in "1234"]
    np.testing.assert_allclose(
        lines(ax)["4 more: median and quartiles"][:, 1], np.median(middle, axis=0)
    )


def test_errors_far_apart_are_on_a_logarithmic_scale(tracker, flight):
    t, truth, z = flight
    near = tracker.run(t, truth)
    _, ax = plot_errors({"near": near, "far": tracker.run(t, z + 9e4)}, truth)
    assert ax.get_yscale() == "log"
    _, ax = plot_errors(near, truth)
    assert ax.get_yscale() == "linear"
    assert ax.get_ylim()[0] == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r, b, x: plot_errors({}, x), "results: must be a TrackResult or a mapping"),
        (lambda r, b, x: plot_errors(7, x), "results: must be a TrackResult or a mapping"),
        (lambda r, b, x: plot_errors({"a": 7}, x), "results: 'a' must be a TrackResult, got 7"),
        (lambda r, b, x: plot_errors(b, x[:-1]), "truth: shape"),
        (lambda r, b, x: plot_errors(b, x, track=9), "track: "),
        (lambda r, b, x: plot_errors(r, x, smooth=2), "smooth: must be an odd number"),
        (lambda r, b, x: plot_errors(r, x, maneuvers="all"), "maneuvers: must be pairs of times"),
        (lambda r, b, x: plot_errors(r, x, maneuvers=[(2, 1)]), "maneuvers: must be pairs"),
        (lambda r, b, x: plot_errors(r, x, maneuvers=[1, 2]), "maneuvers: must be pairs"),
    ],
)
def test_wrong_arguments(call, message, result, batch, flight):
    with pytest.raises(ValueError, match=message):
        call(result, batch, flight[1])
    assert plt.get_fignums() == []
