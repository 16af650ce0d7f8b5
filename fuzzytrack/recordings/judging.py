"""Which judge the plots of a recording get: a gate by their noise, and a circle for angles."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.noise_estimate import NoiseEstimate
from fuzzytrack.recordings.judge import Circle, Gate, Judge

__all__ = ["GateWidth", "judge_of"]

#: Width of a gate in standard deviations of a plot; "auto" is that of `Gate`, None is no gate.
GateWidth = float | Literal["auto"] | None


def judge_of(
    decoder: PlotDecoder, gate: GateWidth = "auto", estimate: NoiseEstimate | None = None
) -> Judge | None:
    """Judge for the plots of a recording.

    Parameters
    ----------
    decoder : PlotDecoder
        How the recording is read.
    gate : float, "auto" or None
        Width of the gate.
    estimate : NoiseEstimate, optional
        Where the noise was estimated: with "auto" the gate is as much wider as targets move more
        than the noise from plot to plot.

    Returns
    -------
    Judge or None
        None if plots need none.

    Raises
    ------
    ValueError
        If a width is none, or one is given and the noise of the plots is not known.
    """
    if isinstance(gate, bool) or not isinstance(gate, float | int | np.number | None):
        if gate != "auto":
            raise ValueError(f"gate: must be a number > 0, 'auto' or None, got {gate!r}")
    elif gate is not None and not 0 < gate < math.inf:
        raise ValueError(f"gate: must be a finite number > 0, got {gate:g}")
    circle = None if decoder.period is None else Circle(decoder.period)
    made = None
    if gate is not None and decoder.noise_is_known:
        made = Gate(Gate().width * _motion(estimate)) if gate == "auto" else Gate(float(gate))
    elif gate not in (None, "auto"):
        raise ValueError("gate: needs the noise of the plots; `sigma` gives it")
    return None if circle is None and made is None else Judge(made, circle)


def _motion(estimate: NoiseEstimate | None) -> float:
    """How much more than noise plots differ from straight lines, on any axis; 1 at least."""
    if estimate is None:
        return 1.0
    return max(1.0, float(np.max(estimate.motion / estimate.sigma)))
