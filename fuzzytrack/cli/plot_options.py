"""Options that say how plots are read, shared by the commands that read them."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.option_groups import changed, grouped
from fuzzytrack.io.reading import Reading
from fuzzytrack.numerals import as_number
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.scan_options import OF_TRACKS

__all__ = ["gate_width", "number_or", "plot_reading", "reads_plots", "reads_scans"]

_Text = str | None


# Headings of these options in the help of a command.
_COLUMNS, _NOISE = "Columns of the plots", "Noise of the plots"
_FAULTS, _FORM = "Faults of the plots", "Form of the file"


def _option(heading: str, metavar: str, help: str) -> Any:
    return typer.Option(metavar=metavar, help=help, rich_help_panel=heading)


def plot_reading(
    time: Annotated[
        _Text,
        _option(_COLUMNS, "COL", "Column of time (s, dates), or DATE,TIME. [default: t, time…]"),
    ] = None,
    time_unit: Annotated[
        _Text, _option(_COLUMNS, "s|ms|us|ns", "Unit of numeric times. [default: by name or size]")
    ] = None,
    wrap: Annotated[
        str, _option(_COLUMNS, "S|auto|none", "Period of a clock that starts again, in seconds.")
    ] = "auto",
    id: Annotated[
        _Text, _option(_COLUMNS, "COL", "Column that identifies the track. [default: one track]")
    ] = None,
    axes: Annotated[
        _Text,
        _option(_COLUMNS, "COL,COL", "Columns of position, m. [default: x,y,z or x_m,y_m,z_m]"),
    ] = None,
    polar: Annotated[
        _Text,
        _option(
            _COLUMNS,
            "RANGE,AZIMUTH[,ELEVATION]",
            "Columns of polar plots: m, or as range_km says; degrees.",
        ),
    ] = None,
    azimuth_from: Annotated[
        str,
        _option(
            _COLUMNS, "north|east", "Azimuth clockwise from north, or the other way from east."
        ),
    ] = "north",
    geodetic: Annotated[
        _Text, _option(_COLUMNS, "LAT,LON[,ALT]", "Columns of latitude and longitude, in degrees.")
    ] = None,
    angle: Annotated[_Text, _option(_COLUMNS, "COL", "Column of a bare angle, in degrees.")] = None,
    cartesian: Annotated[
        bool,
        typer.Option(
            "--cartesian",
            rich_help_panel=_COLUMNS,
            help="Take --axes as positions whatever their names.",
        ),
    ] = False,
    site: Annotated[
        _Text, _option(_COLUMNS, "LAT,LON[,ALT]", "Place of the sensor, in degrees and meters.")
    ] = None,
    own_ship: Annotated[
        _Text, _option(_COLUMNS, "COL,COL", "Columns of the position of a moving sensor, m.")
    ] = None,
    own_heading: Annotated[
        _Text, _option(_COLUMNS, "COL", "Column of its heading (degrees), for relative azimuths.")
    ] = None,
    sigma: Annotated[
        _Text,
        _option(
            _NOISE,
            "S|S,S|COL|COL,COL|auto",
            "Standard deviation of the plots, m; or its columns. [default: auto]",
        ),
    ] = None,
    sigma_range: Annotated[_Text, _option(_NOISE, "S|COL", "The same of range, m.")] = None,
    sigma_azimuth: Annotated[
        _Text, _option(_NOISE, "S|COL", "The same of azimuth, degrees.")
    ] = None,
    sigma_elevation: Annotated[
        _Text, _option(_NOISE, "S|COL", "The same of elevation, degrees.")
    ] = None,
    valid: Annotated[
        list[str] | None,
        _option(_FAULTS, "COL=LOW:HIGH", "Values that are positions; others are missed plots."),
    ] = None,
    duplicates: Annotated[
        str, _option(_FAULTS, "error|first|last|mean", "What to do with equal times in a track.")
    ] = "error",
    stale: Annotated[
        bool,
        typer.Option(
            "--stale",
            rich_help_panel=_FAULTS,
            help="Take a position that repeats as a missed plot.",
        ),
    ] = False,
    least_step: Annotated[
        _Text,
        _option(_FAULTS, "S", "Shortest time to start a track with, s. [default: by the plots]"),
    ] = None,
    max_gap: Annotated[
        str,
        _option(_FAULTS, "S|auto|none", "A longer time without a plot ends the track, in seconds."),
    ] = "auto",
    max_coast: Annotated[
        _Text, _option(_FAULTS, "S", "Leave out rows without a plot after this time, in seconds.")
    ] = None,
    delimiter: Annotated[
        _Text, _option(_FORM, "CHAR|tab", "Between cells. [default: recognized]")
    ] = None,
    decimal: Annotated[_Text, _option(_FORM, ".|,", "Decimal mark. [default: recognized]")] = None,
    na: Annotated[
        _Text, _option(_FORM, "A,B", "More words for a missing number: NULL,-999.")
    ] = None,
    comment: Annotated[str, _option(_FORM, "CHAR", "Lines that begin with it are left out.")] = "#",
    columns: Annotated[
        _Text, _option(_FORM, "A,B,C", "Names of the columns, for a file that has none.")
    ] = None,
    format: Annotated[
        _Text, _option(_FORM, "NAME", "Format of the file. [default: by its name]")
    ] = None,
    sort: Annotated[
        bool,
        typer.Option("--sort", rich_help_panel=_FAULTS, help="Put the plots in order of time."),
    ] = False,
) -> Reading:
    """How plots are read, from what the options say."""
    times = None if time is None else options.names(time, "--time")
    if times is not None and len(times) > 2:
        raise ValueError(f"--time: expected COL, or DATE,TIME, got {time!r}")
    return Reading.of(
        time=None if times is None else times[0] if len(times) == 1 else tuple(times),
        time_unit=time_unit,
        wrap=number_or(wrap, "--wrap", {"auto": "auto", "none": None}),
        id=id,
        axes=_names(axes, "--axes"),
        polar=_names(polar, "--polar"),
        azimuth_from=azimuth_from,
        geodetic=_names(geodetic, "--geodetic"),
        angle=angle,
        cartesian=cartesian,
        site=_numbers(site, "--site"),
        own_ship=_names(own_ship, "--own-ship"),
        own_heading=own_heading,
        sigma=_sigma(sigma, "--sigma"),
        sigma_range=_sigma(sigma_range, "--sigma-range"),
        sigma_azimuth=_sigma(sigma_azimuth, "--sigma-azimuth"),
        sigma_elevation=_sigma(sigma_elevation, "--sigma-elevation"),
        valid=tuple(each for text in valid or () for each in _ranges(text)),
        duplicates=duplicates,
        stale=math.inf if stale else None,
        least_step=None if least_step is None else number_or(least_step, "--least-step", {}),
        max_gap=number_or(max_gap, "--max-gap", {"auto": "auto", "none": None}),
        max_coast=None if max_coast is None else number_or(max_coast, "--max-coast", {}),
        delimiter={"tab": "\t", "\\t": "\t"}.get(delimiter or "", delimiter),
        decimal=decimal,
        na=() if na is None else tuple(word.strip() for word in na.split(",")),
        comment=comment,
        columns=_names(columns, "--columns"),
        format=format,
        sort=sort,
    )


#: Gives a command these options, in place of its argument ``reading``.
reads_plots = grouped(reading=plot_reading)

# Still known: an identity is not used, and a rule about one track is refused by its name.
_HIDDEN: dict[str, dict[str, Any]] = {name: {"hidden": True} for name in ("id", *OF_TRACKS)}
_SCAN_SIGMA = {
    "metavar": "S|S,S|COL|COL,COL",
    "help": "Standard deviation of the plots, m; or its columns. [default: the configuration's]",
}
#: The same for plots without identities: options about tracks are not in the help.
reads_scans = grouped(reading=changed(plot_reading, {**_HIDDEN, "sigma": _SCAN_SIGMA}))


# -------------------------------------------------------------------- texts


def _names(text: str | None, option: str) -> tuple[str, ...] | None:
    return None if text is None else tuple(options.names(text, option))


def number_or(text: str, option: str, words: dict[str, Any]) -> Any:
    """A number > 0, or one of some words."""
    if text in words:
        return words[text]
    value = as_number(text)
    if value is None or not value > 0:
        more = "".join(f", or {word}" for word in words)
        raise ValueError(f"{option}: expected a number > 0{more}, got {text!r}")
    return value


def gate_width(text: str) -> GateWidth:
    """What is written after ``--gate``."""
    width: GateWidth = number_or(text, "--gate", {"auto": "auto", "none": None})
    return width


def _numbers(text: str | None, option: str) -> tuple[float, ...] | None:
    if text is None:
        return None
    found = [as_number(part) for part in text.split(",")]
    if None in found:
        raise ValueError(f"{option}: expected numbers with commas between them, got {text!r}")
    return tuple(value for value in found if value is not None)


def _sigma(text: str | None, option: str) -> float | str | tuple[float | str, ...] | None:
    """Numbers, names of columns, or "auto"."""
    if text is None:
        return None
    found: list[float | str] = []
    for name in options.names(text, option):
        value = as_number(name)
        if value is not None and not value > 0:
            raise ValueError(f"{option} must be > 0, got {value:g}")
        found.append(name if value is None else value)
    return found[0] if len(found) == 1 else tuple(found)


def _ranges(text: str) -> list[tuple[str, float, float]]:
    """Columns with their limits, written COL=LOW:HIGH."""
    found = []
    for name, limits in options.pairs(text, "--valid").items():
        low, colon, high = limits.partition(":")
        least = as_number(low) if low else -math.inf
        most = as_number(high) if high else math.inf
        if not colon or least is None or most is None or not least <= most:
            raise ValueError(
                f"--valid: expected COL=LOW:HIGH, got {text!r}; an end that is left out is no limit"
            )
        found.append((name, least, most))
    return found
