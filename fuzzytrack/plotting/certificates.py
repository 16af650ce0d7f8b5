"""Certificates of stability: the gains in question, and how the error shrinks or grows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzytrack.arrays import Array
from fuzzytrack.gains.certificate import Certificate, error_matrix
from fuzzytrack.gains.covariance_certificate import CovarianceCertificate
from fuzzytrack.gains.polygons import convex_hull
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting.gain_plane import plot_gain_plane
from fuzzytrack.trackers.state import Gains

__all__ = ["plot_certificate"]

# Plots that the error is followed for, and times that a sequence is repeated at least.
PLOTS, REPEATS = 60, 3


def plot_certificate(
    found: Certificate | CovarianceCertificate,
    *,
    axes: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """The gains in question, and what becomes of the error from plot to plot.

    Parameters
    ----------
    found : Certificate or CovarianceCertificate
        From `fuzzytrack.certify`.
    axes : Axes or sequence of Axes, optional
        Axes to draw into: two, and one for gains from a covariance.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        The plane of gains and the size of the error; of gains from a covariance the latter only.

    Raises
    ------
    ValueError
        If there are more or fewer axes.

    Notes
    -----
    Of a certified set the line is the bound of the certificate, which no order of gains exceeds. Of
    a refuted one it is an error under the sequence of gains that was found; both are measured by
    the best norm that was found.
    """
    if isinstance(found, CovarianceCertificate):
        figure, grid = shared.panels("axes", axes, 1, columns=1, size=(6.0, 4.4))
        _contraction(grid[0], found)
        return figure, grid
    figure, grid = shared.panels("axes", axes, 2, columns=2, size=(5.6, 5.4))
    _gains(grid[0], found)
    _errors(grid[1], found)
    return figure, grid


def _gains(ax: Axes, found: Certificate) -> None:
    clouds = {"corners of the set": _as_gains(found.vertices)}
    if len(found.sequence):
        clouds["gains of the sequence"] = _as_gains(np.unique(found.sequence, axis=0))
    plot_gain_plane(clouds, ax=ax)
    hull = convex_hull(found.vertices)
    closed = np.concatenate([hull, hull[:1]])
    planes: list[Any] = [ax, *ax.child_axes]
    for plane in planes:
        plane.plot(*closed.T, color=shared.BLUE, linewidth=1.0, zorder=2)


def _as_gains(pairs: Array) -> Gains:
    alpha, beta = np.reshape(pairs, (-1, 2)).T
    return Gains(alpha, beta, np.zeros_like(alpha))


def _errors(ax: Axes, found: Certificate) -> None:
    if found.verdict == "refuted":
        sizes = _growing(found)
        label, color = "error, with the sequence of gains", shared.VERMILION
    else:
        plots = np.arange(PLOTS + 1)
        sizes = found.rate ** plots.astype(np.float64)
        label, color = "bound, for any order of gains", shared.BLUE
    ax.plot(np.arange(len(sizes)), sizes, color=color, label=label)
    ax.axhline(1.0, color=shared.GRAY, linewidth=0.8)
    shared.log_axis(ax, "y")
    ax.set(xlabel="plots", ylabel="size of the error, 1 at the start", title=found.verdict)
    shared.finish(ax)
    shared.legend_below(ax)


def _growing(found: Certificate) -> Array:
    """Size of an error that the sequence makes grow, before the first plot and after each."""
    alpha, beta = found.sequence.T
    steps = error_matrix(alpha, beta, found.elapsed / found.times.low)
    cycle = np.linalg.multi_dot([np.eye(2), *steps[::-1]])
    values, vectors = np.linalg.eig(cycle)
    error = np.real(vectors[:, np.argmax(np.abs(values))])
    count = max(PLOTS, REPEATS * len(steps))
    errors = [error]
    for k in range(count):
        errors.append(steps[k % len(steps)] @ errors[-1])
    sizes = found.norm(np.array(errors))
    return np.asarray(sizes / sizes[0])


def _contraction(ax: Axes, found: CovarianceCertificate) -> None:
    plots = np.array([0, *found.contraction])
    left = np.array([1.0, *found.contraction.values()])
    ax.plot(plots, left, marker="o", color=shared.BLUE, label="worst sequence that was found")
    shared.log_axis(ax, "y")
    ax.set(xlabel="plots", ylabel="share of the error that is left", title=found.verdict)
    shared.finish(ax)
    shared.legend_below(ax)
