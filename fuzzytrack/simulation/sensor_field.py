"""A field of sensors that measure range and bearing of targets near them."""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, positive
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.fusion import fuse
from fuzzytrack.simulation.noise import WHITE, Noise, Plots, truth_of_runs

__all__ = ["SPACINGS", "SensorField", "canonical_field", "sensor_grid"]


#: Distances between sensors in Llinas et al. (1998), section 4.1 (m).
SPACINGS = {"dense": 2000.0, "medium": 5000.0, "sparse": 10000.0}


@dataclass(frozen=True, eq=False)
class SensorField:
    """Sensors that measure range and bearing of a target within their reach.

    Parameters
    ----------
    position : array_like, shape (n_sensors, 2)
        Positions of the sensors (m); at least one.
    reach : array_like
        Largest range at which each sees a target (m); a number, or one for each sensor.
    range_sigma : array_like
        Standard deviation of a measured range (m); a number, or one for each sensor.
    bearing_sigma : array_like
        Standard deviation of a measured bearing (rad); a number, or one for each sensor.
    detection : float
        Probability that a sensor detects a target within its reach in a scan, 0 < detection <= 1.

    Raises
    ------
    ValueError
        If there is no sensor, shapes do not fit, or a number is out of range.

    Notes
    -----
    Llinas et al. (1998), sections 4.1 and 4.1.2.
    """

    position: Array
    reach: Array
    range_sigma: Array
    bearing_sigma: Array
    detection: float = 1.0

    def __repr__(self) -> str:
        return summary(self, "position", "detection")

    def __init__(
        self,
        position: ArrayLike,
        reach: ArrayLike,
        range_sigma: ArrayLike,
        bearing_sigma: ArrayLike,
        detection: float = 1.0,
    ) -> None:
        places = finite("position", position)
        if places.ndim != 2 or places.shape[1] != 2 or not len(places):
            raise ValueError(
                "position must have shape (n_sensors, 2), one sensor at least; "
                f"got shape {places.shape}"
            )
        if not 0 < detection <= 1:
            raise ValueError(f"detection must be > 0 and <= 1, got {detection}")
        object.__setattr__(self, "position", _frozen(places))
        for name, value in (
            ("reach", reach),
            ("range_sigma", range_sigma),
            ("bearing_sigma", bearing_sigma),
        ):
            each = positive(name, value)
            if each.shape not in ((), (len(places),)):
                raise ValueError(
                    f"{name} must be a number or {len(places)}, one for each sensor; "
                    f"got shape {each.shape}"
                )
            object.__setattr__(self, name, _frozen(np.broadcast_to(each, (len(places),))))
        object.__setattr__(self, "detection", float(detection))

    def sees(self, position: ArrayLike) -> NDArray[np.bool_]:
        """Which sensors have a target within their reach.

        Parameters
        ----------
        position : array_like, shape (..., 2)
            Positions of the target (m); no sensor sees NaN.

        Returns
        -------
        ndarray of bool, shape (..., n_sensors)
        """
        distance, _ = self._polar(position, np.arange(len(self.position)))
        return np.asarray(distance <= self.reach)

    def covariance(self, position: ArrayLike) -> Array:
        """Covariance of the plots of each sensor, to first order.

        Parameters
        ----------
        position : array_like, shape (..., 2)
            Positions of the target, or of its plot (m).

        Returns
        -------
        ndarray, shape (..., n_sensors, 2, 2)
            Covariance in x and y (m²), whether the sensor sees the target or not.

        Notes
        -----
        Llinas et al. (1998), Eq. 4.2.
        """
        everyone = np.arange(len(self.position))
        distance, bearing = self._polar(position, everyone)
        x, y = self._variances(distance, bearing, everyone)
        both = (
            np.sin(2 * bearing) / 2 * (self.range_sigma**2 - (distance * self.bearing_sigma) ** 2)
        )
        return np.stack([np.stack([x, both], axis=-1), np.stack([both, y], axis=-1)], axis=-2)

    def measure(
        self,
        truth: ArrayLike,
        runs: Sequence[np.random.SeedSequence],
        *,
        noise: Noise = WHITE,
        linear: bool = False,
        sigma_from: str = "truth",
    ) -> Plots:
        """Plots of one target by the field, with those of several sensors fused.

        Parameters
        ----------
        truth : array_like, shape (n_steps, 2) or (n_steps, n_runs, 2)
            True positions (m), the same in all runs or each run's own.
        runs : sequence of SeedSequence
            Random stream of each run; see `fuzzytrack.simulation.noise.streams`.
        noise : Noise
            Kind of noise of range and of bearing.
        linear : bool
            Whether the noise is drawn with the first-order covariance of Eq. 4.2; else it is drawn
            in range and bearing.
        sigma_from : {"truth", "plot"}
            Where the first-order covariance is taken that weighs the sensors, and that a tracker is
            told: at the true position, or at what was measured, as in operation.

        Returns
        -------
        Plots
            NaN where no sensor detects the target.

        Raises
        ------
        ValueError
            If shapes do not fit, there is no run, `sigma_from` is unknown, or a sensor detects the
            target exactly where it is itself.

        Notes
        -----
        Llinas et al. (1998), Eqs. 4.1 to 4.4. In the canonical field the two draws give mean
        prediction errors within 1.5 % of each other. Noise of different sensors is independent; a
        sensor draws some in every scan if its run ever comes into its reach, detected or not.
        """
        if sigma_from not in ("truth", "plot"):
            raise ValueError(f"sigma_from: unknown {sigma_from!r}; one of truth, plot")
        positions = truth_of_runs(truth, len(runs))
        seen = np.broadcast_to(
            self.sees(positions), (len(positions), len(runs), len(self.position))
        )
        # Only sensors that have the target within reach in some scan.
        ever = np.flatnonzero(seen.any(axis=(0, 1)))
        error, detected = self._draw(seen[:, :, ever], runs, noise)
        distance, bearing = self._polar(positions, ever)
        if sigma_from == "truth" and np.any(detected & (distance == 0)):
            raise ValueError(
                "truth: the target is exactly at a sensor, where its plot has no variance across "
                "the line of sight (Eq. 4.2); move its start, a way-point or the field"
            )
        away = self.range_sigma[ever] * error[..., 0]
        aside = self.bearing_sigma[ever] * error[..., 1]
        cos, sin = np.cos(bearing), np.sin(bearing)
        if linear:
            far, turned = distance + away, distance * aside
            x, y = far * cos - turned * sin, far * sin + turned * cos
        else:
            far = distance + away
            x, y = far * np.cos(bearing + aside), far * np.sin(bearing + aside)
        plots = self.position[ever] + np.stack([x, y], axis=-1)
        if sigma_from == "plot":
            distance, bearing = np.hypot(x, y), np.arctan2(y, x)
        variance = np.stack(self._variances(distance, bearing, ever), axis=-1)
        fused, of_fused = fuse(
            np.where(detected[..., None], plots, np.nan), np.broadcast_to(variance, plots.shape)
        )
        return Plots(fused, np.sqrt(of_fused))

    def _draw(
        self, seen: NDArray[np.bool_], runs: Sequence[np.random.SeedSequence], noise: Noise
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Noise of range and bearing in standard deviations, and what is detected.

        A run draws for the sensors that see its own target only, whatever other runs there are.
        """
        error = np.zeros((*seen.shape, 2))
        detected = seen.copy()
        for k, stream in enumerate(runs):
            rng = np.random.default_rng(stream)
            own = np.flatnonzero(seen[:, k].any(axis=0))
            error[:, k, own] = noise.draw(rng, (len(seen), len(own), 2))
            if self.detection < 1:
                detected[:, k, own] &= rng.random((len(seen), len(own))) < self.detection
        return error, detected

    def _polar(self, position: ArrayLike, sensors: NDArray[np.intp]) -> tuple[Array, Array]:
        """Range and bearing from some of the sensors, each of shape (..., n_sensors)."""
        places = np.asarray(position, dtype=np.float64)
        if places.ndim == 0 or places.shape[-1] != 2:
            raise ValueError(f"position: needs shape (..., 2), got shape {places.shape}")
        off = places[..., None, :] - self.position[sensors]
        return np.hypot(off[..., 0], off[..., 1]), np.arctan2(off[..., 1], off[..., 0])

    def _variances(
        self, distance: Array, bearing: Array, sensors: NDArray[np.intp]
    ) -> tuple[Array, Array]:
        """Of x and of y, by Eq. 4.2."""
        along = self.range_sigma[sensors] ** 2
        across = (distance * self.bearing_sigma[sensors]) ** 2
        cos2, sin2 = np.cos(bearing) ** 2, np.sin(bearing) ** 2
        return along * cos2 + across * sin2, along * sin2 + across * cos2


def _frozen(values: Array) -> Array:
    own = np.array(values)
    own.flags.writeable = False
    return own


def sensor_grid(
    n: int,
    spacing: float,
    reach: float,
    range_sigma: ArrayLike,
    bearing_sigma: ArrayLike,
    *,
    centre: Sequence[float] = (0.0, 0.0),
    detection: float = 1.0,
) -> SensorField:
    """Square field of n × n sensors.

    Parameters
    ----------
    n : int
        Number of sensors in a row, at least 1.
    spacing : float
        Distance from one to the next, in x and in y (m).
    reach, range_sigma, bearing_sigma, detection
        As for `SensorField`; of several, row after row from the smallest y, each row from the
        smallest x.
    centre : (float, float)
        Center of the field (m).

    Returns
    -------
    SensorField

    Raises
    ------
    ValueError
        If a number is out of range.
    """
    number = operator.index(n)
    if number < 1:
        raise ValueError(f"n must be at least 1, got {number}")
    middle = finite("centre", centre)
    if middle.shape != (2,):
        raise ValueError(f"centre must be two coordinates (m), got shape {middle.shape}")
    line = float(positive("spacing", spacing)) * (np.arange(number) - (number - 1) / 2)
    y, x = np.meshgrid(line, line, indexing="ij")
    position = middle + np.stack([x.ravel(), y.ravel()], axis=1)
    return SensorField(position, reach, range_sigma, bearing_sigma, detection)


def canonical_field(spacing: float = SPACINGS["dense"]) -> SensorField:
    """Sensor field of Llinas et al. (1998), chapter 5: 7 × 7 sensors that reach 1 km.

    Parameters
    ----------
    spacing : float
        Distance from one to the next (m); that of the dense field unless given.

    Notes
    -----
    The report gives "200 [m] position and 3 [deg] of direction variance". Only one reading gives
    the errors of its Table 5.3: a range variance of 200 m², and a bearing variance of 3π/180 rad²,
    as if its number had been turned from degrees into radians.

    Examples
    --------
    >>> from fuzzytrack.simulation.sensor_field import canonical_field
    >>> field = canonical_field()
    >>> len(field.position), field.sees([100.0, 0.0]).sum()
    (49, np.int64(1))
    """
    return sensor_grid(7, spacing, 1000.0, math.sqrt(200.0), math.sqrt(math.radians(3.0)))
