"""
Which gains does it choose?
===========================

Every pair of gains is a point in a plane, and the stable ones fill a triangle. Which part of the
triangle does a rule base use?
"""

# %%
# A straight track that is noisy, and then turns.
import numpy as np

import fuzzytrack as ft

random = np.random.default_rng(3)
t = 4.0 * np.arange(200)
heading = np.deg2rad(90) * np.clip((t - 300) / 60, 0, 1)
velocity = 150 * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
z = np.cumsum(4.0 * velocity, axis=0) + random.normal(0, 100, (len(t), 2))

narrow = ft.load_rulebase("stiffness-damping")
result = ft.AlphaBetaTracker(ft.FuzzyScheduler(narrow)).run(t, z)

# %%
# The outputs of the rule base have limits, and so have the gains: they stay inside the outline, and
# stiffness and damping can be chosen freely there, since any positive pair of them is stable. The
# cloud is small, so it gets an inset. The star is the fixed pair that suits a straight line.
fixed = {"fixed pair": (0.5377, 0.2018)}
ft.plot_gain_plane(result, box=narrow, mark=fixed)

# %%
# The limits decide nearly everything. The same rules within wider limits give a filter with
# much more noise, which at zero damping even stops correcting (α = 0):
wide = ft.load_rulebase("stiffness-damping-wide")
nervous = ft.AlphaBetaTracker(ft.FuzzyScheduler(wide)).run(t, z)
ft.plot_gain_plane({"wide limits": nervous, "narrow limits": result}, box=wide, mark=fixed)

# %%
# The gains over all inputs:
ft.plot_gain_surfaces(narrow)
