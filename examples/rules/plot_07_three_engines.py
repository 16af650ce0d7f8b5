"""
How exact is the output?
========================

A rule base can be evaluated in three ways: exactly, through the discrete relational matrix as the
papers do, or from a table. They are compared here.
"""

# %%
# The exact engine evaluates the sets at the input itself. The relational matrix has values at its
# grid points only: there it must agree up to rounding; between them it takes the nearest one.
import numpy as np
from matplotlib import pyplot as plt

import fuzzytrack as ft

rules = ft.load_rulebase("stiffness-damping-cog")
exact, matrix = ft.FuzzySystem(rules), ft.FuzzySystem(rules, method="relation")


def largest_difference(system, x, y):
    return np.max(np.abs(system(E=x, dE=y)["damping"] - exact(E=x, dE=y)["damping"]))


grid = rules.input("E").universe.values
print(f"relation, on its grid:  {largest_difference(matrix, grid[:, None], grid):.1e}")

random = np.random.default_rng(7)
x, y = random.uniform(-1, 1, (2, 5_000))
print(f"relation, anywhere:     {largest_difference(matrix, x, y):.1e}")

# %%
# The table interpolates between exact values, and measures its error bound when it is built.
nodes = np.array([11, 21, 41, 81])
tables = [ft.FuzzySystem(rules, method="table", table_nodes=int(n)) for n in nodes]
bounds = [table.table_bounds["damping"] for table in tables]
errors = [largest_difference(table, x, y) for table in tables]
for n, error, bound in zip(nodes, errors, bounds, strict=True):
    print(f"table of {n} nodes:      {error:.1e}, bound {bound:.1e}")

# %%
# The error falls faster than the nodes grow in number, and stays below the bound.
figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.loglog(nodes, bounds, "s--", color="0.4", label="bound measured when built")
ax.loglog(nodes, errors, "o-", color="#0072B2", label="largest error at 5,000 points")
ax.set(xlabel="nodes an input", ylabel="error of the damping ratio")
ax.set_xticks(nodes, [str(n) for n in nodes])
ax.yaxis.set_major_formatter("{x:g}")
ax.minorticks_off()
ax.legend(frameon=False)
ax.grid(color="0.9")

# %%
# The surface shows the error of the matrix, with its 41 points for each input: it has steps,
# because the nearest grid point is used instead of the input itself.
figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
for ax, method in zip(axes, ("exact", "relation"), strict=True):
    ft.plot_surface(rules, "damping", points=201, method=method, style="contour", axes=ax)
    ax.set_title(method)
# sphinx_gallery_thumbnail_number = 2
