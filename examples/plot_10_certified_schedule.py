"""
May the gains switch freely?
============================

Each pair of gains of a schedule is stable. That does not make the schedule stable: gains that
change at the wrong moments can make an error grow. A certificate covers all orders.
"""

# %%
# The narrow rule base is certified: whatever the order in which its gains are used, the error, in a
# suitable measure, shrinks at every step.
import numpy as np
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack.gains.certificate import error_matrix
from fuzzytrack.schedulers.reachable_gains import certify

narrow = certify(ft.load_rulebase("stiffness-damping"))
print(f"{narrow.verdict}: at least by a factor of {narrow.rate:.3f} a step")

# %%
# The wide one is refuted, by gains within its limits that make an error grow when repeated.
wide = certify(ft.load_rulebase("stiffness-damping-wide"))
print(f"{wide.verdict}: by a factor of {wide.growth:.3f} a step, with")
print(wide.sequence.round(3))


# %%
# Both, starting with an error of 1 m: gains at random within the narrow limits, and the sequence.
def errors(gains):
    state, size = np.array([1.0, 0.0]), [1.0]
    for matrix in error_matrix(*np.transpose(gains)):
        state = matrix @ state
        size.append(np.hypot(*state))
    return size


random = np.random.default_rng(1)
figure, ax = plt.subplots(layout="constrained")
for run in range(20):
    gains = narrow.vertices[random.integers(len(narrow.vertices), size=40)]
    label = "narrow limits, at random" if run == 0 else None
    ax.semilogy(errors(gains), color="#0072B2", alpha=0.5, linewidth=0.8, label=label)
worst = np.sqrt(np.linalg.cond(narrow.lyapunov)) * narrow.rate ** np.arange(41.0)
ax.semilogy(worst, color="black", linestyle="--", label="certified bound")
repeated = np.tile(wide.sequence, (10, 1))
ax.semilogy(errors(repeated), color="#D55E00", label="wide limits, sequence found")
ax.set(xlabel="step", ylabel="error of position and T × velocity (m)")
ax.grid(True, color="0.9")
figure.legend(loc="outside lower center", ncols=2, frameon=False)
