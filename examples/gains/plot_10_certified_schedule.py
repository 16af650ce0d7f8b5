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
def errors(gains, elapsed=1.0):
    state, size = np.array([1.0, 0.0]), [1.0]
    for matrix in error_matrix(*np.transpose(gains), elapsed):
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

# %%
# All this was at constant T. Times between plots that change are part of the question, since gains
# without a unit do not know them. `omega-schedule` is certified for steps that differ by a factor
# of two, and refuted for a factor of four.
twofold = certify("omega-schedule", steps=(1, 2))
fourfold = certify("omega-schedule", steps=(1, 4))
print(f"1 to 2 s: {twofold.verdict}, at least by a factor of {twofold.rate:.3f} a plot")
print(f"1 to 4 s: {fourfold.verdict}, by a factor of {fourfold.growth:.3f} a plot, with")
for (alpha, beta), elapsed in zip(fourfold.sequence, fourfold.elapsed, strict=True):
    print(f"  alpha {alpha:.3f}, beta {beta:.3f} after {elapsed:g} s")


# %%
# No ellipse does for steps of 1 to 2 s: the norm of the proof has a polygon as unit ball. Every
# gain at every time maps the polygon into a copy of itself that is smaller by the certified factor.
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
ring = np.concatenate([twofold.polygon, twofold.polygon[:1]])
left.plot(*ring.T, color="black", label="norm 1")
left.plot(*(twofold.rate * ring).T, color="black", linestyle="--", label="certified after a plot")
gains = twofold.vertices[random.integers(len(twofold.vertices), size=60)]
for matrix in error_matrix(*gains.T, random.uniform(1, 2, 60)):
    left.fill(*(matrix @ twofold.polygon.T), color="#0072B2", alpha=0.04)
left.set(xlabel="error of predicted position (m)", ylabel="1 s × error of velocity (m)")
left.set(ylim=(-0.95, 1.35))  # room for the legend
left.legend(frameon=False, loc="upper left")

for run in range(20):
    gains = twofold.vertices[random.integers(len(twofold.vertices), size=40)]
    label = "1 to 2 s, at random" if run == 0 else None
    size = errors(gains, random.uniform(1, 2, 40))
    right.semilogy(size, color="#0072B2", alpha=0.5, linewidth=0.8, label=label)
cycles = 40 // len(fourfold.sequence)
size = errors(np.tile(fourfold.sequence, (cycles, 1)), np.tile(fourfold.elapsed, cycles))
right.semilogy(size, color="#D55E00", label="1 to 4 s, sequence found")
right.set(xlabel="plot", ylabel="error (m)")
right.grid(True, color="0.9")
right.legend(frameon=False)
