"""What a kernel is told, with and without `sees_every_step`."""

import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker
from fuzzytrack.schedulers import GainScheduler

NAN = math.nan
PLOTS = np.array([NAN, 5.0, NAN, 8.0, 9.0, NAN, NAN, 13.0])
TIMES = np.array([0.0, 1, 2, 4, 5, 6, 8, 9])
SIGMA = np.arange(8.0) + 1


class Counting(GainScheduler):
    """Remembers the number of calls whose memory was kept, and the sum of their finite sigmas."""

    def __init__(self, every_step, coupled):
        self.sees_every_step, self.coupled = every_step, coupled
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


def memory_and_calls(every_step, start, coupled=False):
    scheduler = Counting(every_step, coupled)
    plots = np.stack([PLOTS, PLOTS], axis=1) if coupled else PLOTS
    sigma = SIGMA[:, None] if coupled else SIGMA
    result = AlphaBetaTracker(scheduler, start).run(TIMES, plots, sigma)
    rows = result.state.rows
    return result.state.lanes[rows.memory : rows.state, 0].tolist(), np.array(scheduler.calls)


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("start", ["two-point", "one-point"])
def test_every_step_from_the_first_plot_on(start, coupled):
    memory, calls = memory_and_calls(True, start, coupled)
    assert memory == [7, 2 + 4 + 5 + 8]
    sigmas = calls[:, 3]
    np.testing.assert_array_equal(sigmas, [np.inf, 2, np.inf, 4, 5, np.inf, np.inf, 8])
    np.testing.assert_array_equal(calls[2:, 2], np.diff(TIMES)[1:])
    asked = [4, 7] if start == "two-point" else [3, 4, 7]
    others = [k for k in range(8) if k not in asked]
    assert (calls[others, :2] == 0).all()
    assert calls[7, 1] == 4


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("start", "kept"), [("two-point", [2, 5 + 8]), ("one-point", [3, 17])])
def test_otherwise_only_plots_that_need_gains(start, kept, coupled):
    memory, calls = memory_and_calls(False, start, coupled)
    assert memory == kept
    assert np.isfinite(calls).all()
