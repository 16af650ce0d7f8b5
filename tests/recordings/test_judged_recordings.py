"""Recordings of many tracks whose plots are judged, in pieces and as a whole."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.io.piece import Piece
from fuzzytrack.recordings.judge import Circle, Gate, Judge
from fuzzytrack.recordings.judged import run_judged
from fuzzytrack.recordings.ragged import run_judged_tracks
from fuzzytrack.recordings.streaming import run_iter
from fuzzytrack.trackers.catalog import make_tracker

pytestmark = pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))
GATE = Judge(Gate(8.0, 2))
# A failure that takes minutes to make smaller is no help.
NO_SHRINKING = [Phase.explicit, Phase.reuse, Phase.generate]
GAINS = ("alpha", "beta", "gamma")
OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation", *GAINS)


def recording(n, n_tracks, n_axes, seed):
    """Identities, times, plots with spikes, and deviations of tracks in any order."""
    rng = np.random.default_rng(seed)
    ids = rng.integers(0, n_tracks, n)
    t = np.cumsum(rng.uniform(0.1, 2, n))
    plots = 3 * t[:, None] + rng.normal(size=(n, n_axes))
    spikes = rng.random(n) < 0.15
    plots[spikes] += 300 * rng.normal(size=(int(spikes.sum()), n_axes))
    plots[rng.random((n, n_axes)) < 0.1] = math.nan
    return ids, t, plots, rng.uniform(0.5, 2, (n, n_axes))


def in_pieces(ids, t, z, sigma, segments, cuts):
    whole = Piece.of(ids, t, z)
    for a, b in pairwise([0, *cuts, len(t)]):
        yield Piece(
            Piece.of(ids[a:b], t[a:b], z[a:b]).ids,
            t[a:b],
            z[a:b],
            whole.rows[a:b],
            sigma=None if sigma is None else sigma[a:b],
            segments=None if segments is None else segments[a:b],
        )


def of(result, name):
    return getattr(result.gains if name in GAINS else result, name)


@given(
    n=st.integers(1, 80),
    n_tracks=st.integers(1, 6),
    seed=st.integers(0, 1000),
    cuts=st.lists(st.integers(0, 80), max_size=5),
    judge=st.sampled_from([None, GATE, Judge(Gate(8.0), Circle(100.0)), Judge(circle=Circle(9.0))]),
    parts=st.sampled_from([1, 2, 4]),
    told=st.booleans(),
)
@settings(max_examples=25, deadline=None, phases=NO_SHRINKING)
def test_any_cuts(n, n_tracks, seed, cuts, judge, parts, told):
    """Rows of pieces are those of each part of each track run by itself, to the last bit."""
    ids, t, z, sigma = recording(n, n_tracks, 2, seed)
    segments = None
    if parts > 1:
        segments = np.zeros(n, dtype=np.int64)
        for id in np.unique(ids):
            mine = np.flatnonzero(ids == id)
            segments[mine] = np.arange(len(mine)) * parts // len(mine)
    cuts = sorted(min(cut, n) for cut in cuts)
    pieces = in_pieces(ids, t, z, sigma if told else None, segments, cuts)
    tracked = list(run_iter(FIXED, pieces, sigma=1.0, judge=judge))
    marks = np.zeros(n, dtype=np.int64) if segments is None else segments
    for id in np.unique(ids):
        for part in np.unique(marks[ids == id]):
            mine = (ids == id) & (marks == part)
            own = sigma[mine] if told else 1.0
            if judge is None:
                alone = FIXED.run(t[mine], z[mine], own)
            else:
                found = run_judged(FIXED, t[mine], z[mine], own, judge)
                alone = found.result
                for name in ("rejected", "begins"):
                    whole = np.concatenate([getattr(each, name) for each in tracked])
                    np.testing.assert_array_equal(whole[mine], getattr(found, name))
            for name in OUTPUTS:
                whole = np.concatenate([each.outputs[name] for each in tracked])
                expected = of(alone, name)
                if judge is not None and judge.circle and name in ("predicted", "filtered"):
                    expected = judge.circle.wrapped(expected)
                np.testing.assert_array_equal(whole[mine], expected, name)


@pytest.mark.parametrize("name", ["maneuver", "kalman-cv:sigma_v=1", "imm-three"])
def test_trackers(name):
    ids, t, z, sigma = recording(200, 5, 2, 7)
    tracker = make_tracker(name)
    pieces = in_pieces(ids, t, z, sigma, None, [30, 31, 140])
    tracked = list(run_iter(tracker, pieces, judge=GATE))
    rejected = np.concatenate([each.rejected for each in tracked])
    filtered = np.concatenate([each.outputs["filtered"] for each in tracked])
    assert rejected.any()
    for id in np.unique(ids):
        mine = ids == id
        alone = run_judged(tracker, t[mine], z[mine], sigma[mine], GATE)
        np.testing.assert_array_equal(rejected[mine], alone.rejected)
        np.testing.assert_array_equal(filtered[mine], alone.result.filtered)


@pytest.mark.parametrize("judge", [GATE, Judge(Gate(8.0), Circle(100.0))])
@pytest.mark.parametrize("told", [False, True])
def test_tracks_of_different_lengths(judge, told):
    rng, tracks, sigmas = np.random.default_rng(5), [], []
    for n in (1, 3, 40, 45, 50, 0, 44):
        _, t, z, sigma = recording(n, 1, 2, int(rng.integers(1000)))
        tracks.append((t, z))
        sigmas.append(sigma)
    shares = []
    own = sigmas if told else None
    found = run_judged_tracks(FIXED, tracks, 1.0, judge, shares.append, sigmas=own)
    assert shares[-1] == 1
    for (t, z), sigma, each in zip(tracks, sigmas, found, strict=True):
        alone = run_judged(FIXED, t, z, sigma if told else 1.0, judge)
        np.testing.assert_array_equal(each.rejected, alone.rejected)
        np.testing.assert_array_equal(each.begins, alone.begins)
        assert each.result.measured is z
        expected = alone.result.filtered
        if judge.circle:
            expected = judge.circle.wrapped(expected)
        np.testing.assert_array_equal(each.result.filtered, expected)
        np.testing.assert_array_equal(each.result.innovation, alone.result.innovation)
    assert run_judged_tracks(FIXED, [], 1.0, judge) == []
