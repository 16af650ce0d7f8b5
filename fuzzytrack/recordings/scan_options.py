"""What a user says of plots without identities, checked: options of a reading and of scans."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning_rules import Cleaning
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.readers import reader_of
from fuzzytrack.io.reading import Reading

__all__ = ["OF_TRACKS", "check_plots", "check_sectors", "checked", "without_identities"]

#: Options about plots of one track.
OF_TRACKS = ("duplicates", "stale", "least_step", "max_gap", "max_coast")

# Turns of an antenna (s), and times from scan to scan.
_LEAST_PERIOD, _MOST_PERIOD = 0.001, 86_400
# Sectors of a turn: the tracks in one need the plots of its neighbors on both sides.
_LEAST_SECTORS, _MOST_SECTORS = 4, 1024


def checked(
    reading: Reading, period: float | None, lateness: float | None, scan: str | None
) -> Reading:
    """Reading without options that plots without identities cannot have."""
    if period is not None and not _LEAST_PERIOD <= period <= _MOST_PERIOD:
        raise ValueError(
            f"period: must be from {_LEAST_PERIOD} to {_MOST_PERIOD} s, got {period!r}; it is the "
            "time of a turn of the antenna"
        )
    if lateness is not None and not 0 <= lateness < math.inf:
        raise ValueError(f"lateness: must be a number of seconds >= 0, got {lateness!r}")
    if period is not None and scan is not None:
        raise ValueError("scan and period: both say what a scan is; give one of them")
    usual = Cleaning()
    for name in OF_TRACKS:
        if getattr(reading.cleaning, name) != getattr(usual, name):
            raise ValueError(
                f"{name}: is about plots of one track; plots of a scan have none yet; leave it out"
            )
    if reading.description.sigma == "auto":
        raise ValueError(
            "sigma: cannot be estimated from plots without identities; give numbers or columns, or "
            "leave it out: the configuration has the noise of its radar"
        )
    return reading


def check_sectors(sectors: int | None, scan: str | None, scans: PathLike | None) -> None:
    """Raise ValueError if there are too few or too many, or something else says what a scan is."""
    if sectors is None:
        return
    if not _LEAST_SECTORS <= sectors <= _MOST_SECTORS:
        raise ValueError(
            f"sectors: must be from {_LEAST_SECTORS} to {_MOST_SECTORS}, got {sectors}"
        )
    for name, value in (("scan", scan), ("scans", scans)):
        if value is not None:
            raise ValueError(f"{name} and sectors: sectors follow the antenna; give one of them")


def without_identities(first: Any, reading: Reading) -> Reading:
    """Reading in which records of ASTERIX need no identity."""
    from fuzzytrack.io.asterix import Asterix

    said = reading.format
    if said is None and isinstance(first, str) and first != "-":
        said = "asterix" if isinstance(reader_of(first), Asterix) else None
    if said is not None and said.split(":")[0] == "asterix" and "identity=" not in said:
        mark = "," if ":" in said else ":"
        return replace(reading, format=f"{said}{mark}identity=none")
    return reading


def check_plots(decoder: PlotDecoder, file: str) -> None:
    """Check that plots have two coordinates, and all deviations of polar ones or none."""
    columns = decoder.columns
    if len(columns.axes) < 2:
        raise DataError(
            f"{file}: column {', '.join(columns.read)}: plots of a scan have two coordinates; name "
            "both with `axes`, `polar` or `geodetic`"
        )
    if decoder.noise_is_polar and any(decoder.noise[:2]) and None in decoder.noise:
        raise ValueError(
            "sigma_range and sigma_azimuth: give both (and that of elevation), or none"
        )
