"""Where a state vector of Stone Soup has positions, velocities and accelerations."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from stonesoup.types.array import StateVector

from fuzzytrack.arrays import Array
from fuzzytrack.gains.singer import fade

__all__ = ["StateLayout"]


@dataclass(frozen=True)
class StateLayout:
    """Places of a state vector, by axes.

    Attributes
    ----------
    position, velocity : tuple of int
        Place of each axis.
    acceleration : tuple of int
        The same; empty for a model without acceleration.

    Raises
    ------
    ValueError
        If there is no axis, their numbers differ, or the places are not 0, 1, 2 … in some order.
    """

    position: tuple[int, ...]
    velocity: tuple[int, ...]
    acceleration: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        n_axes = len(self.position)
        if not n_axes:
            raise ValueError("position_mapping: is empty; give the place of each axis")
        named = {"velocity_mapping": self.velocity}
        if self.acceleration:
            named["acceleration_mapping"] = self.acceleration
        for name, places in named.items():
            if len(places) != n_axes:
                raise ValueError(
                    f"{name}: {places} has {len(places)} places, position_mapping "
                    f"{self.position} has {n_axes}; give one for each axis"
                )
        if sorted(self._places) != list(range(self.ndim)):
            raise ValueError(
                f"{', '.join(['position_mapping', *named])}: {self._places} must be the numbers "
                f"from 0 to {self.ndim - 1}, each once, since the tracker sets the whole state"
            )

    @classmethod
    def of(cls, position: Any, velocity: Any, acceleration: Any = None) -> StateLayout:
        """Layout of what a user gave as mappings."""
        return cls(
            _places("position_mapping", position),
            _places("velocity_mapping", velocity),
            () if acceleration is None else _places("acceleration_mapping", acceleration),
        )

    @property
    def _places(self) -> tuple[int, ...]:
        return (*self.position, *self.velocity, *self.acceleration)

    @property
    def n_axes(self) -> int:
        """Number of axes."""
        return len(self.position)

    @property
    def ndim(self) -> int:
        """Length of a state vector."""
        return len(self._places)

    def vector(self, position: Array, velocity: Array, acceleration: Array) -> Any:
        """State vector of values by axes, each of shape (n_axes,)."""
        values = np.empty((self.ndim, 1))
        values[list(self.position), 0] = position
        values[list(self.velocity), 0] = velocity
        if self.acceleration:
            values[list(self.acceleration), 0] = acceleration
        return StateVector(values)

    def first_covariance(
        self, plot: Array, velocity_deviation: float, acceleration_deviation: float
    ) -> Array:
        """Covariance after one plot of covariance `plot`, shape (n_axes, n_axes)."""
        covar = np.zeros((self.ndim, self.ndim))
        covar[np.ix_(self.position, self.position)] = plot
        covar[self.velocity, self.velocity] = velocity_deviation**2
        if self.acceleration:
            covar[self.acceleration, self.acceleration] = acceleration_deviation**2
        return covar

    def predicted(self, covar: Array, dt: float, noise: float, retention: Array) -> Array:
        """Covariance after a time without a plot.

        Parameters
        ----------
        covar : ndarray, shape (ndim, ndim)
        dt : float
            The time (s).
        noise : float
            Standard deviation of the acceleration, drawn anew for the time (m/s²); of a layout with
            acceleration that of its change.
        retention : ndarray, shape (n_axes,)
            Time for which the acceleration of each axis lasts (s).

        Notes
        -----
        F P Fᵀ + GGᵀσ² with G = (T²/2, T), or (T²/2, T, 1); F as in
        `fuzzytrack.gains.singer.predict_singer`.
        """
        move, push = np.eye(self.ndim), np.zeros((self.ndim, self.n_axes))
        for axis, (x, v) in enumerate(zip(self.position, self.velocity, strict=True)):
            move[x, v] = dt
            push[[x, v], axis] = 0.5 * dt * dt, dt
            if self.acceleration:
                a, phi = self.acceleration[axis], fade(dt / float(retention[axis]))
                move[[x, v, a], a] = 0.5 * dt * dt * phi, dt * phi, phi
                push[a, axis] = 1.0
        found: Array = move @ covar @ move.T + noise**2 * (push @ push.T)
        return found

    def corrected(self, covar: Array, gains: Array, plot: Array) -> Array:
        """Covariance after a plot, in Joseph form.

        Parameters
        ----------
        covar : ndarray, shape (ndim, ndim)
            Predicted.
        gains : ndarray, shape (n_axes, 3)
            What is added to position, velocity and acceleration of each axis, in innovations.
        plot : ndarray, shape (n_axes, n_axes)
            Covariance of the plot (m²).
        """
        gain = np.zeros((self.ndim, self.n_axes))
        axes = np.arange(self.n_axes)
        for places, column in zip(
            (self.position, self.velocity, self.acceleration), gains.T, strict=True
        ):
            if places:
                gain[list(places), axes] = column
        rest = np.eye(self.ndim)
        rest[:, list(self.position)] -= gain
        found: Array = rest @ covar @ rest.T + gain @ plot @ gain.T
        # Rounding leaves it unsymmetric, which the distances of Stone Soup do not need.
        return 0.5 * (found + found.T)


def _places(name: str, given: Any) -> tuple[int, ...]:
    """Places as a tuple of whole numbers."""
    if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str):
        try:
            return tuple(operator.index(place) for place in given)
        except TypeError:
            pass
    raise ValueError(
        f"{name}: must be the places of the axes in the state vector, such as (0, 2), got {given!r}"
    )
