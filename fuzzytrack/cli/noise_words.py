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
    shown = [_one_noise(*pair) for pair in zip(decoder.noise, errors, strict=True)]
    if len(set(shown)) == 1 and not decoder.noise_is_polar:
        return shown[0]
    names = _noise_names(decoder)
    return ", ".join(f"{name} {each}" for name, each in zip(names, shown, strict=True))


def _noise_names(decoder: PlotDecoder) -> tuple[str, ...]:
    columns = decoder.columns
    return columns.read if decoder.noise_is_polar else columns.axes


def _one_noise(sigma: float | str | None, error: float | None) -> str:
    if isinstance(sigma, str):
        return f"column {sigma}"
    value = math.nan if sigma is None else sigma
    return show(value) if error is None else f"{with_error(value, error)} (estimated)"


def noise_json(decoder: PlotDecoder) -> dict[str, Any]:
    """Standard deviations and their errors by coordinate; null where they are not known."""
    names = _noise_names(decoder)
    sigma = dict(zip(names, decoder.noise, strict=True)) if decoder.noise else None
    errors = decoder.noise_errors
    return {
        "sigma": sigma,
        "sigma_error": dict(zip(names, errors, strict=True)) if errors else None,
    }
