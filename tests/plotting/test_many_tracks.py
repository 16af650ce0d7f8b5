import numpy as np
import pytest
from drawn_lines import lines
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.colors import LogNorm

from fuzzytrack.plotting import plot_tracks
from fuzzytrack.trackers.catalog import make_tracker

FIXED = make_tracker("fixed:alpha=0.6:beta=0.2")


def fan(count, steps=6, far=40.0):
    """Tracks from near the middle outwards."""
    t = np.arange(float(steps))
    turns = 2 * np.pi * np.arange(count) / count
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return [FIXED.run(t, (0.3 + t[:, None] / steps) * far * way) for way in ways]


def test_few_tracks_are_named_in_the_legend_each_in_its_color():
    results = fan(3)
    _, ax = plot_tracks(results, ["A7", "_x", ""])
    drawn = lines(ax)
    for name, result in zip(("A7", " _x", "track"), results, strict=True):
        np.testing.assert_array_equal(drawn[name], result.filtered)
    named = [text.get_text() for text in ax.get_legend().get_texts()]
    assert named == ["plots", "A7", " _x", "track", "start", "end"]
    colors = [line.get_color() for line in ax.lines if line.get_label() in ("A7", " _x", "track")]
    assert len(set(colors)) == 3
    np.testing.assert_array_equal(drawn["start"], [r.filtered[0] for r in results])
    np.testing.assert_array_equal(drawn["end"], [r.filtered[-1] for r in results])
    seen = drawn["plots"][np.isfinite(drawn["plots"]).all(axis=1)]
    np.testing.assert_array_equal(seen, np.concatenate([r.measured for r in results]))


def test_more_tracks_are_named_at_their_ends_where_nothing_is_covered():
    results = fan(20)
    figure, ax = plot_tracks(results, [f"ship {k}" for k in range(20)])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["plots", "start", "end"]
    figure.canvas.draw()
    boxes = []
    for text, result in zip(ax.texts, results, strict=True):
        np.testing.assert_allclose(text.xy, result.filtered[-1])
        box = text.get_window_extent()
        assert ax.get_window_extent().padded(1).containsx(box.x0)
        assert not any(box.overlaps(other) for other in boxes)
        for other in results:
            path = ax.transData.transform(other.filtered)
            between = (
                path[:-1, None] + np.linspace(0, 1, 200)[:, None] * np.diff(path, axis=0)[:, None]
            )
            inside = (between > box.min).all(axis=-1) & (between < box.max).all(axis=-1)
            assert not inside.any()
        boxes.append(box)
    assert len(boxes) == 20
    colors = {line.get_color() for line in ax.lines if len(line.get_xdata()) == 6}
    assert len(colors) == 20


def test_where_there_is_no_room_for_names_they_are_in_the_legend():
    _, ax = plot_tracks(
        [FIXED.run([0.0, 1.0], [[0.0, 0.0], [9.0, 9.0]])] * 9,
        [f"a long name {k}" for k in range(9)],
    )
    assert len(ax.texts) == 0
    assert len(ax.get_legend().get_texts()) == 9 + 3


def test_very_many_tracks_have_colors_but_no_names():
    _, ax = plot_tracks(fan(21))
    (collection,) = (c for c in ax.collections if isinstance(c, LineCollection))
    assert len({tuple(color) for color in collection.get_colors()}) == 21
    np.testing.assert_array_equal(collection.get_segments()[0], fan(21)[0].filtered)
    assert ax.get_title() == "21 tracks, each in a color of its own"
    assert set(lines(ax)) == {"plots", "start", "end"}


def test_coasting_of_many_tracks_is_marked_by_dots():
    results = fan(25)
    results[3].innovation[4] = np.nan
    _, ax = plot_tracks(results)
    (dots,) = (line for line in ax.lines if line.get_label() == "coasted")
    assert dots.get_markersize() < 3
    np.testing.assert_array_equal(lines(ax)["coasted"], results[3].filtered[4:5])


