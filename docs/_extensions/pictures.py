"""The page of all pictures: ``docs/pictures.md``, and its files in ``docs/pictures/``.

Sphinx makes them before it reads the pages; run as a script with the name of a folder, this file
makes them there.
"""

import re
import sys
from pathlib import Path

#: What the lines of `PICTURES` use; shown at the top of the page.
SETUP = """\
import numpy as np

import fuzzytrack as ft
from fuzzytrack.plotting import *
from fuzzytrack.scan import Scan, ScanTracker
from fuzzytrack.testbed import monte_carlo

# A turning target, a plot every 4 s, three plots missed.
t = 4.0 * np.arange(60)
heading = np.deg2rad(90) * np.clip((t - 100) / 60, 0, 1)
velocity = 150 * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
truth = np.cumsum(4.0 * velocity, axis=0)
z = truth + np.random.default_rng(1).normal(0, 100, truth.shape)
z[31:34] = np.nan
result = ft.AlphaBetaTracker("stiffness-damping").run(t, z)
fixed = ft.AlphaBetaTracker("fixed:alpha=0.5377:beta=0.2018").run(t, z)
both = {"stiffness-damping": result, "fixed gains": fixed}

# The same in space, and range alone.
height = 3000 + 5 * t
space = ft.AlphaBetaTracker("chan-style").run(t, np.column_stack([z, height]))
alone = ft.AlphaBetaTracker("chan-style").run(t, np.hypot(*z.T))

# Targets that fly apart in all directions, and turn a little at each step: 3, 12 and 40 of them,
# 40,000 plots of 400, and a circle of 900 plots.
def fan(count, steps, turn=0.0, seed=3):
    course = 2 * np.pi * (np.arange(count) / count + turn * np.arange(steps)[:, None])
    path = 400 * np.stack([np.cos(course), np.sin(course)], axis=-1).cumsum(axis=0)
    noise = np.random.default_rng(seed).normal(0, 100, path.shape)
    return ft.AlphaBetaTracker("maneuver:level=10").run(4.0 * np.arange(steps), path + noise, 100)


three, twelve, forty = (fan(count, 40, 0.01) for count in (3, 12, 40))
crowd = fan(400, 100, 0.008)
circle = fan(1, 900, 1 / 900)

# Eight more trackers of the turning target.
many = {
    f"alpha={alpha}": ft.AlphaBetaTracker(ft.FixedGains(alpha, alpha**2 / 2)).run(t, z)
    for alpha in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
}

# A harbor: three boats, of which a radar misses one plot in seven, two buoys, and a shore. The
# radar is on a ship that moves, too.
def harbor(steps=60):
    random = np.random.default_rng(5)
    k = np.arange(steps)[:, None]
    x = [[-300, 250, 60]] + k * [[9, -7, 5]]
    y = [[-120, 180, -260]] + k * [[3, -4, 8]] + 0.05 * k**2 * [[1, 0, -1]]
    boats = np.stack([x, y], axis=-1)
    seen = np.where(random.random((steps, 3, 1)) < 0.86, boats, np.nan)
    buoys = np.array([[-150.0, 180.0], [180.0, -120.0]]) + np.zeros((steps, 2, 2))
    along = random.uniform(-350, 350, (steps, 7))
    shore = np.stack([along, 330 - 0.2 * along + random.normal(0, 9, along.shape)], axis=-1)
    sea = random.uniform(-350, 350, (steps, 4, 2))
    noise = random.normal(0, 1, (steps, 5, 2)) * np.repeat([1.2, 2.2], [3, 2])[:, None]
    targets = np.concatenate([seen, buoys], axis=1) + noise
    plots = np.concatenate([targets, shore, sea], axis=1)
    own = np.stack([-40.0 + 2 * k[:, 0], 0.0 * k[:, 0]], axis=1)
    scans = [
        Scan(2.0 * n, plots[n][np.isfinite(plots[n, :, 0])], own=tuple(own[n]))
        for n in range(steps)
    ]
    names = np.tile(["ferry", "tug", "yacht"], steps)
    return scans, (np.repeat(2.0 * np.arange(steps), 3), names, boats.reshape(-1, 2))


scans, targets = harbor()
tracked = ScanTracker().run(scans)
session = ScanTracker().start()
for scan in scans[:40]:
    session.step(scan)

# Four trackers on 40 random draws of a turning target.
trackers = {
    "maneuver": "maneuver",
    "stiffness-damping": "stiffness-damping",
    "Kalman": "kalman-cv:sigma_v=1",
    "fixed gains": "fixed:alpha=0.3:beta=0.05",
}
found = monte_carlo("turn", trackers, 40, 1)
names = found.names
rmse = dict(zip(names, found.rmse_per_scan()))
twice = dict(zip(names, 2 * found.rmse_per_scan_se()))
bands = {name: (rmse[name] - twice[name], rmse[name] + twice[name]) for name in names}
overall = dict(zip(names, found.rmse()))
sure = {name: (v - 2 * e, v + 2 * e) for name, v, e in zip(names, found.rmse(), found.rmse_se())}
first, last = slice(None, len(found.time) // 2), slice(len(found.time) // 2, None)
halves = {name: [np.nanmean(rmse[name][part]) for part in (first, last)] for name in names}
ranges = {
    name: [[end(rmse[name][part]) for part in (first, last)] for end in (np.nanmin, np.nanmax)]
    for name in names
}
run = found.sample
predicted = dict(zip(names, run.predicted))
distances = dict(zip(names, found.predicted_distance))
nis = found.nis_consistency()
means = dict(zip(names, nis.scan_mean))
band = np.fmax.reduce(nis.scan_low), np.fmin.reduce(nis.scan_high)
"""

