"""
Pictures of many tracks
=======================

You see how tracks of several targets are drawn: each in a color of its own with its identity,
around the radar or by longitude and latitude, and by their density where there are too many.
"""

# %%
# Six aircraft, simulated, as a radar sees them: range and azimuth, some plots missed. On the
# command line, the option ``--plot tracks.png`` of ``fuzzytrack track`` draws the same picture.
import numpy as np

import fuzzytrack as ft
from fuzzytrack.plotting import plot_gains_over_time, plot_tracks
from fuzzytrack.simulation import make_sample

plots = make_sample("radar").plots
tracked = ft.track(plots, polar=("range", "azimuth"), id="track", sigma_range=30, sigma_azimuth=0.1)
tracked.plot()

# %%
# Of up to three tracks α is drawn below, in the colors of the tracks. Of more, the median and the
# quartiles of the gains are drawn if wanted.
plot_gains_over_time(tracked.results, [track.id for track in tracked.recording.tracks])

# %%
# Ships that report their place themselves are drawn by longitude and latitude.
ft.track(make_sample("ais").plots, geodetic=("lat", "lon"), id="mmsi").plot()

# %%
# Tracks that were not read from a file are drawn by ``plot_tracks``: a batch, or a list of results.
# Up to 20 tracks are named at their ends where there is room.
random = np.random.default_rng(4)


def targets(count, steps):
    """Tracks of targets that fly apart in all directions and turn."""
    turn = 0.01 * np.arange(steps)[:, None]
    course = 2 * np.pi * (np.arange(count) / count + turn)
    path = 600 * np.stack([np.sin(course), np.cos(course)], axis=-1).cumsum(axis=0)
    times = 4.0 * np.arange(steps)
    return ft.AlphaBetaTracker("maneuver:level=10").run(
        times, path + random.normal(0, 100, path.shape), sigma=100
    )


plot_tracks(targets(12, 40), [f"A{number}" for number in range(1, 13)], ("east", "north"))

# %%
# More than 20,000 plots are counted in cells.
plot_tracks(targets(600, 60), axes_names=("east", "north"))
