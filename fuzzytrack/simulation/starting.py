"""Plots for a two-point start: one in each of the first two scans."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.noise import Plots

__all__ = ["prepare_start"]


def prepare_start(t: ArrayLike, z: ArrayLike, sigma: ArrayLike) -> tuple[Array, Plots]:
    """Plots from the first one on, with the second scan interpolated where it was missed.

    Parameters
    ----------
    t : array_like, shape (n_steps,)
        Times (s), increasing.
    z : array_like, shape (n_steps, ...)
        Plots (m); NaN where missed.
    sigma : array_like
        Their standard deviation (m), broadcast against `z`.

    Returns
    -------
    t : ndarray, shape (n_left,)
        Times (s) from the first scan on in which any run has a plot.
    plots : Plots
        Plots and standard deviations from there on. A run, and axis, whose first plot comes later
        has NaN until then. Where the scan after its first plot was missed it holds the straight
        line from the first plot to the next one; a run without a next one stays as it is.

    Raises
    ------
    ValueError
        If shapes do not fit, or there is no plot at all.

    Notes
    -----
    Llinas et al. (1998), section 4.1.1. The interpolated plot uses a later one: this is for
    simulation. Its standard deviation is that of the interpolation.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.simulation.starting import prepare_start
    >>> t, plots = prepare_start([0, 1, 2, 3], [np.nan, 5.0, np.nan, 9.0], 1.0)
    >>> t, plots.z
    (array([1., 2., 3.]), array([5., 7., 9.]))
    """
    times = np.asarray(t, dtype=np.float64)
    given = np.asarray(z, dtype=np.float64)
    if given.ndim == 0 or times.shape != given.shape[:1]:
        raise ValueError(
            f"t: needs one time a scan; got shapes {times.shape} for t and {given.shape} for z"
        )
    deviations = np.broadcast_to(np.asarray(sigma, dtype=np.float64), given.shape)
    lanes = given.reshape(len(given), -1)
    seen = ~np.isnan(lanes)
    any_seen = np.flatnonzero(seen.any(axis=1))
    if not len(any_seen):
        raise ValueError("z: no scan has a plot")
    begin = int(any_seen[0])
    times, lanes, seen = times[begin:], lanes[begin:].copy(), seen[begin:]
    spread = deviations.reshape(len(given), -1)[begin:].copy()

    first = seen.argmax(axis=0)
    order = np.arange(len(times))[:, None]
    later = seen & (order > first + 1)
    following = later.argmax(axis=0)
    # One lane for each axis of a run; other lanes have their second plot, or no later plot.
    column = np.flatnonzero(later.any(axis=0))
    column = column[~seen[first[column] + 1, column]]
    one, two, three = first[column], first[column] + 1, following[column]
    part = (times[two] - times[one]) / (times[three] - times[one])
    lanes[two, column] = (1 - part) * lanes[one, column] + part * lanes[three, column]
    spread[two, column] = np.hypot((1 - part) * spread[one, column], part * spread[three, column])
    shape = (len(times), *given.shape[1:])
    return times, Plots(lanes.reshape(shape), spread.reshape(shape))
