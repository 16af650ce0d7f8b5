"""Tracks of a scan tracker: what is drawn, how it is marked, and what happens where it is much."""

import numpy as np
import pytest
from drawn_lines import lines
from harbor import harbor, reports_of
from matplotlib.collections import LineCollection, QuadMesh

from fuzzytrack.plotting import plot_scan
from fuzzytrack.scan import KINDS, STATUSES, Scan, TrackReports

HARBOR = harbor()


def tracks_of(ax):
    """Collections of lines, by the color of each line, with the dashes that they have."""
    return {
        tuple(np.round(c.get_linestyles()[0][1] or (), 1)): c.get_segments()
        for c in ax.collections
        if isinstance(c, LineCollection)
    }


def rows(reports, track):
    return reports.where(reports.track_id == track)


def line_of(reports, track, first=0, last=None):
    """Rows of one track, by the time of the first and after the last."""
    own = rows(reports, track)
    last = np.inf if last is None else last
    return own.position[(own.time >= first) & (own.time <= last)]


def test_every_track_is_one_line_in_its_color_broken_where_it_coasts():
    _, ax = plot_scan(HARBOR.reports)
    drawn = [c for c in ax.collections if isinstance(c, LineCollection)]
    solid = next(c for c in drawn if c.get_linewidths()[0] > 1.5)
    segments = solid.get_segments()
    # Confirmed from the sixth scan on: the line begins at the last tentative place.
    np.testing.assert_array_equal(segments[0], line_of(HARBOR.reports, 1, 10))
    # Track 2 coasts from 40 to 48 s: before, and after.
    np.testing.assert_array_equal(segments[1], line_of(HARBOR.reports, 2, 10, 38))
    np.testing.assert_array_equal(segments[2], line_of(HARBOR.reports, 2, 48))
    assert len({tuple(c) for c in solid.get_colors()}) == 5
    colors = [tuple(c) for c in solid.get_colors()]
    assert colors[1] == colors[2]


def test_coasting_is_dashed_and_tentative_dotted():
    _, ax = plot_scan(HARBOR.reports)
    found = {
        line.get_label(): line
        for line in ax.lines
        if line.get_label() in ("moving", "static", "coasting", "tentative")
    }
    assert found["moving"].get_linestyle() == found["static"].get_linestyle() == "-"
    assert found["coasting"].get_linestyle() == found["tentative"].get_linestyle() == "--"
    dashed = [s for dashes, some in tracks_of(ax).items() if dashes for s in some]
    coasted = line_of(HARBOR.reports, 2, 38, 48)
    assert any(np.array_equal(segment, coasted) for segment in dashed)


def test_static_tracks_are_gray_and_can_be_left_out():
    _, ax = plot_scan(HARBOR.reports)
    last = [rows(HARBOR.reports, track).position[-1] for track in (50, 51, 52)]
    np.testing.assert_array_equal(lines(ax)["_static"], last)
    _, ax = plot_scan(HARBOR.reports, static=False)
    assert "_static" not in lines(ax)
    assert {text.get_text() for text in ax.texts} <= {"1", "2", "3", "4", "100"}


def test_tracks_that_were_never_confirmed_have_no_color_and_no_mark():
    early = rows(HARBOR.reports, 3)
    early.status[:] = STATUSES.index("tentative")
    both = TrackReports.joined([early, rows(HARBOR.reports, 4)])
    _, ax = plot_scan(both)
    dotted = [c for c in ax.collections if isinstance(c, LineCollection) and len(c.get_segments())]
    found = [
        (tuple(color), segment)
        for c in dotted
        for color, segment in zip(
            np.broadcast_to(c.get_colors(), (len(c.get_segments()), 4)),
            c.get_segments(),
            strict=True,
        )
    ]
    gray = [segment for color, segment in found if color[0] == color[1] == color[2]]
    np.testing.assert_array_equal(gray, [early.position])
    assert len(lines(ax)["start"]) == 1
    assert [text.get_text() for text in ax.texts] == ["4"]
    assert {text.get_text() for text in plot_scan(both, static=False)[1].texts} == {"4"}


def test_starts_ends_and_the_last_scan_are_marked():
    _, ax = plot_scan(HARBOR.reports)
    drawn = lines(ax)
    starts = [rows(HARBOR.reports, track).position[0] for track in (1, 2, 3, 4, 100)]
    np.testing.assert_array_equal(drawn["start"], starts)
    np.testing.assert_array_equal(drawn["end"], rows(HARBOR.reports, 1).position[-1:])
    (dots,) = (c for c in ax.collections if not isinstance(c, LineCollection))
    here = [rows(HARBOR.reports, track).position[-1] for track in (2, 3, 4, 100)]
    np.testing.assert_array_equal(dots.get_offsets(), here)


