import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.io.piece import Piece
from fuzzytrack.recordings.streaming import OpenTracks, run_iter
from fuzzytrack.trackers.catalog import make_tracker

# Times at random lie much closer together than fixed gains allow.
pytestmark = pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))
GAINS = ("alpha", "beta", "gamma")
OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation", *GAINS)


def recording(n, n_tracks, n_axes, seed):
    """Identities, times and plots of tracks that come in no order."""
    rng = np.random.default_rng(seed)
    ids = rng.integers(0, n_tracks, n)
    plots = 10 * rng.normal(size=(n, n_axes))
    plots[rng.random((n, n_axes)) < 0.1] = math.nan
    return ids, np.cumsum(rng.uniform(0.1, 2, n)), plots


def in_pieces(ids, t, z, cuts):
    edges = [0, *cuts, len(t)]
    return [Piece.of(ids[a:b], t[a:b], z[a:b]) for a, b in pairwise(edges)]


def check_equal(tracker, ids, t, z, cuts, sigma=None):
    """Rows of pieces are to be those of each track run by itself, to the last bit."""
    found = list(run_iter(tracker, in_pieces(ids, t, z, cuts), sigma=sigma))
    for name in OUTPUTS:
        whole = np.concatenate([tracked.outputs[name] for tracked in found])
        for id in np.unique(ids):
            mine = ids == id
            alone = tracker.run(t[mine], z[mine], sigma)
            source = alone.gains if name in GAINS else alone
            np.testing.assert_array_equal(whole[mine], getattr(source, name))


@pytest.mark.parametrize(
    "name",
    [
        "fixed:alpha=0.5:beta=0.2",
        "stiffness-damping",
        "kalman-cv:sigma_v=1",
        "imm:quiet_sigma=0.1:maneuver_sigma=2",
        "imm:quiet_sigma=0.1:maneuver_sigma=2:joint=false",
        "window-search:window=3",
    ],
)
@pytest.mark.parametrize("n_axes", [1, 2])
def test_pieces_equal_each_track_alone(name, n_axes):
    ids, t, z = recording(300, 12, n_axes, 5)
    check_equal(make_tracker(name), ids, t, z, [3, 4, 90, 90, 200], 1.0)


@given(
    n=st.integers(1, 80),
    n_tracks=st.integers(1, 12),
    seed=st.integers(0, 1000),
    cuts=st.lists(st.integers(0, 80), max_size=6),
)
@settings(max_examples=25)
def test_any_cuts(n, n_tracks, seed, cuts):
    ids, t, z = recording(n, n_tracks, 2, seed)
    check_equal(FIXED, ids, t, z, sorted(min(cut, n) for cut in cuts))


def test_tracks_need_not_be_in_step():
    """One track lies in one piece, another in each; their times have nothing in common."""
    ids = np.array(["b", "b", "b", "a", "a", "a"])
    t = np.array([10.0, 11.0, 12.0, 0.0, 1.0, 3.0])
    check_equal(FIXED, ids, t, np.arange(6.0)[:, None] ** 2, [4, 5])


def test_states_of_more_and_more_tracks():
    ids = np.concatenate([np.arange(k) for k in (1, 5, 40, 300)])
    t = np.repeat([0.0, 1.0, 2.0, 3.0], [1, 5, 40, 300])
    z = np.random.default_rng(2).normal(size=(len(t), 1))
    check_equal(FIXED, ids, t, z, [1, 6, 46])


def test_what_is_kept():
    piece = Piece.of(["a"], [0], [[1.0]])
    (tracked,) = run_iter(FIXED, [piece], keep=("predicted", "gains"))
    assert set(tracked.outputs) == {"predicted", *GAINS}
    assert tracked.piece is piece
    (tracked,) = run_iter(FIXED, [piece], keep="filtered")
    assert set(tracked.outputs) == {"filtered"}
    with pytest.raises(ValueError, match="keep: unknown 'position'; out of predicted, filtered"):
        OpenTracks(FIXED, keep=("position",))


def test_nothing_comes_of_nothing():
    empty = Piece.of([], [], np.empty((0, 2)))
    (tracked,) = run_iter(FIXED, [empty])
    assert tracked.outputs["filtered"].shape == (0, 2)
    assert list(run_iter(FIXED, [])) == []


def last(pieces):
    for _ in run_iter(FIXED, pieces):
        pass


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([5.0, 5.0], r"row 2: time 5 \(id 'a'\) repeats 5"),
        ([5.0, 4.0], r"row 2: time 4 \(id 'a'\) is earlier than 5"),
    ],
)
def test_times_that_go_back(times, message):
    with pytest.raises(DataError, match=message):
        last([Piece.of(["a", "a"], times, [[1.0], [2.0]])])
    pieces = [Piece.of(["b", "a"], [0.0, times[0]], [[1.0], [2.0]])]
    pieces.append(Piece.of(["b", "a"], [1.0, times[1]], [[1.0], [2.0]]))
    with pytest.raises(DataError, match=message):
        last(pieces)


@pytest.mark.parametrize(
    ("piece", "message"),
    [
        (([1], [math.nan], [[0.0]]), "row 1: time nan; expected a finite number"),
        (([1, 2], [0, 0], [[0.0], [math.inf]]), r"row 2: plot \[inf\]; expected finite numbers"),
    ],
)
def test_what_is_not_finite(piece, message):
    with pytest.raises(DataError, match=message):
        last([Piece.of(*piece)])


def test_axes_that_change():
    pieces = [Piece.of([1], [0], [[0.0]]), Piece.of([1], [1], [[0.0, 1.0]])]
    with pytest.raises(ValueError, match="plots: 2 axes; the pieces before have 1"):
        last(pieces)
