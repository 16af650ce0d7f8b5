"""Warnings of gains that do not suit the times of the plots."""

import warnings

import numpy as np
import pytest

import fuzzytrack as ft
from benchmarks.straight import lost
from fuzzytrack.schedulers import FadingMemory, KalmanCA, KalmanCV, QualityGains
from fuzzytrack.trackers import ParallelBank, WindowSearch
from fuzzytrack.trackers.catalog import as_tracker

FIXED = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))
PAIRS = np.cumsum(np.tile([0.02, 0.98], 40))


def plots_at(times, axes=1, seed=1):
    noise = np.random.default_rng(seed).normal(size=(*times.shape, axes))
    return 3.0 * times[..., None] + noise


def warned(tracker, times, plots, sigma=1.0, **given):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        tracker.run(times, plots, sigma, **given)
    assert {w.category for w in caught} <= {ft.TrackWarning}
    assert {w.filename for w in caught} <= {__file__}
    assert len(caught) <= 1
    return bool(caught)


def test_near_duplicate_times():
    with pytest.warns(ft.TrackWarning, match=r"AlphaBetaTracker\(FixedGains\(0.5, 0.2\)\): .* noi"):
        FIXED.run(PAIRS, plots_at(PAIRS))
    assert warned(FIXED, PAIRS, plots_at(PAIRS)[:, 0])
    # The same plots, evenly.
    even = np.arange(80) / 2
    assert not warned(FIXED, even, plots_at(even))


@pytest.mark.parametrize(
    "tracker",
    [
        ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, period=1)),
        ft.AlphaBetaTracker("stiffness-damping:period=1"),
        ft.AlphaBetaTracker(KalmanCV(0.5)),
        ft.AlphaBetaTracker(KalmanCV(0.01), "one-point"),
        ft.AlphaBetaTracker(KalmanCA(0.5, 1.0)),
        as_tracker("imm:quiet_sigma=0.01:maneuver_sigma=1"),
        as_tracker("imm-three:level=5"),
    ],
    ids=repr,
)
@pytest.mark.parametrize("spread", [1.0, 3.0])
def test_gains_that_follow_the_time_are_right_at_any_times(tracker, spread):
    random = np.random.default_rng(7)
    assert not warned(tracker, PAIRS, plots_at(PAIRS, 2))
    times = np.cumsum(10 ** random.uniform(-spread, spread, (100, 6)), axis=0)
    plots = plots_at(times, 2)
    plots[random.random((100, 6)) < 0.4] = np.nan
    assert not warned(tracker, times, plots)


@pytest.mark.parametrize(
    "tracker",
    [
        FIXED,
        ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, 0.03)),
        ft.AlphaBetaTracker(FadingMemory(0.6)),
        ft.AlphaBetaTracker(QualityGains()),
        ft.AlphaBetaTracker("stiffness-damping"),
        ft.AlphaBetaTracker("chan-style"),  # coupled
        ft.AlphaBetaTracker("omega-schedule"),
        ParallelBank(),
        WindowSearch(window=4),
    ],
    ids=repr,
)
def test_gains_without_a_unit_are_wrong_at_times_that_differ_much(tracker):
    times = np.cumsum(10 ** np.random.default_rng(7).uniform(-2, 2, (100, 6)), axis=0)
    plots = plots_at(times, 2)
    assert warned(tracker, times, plots)
    assert not warned(tracker, np.arange(100.0), plots)
    # At the times of some tracks; all others are even.
    mixed = np.broadcast_to(np.arange(100.0)[:, None], (100, 6)).copy()
    mixed[:, 4] = times[:, 4]
    assert warned(tracker, mixed, plots)


def test_any_shape():
    times = np.cumsum(10 ** np.random.default_rng(7).uniform(-2, 2, (60, 3, 2)), axis=0)
    plots = plots_at(times, 2)
    for tracker in (FIXED, ft.AlphaBetaTracker("omega-schedule")):
        assert warned(tracker, times, plots)
        assert warned(tracker, times[:, 0, 0], plots)
        assert warned(tracker, times[:, 0, 0], plots[:, 0, 0, 0])
        assert warned(tracker, times, plots, dtype=np.float32)
        assert not warned(tracker, np.arange(60.0), plots)


def test_without_gains_there_is_nothing_to_look_at():
    assert not warned(FIXED, PAIRS, plots_at(PAIRS), keep=("predicted",))
    assert warned(FIXED, PAIRS, plots_at(PAIRS), keep=("gains",))


def test_of_a_large_batch_some_tracks_are_looked_at():
    times = np.repeat(PAIRS[:, None], 900, axis=1)
    assert warned(FIXED, times, plots_at(times))
    assert warned(FIXED, PAIRS, plots_at(times))


def test_a_continued_run():
    plots = plots_at(PAIRS)
    with pytest.warns(ft.TrackWarning):
        state = FIXED.run(PAIRS[:40], plots[:40]).state
    assert warned(FIXED, PAIRS[40:], plots[40:], state=state)


def test_nothing_to_look_at():
    empty = np.zeros((0, 3, 2))
    assert not warned(FIXED, np.zeros(0), empty)
    assert not warned(FIXED, [3.0], np.zeros((1, 2)))
    assert not warned(FIXED, [0.0, 1.0, 2.0, 90.0], np.full((4, 2), np.nan))
    assert not warned(FIXED, [0.0, 0.01, 9.0], np.zeros((3, 0, 2)))


def test_steps_of_a_single_track_may_differ_by_half():
    times = np.cumsum(np.random.default_rng(2).uniform(0.5, 1.5, 100))
    assert not warned(ft.AlphaBetaTracker(ft.FixedGains(0.54, 0.548)), times, plots_at(times))


# ------------------------------------------------------------------ whoever loses tracks says so

HOLD = (
    "kalman-cv:sigma_v=0.1",
    "kalman-ca:sigma_v=0.01:acceleration_sigma=0.3",
    "imm:quiet_sigma=0.05:maneuver_sigma=0.5",
    "imm-three:level=0.5",
    "fixed:alpha=0.543:beta=0.548:period=1",
    "fading-memory:xi=0.6:period=1",
    "stiffness-damping:period=1",
    "chan-style:period=1",
    "omega-schedule:period=1",
)
MAY_LOSE = (
    "fixed:alpha=0.543:beta=0.548",
    "fixed:alpha=0.5:beta=0.2:gamma=0.03",
    "benedict-bordner:alpha=0.4",
    "fading-memory:xi=0.6",
    "growing-memory:limit=8",
    "linear-combination",
    "track-quality",
    "stiffness-damping",
    "stiffness-damping-wide",
    "chan-style",
    "omega-schedule",
    "bank",
    "window-search",
)


@pytest.mark.untraced
@pytest.mark.parametrize("name", [*HOLD, *MAY_LOSE])
def test_whoever_loses_straight_tracks_says_so(name):
    """Detection 0.4, times whose largest is ten times the smallest."""
    share, said = lost(as_tracker(name), tracks=60 if name in HOLD else 200, seed=20)
    assert said or not share
    if name in HOLD:
        assert (share, said) == (0, False)