#: Lines that make the pictures, by the heading under which they are shown.
PICTURES = {
    "Rule bases": [
        'plot_rulebase("stiffness-damping")',
        'plot_rulebase("maneuver", style="contour")',
        'plot_rulebase("omega-schedule")',
        'plot_rulebase("tipper")',
        'plot_rules("chan-style")',
        'plot_rules("maneuver")',
        'plot_memberships("stiffness-damping")',
        'plot_memberships("maneuver")',
        'plot_memberships("tipper", "tip")',
        'plot_surface("stiffness-damping")',
        'plot_surface("stiffness-damping", style="contour")',
        'plot_surface("tipper")',
        'plot_surface("tipper", style="contour")',
        'plot_surface("maneuver")',
        'plot_surface("omega-schedule")',
        'plot_gain_surfaces("stiffness-damping")',
        'plot_gain_surfaces("chan-style", style="contour")',
        'plot_gain_surfaces("omega-schedule")',
        'plot_relation("valve")',
        'plot_relation("valve", at=1.25)',
    ],
    "Gains": [
        'plot_gain_plane(both, "stiffness-damping")',
        'plot_certificate(ft.certify("stiffness-damping", steps=(1, 4)))',
        'plot_certificate(ft.certify("omega-schedule"))',
        'plot_certificate(ft.certify("maneuver", steps=(1, 4), missed=2))',
        'plot_gain_plane(result, mark={"fixed": (0.5377, 0.2018)}, inset=False)',
        "plot_stability_regions()",
        "plot_stability_volume()",
        'plot_stability_volume(surfaces="critical")',
        'plot_stability_volume(surfaces="dividing")',
        'plot_stability_volume("abc")',
        'plot_stability_volume("abc", surfaces="critical")',
        'plot_stability_volume("abc", surfaces="dividing")',
        "plot_noise_ratio()",
        'plot_noise_ratio(of="velocity")',
        'plot_noise_against_lag({"fixed gains": (0.5377, 0.2018)})',
        "plot_noise_surfaces()",
        'plot_noise_surfaces(space="abc")',
    ],
    "Best gains": [
        "plot_optimal_curves()",
        "plot_optimal_gains()",
        "plot_optimal_gains(order=3)",
        "plot_motion_gains()",
        "plot_motion_gains(order=3)",
        "plot_circle_cost()",
        "plot_circle_gains()",
        "plot_circle_gains(order=3)",
    ],
    "Tracks": [
        "plot_track(result, truth)",
        "plot_track(result, truth, gains=True)",
        "plot_track(space)",
        "plot_track(circle, track=0, gains=True)",
        'plot_tracks(three, ["A7", "B2", "C3"], gains=True)',
        "plot_tracks(twelve)",
        "plot_tracks(forty)",
        "plot_tracks(crowd)",
        "plot_gains_over_time(result, maneuvers=[(100, 160)])",
        "plot_gains_over_time(twelve)",
        'plot_track(alone, axes_names=["range"])',
        "plot_errors(both, truth)",
        "plot_errors(both | many, truth)",
    ],
    "Scans": [
        'plot_scan(tracked, scans, targets, ["east", "north"])',
        'plot_gates(session, scans[40], ((-60, 300), (-170, 130)), ["east", "north"])',
        'plot_clutter_map(session, scans[:40], axes_names=["east", "north"])',
        "plot_life_bars(tracked, targets)",
        'plot_scores(ft.score(tracked, targets, truth_lists="moving"))',
    ],
    "Experiments": [
        'plot_comparison(overall, sure, reference={"plots": found.measured_rmse})',
        "plot_comparison(halves, ranges, ['first half', 'second half'])",
        "plot_error_over_time(found.time, rmse, bands)",
        "plot_error_distribution(distances)",
        "plot_trajectories(run.time, run.truth, run.plots, predicted)",
        "plot_consistency(found.time, means, band, expected=2)",
    ],
}


