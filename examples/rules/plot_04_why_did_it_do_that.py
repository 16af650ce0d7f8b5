"""
Why did it do that?
===================

The decisions of a rule base can be explained. Find the update with the largest innovation, and show
which rules chose the gains.
"""

# %%
# A target on a line that brakes at 15 s, seen with noise.
import numpy as np

import fuzzytrack as ft

random = np.random.default_rng(5)
t = np.arange(30.0)
truth = np.where(t < 15, 40 * t, 600 + 10 * (t - 15))
z = truth + random.normal(0, 5, len(t))

rules = ft.load_rulebase("stiffness-damping")
result = ft.AlphaBetaTracker(ft.FuzzyScheduler(rules)).run(t, z)
ft.plot_track(result, truth, axes_names=["distance"])

# %%
# The inputs of the rules are the innovation against the distance traveled, and the change of that
# (the normalization ``chan``). The first two plots only start the track.
innovation, change = result.innovation[2:], np.diff(z)[1:]
error = innovation / np.maximum(abs(innovation), abs(change))
before = np.concatenate([[0.0], error[:-1]])
rate = (error - before) / np.maximum(abs(error - before), abs(before))

# %%
# Where is the innovation largest, and which gains did the rules choose? Every rule that fired, the
# strongest first, and the gains that follow from its outputs:
system = ft.FuzzySystem(rules)


def why(k):
    print(f"t = {t[k + 2]:g} s, innovation {innovation[k]:.1f} m")
    for fired in system.explain(E=error[k], dE=rate[k]):
        print("   ", fired)
    outputs = system(E=error[k], dE=rate[k])
    alpha, beta = ft.alpha_beta_from_w(outputs["stiffness"], outputs["damping"])
    print(f"    alpha {alpha:.3f}, beta {beta:.3f}; used was {result.gains.alpha[k + 2]:.3f}")


largest = int(np.argmax(abs(innovation)))
why(largest)

# %%
# For a large error that does not change, the published rules choose the smallest stiffness and
# damping: they correct least just when the target brakes. This is a place to edit. Four plots later
# the track is close to the target again, and several rules fire together:
why(largest + 4)
