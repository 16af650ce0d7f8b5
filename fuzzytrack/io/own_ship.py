"""Plots relative to a sensor that moves, as positions about a fixed origin."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.io.geodetic import LocalFrame, axes_on_earth, on_the_earth
from fuzzytrack.io.polar import ConvertedPlots

__all__ = ["relative_to_own_ship"]


def relative_to_own_ship(
    plots: ConvertedPlots,
    own: ArrayLike | None = None,
    heading: ArrayLike | None = None,
    frame: LocalFrame | None = None,
) -> ConvertedPlots:
    """Positions about a fixed origin of plots relative to own ship.

    Own ship's position and heading are taken as exact: their errors are not in the covariance.

    Parameters
    ----------
    plots : ConvertedPlots
        Positions relative to own ship: to its east and north; with `heading`, to starboard and
        ahead, which is what `polar_to_cartesian` makes of bearings from the bow. Maybe up.
    own : array_like, shape (n, 2) or (n, 3), optional
        Own ship at the time of each plot: east, north and maybe up of the origin in m; with
        `frame`, latitude and longitude in degrees and maybe altitude in m. Without up or
        altitude, it is at the height of the origin. For plots on one axis, that axis
        serves. Without `own`, it is at the origin.
    heading : array_like, shape (n,) or a number, optional
        Direction of its bow in degrees clockwise from north.
    frame : LocalFrame, optional
        Origin of the positions, if `own` is a place on earth.

    Returns
    -------
    ConvertedPlots
        Where own ship's position or heading is NaN, the plot is a missed one. An axis that the plot
        does not have stays NaN; to be turned, a plot needs all. Marked as impossible are, beside
        the plots that were, those with a heading outside [-360, 720], and with an own ship whose
        place does not exist or is out of the frame's reach.

    Raises
    ------
    ValueError
        If the shapes do not fit.
    DataError
        If pymap3d is needed and not installed.
    """
    if heading is not None:
        plots = _headed(plots, np.asarray(heading, dtype=np.float64))
    if own is None:
        return plots
    places = np.asarray(own, dtype=np.float64)
    n = len(plots.position)
    allowed = (2, 3) if frame is not None or plots.position.shape[1] > 1 else (1, 2, 3)
    if places.shape not in [(n, axes) for axes in allowed]:
        raise ValueError(f"`own`: shape {places.shape}; expected ({n}, 2) or ({n}, 3)")
    if frame is not None:
        return _carried(plots, places, frame)
    axes = min(places.shape[1], plots.position.shape[1])
    position = plots.position.copy()
    position[:, :axes] += places[:, :axes]
    position[np.isnan(places).any(axis=1)] = np.nan
    impossible = plots.impossible | np.isinf(places).any(axis=1)
    return _known(position, plots.covariance, impossible)


def _headed(plots: ConvertedPlots, heading: Array) -> ConvertedPlots:
    """Plots to starboard and ahead as plots to the east and north."""
    n = len(plots.position)
    if heading.shape not in ((), (n,)):
        raise ValueError(f"`heading`: shape {heading.shape}; expected a number, or ({n},)")
    degrees = np.broadcast_to(heading, (n,))
    impossible = (degrees < -360) | (degrees > 720)
    angle = np.radians(np.where(impossible, np.nan, degrees))
    turn = np.zeros((n, 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 0, 1], turn[:, 1, 0], turn[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    position = _turned(turn, plots.position)
    covariance = _turned_covariance(turn, plots.covariance)
    return _known(position, covariance, plots.impossible | impossible)


def _carried(plots: ConvertedPlots, own: Array, frame: LocalFrame) -> ConvertedPlots:
    """Plots about places on earth as plots about the origin of the frame.

    East and north of own ship are other directions than those of the origin: at a latitude of 60°,
    100 km to the east, north is turned by 1.6°.
    """
    lat, lon = own[:, 0], own[:, 1]
    alt = np.where(np.isnan(own[:, 2]), frame.alt, own[:, 2]) if own.shape[1] == 3 else None
    turn = axes_on_earth(frame.lat, frame.lon) @ np.swapaxes(axes_on_earth(lat, lon), -1, -2)
    ship = frame.to_local(lat, lon, alt)
    impossible = plots.impossible | ship.impossible | ship.too_far
    if plots.position.shape[1] == 3:
        if alt is None:
            ship = frame.to_local(lat, lon, np.full(len(lat), frame.alt))
        position = ship.position + _turned(turn, plots.position)
    else:
        # Own ship and target at the height of the origin, as all plots without a height.
        shown = np.where(impossible[:, None], np.nan, own)
        east, north = plots.position.T
        places = on_the_earth(east, north, shown[:, 0], shown[:, 1], frame.alt)
        target = frame.to_local(places.lat, places.lon)
        position, impossible = target.position, impossible | target.too_far
    return _known(position, _turned_covariance(turn, plots.covariance), impossible)


def _turned(turn: Array, position: Array) -> Array:
    axes = position.shape[1]
    return np.asarray(np.einsum("nij,nj->ni", turn[:, :axes, :axes], position))


def _turned_covariance(turn: Array, covariance: Array | None) -> Array | None:
    if covariance is None:
        return None
    axes = covariance.shape[-1]
    part = turn[:, :axes, :axes]
    turned: Array = part @ covariance @ np.swapaxes(part, -1, -2)
    return (turned + np.swapaxes(turned, -1, -2)) / 2


def _known(position: Array, covariance: Array | None, impossible: Mask) -> ConvertedPlots:
    """Plots without the impossible ones; a covariance needs all axes of a plot."""
    position = np.where(impossible[:, None], np.nan, position)
    if covariance is not None:
        covariance = covariance.copy()
        covariance[np.isnan(position).any(axis=1)] = np.nan
    return ConvertedPlots(position, covariance, impossible)
