"""Plots in range and azimuth, perhaps elevation, as Cartesian positions, and back.

Axes are x to the east, y to the north and z up, with the sensor at the origin. Angles are in
radians. An azimuth counts clockwise from north, or counter-clockwise from east.

Noise. The range and the angles of a plot have Gaussian errors. Plain trigonometry then gives
positions that are too near on average, by the factor ``exp(-sigma_azimuth**2 / 2)``: at 0.1° by
1.5e-6, at 10° by 1.5 %. Given the standard deviations, positions are those of the multiplicative
unbiased conversion, and the covariance is the mean square of their error conditioned on the
measurement, both of

    L. Mo, X. Song, Y. Zhou, Z. K. Sun and Y. Bar-Shalom, "Unbiased converted measurements for
    tracking", IEEE Transactions on Aerospace and Electronic Systems 34(3), 1998, 1023-1027.

The modified conversion of Z. Duan, C. Han and X. R. Li (ibid. 40(4), 2004, 1374-1377) multiplies
by the factor by which Mo et al. divide. It gives the mean of positions when nothing else is known
of where the target is; for a target at a given place, its positions are too near by the square of
the factor. Tracks are judged by the latter, so it is not used here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.io.angles import TURN, wrapped

__all__ = [
    "AzimuthFrom",
    "ConvertedPlots",
    "PolarPlots",
    "cartesian_to_polar",
    "polar_to_cartesian",
]

#: Where azimuths begin: clockwise from north, or counter-clockwise from east.
AzimuthFrom = Literal["north", "east"]

#: Noise of an angle, in radians, beyond which the Gaussian has no meaning on a circle.
LARGEST_SIGMA = 1.0

#: A range, or its noise, beyond which it is a value for "nothing measured" (and its square may
#: leave the range of numbers).
LARGEST_RANGE = 1e15


@dataclass(frozen=True)
class ConvertedPlots:
    """Positions of plots that were given in other coordinates.

    Attributes
    ----------
    position : ndarray, shape (n, n_axes)
        East, north and perhaps up; NaN where a part of the plot was missing or impossible.
    covariance : ndarray, shape (n, n_axes, n_axes), or None
        Mean square of the errors of each position; None if no noise was given.
    impossible : ndarray of bool, shape (n,)
        Plots that were dropped since no sensor measures such values.
    """

    position: Array
    covariance: Array | None
    impossible: Mask

    @property
    def sigma(self) -> Array | None:
        """Standard deviation on each axis, shape (n, n_axes): the square roots of the diagonals.

        What the errors of the axes have in common is left out; None if no noise was given.
        """
        if self.covariance is None:
            return None
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))


@dataclass(frozen=True)
class PolarPlots:
    """Positions as a sensor at the origin sees them.

    Attributes
    ----------
    range : ndarray, shape (n,)
        Distance; over all axes, so that it is the slant range of positions with a height.
    azimuth : ndarray, shape (n,)
        Radians in [0, 2 pi); NaN above and at the sensor, where there is none.
    elevation : ndarray, shape (n,), or None
        Radians in [-pi/2, pi/2]; NaN at the sensor. None for positions in the plane.
    """

    range: Array
    azimuth: Array
    elevation: Array | None


def polar_to_cartesian(
    range: ArrayLike,
    azimuth: ArrayLike,
    elevation: ArrayLike | None = None,
    *,
    azimuth_from: AzimuthFrom = "north",
    sigma_range: ArrayLike | None = None,
    sigma_azimuth: ArrayLike | None = None,
    sigma_elevation: ArrayLike | None = None,
) -> ConvertedPlots:
    """Positions of plots in polar coordinates, and the covariance of their errors.

    With an elevation, the range is the slant range, and the position has three axes. Without
    it, the range is taken as the distance in the plane: a target at the height h and the
    slant range r appears farther from the sensor's foot than it is, by about ``h**2 / (2 * r)``.

    Parameters
    ----------
    range : array_like, shape (n,)
        Distances from the sensor.
    azimuth, elevation : array_like, shape (n,)
        Angles in radians; elevation above the horizon.
    azimuth_from : {"north", "east"}
        Azimuth clockwise from north, or counter-clockwise from east.
    sigma_range, sigma_azimuth, sigma_elevation : array_like, shape (n,) or a number, optional
        Standard deviations; of all coordinates that there are, or of none. With them positions
        are debiased; see the module.

    Returns
    -------
    ConvertedPlots
        NaN in any coordinate makes the plot a missed one. So do impossible values, which are
        marked: a range below 0 or above 1e15, an azimuth outside [-360°, 720°], an elevation
        beyond ±90°.

    Raises
    ------
    ValueError
        If shapes differ, a standard deviation is missing, NaN, negative or too large (above
        1 radian for an angle, 1e15 for the range), or `azimuth_from` has another value.
    """
    plots = {"range": range, "azimuth": azimuth}
    sigmas = {"sigma_range": sigma_range, "sigma_azimuth": sigma_azimuth}
    if elevation is not None:
        plots["elevation"], sigmas["sigma_elevation"] = elevation, sigma_elevation
    elif sigma_elevation is not None:
        raise ValueError("`sigma_elevation`: the plots have no elevation; leave it out")
    columns = _columns(plots)
    impossible = _impossible(**columns)
    missed = impossible | np.any([np.isnan(column) for column in columns.values()], axis=0)
    clean = {name: np.where(missed, np.nan, column) for name, column in columns.items()}
    ahead = _clockwise(clean["azimuth"], azimuth_from)
    distance, height = clean["range"], clean.get("elevation", np.zeros(missed.shape))
    noise = _checked_sigmas(sigmas, missed.shape)
    if noise is None:
        shrink_azimuth = shrink_elevation = np.ones(missed.shape)
        covariance = None
    else:
        noise.setdefault("sigma_elevation", np.zeros(missed.shape))
        shrink_azimuth = np.exp(-(noise["sigma_azimuth"] ** 2) / 2)
        shrink_elevation = np.exp(-(noise["sigma_elevation"] ** 2) / 2)
        covariance = _mean_square(distance, ahead, height, **noise)
    level = distance * np.cos(height) / (shrink_azimuth * shrink_elevation)
    position = np.stack(
        [
            level * np.sin(ahead),
            level * np.cos(ahead),
            distance * np.sin(height) / shrink_elevation,
        ],
        axis=-1,
    )
    n_axes = len(plots)
    if covariance is not None:
        covariance = covariance[:, :n_axes, :n_axes]
    return ConvertedPlots(position[:, :n_axes], covariance, impossible)


def cartesian_to_polar(position: ArrayLike, *, azimuth_from: AzimuthFrom = "north") -> PolarPlots:
    """Range, azimuth and perhaps elevation of positions, seen from the origin.

    Parameters
    ----------
    position : array_like, shape (n, 2) or (n, 3)
        East, north and perhaps up.
    azimuth_from : {"north", "east"}
        Azimuth clockwise from north, or counter-clockwise from east.

    Raises
    ------
    ValueError
        If the shape is another, or `azimuth_from` has another value.
    """
    places = np.asarray(position, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] not in (2, 3):
        raise ValueError(f"`position`: shape {places.shape}; expected (n, 2) or (n, 3)")
    east, north = places[:, 0], places[:, 1]
    level = np.hypot(east, north)
    clockwise = np.where(level == 0, np.nan, np.arctan2(east, north))
    azimuth = wrapped(_clockwise(clockwise, azimuth_from))
    if places.shape[1] == 2:
        return PolarPlots(level, azimuth, None)
    up = places[:, 2]
    distance = np.hypot(level, up)
    elevation = np.where(distance == 0, np.nan, np.arctan2(up, level))
    return PolarPlots(distance, azimuth, elevation)


def _clockwise(azimuth: Array, azimuth_from: AzimuthFrom) -> Array:
    """Azimuths of one kind as those clockwise from north; the same the other way round."""
    if azimuth_from not in ("north", "east"):
        raise ValueError(f"`azimuth_from`: {azimuth_from!r}; expected north or east")
    return azimuth if azimuth_from == "north" else TURN / 4 - azimuth


def _columns(plots: dict[str, ArrayLike]) -> dict[str, Array]:
    """Coordinates as arrays of one value for each plot."""
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in plots.items()}
    shape = columns["range"].shape
    for name, column in columns.items():
        if column.ndim != 1 or column.shape != shape:
            raise ValueError(
                f"`{name}`: shape {column.shape}; expected one value for each plot"
                + ("" if name == "range" else f", {shape}, as `range` has")
            )
    return columns


def _impossible(range: Array, azimuth: Array, elevation: Array | None = None) -> Mask:
    """Plots that no sensor can have measured; what is missing is not impossible."""
    # A hair is allowed for degrees that were turned into radians.
    hair = 1e-9
    wrong = (range < 0) | (range > LARGEST_RANGE)
    wrong |= (azimuth < -TURN - hair) | (azimuth > 2 * TURN + hair)
    if elevation is not None:
        wrong |= np.abs(elevation) > TURN / 4 + hair
    return np.asarray(wrong)


def _checked_sigmas(
    sigmas: dict[str, ArrayLike | None], shape: tuple[int, ...]
) -> dict[str, Array] | None:
    """Standard deviations of each plot; None if none is given."""
    missing = [name for name, values in sigmas.items() if values is None]
    if len(missing) == len(sigmas):
        return None
    if missing:
        given = next(name for name in sigmas if name not in missing)
        raise ValueError(f"`{missing[0]}`: is missing; `{given}` was given, so give it as well")
    checked: dict[str, Array] = {}
    for name, values in sigmas.items():
        sigma = np.asarray(values, dtype=np.float64)
        if sigma.shape not in ((), shape):
            raise ValueError(f"`{name}`: shape {sigma.shape}; expected a number, or {shape}")
        is_angle = name != "sigma_range"
        most = LARGEST_SIGMA if is_angle else LARGEST_RANGE
        bad = ~((sigma >= 0) & (sigma <= most))
        if bad.any():
            value, *limits = (
                f"{number:.6g} rad ({np.degrees(number):.6g}°)" if is_angle else f"{number:.6g}"
                for number in (float(sigma[bad][0]), most)
            )
            where = f" at plot {int(np.flatnonzero(bad)[0])}" if sigma.ndim else ""
            raise ValueError(f"`{name}`: {value}{where}; expected 0 to {limits[0]}")
        checked[name] = np.broadcast_to(sigma, shape)
    return checked


def _mean_square(
    distance: Array,
    ahead: Array,
    height: Array,
    sigma_range: Array,
    sigma_azimuth: Array,
    sigma_elevation: Array,
) -> Array:
    """Mean square of the errors of debiased positions, given what was measured.

    The equations of Mo et al. (1998) for the covariance, along the level direction of the
    target, across it, and up; there only two errors belong together. Written with ``expm1`` of
    the variances, since what remains of the powers of the angles' noise is of first or second
    order in them. Without elevation and its noise these are the equations for the plane.
    """
    a, e = sigma_azimuth**2, sigma_elevation**2
    cos, sin = np.cos(height), np.sin(height)
    near, far = distance**2, sigma_range**2
    # E[cos(2w)] and its complement, for the error w of each angle.
    double_a, double_e = np.exp(-2 * a), np.exp(-2 * e)
    lost_a, lost_e = -np.expm1(-2 * a), -np.expm1(-2 * e)
    level = lost_e + 2 * double_e * cos**2  # twice E[cos²(elevation)], up to 2
    along = near * (
        (1 + double_a) * lost_e / 4
        + cos**2 * (np.expm1(a + e) - lost_a / 2 - lost_e + lost_a * lost_e / 2)
    ) + far * ((1 + double_a) * level / 4)
    across = (near + far) * lost_a * level / 4
    up = near * (lost_e / 2 + sin**2 * (np.expm1(e) - lost_e)) + far * (
        (lost_e + 2 * double_e * sin**2) / 2
    )
    shrink = np.exp(-a / 2)
    along_up = (
        cos * sin * (near * (np.expm1(e) / shrink - shrink * lost_e) + far * shrink * double_e)
    )
    # Without noise, rounding may leave a hair below zero.
    return _turned(np.maximum(along, 0.0), across, np.maximum(up, 0.0), along_up, ahead)


def _turned(along: Array, across: Array, up: Array, along_up: Array, ahead: Array) -> Array:
    """The covariance along, across and up, turned to east, north and up."""
    sin, cos = np.sin(ahead), np.cos(ahead)
    covariance = np.empty((*ahead.shape, 3, 3))
    covariance[:, 0, 0] = along * sin**2 + across * cos**2
    covariance[:, 1, 1] = along * cos**2 + across * sin**2
    covariance[:, 0, 1] = covariance[:, 1, 0] = (along - across) * sin * cos
    covariance[:, 0, 2] = covariance[:, 2, 0] = along_up * sin
    covariance[:, 1, 2] = covariance[:, 2, 1] = along_up * cos
    covariance[:, 2, 2] = up
    return covariance
