"""Pictures of rule bases, gains and tracks, with matplotlib.

Every function returns the figure and its axes, and draws into axes of your own if you give it some.
None of them shows the figure: use ``matplotlib.pyplot.show()``, a notebook or ``figure.savefig()``.
A figure that a function makes belongs to pyplot, as with other libraries, and is closed by
``matplotlib.pyplot.close(figure)``. Where pyplot must not be used, as in a server, give axes of a
``matplotlib.figure.Figure``.
"""

from fuzzytrack.plotting.certificates import plot_certificate
from fuzzytrack.plotting.circle import plot_circle_cost, plot_circle_gains
from fuzzytrack.plotting.clutter import plot_clutter_map
from fuzzytrack.plotting.comparison import plot_comparison
from fuzzytrack.plotting.experiments import (
    plot_consistency,
    plot_error_distribution,
    plot_error_over_time,
    plot_trajectories,
)
from fuzzytrack.plotting.gain_plane import plot_gain_plane
from fuzzytrack.plotting.gains_over_time import plot_gains_over_time
from fuzzytrack.plotting.gates import plot_gates
from fuzzytrack.plotting.life_bars import plot_life_bars
from fuzzytrack.plotting.memberships import plot_memberships
from fuzzytrack.plotting.noise import plot_noise_against_lag, plot_noise_ratio, plot_noise_surfaces
from fuzzytrack.plotting.optimum import plot_motion_gains, plot_optimal_curves, plot_optimal_gains
from fuzzytrack.plotting.rulebases import plot_rulebase, plot_rules
from fuzzytrack.plotting.scans import plot_scan
from fuzzytrack.plotting.scores import plot_scores
from fuzzytrack.plotting.stability import plot_stability_regions, plot_stability_volume
from fuzzytrack.plotting.surfaces import plot_gain_surfaces, plot_relation, plot_surface
from fuzzytrack.plotting.track_errors import plot_errors
from fuzzytrack.plotting.tracks import plot_track, plot_tracks

__all__ = [
    "plot_certificate",
    "plot_circle_cost",
    "plot_circle_gains",
    "plot_clutter_map",
    "plot_comparison",
    "plot_consistency",
    "plot_error_distribution",
    "plot_error_over_time",
    "plot_errors",
    "plot_gain_plane",
    "plot_gain_surfaces",
    "plot_gains_over_time",
    "plot_gates",
    "plot_life_bars",
    "plot_memberships",
    "plot_motion_gains",
    "plot_noise_against_lag",
    "plot_noise_ratio",
    "plot_noise_surfaces",
    "plot_optimal_curves",
    "plot_optimal_gains",
    "plot_relation",
    "plot_rulebase",
    "plot_rules",
    "plot_scan",
    "plot_scores",
    "plot_stability_regions",
    "plot_stability_volume",
    "plot_surface",
    "plot_track",
    "plot_tracks",
    "plot_trajectories",
]
