"""Plots tracked as they come: the answers are those of the sorted recording, to the last bit."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.io.data_frame import FrameSource
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.plot_files import PlotFiles, Survey
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.table import Words
from fuzzytrack.recordings.live import LiveTracks
from fuzzytrack.recordings.live_answers import REVISION
from fuzzytrack.recordings.preparation import prepare_surveyed
from fuzzytrack.recordings.restarts import Restarts
from fuzzytrack.recordings.streaming import OpenTracks
from fuzzytrack.recordings.track_table import TrackRows

FIXED = "fixed:alpha=0.5:beta=0.3"


def plots_of(tracker=FIXED, **options):
    """Prepared plots of two axes with an identity."""
    source = FrameSource.of({"time": [0.0], "id": ["a"], "x": [0.0], "y": [0.0]})
    reading = Reading.of(id="id", **options)
    return prepare_surveyed(PlotFiles.of((source,), reading), Survey(), tracker)


def piece_of(rows):
    """Rows (id, time, x, y) as a piece, in this order."""
    names = tuple(dict.fromkeys(id for id, *_ in rows))
    codes = np.array([names.index(id) for id, *_ in rows], dtype=np.int64)
    numbers = np.array([row[1:] for row in rows], dtype=float).reshape(-1, 3)
    lines = np.arange(2, 2 + len(rows))
    return Piece(Words(names, codes), numbers[:, 0], numbers[:, 1:], lines)


def of_the_whole(prepared, rows):
    """Answers to the sorted recording, by identity and time; what `track --sort` does."""
    piece = piece_of(rows)
    order = np.lexsort((piece.time, piece.ids.codes))
    pieces = list(prepared.files.cleaned([piece.take(order)], Findings()))
    table = prepared.table
    tracks = OpenTracks(
        prepared.tracker, prepared.files.decoder.sigma, table.outputs, prepared.judge
    )
    values, restarts, found = TrackRows(table), Restarts(), {}
    for cleaned in pieces:
        tracked = tracks.advance(cleaned)
        part = tracked.piece
        if tracked.begins is not None:
            part = restarts.advance(part, tracked.begins)
        columns = values.values(part, tracked.outputs)
        for k in range(len(part)):
            found[part.ids[k], float(part.time[k])] = {n: columns[n][k] for n in table.names}
    return found


def last_answers(live, rows, cuts=()):
    """Last answer to each identity and time, of rows that come in parts."""
    piece, found, revisions = piece_of(rows), {}, {}
    every = []
    edges = [0, *sorted(cuts), len(rows)]
    for begin, end in pairwise(edges):
        if begin == end:
            continue
        answers = live.push(piece.take(np.arange(begin, end)))
        for k in range(len(answers)):
            row = {name: answers.columns[name][k] for name in live.names}
            key = row["id"], float(row["time"])
            revision = row.pop(REVISION)
            assert revision == revisions.get(key, -1) + 1
            found[key], revisions[key] = row, revision
            every.append((int(answers.lines[k]), int(revision), key, same_form(row)))
    return found, every


def same_form(row):
    """A row whose numbers can be compared bit by bit."""
    return {
        name: np.float64(value).tobytes() if isinstance(value, float | np.floating) else value
        for name, value in row.items()
    }


@st.composite
def late_feeds(draw):
    """Rows of a few tracks, in an order within a lateness."""
    lateness = draw(st.sampled_from([2.0, 5.0, 11.0]))
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    rows = []
    for id in "abc"[: draw(st.integers(1, 3))]:
        count = draw(st.integers(1, 30))
        steps = rng.choice([0.5, 1.0, 1.5, 4.0, 400.0], count, p=[0.3, 0.3, 0.25, 0.1, 0.05])
        times = np.cumsum(steps)
        places = np.cumsum(rng.normal(0, 3, (count, 2)), axis=0)
        places[rng.random(count) < 0.15] += 500.0
        places[rng.random(count) < 0.15] = math.nan
        rows += [(id, t, x, y) for t, (x, y) in zip(times.tolist(), places.tolist(), strict=True)]
    arrival = np.array([t for _, t, *_ in rows]) + rng.uniform(0, lateness, len(rows))
    return [rows[k] for k in np.argsort(arrival, kind="stable")], lateness, rng


@pytest.mark.untraced
@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.TrackWarning")
@pytest.mark.parametrize(
    ("tracker", "options"),
    [
        (FIXED, {}),
        ("kalman-cv:sigma_v=0.5", {"sigma": 3.0, "stale": 5.0, "least_step": 0.8}),
        ("stiffness-damping", {"max_gap": 20.0}),
    ],
)
@settings(max_examples=20)
@given(feed=late_feeds())
def test_last_answers_to_late_plots_are_those_of_the_sorted_recording(tracker, options, feed):
    rows, lateness, rng = feed
    ready = plots_of(tracker, **options)
    whole = of_the_whole(ready, rows)
    live = LiveTracks(ready, lateness=lateness)
    found, every = last_answers(live, rows, rng.integers(0, len(rows) + 1, 3).tolist())
    assert found.keys() == whole.keys()
    for key, row in found.items():
        assert same_form(row) == same_form(whole[key])
    # However the rows come in parts, the same is written.
    again = last_answers(LiveTracks(ready, lateness=lateness), rows, range(1, len(rows)))[1]
    assert again == every
    assert not live.faults.counts
