"""
From plots to tracks: a harbor
==============================

You see what a scan tracker makes of the plots of a radar that have no identities: tracks with
their kind and status, the clutter that it has learned, its gates, and how well the tracks fit the
truth, as pictures and as an animated page.
"""

# %%
# A harbor is simulated: boats, a ferry of 40 m, a shore, piers and other clutter, seen from a small
# ship that moves. On the command line ``fuzzytrack simulate harbor`` writes such plots, and
# ``fuzzytrack scan`` tracks plots of any file.
import html
import tempfile
from pathlib import Path

import fuzzytrack as ft
from fuzzytrack.plotting import plot_clutter_map, plot_gates, plot_life_bars, plot_scan
from fuzzytrack.reports import write_scan_page
from fuzzytrack.simulation.scene import load_scene, simulate_scans

simulated = simulate_scans(load_scene("harbor:scans.count=120"), seed=1)
scans = simulated.scans
truth = simulated.truth.time, simulated.truth.target_id, simulated.truth.position

# %%
# Each track has a color, dashed where it coasts. The broad gray lines are the truth.
tracker = ft.load_scanner("default")
result = tracker.run(scans)
axes = ("east", "north")
plot_scan(result, scans, truth, axes)

# %%
# Which track followed which boat, and for how long. A triangle marks where another track takes
# over; where there is none, a thin line is left.
plot_life_bars(result, truth)

# %%
# A session takes scan after scan. It knows how dense clutter is: high along the shore and at the
# piers, so that few tracks begin there.
session = tracker.start()
for scan in scans[:60]:
    session.step(scan)
plot_clutter_map(session, scans[:60], axes_names=axes)

# %%
# Where its tracks are expected in the next scan: a plot inside of a gate may be that of the track.
# Gates of tentative tracks are dotted, and wide where their velocity is not known yet.
plot_gates(session, scans[60], axes_names=axes)

# %%
# OSPA is the distance between the set of tracks and that of true targets: a target without a track
# counts as 20 m. The truth lists what moves only.
ft.score(result, truth, truth_lists="moving").plot()


# %%
# The same as a page with a slider of time. The file loads nothing, so it can be sent to anybody:
# the space bar plays, the arrows go from scan to scan, and a track that is clicked shows its
# numbers. ``fuzzytrack scan PLOTS --animate harbor.html`` writes it, too.
class Shown:
    """A page within this page."""

    def __init__(self, path):
        self.text = Path(path).read_text(encoding="utf-8")

    def _repr_html_(self):
        inside = html.escape(self.text)
        look = "width: 100%; height: 44rem; border: 1px solid gray"
        return f'<iframe title="Animated tracks" srcdoc="{inside}" style="{look}"></iframe>'


with tempfile.TemporaryDirectory() as folder:
    page = write_scan_page(Path(folder) / "harbor.html", result, scans, truth, axes, title="Harbor")
    shown = Shown(page)
shown