def test_plots_truth_and_own_ship():
    _, ax = plot_scan(HARBOR.reports, HARBOR.scans, HARBOR.truth)
    drawn = lines(ax)
    expected = np.concatenate([scan.positions for scan in HARBOR.scans])
    np.testing.assert_array_equal(drawn["plots"], expected)
    np.testing.assert_array_equal(drawn["radar"], [HARBOR.scans[-1].own])
    true = drawn["true"]
    gaps = np.flatnonzero(np.isnan(true[:, 0]))
    np.testing.assert_array_equal(gaps, [60, 121, 182])
    _, names, positions = HARBOR.truth
    np.testing.assert_array_equal(true[:60], positions[names == "boat 0"])


def test_north_is_upwards_and_far_is_in_kilometers():
    far = reports_of(
        [(k, 2.0 * k, 1, [9000.0 * k, 10.0], [1, 0], [1] * 4, 1, 1, 1, 0, 0) for k in (0, 1)]
    )
    _, ax = plot_scan(far, axes_names=("north", "east"))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("east (km)", "north (km)")
    np.testing.assert_allclose(lines(ax)["start"], [[0.01, 0.0]])
    assert ax.get_aspect() == 1.0
    assert plot_scan(far)[1].get_ylabel() == "y (km)"


def test_names_cover_nothing():
    figure, ax = plot_scan(HARBOR.reports, HARBOR.scans)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert len(boxes) >= 6
    for number, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:number])
    names = [text.get_text() for text in ax.texts]
    assert "100" in names
    for text in ax.texts:
        np.testing.assert_array_equal(
            text.xy, rows(HARBOR.reports, int(text.get_text())).position[-1]
        )


def test_a_gap_in_a_track_is_no_line():
    place = [[0.0, 0.0], [1.0, 0.0], [8.0, 0.0], [9.0, 0.0]]
    some = reports_of(
        [
            (k, 2.0 * k, 1, p, [1, 0], [1] * 4, 1, 1, 1, 0, 0)
            for k, p in zip((0, 1, 7, 8), place, strict=True)
        ]
    )
    _, ax = plot_scan(some)
    (collection,) = (c for c in ax.collections if isinstance(c, LineCollection))
    np.testing.assert_array_equal(collection.get_segments(), [place[:2], place[2:]])


def test_order_of_rows_does_not_matter():
    shuffled = HARBOR.reports.where(np.random.default_rng(0).permutation(len(HARBOR.reports)))
    one, other = (tracks_of(plot_scan(each)[1]) for each in (HARBOR.reports, shuffled))
    assert one.keys() == other.keys()
    for key, segments in one.items():
        for a, b in zip(segments, other[key], strict=True):
            np.testing.assert_array_equal(a, b)


def test_a_result_is_taken_by_its_reports_and_own_path():
    class Result:
        reports = HARBOR.reports
        own = np.array([[0.0, 0.0], [3.0, 4.0]])

    _, ax = plot_scan(Result())
    np.testing.assert_array_equal(lines(ax)["radar"], [[3.0, 4.0]])


@pytest.mark.parametrize("scans", [None, [], [Scan(0.0, np.empty((0, 2)))]])
def test_no_track_and_no_plot(scans):
    _, ax = plot_scan(TrackReports.none(), scans)
    assert ax.get_title() == "no track"


def test_very_many_tracks_and_plots_are_counted_in_cells():
    count = 5000
    random = np.random.default_rng(0)
    place = random.uniform(-1, 1, (count, 2))
    n = np.arange(count)
    words, zeros = np.ones(count, np.uint8), np.zeros(count)
    many = TrackReports(
        0 * n, zeros, n + 1, place, place, np.ones((count, 4)), words, words, zeros, zeros, n
    )
    _, ax = plot_scan(many, [Scan(0.0, random.uniform(-1, 1, (20_001, 2)))])
    assert ax.get_title() == "5,000 tracks, not drawn one by one"
    counted = [c for c in ax.collections if isinstance(c, QuadMesh)]
    assert [int(mesh.get_array().sum()) for mesh in counted] == [count]
    assert "plots" not in lines(ax)
    _, ax = plot_scan(many.where(n < 3), [Scan(0.0, random.uniform(-1, 1, (20_001, 2)))])
    counted = [c for c in ax.collections if isinstance(c, QuadMesh)]
    assert [int(mesh.get_array().sum()) for mesh in counted] == [20_001]
    assert "start" in lines(ax)
    _, ax = plot_scan(many.where(n < 201))
    assert "start" not in lines(ax)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1, 2],), "result: must be the result of a scan tracker, or TrackReports; got list"),
        (
            (HARBOR.reports, None, ([0.0], ["a"], [[1.0]])),
            "truth: positions have 1 axes; a map needs two",
        ),
        ((HARBOR.reports, None, None, ["x"]), "axes_names: needs 2 names, got 1: x"),
    ],
)
def test_what_cannot_be_drawn_is_said(arguments, message):
    with pytest.raises(ValueError, match=message):
        plot_scan(*arguments)


def test_words_of_the_reports_are_as_the_picture_expects():
    assert STATUSES == ("tentative", "confirmed", "coasting")
    assert KINDS == ("undecided", "moving", "static")
