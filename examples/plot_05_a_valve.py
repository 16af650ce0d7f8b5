"""
How do rules become a number?
=============================

The smallest complete fuzzy system, from chapter 3.1 of Llinas et al. (1998): it keeps the flow out
of a valve constant. No tracking here: the engine knows nothing of targets.
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
# the answer.
plot_relation(valve, at=1.25)

# %%
# Doing so for every flow gives the control curve.
ft.plot_surface(valve)

# %%
# A rule may be trusted by half. With a confidence of 0.5 the spike of the first rule (flow zero,
# opening large) is only half as high, so its neighbor gains weight where both speak.
doubted = ft.load_rulebase("valve-confidence")
print(doubted.rules[0])
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
plot_relation(valve, axes=left)
plot_relation(doubted, axes=right)
left.set_title("trusted")
right.set_title("first rule trusted by half")

# %%
# Where the first rule is alone, its confidence makes no difference: there is no other opinion.
for flow in (0.0, 0.25, 0.5, 1.25):
    trusted = ft.FuzzySystem(valve)(flow=flow)["opening"]
    half = ft.FuzzySystem(doubted)(flow=flow)["opening"]
    print(f"flow {flow:4.2f}:  opening {trusted:.3f}  by half {half:.3f}")