# Width in inches beyond which a picture gets a row of its own.
WIDE = 7.0


def function_of(line):
    """Name of the function that a line calls."""
    return re.match(r"\w+", line)[0]


def pictures(lines=None):
    """Name of the file, line and figure of each picture, one after the other; all unless given."""
    known = {}
    exec(SETUP, known)
    counts = {}
    for line in lines or [line for some in PICTURES.values() for line in some]:
        name = function_of(line)
        counts[name] = counts.get(name, 0) + 1
        yield f"{name}-{counts[name]}.png", line, eval(line, known)[0]


def write(folder):
    """Write ``pictures.md`` and the folder ``pictures`` beside it."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    folder = Path(folder)
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    entries = {}
    for file, line, figure in pictures():
        figure.savefig(folder / "pictures" / file, dpi=100)
        kind = "picture wide" if figure.get_figwidth() > WIDE else "picture"
        entries[line] = ENTRY.format(file=file, line=line, name=function_of(line), kind=kind)
        plt.close(figure)
    text = [HEAD]
    for heading, lines in PICTURES.items():
        text += [f"## {heading}\n", *(entries[line] for line in lines)]
    text.append(FOOT.format(setup=SETUP))
    (folder / "pictures.md").write_text("\n".join(text), encoding="utf-8")


def setup(app):
    """Draw when Sphinx begins."""
    write(app.srcdir)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


HEAD = """\
# All pictures

You see what every function of {mod}`fuzzytrack.plotting` draws, and the line that makes each
picture. What the lines use is at the end. This page is generated: its lines run when the
documentation is built.

```{raw} html
<style>
figure.picture { display: inline-block; width: 100%; margin: 0 0 1.5rem; vertical-align: top; }
.bd-article figure.picture figcaption, figure.picture .legend { margin: 0; text-align: left; }
figure.picture pre { white-space: pre-wrap; font-size: .8rem; margin: 0; text-align: left; }
figure.picture figcaption p { margin: .3rem 0; }
@media (min-width: 60rem) {
section:has(> figure.picture) {
  display: grid; grid-template-columns: 1fr 1fr; grid-auto-flow: row dense; column-gap: 2%;
}
section:has(> figure.picture) > :not(figure.picture), figure.picture.wide { grid-column: 1 / -1; }
}
</style>
```
"""

ENTRY = """\
```{{figure}} pictures/{file}
:alt: {name}
:figclass: {kind}

{{func}}`~fuzzytrack.plotting.{name}`

    {line}
```
"""

FOOT = """\
## What the lines use

```python
{setup}```
"""

if __name__ == "__main__":
    write(sys.argv[1])
