"""From the columns of a table to plots: times in seconds, positions in one frame, noise."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.table import Cells, Table, Words
from fuzzytrack.io.times import Clock

if TYPE_CHECKING:
    from fuzzytrack.io.geodetic import LocalFrame
    from fuzzytrack.io.polar import ConvertedPlots

__all__ = ["Noise", "PlotDecoder"]

#: Standard deviation of each coordinate that is measured: a number, the column that has it, or
#: None where it is not known.
Noise = tuple[float | str | None, ...]

_LATITUDES = ("lat", "latitude")


@dataclass(frozen=True)
class PlotDecoder:
    """How the rows of a table become plots; the same for all tables of a recording.

    Attributes
    ----------
    columns : Columns
        Which columns are what.
    description : PlotDescription
        What is known of them.
    clock : Clock
        How times are read, and where they begin.
    frame : LocalFrame or None
        East, north and up about a place on earth, where that is known.
    noise : tuple of (float, str or None)
        Standard deviation of each measured coordinate, or the column that has it: of each axis in
        meters, or of range (m), azimuth (deg) and elevation (deg).
    noise_errors : tuple of (float or None)
        Standard error of each number in `noise` that was estimated.
    """

    columns: Columns
    description: PlotDescription
    clock: Clock
    frame: LocalFrame | None = None
    noise: Noise = ()
    noise_errors: tuple[float | None, ...] = ()

    # ---------------------------------------------------------------- what is known

    @property
    def period(self) -> float | None:
        """Full circle in the unit of a bare angle; None for other positions."""
        if self.columns.position != "angle":
            return None
        return 2 * math.pi if self._in_radians(self.columns.axes[0]) else 360.0

    @property
    def noise_is_polar(self) -> bool:
        """Whether the noise is that of range and angles."""
        said = self.description
        return self.columns.position == "polar" and said.sigma in (None, "auto")

    @property
    def sigma(self) -> float | tuple[float, ...] | None:
        """Standard deviation of all plots, one or one for each axis, if it is the same for all."""
        numbers = [value for value in self.noise if isinstance(value, float)]
        if self.noise_is_polar or len(numbers) < len(self.columns.axes):
            return None
        return numbers[0] if len(set(numbers)) == 1 else tuple(numbers)

    @property
    def noise_is_known(self) -> bool:
        """Whether all coordinates have a standard deviation."""
        return bool(self.noise) and None not in self.noise

    def with_estimate(self, sigma: Sequence[float], errors: Sequence[float]) -> PlotDecoder:
        """Decoder that takes estimated noise, with its standard errors, where none is given."""
        given = self.noise or (None,) * len(sigma)
        pairs = list(zip(given, sigma, errors, strict=True))
        return replace(
            self,
            noise=tuple(found if known is None else known for known, found, _ in pairs),
            noise_errors=tuple(error if known is None else None for known, _, error in pairs),
        )

    # ---------------------------------------------------------------- plots

    def decode(self, table: Table, lost: Counter[str]) -> Piece:
        """Make plots of the rows of a table.

        Parameters
        ----------
        table : Table
            The columns `columns.kinds`.
        lost : Counter
            Positions that cannot be are missed plots, and are counted here by the reason.

        Raises
        ------
        DataError
            If a time or a standard deviation is none; names row, column and value.
        """
        measured = self._measured(table, lost)
        return self._piece(table, *self._placed(table, measured, lost))

    def decode_with_covariance(
        self, table: Table, lost: Counter[str]
    ) -> tuple[Piece, Array | None]:
        """Make plots of the rows of a table, with the covariance of the errors of each.

        Parameters
        ----------
        table, lost
            As for `decode`.

        Returns
        -------
        piece : Piece
            Without standard deviations.
        covariance : ndarray, shape (n_rows, n_axes, n_axes), or None
            NaN where the plot is missed; None if the noise is not known.

        Raises
        ------
        DataError
            As `decode`.
        """
        measured = self._measured(table, lost)
        plots = self._converted(table, measured, lost)
        covariance = plots.covariance
        if covariance is None and not self.noise_is_polar:
            sigma = self._noise(table, measured)
            covariance = None if sigma is None else sigma[:, :, None] ** 2 * np.eye(sigma.shape[1])
        return self._piece(table, plots.position, None), covariance

    def measured(self, table: Table) -> Piece:
        """Rows of a table as they are measured: range and angles of polar plots, else positions."""
        if self.columns.position != "polar":
            return self.decode(table, Counter())
        return self._piece(table, self._measured(table, Counter()), None)

    def _piece(self, table: Table, plots: Array, sigma: Array | None) -> Piece:
        columns = self.columns
        cells = joined_cells(table, columns)
        return Piece(
            table.words[columns.id] if columns.id else Words.same("", len(table.rows)),
            self.clock.seconds(cells, table.rows, table.file, columns.time),
            plots,
            table.rows,
            table.file,
            sigma=sigma,
            time_cells=table.cells[columns.time],
        )

    def _measured(self, table: Table, lost: Counter[str]) -> Array:
        """Columns of position, NaN where the value is not allowed."""
        values = self._lengths(table, self.columns.read)
        for name, least, most in self.description.valid:
            if name not in self.columns.read:
                continue
            column = table.numbers[name]  # limits are in the unit of the column
            bad = (column < least) | (column > most)
            if bad.any():
                values[bad] = math.nan
                lost[f"{name} outside of {least:g} to {most:g}"] += int(bad.sum())
        return values

    def _lengths(self, table: Table, names: Sequence[str]) -> Array:
        """Columns of numbers side by side, those of lengths in meters."""
        return np.stack([table.numbers[name] * self.columns.meters(name) for name in names], axis=1)

    def _placed(
        self, table: Table, measured: Array, lost: Counter[str]
    ) -> tuple[Array, Array | None]:
        """Positions in meters (or a bare angle), and standard deviations a plot if they differ."""
        plots = self._converted(table, measured, lost)
        sigma = plots.sigma
        return plots.position, self._sigma(table, measured) if sigma is None else sigma

    def _converted(self, table: Table, measured: Array, lost: Counter[str]) -> ConvertedPlots:
        """Positions in meters (or a bare angle), with the covariance of polar plots."""
        from fuzzytrack.io.polar import ConvertedPlots

        position, sound = self.columns.position, np.zeros(len(measured), dtype=bool)
        if position == "angle":
            turned = measured if self.columns.own_heading == "" else self._turned(table, measured)
            return ConvertedPlots(turned, None, sound)
        if position == "geodetic":
            assert self.frame is not None
            place = self.frame.to_local(*measured.T)
            _count(lost, place.impossible, "an impossible latitude or longitude")
            _count(lost, place.too_far, "a place more than 5000 km away")
            return ConvertedPlots(place.position, None, place.impossible | place.too_far)
        if position == "polar":
            plots = self._polar(table, measured)
            _count(lost, plots.impossible, "an impossible range or angle")
        else:
            plots = ConvertedPlots(measured, None, sound)
        return self._about_origin(table, plots, lost)

    def _polar(self, table: Table, measured: Array) -> ConvertedPlots:
        from fuzzytrack.io.polar import polar_to_cartesian

        distance, azimuth, *elevation = measured.T
        noise = self._noise(table, measured) if self.noise_is_polar else None
        names = ("sigma_range", "sigma_azimuth", "sigma_elevation")
        sigmas = {}
        if noise is not None:
            # Standard deviations of angles are in degrees whatever the angles are in.
            noise[:, 1:] = np.deg2rad(noise[:, 1:])
            sigmas = dict(zip(names, noise.T, strict=False))
        return polar_to_cartesian(
            distance,
            azimuth * self.radians(1),
            elevation[0] * self.radians(2) if elevation else None,
            azimuth_from=self.description.azimuth_from,
            **sigmas,
        )

    def _about_origin(
        self, table: Table, plots: ConvertedPlots, lost: Counter[str]
    ) -> ConvertedPlots:
        """Plots of a moving sensor as plots about a fixed origin."""
        names, heading = self.columns.own_ship, self.columns.own_heading
        if not names and not heading:
            return plots
        from fuzzytrack.io.own_ship import relative_to_own_ship

        own = self._lengths(table, names) if names else None
        moved = relative_to_own_ship(
            plots,
            own,
            np.rad2deg(table.numbers[heading] * self._radians(heading)) if heading else None,
            self.frame if self.own_ship_is_geodetic else None,
        )
        bad: Mask = moved.impossible & ~plots.impossible
        _count(lost, bad, "an impossible position of own ship")
        return moved

    def _turned(self, table: Table, measured: Array) -> Array:
        """Bare angles from the bow as angles from north."""
        own = self.columns.own_heading
        heading = table.numbers[own] * self._radians(own)
        return np.asarray(measured + heading[:, None] / self._radians(self.columns.axes[0]))

    def radians(self, coordinate: int) -> float:
        """Radians of the unit of a measured angle: degrees, unless the file says radians."""
        return self._radians(self.columns.read[coordinate])

    def _radians(self, name: str) -> float:
        return 1.0 if self._in_radians(name) else math.pi / 180

    def _in_radians(self, name: str) -> bool:
        return self.columns.unit(name) == "rad"

    @property
    def own_ship_is_geodetic(self) -> bool:
        """Whether the position of the sensor is given as latitude and longitude."""
        return bool(self.columns.own_ship) and is_latitude(self.columns.own_ship[0])

    # ---------------------------------------------------------------- noise

    def _sigma(self, table: Table, measured: Array) -> Array | None:
        """Standard deviations of each plot, where a column has them."""
        if not any(isinstance(value, str) for value in self.noise):
            return None
        return self._noise(table, measured)

    def _noise(self, table: Table, measured: Array) -> Array | None:
        """Standard deviation of each measured coordinate of each row; None if one is not known."""
        if not self.noise or None in self.noise:
            return None
        missed: Mask = np.logical_not(np.isfinite(measured).all(axis=1))
        found = np.empty(measured.shape)
        for k, value in enumerate(self.noise):
            if isinstance(value, str):
                found[:, k] = _positive(table, value, missed) * self.columns.meters(value)
            else:
                found[:, k] = value
        return found


def joined_cells(table: Table, columns: Columns) -> Cells:
    """Cells of time; date and time of day of one row joined to one text."""
    cells = table.cells[columns.time]
    if not columns.date:
        return cells
    dates = table.cells[columns.date]
    return [f"{str(date)[:10].strip()} {time}" for date, time in zip(dates, cells, strict=True)]


def is_latitude(name: str) -> bool:
    """Whether a column is a latitude by its name."""
    return any(word in plain_name(name)[0].split("_") for word in _LATITUDES)


def _count(lost: Counter[str], bad: Mask, reason: str) -> None:
    if bad.any():
        lost[reason] += int(bad.sum())


def _positive(table: Table, name: str, missed: Mask) -> Array:
    """Standard deviations from a column; 1 where there is no plot to have one."""
    values = np.where(missed, 1.0, table.numbers[name])
    bad = ~(values > 0)
    if bad.any():
        row = int(np.argmax(bad))
        raise DataError(
            f"{table.file}: row {table.rows[row]}, column {name}: {values[row]:g}; expected a "
            "standard deviation > 0 for every plot"
        )
    return values
