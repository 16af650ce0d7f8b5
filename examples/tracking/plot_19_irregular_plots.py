"""
Plots at irregular times
========================

Reports of an aircraft come 1 to 10 s apart, and some are lost. The rule base ``maneuver`` tracks
them with two numbers: the noise of the plots, and the strongest maneuver to expect.
"""

# %%
# The aircraft flies at 200 m/s, and turns through 180 degrees with 4 m/s². The plots have a
# standard deviation of 60 m on each axis; one in ten is missing (NaN).
import matplotlib.pyplot as plt
import numpy as np

import fuzzytrack as ft
from fuzzytrack.trackers import three_model_imm

random = np.random.default_rng(3)
t = np.cumsum(10 ** random.uniform(0, 1, 110))
begin, rate = 190.0, 4 / 200
fine = np.arange(0, t[-1] + 1, 0.1)
heading = np.clip(rate * (fine - begin), 0, np.pi)
path = np.cumsum(20 * np.stack([np.cos(heading), np.sin(heading)], axis=-1), axis=0)
truth = np.stack([np.interp(t, fine, path[:, axis]) for axis in (0, 1)], axis=-1)
z = truth + random.normal(0, 60, truth.shape)
z[random.random(len(t)) < 0.1] = np.nan

# %%
tracker = ft.AlphaBetaTracker("maneuver:level=5")
result = tracker.run(t, z, sigma=60)
ft.plot_track(result, truth)

# %%
# On the straight course α is small; it is larger after a long gap, because the target may have
# changed its course in that time. In the turn the innovations are large and point the same way; the
# rules then set a strong maneuver, and α rises.
seen = ~result.coasted.any(axis=-1)
alpha = result.gains.alpha[seen, 0]
gap = np.diff(t[seen], prepend=np.nan)
figure, ax = plt.subplots(figsize=(8, 3.5), layout="constrained")
ax.axvspan(begin, begin + np.pi / rate, color="0.92", label="turn")
points = ax.scatter(t[seen], alpha, c=gap, s=25, cmap="viridis", zorder=2)
figure.colorbar(points, label="time since the last plot (s)")
ax.set(xlabel="time (s)", ylabel="α", ylim=(0, 1.02))
ax.legend(loc="lower right")

# %%
# The same track 200 times, with other noise each time, in comparison with other trackers. Fixed
# gains and the Kalman filter have no numbers for a straight course and others for a turn; here
# they have those that were tuned on the tracks of :doc:`/ranking`, in units of this noise, for
# plots every 4 s. The IMM of three models runs three Kalman filters for each track.
others = {
    "fixed gains": ft.AlphaBetaTracker("fixed:alpha=0.543:beta=0.548"),
    "fixed gains with a period": ft.AlphaBetaTracker("fixed:alpha=0.543:beta=0.548:period=4"),
    "Kalman filter": ft.AlphaBetaTracker(f"kalman-cv:sigma_v={0.87 * 60 / 4**2}"),
    "maneuver-two-rules": ft.AlphaBetaTracker("maneuver-two-rules:level=5"),
    "maneuver": tracker,
    "imm-three": three_model_imm(level=5),
}
plots = truth[:, None, :] + random.normal(0, 60, (len(t), 200, 2))
plots[random.random((len(t), 200)) < 0.1] = np.nan
for name, other in others.items():
    predicted = other.run(t, plots, sigma=60, keep=("predicted",)).predicted
    error = np.linalg.norm(predicted - truth[:, None, :], axis=-1)[10:]
    print(f"{name:26}  prediction error, RMS: {np.sqrt(np.mean(error**2)):7.1f} m")
