"""Standard deviations of plots in words and as JSON, as `track` prints them."""

from __future__ import annotations

import math
from typing import Any

from fuzzytrack.cli.output import show, with_error
from fuzzytrack.io.decoder import PlotDecoder

__all__ = ["noise_json", "noise_sentence"]


def noise_sentence(decoder: PlotDecoder) -> str:
    """Standard deviations of the plots in words; empty if they are not known."""
    if set(decoder.noise) <= {None}:
        return ""
    errors = decoder.noise_errors or (None,) * len(decoder.noise)
    shown = [_one_noise(*each) for each in zip(decoder.noise, errors, _units(decoder), strict=True)]
    if len(set(shown)) == 1 and not decoder.noise_is_polar:
        return shown[0]
    names = _noise_names(decoder)
    return ", ".join(f"{name} {each}" for name, each in zip(names, shown, strict=True))


def _noise_names(decoder: PlotDecoder) -> tuple[str, ...]:
    columns = decoder.columns
    return columns.read if decoder.noise_is_polar else columns.axes


def _units(decoder: PlotDecoder) -> list[str]:
    """Unit of each standard deviation; empty for Cartesian positions, in the unit of their file."""
    count = len(decoder.noise)
    if decoder.noise_is_polar:
        return ["m", *["deg"] * (count - 1)]
    if decoder.columns.position == "cartesian":
        return [""] * count
    # A bare angle has a period; places on the earth are tracked in meters.
    return [{None: "m", 360.0: "deg"}.get(decoder.period, "rad")] * count


def _one_noise(sigma: float | str | None, error: float | None, unit: str) -> str:
    if isinstance(sigma, str):
        return f"column {sigma}"
    value = math.nan if sigma is None else sigma
    number = show(value) if error is None else with_error(value, error)
    unit = f" {unit}" if unit else ""
    return f"{number}{unit}" if error is None else f"{number}{unit} (estimated)"


def noise_json(decoder: PlotDecoder) -> dict[str, Any]:
    """Standard deviations and their errors by coordinate; null where they are not known."""
    names = _noise_names(decoder)
    sigma = dict(zip(names, decoder.noise, strict=True)) if decoder.noise else None
    errors = decoder.noise_errors
    return {
        "sigma": sigma,
        "sigma_error": dict(zip(names, errors, strict=True)) if errors else None,
    }
