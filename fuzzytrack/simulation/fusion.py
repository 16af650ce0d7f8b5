"""Measurement fusion: the plots of several sensors combined into one, axis by axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array

__all__ = ["fuse", "fuse_pair"]


def fuse_pair(
    z1: ArrayLike, variance1: ArrayLike, z2: ArrayLike, variance2: ArrayLike
) -> tuple[Array, Array]:
    """Fuse the measurements of two sensors, weighted by their variances.

    Parameters
    ----------
    z1, z2 : array_like
        Measurements (m), broadcast against each other; NaN where a sensor has none.
    variance1, variance2 : array_like
        Their variances (m²).

    Returns
    -------
    z : ndarray
        Fused measurement (m): of one sensor where the other has none, NaN where neither has one.
    variance : ndarray
        Its variance (m²); NaN where `z` is.

    Raises
    ------
    ValueError
        If a variance is not positive and finite where there is a measurement.

    Notes
    -----
    Llinas et al. (1998), Eqs. 4.3 and 4.4.

    Examples
    --------
    >>> from fuzzytrack.simulation.fusion import fuse_pair
    >>> z, variance = fuse_pair(0.0, 1.0, 10.0, 4.0)
    >>> float(z), float(variance)
    (2.0, 0.8)
    """
    one, of_one = _checked("variance1", z1, variance1)
    two, of_two = _checked("variance2", z2, variance2)
    return _pair(one, of_one, two, of_two)


def fuse(z: ArrayLike, variance: ArrayLike) -> tuple[Array, Array]:
    """Fuse the measurements of any number of sensors, pair by pair.

    Parameters
    ----------
    z : array_like, shape (..., n_sensors, n_axes)
        Measurements (m); NaN where a sensor has none.
    variance : array_like
        Their variances (m²), broadcast against `z`.

    Returns
    -------
    z : ndarray, shape (..., n_axes)
        Fused measurement (m); NaN where no sensor has one.
    variance : ndarray, shape (..., n_axes)
        Its variance (m²); NaN where `z` is.

    Raises
    ------
    ValueError
        If `z` has no axis for sensors, shapes do not fit, or a variance is not positive and finite
        where there is a measurement.

    Notes
    -----
    Llinas et al. (1998), section 4.1.3. Fusing pair by pair is the mean weighted by 1/variance, so
    the order of the sensors does not matter (but for rounding).
    """
    plots, variances = _checked("variance", z, variance)
    if plots.ndim < 2:
        raise ValueError(f"z: needs shape (..., n_sensors, n_axes); got shape {plots.shape}")
    fused = np.full(plots.shape[:-2] + plots.shape[-1:], np.nan)
    of_fused = fused
    # In order from the first, so that a sensor without a measurement leaves the result as it is.
    for k in range(plots.shape[-2]):
        fused, of_fused = _pair(fused, of_fused, plots[..., k, :], variances[..., k, :])
    return fused, of_fused


def _pair(z1: Array, variance1: Array, z2: Array, variance2: Array) -> tuple[Array, Array]:
    # Halves and a quotient first, so that neither a sum nor a product of variances overflows.
    half = variance1 / 2 + variance2 / 2
    weight = variance1 / half / 2
    no_one, no_two = np.isnan(z1), np.isnan(z2)
    z = np.where(no_one, z2, np.where(no_two, z1, z1 + weight * (z2 - z1)))
    variance = np.where(no_one, variance2, np.where(no_two, variance1, weight * variance2))
    return z, variance


def _checked(name: str, z: ArrayLike, variance: ArrayLike) -> tuple[Array, Array]:
    """Measurements and variances broadcast to one shape, variances NaN where measurements are."""
    plots = np.asarray(z, dtype=np.float64)
    given = np.asarray(variance, dtype=np.float64)
    try:
        plots, given = np.broadcast_arrays(plots, given)
    except ValueError:
        raise ValueError(
            f"{name}: shape {given.shape} does not broadcast with the measurements' {plots.shape}"
        ) from None
    seen = ~np.isnan(plots)
    bad = seen & ~(np.isfinite(given) & (given > 0))
    if bad.any():
        at = tuple(int(k) for k in np.argwhere(bad)[0])
        raise ValueError(
            f"{name} must be positive and finite where there is a measurement; got {given[at]:g} "
            f"at index {at}"
        )
    return plots, np.where(seen, given, np.nan)
