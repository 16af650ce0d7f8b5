"""Plots of Stone Soup, its detections, as positions with their covariances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from stonesoup.models.base import LinearModel, ReversibleModel
from stonesoup.types.array import StateVector
from stonesoup.types.state import State

from fuzzytrack.arrays import Array

__all__ = ["position_of"]

# Balances the rounding of a central difference against its truncation.
_STEP = float(np.finfo(float).eps) ** (1 / 3)


def position_of(
    detection: Any, model: Any, position_mapping: Sequence[int], ndim: int | None = None
) -> tuple[Array, Array]:
    """Position of a detection, and its covariance.

    That of a model that is not linear comes from its inverse function and the Jacobian of it. What
    a detection says of velocity is not used.

    Parameters
    ----------
    detection : stonesoup.types.detection.Detection
    model : stonesoup.models.measurement.MeasurementModel or None
        Used if the detection has none.
    position_mapping : sequence of int
        Places of the axes in a state vector.
    ndim : int, optional
        Length of the state vectors of tracks, which must be that of the model.

    Returns
    -------
    position : ndarray, shape (n_axes,)
        In m.
    covariance : ndarray, shape (n_axes, n_axes)
        In m².

    Raises
    ------
    ValueError
        If there is no model, it does not measure the position, or a number is not finite.
    """
    model = detection.measurement_model or model
    if model is None:
        raise ValueError(
            "measurement_model: neither the detection nor the component has one; give it to either"
        )
    places = list(position_mapping)
    if model.ndim_state <= max(places) or ndim not in (None, model.ndim_state):
        wanted = f"more than {max(places)}" if ndim is None else str(ndim)
        raise ValueError(
            f"measurement_model: its states have {model.ndim_state} places, those of the mappings "
            f"{wanted}; give the same ndim_state"
        )
    measured = np.asarray(detection.state_vector, dtype=np.float64).ravel()
    noise = np.asarray(model.covar(), dtype=np.float64)
    if not (np.isfinite(measured).all() and np.isfinite(noise).all()):
        raise ValueError(
            f"detection: {measured.tolist()}, or its noise, is not finite; leave it out"
        )
    if isinstance(model, LinearModel):
        position, inverse = _linear(model, measured, places)
    else:
        position, inverse = _reversed(model, measured, places)
    covariance = inverse @ noise @ inverse.T
    return position, covariance


def _linear(model: Any, measured: Array, places: list[int]) -> tuple[Array, Array]:
    """Position, and the matrix that makes it of a measurement."""
    matrix = np.asarray(model.matrix(), dtype=np.float64)
    # Exact, where a model takes some components as they are.
    picks = np.array_equal(matrix @ matrix.T, np.eye(len(matrix)))
    every: Array = matrix.T if picks else np.asarray(np.linalg.pinv(matrix), np.float64)
    inverse = every[places]
    if not np.allclose(inverse @ matrix, np.eye(model.ndim_state)[places], atol=1e-9):
        raise ValueError(_no_position(model, places))
    return inverse @ measured, inverse


def _reversed(model: Any, measured: Array, places: list[int]) -> tuple[Array, Array]:
    """Position, and the Jacobian of the inverse function."""
    if not isinstance(model, ReversibleModel):
        raise ValueError(_no_position(model, places))

    def position(values: Array) -> Array:
        try:
            found = model.inverse_function(State(StateVector(values)))
        except NotImplementedError:
            raise ValueError(_no_position(model, places)) from None
        return np.asarray(found, dtype=np.float64).ravel()[places]

    columns = []
    for k, value in enumerate(measured):
        step = np.zeros_like(measured)
        step[k] = _STEP * max(1.0, abs(value))
        columns.append((position(measured + step) - position(measured - step)) / (2 * step[k]))
    return position(measured), np.stack(columns, axis=-1)


def _no_position(model: Any, places: list[int]) -> str:
    return (
        f"measurement_model: {type(model).__name__} does not measure the position on every axis of "
        f"position_mapping {tuple(places)}; give one that does, or leave its detections out"
    )
