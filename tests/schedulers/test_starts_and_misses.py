"""What a kernel is told at the start of a track and where plots are missing, and what it keeps."""

import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import GainScheduler

NAN = math.nan
PLOTS = np.array([NAN, 5.0, NAN, 8.0, 9.0, NAN, NAN, 13.0])
TIMES = np.array([0.0, 1, 2, 4, 5, 6, 8, 9])
SIGMA = np.arange(8.0) + 1
SEEN = ~np.isnan(PLOTS)

#: Time since the last plot, or since the last step; before the second row it has no meaning.
SINCE = {"elapsed": [1.0, 3.0, 1.0, 1.0, 3.0, 4.0], "step": [1.0, 2.0, 1.0, 1.0, 2.0, 1.0]}


class Counting(GainScheduler):
    """Remembers the number of calls whose memory was kept, and the sum of their finite sigmas."""

    def __init__(self, starts, misses, coupled):
        self.sees_starts, self.sees_misses, self.coupled = starts, misses, coupled
        self.calls = []

    def initial_memory(self, n_axes):
        return (0.0, 0.0)

    def kernel(self, n_axes):
        def kernel(innovation, change, dt, sigma, memory):
            if self.coupled:
                (innovation, *_), (change, *_), (sigma, *_) = innovation, change, sigma
            self.calls.append((innovation, change, dt, sigma))
            told = sigma if sigma != math.inf else 0.0
            return 0.5, 0.2, 0.0, 1.0, (memory[0] + 1, memory[1] + told)

        return kernel


def memory_and_calls(start, missed, coupled, starts=False, misses=False):
    scheduler = Counting(starts, misses, coupled)
    plots = np.stack([PLOTS, PLOTS], axis=1) if coupled else PLOTS
    sigma = SIGMA[:, None] if coupled else SIGMA
    result = AlphaBetaTracker(scheduler, start, missed).run(TIMES, plots, sigma)
    rows = result.state.rows
    calls = np.array(scheduler.calls)
    np.testing.assert_array_equal(calls[2:, 2], SINCE[missed])
    return result.state.lanes[rows.memory : rows.state, 0].tolist(), calls


every_way = [
    pytest.mark.parametrize("coupled", [False, True]),
    pytest.mark.parametrize("missed", ["elapsed", "step"]),
    pytest.mark.parametrize("start", ["two-point", "one-point"]),
]


def in_every_way(test):
    for mark in every_way:
        test = mark(test)
    return test


@in_every_way
@pytest.mark.parametrize(("starts", "misses"), [(True, False), (True, True)])
def test_starts_and_misses(starts, misses, start, missed, coupled):
    memory, calls = memory_and_calls(start, missed, coupled, starts, misses)
    # Where time goes on from step to step, a memory must follow it.
    follows = misses or missed == "step"
    assert memory == [7 if follows else 4, 2 + 4 + 5 + 8]
    np.testing.assert_array_equal(calls[:, 3], np.where(SEEN, SIGMA, np.inf))
    asked = [4, 7] if start == "two-point" else [3, 4, 7]
    others = [k for k in range(8) if k not in asked]
    assert (calls[others, :2] == 0).all()
    assert calls[7, 1] == 4


@in_every_way
def test_otherwise_only_plots_that_need_gains(start, missed, coupled):
    memory, calls = memory_and_calls(start, missed, coupled)
    assert memory == ([2, 5 + 8] if start == "two-point" else [3, 4 + 5 + 8])
    assert np.isfinite(calls).all()


@pytest.mark.parametrize("start", ["two-point", "one-point"])
def test_who_counts_misses_is_told_how_many(start):
    """Rows left out are not counted, and only there rows without a plot differ from them."""
    with_rows, _ = memory_and_calls(start, "elapsed", False, True, True)
    tracker = AlphaBetaTracker(Counting(True, True, False), start)
    state = tracker.run(TIMES[SEEN], PLOTS[SEEN], SIGMA[SEEN]).state
    without = state.lanes[state.rows.memory : state.rows.state, 0].tolist()
    assert (with_rows, without) == ([7, 19], [4, 19])