def test_parts_of_a_track_share_its_color_and_no_line_joins_them():
    first, second, third = fan(3)
    _, ax = plot_tracks([first, second, third], ["a", "b", "a"])
    gap = np.full((1, 2), np.nan)
    expected = np.concatenate([first.filtered, gap, third.filtered])
    np.testing.assert_array_equal(lines(ax)["a"], expected)
    np.testing.assert_array_equal(lines(ax)["start"], [first.filtered[0], second.filtered[0]])
    np.testing.assert_array_equal(lines(ax)["end"], [third.filtered[-1], second.filtered[-1]])


def test_a_batch_is_its_tracks(batch):
    _, ax = plot_tracks(batch)
    np.testing.assert_array_equal(lines(ax)["1,2"], batch.filtered[:, 1, 2])
    missed = lines(ax)["coasted"]
    np.testing.assert_array_equal(missed, batch.filtered[5:6, 1, 2])


def test_a_batch_draws_all_of_its_tracks_itself(batch):
    drawn = lines(batch.plot(ids=list("abcdef")).axes[0])
    np.testing.assert_array_equal(drawn["f"], batch.filtered[:, 1, 2])
    drawn = lines(batch.plot(track=(0, 1)).axes[0])
    np.testing.assert_array_equal(drawn["filtered"], batch.filtered[:, 0, 1])


def test_one_track_is_drawn_with_all_that_is_known(result):
    _, ax = plot_tracks([result], ["A7"])
    assert {"plots", "predicted", "filtered", "coasted", "start", "end"} == set(lines(ax))


def test_plots_that_a_gate_rejected_are_marked_and_do_not_shrink_the_rest():
    t = np.arange(30.0)
    z = np.stack([t, 0 * t], axis=1)
    result = FIXED.run(t, np.where((t == 9) | (t == 20), np.nan, 1.0)[:, None] * z)
    result.measured[9], result.measured[20] = (9.0, 3.0), (1e6, 0.0)
    _, ax = plot_tracks([result])
    drawn = lines(ax)
    np.testing.assert_array_equal(drawn["plots not used (+ 1 outside)"], [(9.0, 3.0)])
    np.testing.assert_array_equal(drawn["coasted"], result.filtered[[9, 20]])
    assert np.isnan(drawn["plots"][[9, 20]]).all()
    assert ax.get_xlim()[1] < 60


@pytest.mark.parametrize("count", [5, 200])
def test_rejected_plots_are_small_where_they_are_many(count):
    t = np.arange(300.0)
    result = FIXED.run(t, np.where(t[:, None] < 300 - count, t[:, None] + [0.0, 1.0], np.nan))
    result.measured[300 - count :] = result.filtered[300 - count :] + 5
    _, ax = plot_tracks([result])
    (rejected,) = (line for line in ax.lines if line.get_label() == "plots not used")
    assert len(rejected.get_xdata()) == count
    assert (rejected.get_markersize() < 3) == (count > 75)


def test_many_plots_are_drawn_by_their_density():
    t = np.arange(5000.0)
    z = np.random.default_rng(2).normal(size=(5000, 2))
    results = [FIXED.run(t, z + 9 * k) for k in range(5)]
    _, ax = plot_tracks(results)
    (mesh,) = (c for c in ax.collections if isinstance(c, QuadMesh))
    assert mesh.get_array().sum() == 25_000
    assert "plots" not in lines(ax)
    np.testing.assert_array_equal(lines(ax)["0"], results[0].filtered)
    assert ax.figure.axes[1].get_ylabel() == "plots in a cell"
    corners = mesh.get_coordinates()
    width, height = corners[0, 1] - corners[0, 0], corners[1, 0] - corners[0, 0]
    assert width[0] == pytest.approx(height[1], rel=0.02)
    # Of tracks that could not be told apart there are none.
    _, ax = plot_tracks([FIXED.run(t[:1000], z[:1000])] * 21, [str(k) for k in range(21)])
    assert lines(ax) == {}
    assert ax.get_title() == "21 tracks, not drawn one by one"
    assert not any(isinstance(c, LineCollection) for c in ax.collections)


