"""
Ranking trackers
================

Trackers on the random tracks with which this package ranks them: ``report``, the four maneuvers of
Llinas et al. (1998); ``mixed``, straight legs and turns or accelerations of 0.1 to 1 σ/T²;
``strong``, the same with 1 to 3 σ/T². Errors are those of the predicted position, in standard
deviations σ of the noise.

A tracker can only be judged when its numbers are tuned. Those that are written out here were tuned
once for all three sets, on other tracks than those of this page, as for a radar whose targets are
not known beforehand; ``maneuver`` and ``imm-three`` are told the strongest maneuver to expect,
3 σ/T². The ranking of every tracker of the package, on many more tracks, is in :doc:`/ranking`.
"""

# %%
# Each tracker is a text, as on the command line.
from matplotlib import pyplot as plt

from fuzzytrack.tuning import VARIANTS, rank

trackers = {
    "fixed α-β": "fixed:alpha=0.543:beta=0.548",
    "fixed α-β, published": "fixed:alpha=0.5377:beta=0.2018",
    "stiffness-damping": "stiffness-damping",
    "omega-schedule": "omega-schedule",
    "Kalman CV": "kalman-cv:sigma_v=0.8697",
    "bank": "bank:lowest=0.3621:highest=0.9048:forget=0.6779",
    "maneuver": "maneuver:level=3",
    "IMM CV/CA": (
        "imm:quiet_sigma=0.003112:maneuver_sigma=0.4009:quiet_stay=0.9319:maneuver_stay=0.8489"
    ),
    "imm-three": "imm-three:level=3",
}

# %%
# Real plots do not come at a constant period T, and some do not come at all. A variant says when
# they come and how good they are.
chosen = ["constant T", "T=2", "Pd.5", "jitter", "alternate 1:10", "outliers"]
for name in chosen:
    print(f"{name:15} {VARIANTS[name]}")

# %%
# 60 fresh tracks a set. A change is that of the geometric mean over the sets, against the Kalman
# filter on the same plots, with the standard error of the paired difference.
ranking = rank(trackers, tracks=60, seed=20, variants=chosen)
print(f"{'':21}" + "".join(f"{name:>17}" for name in chosen))
for name in trackers:
    cells = []
    for variant in chosen:
        change = ranking.change(name, "Kalman CV", variant)
        text = f"{100 * change.value:+.1f} ± {100 * change.error:.1f} %"
        cells.append(f"{text if change.value < 3 else f'× {1 + change.value:.3g}':>17}")
    print(f"{name:21}" + "".join(cells))

# %%
# At a constant period rules on a smoothed innovation, ``omega-schedule``, are better than every
# fixed gain and every Kalman filter. With irregular time they are not: dimensionless gains do not
# suit it, and may diverge. The rules of ``maneuver`` set the noise of a covariance instead, which
# follows the time since the last plot. They are better than an IMM of two models; one of three
# models is better still.
shown = [name for name in trackers if name != "Kalman CV"]
figure, axes = plt.subplots(2, 3, figsize=(9, 6.5), sharey=True, layout="constrained")
for ax, variant in zip(axes.flat, chosen, strict=True):
    changes = [ranking.change(name, "Kalman CV", variant) for name in shown]
    values = [min(100 * change.value, 60) for change in changes]
    colors = ["#0072B2" if value < 0 else "#D55E00" for value in values]
    errors = [100 * c.error if c.value < 0.6 else 0 for c in changes]
    ax.barh(shown, values, xerr=errors, color=colors)
    ax.axvline(0, color="black", linewidth=0.8)
    ax.set(title=variant, xlim=(-25, 60))
    ax.set_axisbelow(True)
    ax.grid(axis="x", color="0.9")
figure.supxlabel("RMSE of prediction, change against a tuned Kalman filter (%), cut off at 60")
