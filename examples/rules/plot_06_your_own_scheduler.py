"""
How do I write my own scheduler?
================================

As one small function of numbers. This one compares innovations with the noise of the plots: its
gains are small while innovations look like noise, and large when they keep the same sign.
"""

# %%
# The whole scheduler. Noise cancels in a running mean, a turn does not; the mean is the
# memory of the scheduler. The gains stay on the curve of Benedict and Bordner, on which only
# one number is left to choose.
from dataclasses import dataclass

import numpy as np

import fuzzytrack as ft
from fuzzytrack.plotting import plot_errors


@dataclass(frozen=True)
class Alert(ft.GainScheduler):
    calm: float = 0.3
    quick: float = 0.8
    needs_sigma = True

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        calm, quick = self.calm, self.quick

        def alert(innovation, change, dt, sigma, memory):
            mean = 0.6 * memory[0] + 0.4 * innovation / sigma
            surprise = min(abs(mean) / 2.0, 1.0)
            alpha = calm + (quick - calm) * surprise * surprise
            beta = alpha * alpha / (2.0 - alpha)
            return alpha, beta, 0.0, 1.0, (mean,)

        return alert


# %%
# It plugs into the tracker like any other, for one track, a stream or a batch.
t = 4.0 * np.arange(60)
heading = np.deg2rad(90) * np.clip((t - 100) / 60, 0, 1)
velocity = 150 * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
truth = np.cumsum(4.0 * velocity, axis=0)
plots = truth[:, None, :] + np.random.default_rng(6).normal(0, 100, (len(t), 100, 2))

results = {
    "always calm": ft.AlphaBetaTracker(Alert(0.3, 0.3)).run(t, plots, sigma=100.0),
    "always quick": ft.AlphaBetaTracker(Alert(0.8, 0.8)).run(t, plots, sigma=100.0),
    "alert": ft.AlphaBetaTracker(Alert()).run(t, plots, sigma=100.0),
}
plot_errors(results, truth)

# %%
# It holds the turn like the quick filter, and is far quieter on the straight legs. Its gains:
ft.plot_gain_plane(results["alert"])
