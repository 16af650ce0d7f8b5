import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.io import Piece
from fuzzytrack.recordings import Totals
from fuzzytrack.recordings.streaming import OpenTracks

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))


def test_totals_by_hand():
    tracks, whole = OpenTracks(FIXED), Totals()
    for piece in (
        Piece.of(["a", "b", "a"], [0, 5, 1], [[0.0], [7.0], [10.0]]),
        Piece.of(["a", "b", "a"], [2, 6, 4], [[19.0], [math.nan], [40.0]]),
    ):
        whole.add(tracks.advance(piece))
    whole.close(len(tracks), tracks.duration)
    assert (whole.tracks, whole.plots, whole.missed, whole.duration) == (2, 5, 1, 5.0)
    # a: 20 is predicted for 19; then x = 19.5, v = 9.8, and 39.1 for 40
    assert whole.squares[0] == pytest.approx(1 + 0.81)
    assert whole.summary["innovation_rms"] == pytest.approx(math.sqrt(1.81 / 2))
    assert whole.summary["alpha"] == 0.5
    both = Totals()
    both.merge(whole)
    both.merge(whole)
    assert (both.tracks, both.plots, both.summary["beta"]) == (4, 10, pytest.approx(0.2))
    assert math.isnan(Totals().summary["alpha"])


def test_totals_of_whole_tracks_are_those_of_their_pieces():
    rng = np.random.default_rng(3)
    plots = rng.normal(size=(40, 2)).cumsum(axis=0)
    plots[rng.random((40, 2)) < 0.2] = math.nan
    ids, times = rng.integers(0, 3, 40), np.cumsum(rng.uniform(0.5, 2, 40))
    tracks, pieces = OpenTracks(FIXED), Totals()
    pieces.add(tracks.advance(Piece.of(ids, times, plots)))
    pieces.close(len(tracks), tracks.duration)
    whole = Totals.of([FIXED.run(times[ids == id], plots[ids == id]) for id in range(3)])
    assert (whole.tracks, whole.plots) == (pieces.tracks, pieces.plots)
    assert whole.plots + whole.missed == 40
    assert whole.summary == pytest.approx(pieces.summary, rel=1e-12)


def test_totals_of_one_plot():
    summary = Totals.of([FIXED.run([3.0], [[7.0]])]).summary
    assert (summary["plots"], summary["missed"], summary["duration"]) == (1, 0, 0.0)
    assert math.isnan(summary["innovation_rms"])
