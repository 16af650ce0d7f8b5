"""A card of fixed gains, printed for people."""

from __future__ import annotations

from typing import Any

from fuzzytrack.cli.output import print_table, say, show
from fuzzytrack.gains.card import kalata_gains_at

__all__ = ["print_card"]

OUTPUTS = {
    "predicted": ("predicted position", "m"),
    "filtered": ("filtered position", "m"),
    "interval": ("position, mean over the interval", "m"),
    "velocity": ("velocity", "m/s"),
    "acceleration": ("acceleration", "m/s²"),
}


def print_card(found: dict[str, Any]) -> None:
    """Print what `fuzzytrack.gains.gain_card` found."""
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
    beta, gamma = kalata_gains_at(alpha)
    text = f"none: for this α Kalata's β is {show(beta)}"
    return text + (f" and γ {show(gamma)}" if found["gamma"] else "")


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
