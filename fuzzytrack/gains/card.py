"""A card of fixed gains: stability, poles, noise and lag."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np

from fuzzytrack.gains.abc_space import to_abc
from fuzzytrack.gains.design import critically_damped, kalata
from fuzzytrack.gains.performance import covariance, noise_ratio, steady_error
from fuzzytrack.gains.stability import Region, is_stable, poles, region
from fuzzytrack.gains.wdomain import w_from_alpha_beta_gamma

__all__ = ["gain_card", "kalata_gains_at"]

# Printed gains have few digits: gains this close to Kalata's count as Kalata's.
NEAR = 1e-3


def gain_card(
    alpha: float, beta: float, gamma: float = 0.0, dt: float = 1.0, sigma: float | None = None
) -> dict[str, Any]:
    """Stability, poles, noise and lag of fixed gains.

    Parameters
    ----------
    alpha, beta, gamma : float
        Gains, stable or not; the acceleration gain is γ/(2T²).
    dt : float
        Sampling time T, s, > 0.
    sigma : float, optional
        Standard deviation of a measured position, m, > 0.

    Returns
    -------
    dict
        Numbers, words, and lists and mappings of them, by name; what does not exist is None. For
        gains that are not stable, only the gains, ``stable``, ``reason``, ``region`` and ``poles``
        are there. ``deviation`` and ``covariance`` are there if `sigma` is given.

    Raises
    ------
    ValueError
        If a gain is not finite, or `dt` or `sigma` not above 0.

    Examples
    --------
    >>> found = gain_card(0.5, 0.7)
    >>> found["stable"], round(found["noise_ratio"]["filtered"], 4)
    (True, 0.7391)
    """
    _above_zero("dt", dt)
    if sigma is not None:
        _above_zero("sigma", sigma)
    places = [complex(pole) for pole in poles(alpha, beta, gamma)]
    found: dict[str, Any] = {
        "alpha": alpha,
        "beta": beta,
        "gamma": gamma,
        "dt": dt,
        "sigma": sigma,
        "stable": bool(is_stable(alpha, beta, gamma)),
        "reason": _reason(alpha, beta, gamma),
        "region": str(region(*to_abc(alpha, beta, gamma)[:2])),
        "poles": [
            {
                "real": pole.real,
                "imaginary": pole.imag,
                "modulus": abs(pole),
                "angle": math.degrees(cmath.phase(pole)),
            }
            for pole in places
        ],
    }
    if not found["stable"]:
        found["region"] = Region.UNSTABLE.value
        return found
    omega0, zeta, omega3 = w_from_alpha_beta_gamma(alpha, beta, gamma)
    found |= {
        "omega0": float(omega0),
        "zeta": float(zeta),
        "omega3": float(omega3) if gamma else None,
        "tracking_index": _tracking_index(alpha, beta, gamma),
        "noise_ratio": _noise(alpha, beta, gamma, dt),
        "lag_per_acceleration": float(steady_error(alpha, beta, gamma, dt, 1.0)),
        "lag_per_jerk": (float(steady_error(alpha, beta, gamma, dt, jerk=1.0)) if gamma else None),
    }
    if sigma is not None:
        found["deviation"] = {
            name: sigma * math.sqrt(ratio) for name, ratio in found["noise_ratio"].items()
        }
        found["covariance"] = None if gamma else covariance(alpha, beta, sigma, dt)
    return found


def _above_zero(name: str, value: float) -> None:
    if not 0 < value < math.inf:
        raise ValueError(f"{name}: must be > 0, got {value:g}")


def _reason(alpha: float, beta: float, gamma: float) -> str:
    """Why gains are stable, or which condition fails first."""
    if not alpha > 0:
        return "alpha must be above 0"
    if not beta > 0:
        return "beta must be above 0"
    if not 2 * alpha + beta < 4:
        return f"2 alpha + beta must be below 4, and is {2 * alpha + beta:g}"
    if gamma < 0:
        return "gamma must not be negative"
    limit = 4 * alpha * beta / (2 - alpha)
    if not gamma < limit:
        return f"gamma must be below 4 alpha beta / (2 - alpha) = {limit:g}"
    return "all poles lie inside the unit circle"


def _tracking_index(alpha: float, beta: float, gamma: float) -> float | None:
    """Tracking index λ if the gains are Kalata's, else None."""
    if not alpha < 1:
        return None
    root = math.sqrt(1 - alpha)
    index = gamma / (2 * root) if gamma else beta / root
    meant = kalata(index, 3) if gamma else kalata(index, 2)
    return index if np.allclose(meant, (alpha, beta, gamma)[: len(meant)], rtol=NEAR) else None


def _noise(alpha: float, beta: float, gamma: float, dt: float) -> dict[str, float]:
    """Variance of each output per variance of the noise; with units, (m/s)² per m² and so on."""
    powers = {"predicted": 0, "filtered": 0, "interval": 0, "velocity": 2, "acceleration": 4}
    return {
        name: float(noise_ratio(alpha, beta, gamma, of=name)) / dt**power  # type: ignore[arg-type]
        for name, power in powers.items()
        if gamma or name != "acceleration"
    }


def kalata_gains_at(alpha: float) -> tuple[float, float]:
    """β and γ of Kalata's gains with a given α, 0 < α < 1; γ is for a filter with acceleration."""
    beta = 2.0 * float(critically_damped(alpha))
    return beta, beta * beta / alpha
