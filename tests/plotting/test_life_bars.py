"""Bars of tracks and true objects over time: where each begins and ends, and what it means."""

import numpy as np
import pytest
from harbor import PERIOD, harbor
from matplotlib.colors import to_rgba

from fuzzytrack.errors import DataError
from fuzzytrack.plotting import plot_life_bars
from fuzzytrack.scan import TrackReports

HARBOR = harbor()
TIMES = PERIOD * np.arange(60)


def bars(ax):
    """First and last time of every bar, its height and its color, by the name of its row."""
    rows = {
        round(tick, 6): text.get_text()
        for tick, text in zip(ax.get_yticks(), ax.get_yticklabels(), strict=True)
    }
    found = {name: [] for name in rows.values()}
    for collection in ax.collections:
        for path in collection.get_paths():
            low, high = path.vertices.min(axis=0), path.vertices.max(axis=0)
            row = min(rows, key=lambda tick: abs(tick - (low[1] + high[1]) / 2))
            color = tuple(collection.get_facecolor()[0][:3])
            span = (round(low[0], 6), round(high[0], 6), round(high[1] - low[1], 6), color)
            found[rows[row]].append(span)
    return found


def test_tracks_have_bars_by_status():
    _, ax = plot_life_bars(HARBOR.reports, times=TIMES)
    found = bars(ax)
    assert list(found) == ["1", "2", "3", "4", "100", "50 static", "51 static", "52 static"]
    spans = sorted(each[:3] for each in found["2"])
    # Tentative from 6 s, confirmed from 12 s, coasting from 40 to 50 s, until after the last scan.
    assert spans == [(6, 12, 0.22), (12, 40, 0.72), (40, 50, 0.38), (50, 120, 0.72)]
    assert sorted(each[:2] for each in found["1"]) == [(6, 12), (12, 60)]
    assert len({found[name][0][3] for name in ("1", "2", "3", "4", "100")}) == 5
    assert found["50 static"][0][3] == to_rgba("0.55")[:3]


def test_true_objects_have_the_colors_of_their_tracks():
    _, ax = plot_life_bars(HARBOR.reports, HARBOR.truth, times=TIMES)
    found = bars(ax)
    assert list(found)[:4] == ["boat 0", "boat 1", "boat 2", "boat 3"]
    color = {name: spans[0][3] for name, spans in found.items()}
    # Tentative reports are no tracks: boats are followed from 12 s on.
    thin, *followed = sorted(found["boat 0"], key=lambda span: span[2])
    assert thin[:2] == (0, 120)
    assert sorted(followed) == [
        (12, 60, 0.72, color["1"]), (60, 120, 0.72, color["100"])
    ]  # fmt: skip
    (switch,) = (each for each in ax.lines if len(each.get_xdata()) == 1)
    assert switch.get_xdata()[0] == 60
    assert "another track takes over" in [t.get_text() for t in ax.get_legend().get_texts()]


def test_a_truth_farther_than_the_limit_is_not_followed():
    time, names, positions = HARBOR.truth
    _, ax = plot_life_bars(HARBOR.reports, (time, names, positions + 500.0), times=TIMES)
    assert [len(bars(ax)[f"boat {k}"]) for k in range(4)] == [1, 1, 1, 1]
    assert "1 moving" in bars(ax)


def test_a_lag_of_the_tracks_is_taken_off():
    time, names, positions = HARBOR.truth
    earlier = time - 30.0, names, positions
    _, ax = plot_life_bars(HARBOR.reports, earlier, times=TIMES, lag=30.0)
    assert sorted(bars(ax)["boat 1"], key=lambda span: span[2])[1][:2] == (12, 120)


def test_of_too_many_tracks_those_that_follow_an_object_come_first():
    _, ax = plot_life_bars(HARBOR.reports, HARBOR.truth, times=TIMES, most=5)
    assert list(bars(ax))[4:] == ["1", "2", "3", "4", "100"] or set(list(bars(ax))[4:]) == {
        "1", "2", "3", "4", "100"
    }  # fmt: skip
    texts = [text.get_text() for text in ax.texts]
    assert "3 more tracks, not drawn" in texts
    _, ax = plot_life_bars(HARBOR.reports, HARBOR.truth, times=TIMES, most=2)
    assert ax.get_title() == "2 of 4 true objects"


def test_times_are_those_of_the_reports_if_none_are_given():
    _, ax = plot_life_bars(HARBOR.reports)
    assert sorted(each[:2] for each in bars(ax)["3"]) == [(6, 12), (12, 120)]

    class Result:
        reports = HARBOR.reports
        times = TIMES + 100.0

    _, ax = plot_life_bars(Result())
    assert sorted(each[:2] for each in bars(ax)["3"])[0] == (106, 112)


def test_no_track():
    _, ax = plot_life_bars(TrackReports.none())
    assert ax.get_title() == "no track"
    _, ax = plot_life_bars(TrackReports.none(), HARBOR.truth, times=TIMES)
    assert list(bars(ax)) == ["boat 0", "boat 1", "boat 2", "boat 3"]


def test_a_truth_of_another_time_is_an_error():
    time, names, positions = HARBOR.truth
    with pytest.raises(DataError, match="truth: known from"):
        plot_life_bars(HARBOR.reports, (time + 1e6, names, positions), times=TIMES)
