"""
In a notebook
=============

What a notebook shows of a value when it is the last line of a cell, and what ``plot()`` draws. The
tables need no matplotlib, run no scripts, and take the colors of a light page or a dark one.
"""

# sphinx_gallery_thumbnail_number = 2

import numpy as np

import fuzzytrack as ft
from fuzzytrack.testbed import compare

# %%
# A rule base is its table of words. The words are tinted by the order of their sets: blue is the
# lowest, orange the highest.

rules = ft.load_rulebase("stiffness-damping")
rules

# %%
# One that is no table is a list of rules. A system adds the sets.

ft.FuzzySystem("maneuver")

# %%
# ``plot()`` of a rule base draws its sets, its rules and its surfaces; that of a system the
# surfaces alone, with the options of :func:`~fuzzytrack.plotting.plot_surface`.

figure = ft.FuzzySystem(rules).plot("stiffness", style="contour")

# %%
# A certificate shows what proves or refutes stability.

found = ft.certify(rules, steps=(1, 4))
found

# %%
figure = found.plot()

# %%
# A comparison marks the best tracker, and those that are worse than the plots themselves.

t = np.arange(60.0)
truth = np.stack([10 * t, 100 * np.sin(t / 12)], axis=1)
comparison = compare(
    ["maneuver", "stiffness-damping", "fixed:alpha=0.2:beta=0.02"], t, truth, 5.0, 30, 0
)
comparison

# %%
figure = comparison.plot()

# %%
# A recording that was tracked has a table of its tracks and a picture.

plots = {"t": t, "x": truth[:, 0], "y": truth[:, 1] + np.random.default_rng(0).normal(0, 5, 60)}
ft.track(plots, sigma=5)
