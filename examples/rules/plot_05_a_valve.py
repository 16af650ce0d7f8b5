"""
How do rules become a number?
=============================

The smallest complete fuzzy system, from chapter 3.1 of Llinas et al. (1998): it keeps the flow out
of a valve constant. There is no tracking here: the engine can be used for anything.
"""

# %%
# Four rules over one input: the less flows, the more is opened.
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack.plotting import plot_relation

valve = ft.load_rulebase("valve")
for rule in valve.rules:
    print(rule)
ft.plot_memberships(valve)

# %%
# All rules together are one relational matrix between flow and opening, with a spike for each rule.
# A flow of 1.25 picks the column under the dashed line: the fuzzy output. Its center of gravity is
# the result.
plot_relation(valve, at=1.25)

# %%
# Doing so for every flow gives the control curve.
ft.plot_surface(valve)

# %%
# A rule can have a confidence below 1. With a confidence of 0.5 the spike of the first rule (flow
# zero, opening large) is only half as high, so its neighbor has more weight where both fire.
doubted = ft.load_rulebase("valve-confidence")
print(doubted.rules[0])
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
plot_relation(valve, axes=left)
plot_relation(doubted, axes=right)
left.set_title("trusted")
right.set_title("first rule trusted by half")

# %%
# Where only the first rule fires, its confidence makes no difference: there is nothing to weigh.
for flow in (0.0, 0.25, 0.5, 1.25):
    trusted = ft.FuzzySystem(valve)(flow=flow)["opening"]
    half = ft.FuzzySystem(doubted)(flow=flow)["opening"]
    print(f"flow {flow:4.2f}:  opening {trusted:.3f}  by half {half:.3f}")
# sphinx_gallery_thumbnail_number = 2