def test_densities_far_apart_have_a_logarithmic_scale():
    crowded = np.concatenate([np.zeros((20_000, 1)), np.arange(900.0)[:, None]])
    _, ax = plot_tracks(FIXED.run(np.arange(len(crowded), dtype=float), crowded), unit="")
    (mesh,) = (c for c in ax.collections if isinstance(c, QuadMesh))
    assert mesh.get_array().sum() == 20_900
    _, ax = plot_tracks(FIXED.run(np.arange(20_900.0), np.repeat(crowded, 2, axis=1)))
    (mesh,) = (c for c in ax.collections if isinstance(c, QuadMesh))
    assert isinstance(mesh.norm, LogNorm)


def test_long_lines_have_fewer_points_but_keep_their_gaps():
    t = np.arange(150_000.0)
    half = FIXED.run(t, np.stack([t, t], axis=1))
    _, ax = plot_tracks([half, half], ["a", "a"])
    drawn = lines(ax)["filtered"]
    assert len(drawn) < 200_000
    assert np.isnan(drawn).any(axis=1).sum() == 1
    np.testing.assert_array_equal(drawn[-1], half.filtered[-1] / 1000)


def test_no_line_joins_a_full_circle_and_zero():
    z = np.array([350.0, 356.0, 2.0, 8.0])
    result = make_tracker("fixed:alpha=1:beta=1e-9").run(np.arange(4.0), z)
    _, ax = plot_tracks([result], unit="deg", period=360.0)
    np.testing.assert_allclose(lines(ax)["filtered"][:, 1], [350, 356, np.nan, 2, 8])
    np.testing.assert_array_equal(lines(ax)["plots"][:, 1], z)


def test_positions_are_drawn_elsewhere_and_the_sensor_is_marked():
    results = fan(2)
    _, ax = plot_tracks(
        results, aspect=2.0, project=lambda p: p + 5.0, sensor=(1.0, 2.0), unit=("deg", "deg")
    )
    np.testing.assert_array_equal(lines(ax)["0"], results[0].filtered + 5)
    np.testing.assert_array_equal(lines(ax)["sensor"], [(1.0, 2.0)])
    assert ax.get_aspect() == 2.0


def test_times_of_hours_are_in_hours():
    _, ax = plot_tracks([FIXED.run([0.0, 3600.0, 9000.0], [1.0, 2.0, 3.0])])
    np.testing.assert_array_equal(lines(ax)["plots"], [(0, 1), (1, 2), (2.5, 3)])
    assert ax.get_xlabel() == "time (h)"


@pytest.mark.parametrize("count", [2, 12, 25])
def test_nothing_is_clipped(count):
    figure, _ = plot_tracks(fan(count), gains=True)
    figure.canvas.draw()
    tight, whole = figure.get_tightbbox(), figure.bbox_inches
    assert tight.x0 >= -0.01
    assert tight.y0 >= -0.01
    assert tight.x1 <= whole.x1 + 0.01
    assert tight.y1 <= whole.y1 + 0.01


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: plot_tracks([]), "results: must be a TrackResult or a sequence of at least one"),
        (lambda r: plot_tracks(7), "results: must be"),
        (lambda r: plot_tracks([r[0], 7]), "results: 1: must be a TrackResult of one track, got i"),
        (lambda r: plot_tracks(r, ["a"]), "ids: 1 for 2 tracks"),
        (lambda r: plot_tracks(r, unit=("m",)), "unit: needs 1 or 2 units, got 1"),
        (
            lambda r: plot_tracks([r[0], FIXED.run([0.0], [1.0])]),
            r"results: tracks with \[1, 2\] ax",
        ),
    ],
)
def test_wrong_arguments(call, message):
    with pytest.raises(ValueError, match=message):
        call(fan(2))
    assert plt.get_fignums() == []
