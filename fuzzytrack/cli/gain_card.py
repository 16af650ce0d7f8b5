"""What fixed gains do, on one card."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np

from fuzzytrack import gains as theory
from fuzzytrack.cli.output import print_table, say, show

__all__ = ["card", "print_card"]

# A printed gain has few digits; what is as near to a curve as this was meant to lie on it.
NEAR = 1e-3

OUTPUTS = {
    "predicted": ("predicted position", "m"),
    "filtered": ("filtered position", "m"),
    "interval": ("position, mean over the interval", "m"),
    "velocity": ("velocity", "m/s"),
    "acceleration": ("acceleration", "m/s²"),
}


def card(
    alpha: float, beta: float, gamma: float = 0.0, dt: float = 1.0, sigma: float | None = None
) -> dict[str, Any]:
    """All that is known of fixed gains, as JSON prints it; what does not exist is None."""
    _above_zero("dt", dt)
    if sigma is not None:
        _above_zero("sigma", sigma)
    poles = [complex(pole) for pole in theory.poles(alpha, beta, gamma)]
    found: dict[str, Any] = {
        "alpha": alpha,
        "beta": beta,
        "gamma": gamma,
        "dt": dt,
        "sigma": sigma,
        "stable": bool(theory.is_stable(alpha, beta, gamma)),
        "reason": _reason(alpha, beta, gamma),
        "region": str(theory.region(*theory.to_abc(alpha, beta, gamma)[:2])),
        "poles": [
            {
                "real": pole.real,
                "imaginary": pole.imag,
                "modulus": abs(pole),
                "angle": math.degrees(cmath.phase(pole)),
            }
            for pole in poles
        ],
    }
    if not found["stable"]:
        found["region"] = theory.Region.UNSTABLE.value
        return found
    omega0, zeta, omega3 = theory.w_from_alpha_beta_gamma(alpha, beta, gamma)
    found |= {
        "omega0": float(omega0),
        "zeta": float(zeta),
        "omega3": float(omega3) if gamma else None,
        "tracking_index": _tracking_index(alpha, beta, gamma),
        "noise_ratio": _noise(alpha, beta, gamma, dt),
        "lag_per_acceleration": float(theory.steady_error(alpha, beta, gamma, dt, 1.0)),
        "lag_per_jerk": (
            float(theory.steady_error(alpha, beta, gamma, dt, jerk=1.0)) if gamma else None
        ),
    }
    if sigma is not None:
        found["deviation"] = {
            name: sigma * math.sqrt(ratio) for name, ratio in found["noise_ratio"].items()
        }
        found["covariance"] = None if gamma else theory.covariance(alpha, beta, sigma, dt)
    return found


def _above_zero(name: str, value: float) -> None:
    if not 0 < value < math.inf:
        raise ValueError(f"--{name} must be > 0, got {value:g}")


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
    """λ of Kalata's gains, if these are such."""
    if not alpha < 1:
        return None
    root = math.sqrt(1 - alpha)
    index = gamma / (2 * root) if gamma else beta / root
    meant = theory.kalata(index, 3) if gamma else theory.kalata(index, 2)
    return index if np.allclose(meant, (alpha, beta, gamma)[: len(meant)], rtol=NEAR) else None


def _noise(alpha: float, beta: float, gamma: float, dt: float) -> dict[str, float]:
    """Variance of each output per variance of the noise; with units, (m/s)² per m² and so on."""
    powers = {"predicted": 0, "filtered": 0, "interval": 0, "velocity": 2, "acceleration": 4}
    return {
        name: float(theory.noise_ratio(alpha, beta, gamma, of=name)) / dt**power  # type: ignore[arg-type]
        for name, power in powers.items()
        if gamma or name != "acceleration"
    }


def print_card(found: dict[str, Any]) -> None:
    """Print a card for people."""
    third = f", γ = {show(found['gamma'], 6)}" if found["gamma"] else ""
    say(
        f"α = {show(found['alpha'], 6)}, β = {show(found['beta'], 6)}{third}"
        f"; T = {show(found['dt'])} s"
    )
    say()
    lines = [("stable", f"{'yes' if found['stable'] else 'no'}: {found['reason']}")]
    lines += [
        ("" if number else "poles", _pole(pole)) for number, pole in enumerate(found["poles"])
    ]
    if found["stable"]:
        lines.insert(1, ("region", found["region"]))
        lines += _w_domain(found)
        index = found["tracking_index"]
        lines.append(("tracking index", show(index) if index is not None else _no_index(found)))
        lines += _lags(found)
    width = max(len(key) for key, _ in lines)
    for key, text in lines:
        say(f"{key:<{width}}  {text}")
    if found["stable"]:
        say()
        _print_noise(found)


def _pole(pole: dict[str, float]) -> str:
    place = f"{pole['real']:.4f}"
    if pole["imaginary"]:
        place += f" {'+' if pole['imaginary'] > 0 else '-'} {abs(pole['imaginary']):.4f}j"
    return f"{place:<18}  modulus {pole['modulus']:.4f}, angle {pole['angle']:.2f}°"


def _w_domain(found: dict[str, Any]) -> list[tuple[str, str]]:
    rate = 2 / found["dt"]
    text = f"ω₀ = {show(found['omega0'])} ({show(found['omega0'] * rate)} rad/s)"
    text += f", ζ = {show(found['zeta'])}"
    if found["omega3"] is not None:
        text += f", ω₃ = {show(found['omega3'])} ({show(found['omega3'] * rate)} rad/s)"
    return [("w-domain", text)]


def _no_index(found: dict[str, Any]) -> str:
    alpha = found["alpha"]
    if not alpha < 1:
        return "none: Kalata's gains have α < 1"
    beta = 2 * (1 - math.sqrt(1 - alpha)) ** 2
    text = f"none: for this α Kalata's β is {show(beta)}"
    return text + (f" and γ {show(beta**2 / alpha)}" if found["gamma"] else "")


def _lags(found: dict[str, Any]) -> list[tuple[str, str]]:
    text = f"{show(found['lag_per_acceleration'])} m behind 1 m/s²"
    if found["lag_per_jerk"] is not None:
        text += f", {show(found['lag_per_jerk'])} m behind 1 m/s³"
    return [("steady lag", text)]


def _print_noise(found: dict[str, Any]) -> None:
    deviation = found.get("deviation")
    heads = ["noise passed on", "variance ratio"]
    heads += [f"deviation at {show(found['sigma'])} m"] if deviation else []
    rows = []
    for name, ratio in found["noise_ratio"].items():
        label, unit = OUTPUTS[name]
        per = "" if unit == "m" else f" ({unit})²/m²"
        row = [label, f"{show(ratio)}{per}"]
        rows.append([*row, f"{show(deviation[name])} {unit}"] if deviation else row)
    print_table(heads, rows)
    covariance = found.get("covariance")
    if covariance is not None:
        (position, cross), (_, velocity) = covariance
        say(
            f"covariance of filtered position and velocity: {show(position)} m², "
            f"{show(cross)} m²/s, {show(velocity)} m²/s²"
        )
