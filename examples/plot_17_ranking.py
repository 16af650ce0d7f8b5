"""
Which tracker is best?
======================

Every tracker here on three sets of random tracks: ``report``, the four maneuvers of Llinas et al.
(1998); ``mixed``, straight legs and turns or accelerations of 0.1 to 1 σ/T²; ``strong``, the same
with 1 to 3 σ/T². Errors are those of the predicted position, in standard deviations σ of the noise.

A tracker can only be judged when its numbers are tuned. Each was tuned twice, on other tracks than
those of this page: for each set by itself, and once for all three, as for a radar whose targets
are not known beforehand.
"""

# %%
# The numbers that ``benchmarks/tune.py`` found.
from matplotlib import pyplot as plt

from fuzzytrack.tuning import FAMILIES, rank

TUNED = {
    "fixed α-β, published": {},
    "stiffness-damping": {},
    "stiffness-damping-wide": {},
    "chan-style": {},
    "omega-schedule": {},
    "fixed α-β": {
        "report": (0.5289, 0.3793),
        "mixed": (0.5026, 0.351),
        "strong": (0.5542, 0.8273),
        "all": (0.5369, 0.531),
    },
    "Kalman CV": {
        "report": (0.5397,),
        "mixed": (0.5073,),
        "strong": (1.743,),
        "all": (0.8697,),
    },
    "fading memory": {
        "report": (0.6647,),
        "mixed": (0.6727,),
        "strong": (0.4797,),
        "all": (0.5921,),
    },
    "Kalman CA": {
        "report": (0.09333, 0.05231),
        "mixed": (0.09774, 0.00505),
        "strong": (0.4789, 0.005171),
        "all": (0.2078, 0.005041),
    },
    "innovation variance": {
        "report": (0.384, 7.793),
        "mixed": (0.3818, 18.83),
        "strong": (0.7363, 7.242),
        "all": (0.3445, 8.852),
    },
    "track quality": {
        "report": (2.519,),
        "mixed": (2.653,),
        "strong": (1.001,),
        "all": (1.763,),
    },
    "window search": {
        "report": (0.6506,),
        "mixed": (0.6401,),
        "strong": (0.9194,),
        "all": (0.6529,),
    },
    "bank, soft": {
        "report": (0.4686, 0.7869, 0.9089),
        "mixed": (0.352, 0.7751, 0.6672),
        "strong": (0.5007, 0.985, 0.468),
        "all": (0.3621, 0.9048, 0.6779),
    },
    "stiffness-damping, limits": {
        "report": (0.3964, 0.3973, 0.3682, 0.6001),
        "mixed": (0.3684, 0.3713, 0.4504, 0.5271),
        "strong": (0.6314, 0.6341, 0.3092, 0.455),
        "all": (0.4651, 0.4949, 0.3688, 0.5052),
    },
    "omega-schedule, tuned": {
        "report": (0.8631, 1.664, 0.2437, 0.306, 0.555, 0.9017),
        "mixed": (0.8162, 2.012, 0.2311, 0.3035, 0.5303, 0.5405),
        "strong": (0.7446, 1.842, 0.3663, 0.3663, 0.6928, 0.8469),
        "all": (0.7975, 1.937, 0.2722, 0.3023, 0.5485, 0.8221),
    },
    "IMM CV/CV": {
        "report": (0.2447, 0.8396, 0.9986, 0.997),
        "mixed": (0.002049, 0.8594, 0.945, 0.8897),
        "strong": (0.02583, 2.351, 0.9364, 0.9576),
        "all": (0.221, 1.879, 0.9706, 0.883),
    },
    "IMM CV/CA": {
        "report": (0.1286, 0.1344, 0.9613, 0.9563),
        "mixed": (0.009928, 0.1887, 0.9233, 0.8555),
        "strong": (0.00779, 0.6356, 0.9191, 0.9301),
        "all": (0.003112, 0.4009, 0.9319, 0.8489),
    },
}

# %%
# 60 fresh tracks a set. "Numbers" is how many were tuned; "change" is that of the geometric mean
# over the sets, against fixed α-β gains tuned in the same way.
ranking = rank(TUNED, tracks=60, seed=20)
print(f"{'':27}  tuned once for all:                        tuned for each")
print(f"{'':27}{'numbers':>8}{'report':>8}{'mixed':>8}{'strong':>8}{'change':>16}{'change':>12}")
for each in ranking:
    errors = "".join(f"{each.single[name]:8.3f}" for name in ("report", "mixed", "strong"))
    change = f"{100 * each.single_change:+.1f} ± {100 * each.single_error:.1f} %"
    count = len(FAMILIES[each.name].start)
    print(f"{each.name:27}{count:8}{errors}{change:>16}{100 * each.own_change:+10.1f} %")

# %%
# In words:
#
# * **The published rule base is not better than a tuned fixed filter.** With its four limits tuned
#   it is as good as that, not better: an innovation relative to the displacement of the target
#   does not measure the noise.
# * Rules on a *smoothed innovation against the noise*, ``omega-schedule``, are better than every
#   fixed gain and every Kalman filter, and as good as an IMM of two models of constant velocity; as
#   shipped, without tuning.
# * The IMM with a model of acceleration is the best of all.
# * A bank of fixed filters, mixed by how well they predicted, gains half as much. Gains from the
#   variance of the innovation, or searched over a window, react late and are no better.
# * For one kind of target alone the differences are small: tune a fixed filter first.
names = [each.name for each in ranking if each.single_change < 0.3][::-1]
shown = {each.name: each for each in ranking}
figure, ax = plt.subplots(figsize=(7.5, 5.2), layout="constrained")
places = range(len(names))
single = [100 * shown[name].single_change for name in names]
errors = [100 * shown[name].single_error for name in names]
own = [100 * shown[name].own_change for name in names]
ax.barh(places, single, xerr=errors, color="#0072B2", label="tuned once for all three sets")
ax.plot(own, places, "D", color="#D55E00", label="tuned for each set")
ax.set_yticks(places, names)
ax.axvline(0, color="black", linewidth=0.8)
ax.set_xlabel("RMSE of prediction, change against tuned fixed gains (%)")
ax.legend(loc="upper right")
ax.set_axisbelow(True)
ax.grid(axis="x", color="0.9")
