"""
The file of a radar
===================

A radar writes range and azimuth. ``track`` makes tracks of them in x (east) and y (north), with the
noise of each plot.
"""

# %%
# An aircraft passes a radar at 18 km, and turns to the north. The radar sees it every 4 s, with a
# standard deviation of 30 m in range and 0.15° in azimuth. Some plots are missed, and two
# are wrong by 2 km. The table has the names and units of a usual file.
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import fuzzytrack as ft

random = np.random.default_rng(8)
n, step, speed = 90, 4.0, 150.0
turn = np.clip(0.02 * (step * np.arange(n) - 200), 0, np.pi / 2)
course = np.pi / 2 - turn
moves = speed * step * np.stack([np.sin(course), np.cos(course)], axis=-1)
truth = np.array([-16_000.0, 18_000.0]) + np.cumsum(moves, axis=0)

distance = np.hypot(*truth.T) + random.normal(0, 30, n)
azimuth = np.degrees(np.arctan2(*truth.T)) + random.normal(0, 0.15, n)
distance[[25, 60]] += 2_000
distance[random.random(n) < 1 / 15] = np.nan
plots = pd.DataFrame(
    {
        "time": pd.date_range("2024-05-01T12:00:00Z", periods=n, freq="4s"),
        "range": distance.round(0),
        "azimuth": (azimuth % 360).round(2),
    }
)
print(plots.head(4).to_string(index=False))

# %%
# A name of a file does as well as a data frame. On the command line it would be ``fuzzytrack track
# radar.csv --polar range,azimuth --sigma-range 30 --sigma-azimuth 0.15``.
tracked = ft.track(plots, polar=("range", "azimuth"), sigma_range=30, sigma_azimuth=0.15)
for sentence in tracked.findings.sentences():
    print(sentence)
result = tracked.results[0]
tracked.plot()

# %%
# Azimuth passes north on the way. The two wrong plots are beyond the gate and were not used; of a
# missed plot the row holds the prediction.
table = tracked.to_pandas()
print(table[["x_filtered", "y_filtered", "x_sd", "speed", "course", "coasted"]].tail(4))

# %%
# The deviation of a filtered position follows the noise across the line of sight, which grows with
# the distance, and the maneuver that the rules see.
error = np.hypot(*(result.filtered - truth).T)
figure, ax = plt.subplots(figsize=(8, 3.5), layout="constrained")
ax.plot(step * np.arange(n), error, ".", label="error of the filtered position")
ax.plot(step * np.arange(n), np.hypot(table["x_sd"], table["y_sd"]), label="its deviation")
ax.set(xlabel="time (s)", ylabel="m")
ax.legend(loc="upper left")
