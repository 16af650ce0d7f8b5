"""Pictures of rule bases, gains and tracks, with matplotlib.

Every function returns the figure and its axes, draws into axes of yours when you give it some, and
never shows anything: that is for ``matplotlib.pyplot.show()``, a notebook or ``figure.savefig()``.
A figure that a function makes belongs to pyplot, as with other libraries, and is closed by
``matplotlib.pyplot.close(figure)``. Where pyplot is unwelcome, as in a server, give axes of a
``matplotlib.figure.Figure``.
"""

from fuzzytrack.plotting.gain_plane import plot_gain_plane
from fuzzytrack.plotting.memberships import plot_memberships
from fuzzytrack.plotting.surfaces import plot_gain_surfaces, plot_relation, plot_surface
from fuzzytrack.plotting.tracks import plot_errors, plot_track

__all__ = [
    "plot_errors",
    "plot_gain_plane",
    "plot_gain_surfaces",
    "plot_memberships",
    "plot_relation",
    "plot_surface",
    "plot_track",
]
