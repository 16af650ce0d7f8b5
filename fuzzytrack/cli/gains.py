"""The commands about gains: what a pair or triple does, how to choose one, how safe a rule base is.

Nothing here computes: it asks `fuzzytrack.gains` and says the answers in words.
"""

from __future__ import annotations

import cmath
import math
from typing import Annotated, Any

import numpy as np
import typer

from fuzzytrack import gains as theory
from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, say, show
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.schedulers.certificate import REACHES
from fuzzytrack.schedulers.certificate import certify as certify_gains

__all__ = ["card", "certify", "design", "gains"]

design = typer.Typer(
    no_args_is_help=True,
    help="Choose gains by a rule of design, and say what they do.",
    rich_markup_mode=None,
)

Dt = Annotated[float, typer.Option("--dt", metavar="T", help="Sampling time, s.")]
MaybeDt = Annotated[float | None, typer.Option("--dt", metavar="T", help="Sampling time, s.")]
Sigma = Annotated[
    float | None,
    typer.Option("--sigma", metavar="S", help="Standard deviation of a measured position, m."),
]
Order = Annotated[
    int, typer.Option("--order", min=2, max=3, help="2: alpha and beta. 3: gamma as well.")
]

# A printed gain has few digits; what is as near to a curve as this was meant to lie on it.
NEAR = 1e-3

OUTPUTS = {
    "predicted": ("predicted position", "m"),
    "filtered": ("filtered position", "m"),
    "interval": ("position, mean over the interval", "m"),
    "velocity": ("velocity", "m/s"),
    "acceleration": ("acceleration", "m/s²"),
}


def gains(
    alpha: Annotated[float, typer.Option(metavar="A", help="Position gain.")],
    beta: Annotated[float, typer.Option(metavar="B", help="Velocity gain.")],
    gamma: Annotated[
        float, typer.Option(metavar="G", help="Acceleration gain, of γ/(2T²); 0 for none.")
    ] = 0.0,
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """Say what fixed gains do: stability, poles, noise and lag."""
    found = card(alpha, beta, gamma, dt, sigma)
    if json:
        print_json(found)
    else:
        _print_card(found)


# ---------------------------------------------------------------- the card


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


def _print_card(found: dict[str, Any]) -> None:
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


# ---------------------------------------------------------------- design


def _print_design(
    name: str,
    parameters: dict[str, Any],
    found: tuple[Any, ...],
    dt: float,
    sigma: float | None,
    json: bool,
) -> None:
    alpha, beta, gamma = (float(gain) for gain in (*found, 0.0)[:3])
    answer = card(alpha, beta, gamma, dt, sigma)
    if json:
        print_json({"design": name, "parameters": parameters, **answer})
        return
    words = (f"{key} = {show(value)}" for key, value in parameters.items())
    say(f"{name}: {', '.join(words)}")
    _print_card(answer)


def _one_of(**given: float | None) -> None:
    """Complain unless exactly one option is given."""
    if sum(value is not None for value in given.values()) != 1:
        names = " or ".join(f"--{name.replace('_', '-')}" for name in given)
        raise ValueError(f"give either {names}")


@design.command()
def kalata(
    index: Annotated[float | None, typer.Option(metavar="L", help="Tracking index λ.")] = None,
    sigma_v: Annotated[
        float | None,
        typer.Option(metavar="SV", help="Standard deviation of the acceleration, m/s²."),
    ] = None,
    sigma_w: Annotated[
        float | None,
        typer.Option(metavar="SW", help="Standard deviation of a measured position, m."),
    ] = None,
    dt: Dt = 1.0,
    order: Order = 2,
    json: options.Json = False,
) -> None:
    """Steady Kalman filter, by the tracking index λ = σ_v T²/σ_w."""
    _one_of(index=index, sigma_v=sigma_v)
    if index is None:
        if sigma_w is None:
            raise ValueError("--sigma-v needs --sigma-w too")
        assert sigma_v is not None
        index = float(theory.tracking_index(sigma_v, sigma_w, dt))
    found = theory.kalata(index, 3) if order == 3 else theory.kalata(index, 2)
    _print_design("kalata", {"index": index, "order": order}, found, dt, sigma_w, json)


@design.command()
def benedict_bordner(
    alpha: Annotated[float, typer.Option(metavar="A", help="Position gain.")],
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """Least transient error for its noise, at constant velocity."""
    found = alpha, theory.benedict_bordner(alpha)
    _print_design("benedict-bordner", {"alpha": alpha}, found, dt, sigma, json)


@design.command()
def critically_damped(
    alpha: Annotated[float | None, typer.Option(metavar="A", help="Position gain.")] = None,
    xi: Annotated[float | None, typer.Option(metavar="X", help="The pole, 0 <= ξ < 1.")] = None,
    order: Order = 2,
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """All poles in one place: a filter of fading memory."""
    _one_of(alpha=alpha, xi=xi)
    if xi is not None:
        found = theory.fading_memory(xi, 3) if order == 3 else theory.fading_memory(xi, 2)
        _print_design("critically-damped", {"xi": xi, "order": order}, found, dt, sigma, json)
        return
    if order == 3:
        raise ValueError("--order 3 needs --xi")
    assert alpha is not None
    pair = alpha, theory.critically_damped(alpha)
    _print_design("critically-damped", {"alpha": alpha}, pair, dt, sigma, json)


@design.command()
def growing_memory(
    n: Annotated[float, typer.Option("--n", metavar="N", help="Number of plots.")],
    order: Order = 2,
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """Least squares over N plots: the gains at the last of them."""
    found = theory.growing_memory(n, 3) if order == 3 else theory.growing_memory(n, 2)
    _print_design("growing-memory", {"n": n, "order": order}, found, dt, sigma, json)


@design.command()
def w(
    omega0: Annotated[
        float, typer.Option(metavar="W", help="Natural frequency; in rad/s with --dt.")
    ],
    zeta: Annotated[float, typer.Option(metavar="Z", help="Damping ratio.")],
    omega3: Annotated[
        float, typer.Option(metavar="W3", help="Third pole, as --omega0; 0 for none.")
    ] = 0.0,
    dt: MaybeDt = None,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """Natural frequency and damping, as in a rule base of stiffness and damping."""
    found = theory.alpha_beta_gamma_from_w(omega0, zeta, omega3, dt)
    parameters = {"omega0": omega0, "zeta": zeta} | ({"omega3": omega3} if omega3 else {})
    _print_design("w", parameters, found, 1.0 if dt is None else dt, sigma, json)


@design.command()
def optimal(
    sigma: Annotated[
        float, typer.Option(metavar="S", help="Standard deviation of a measured position, m.")
    ],
    velocity: Annotated[
        float, typer.Option(metavar="V", help="Velocity that the target starts with, m/s.")
    ] = 0.0,
    acceleration: Annotated[
        float, typer.Option(metavar="A", help="Acceleration that it starts with, m/s².")
    ] = 0.0,
    kappa: Annotated[float, typer.Option(metavar="K", help="Weight of the noise.")] = 1.0,
    steady: Annotated[
        bool, typer.Option("--steady", help="Weigh the steady lag, not the transient error.")
    ] = False,
    order: Order = 2,
    dt: Dt = 1.0,
    json: options.Json = False,
) -> None:
    """Least sum of noise and transient error on a straight line, or of noise and steady lag."""
    if not (velocity or acceleration):
        raise ValueError("give --velocity or --acceleration, other than 0")
    parameters: dict[str, Any] = {"velocity": velocity, "acceleration": acceleration}
    parameters = {key: value for key, value in parameters.items() if value}
    found: tuple[Any, ...]
    if steady:
        if velocity or order == 3:
            raise ValueError("--steady is for --acceleration alone, and --order 2")
        index = theory.steady_index(acceleration, dt, sigma, kappa)
        found = theory.optimal_for_steady_error(index)
    elif order == 3:
        found = theory.optimal_alpha_beta_gamma(
            theory.velocity_index(velocity, dt, sigma, kappa),
            theory.acceleration_index(acceleration, dt, sigma, kappa),
        )
    elif velocity and acceleration:
        raise ValueError("give --velocity or --acceleration, not both; or --order 3 with both")
    elif velocity:
        found = theory.optimal_for_velocity(theory.velocity_index(velocity, dt, sigma, kappa))
    else:
        found = theory.optimal_for_acceleration(
            theory.acceleration_index(acceleration, dt, sigma, kappa)
        )
    parameters |= {"sigma": sigma, "kappa": kappa, "order": order}
    _print_design("optimal", parameters, found, dt, sigma, json)


# ---------------------------------------------------------------- certificate


def certify(
    name: Annotated[str, typer.Argument(metavar="RULEBASE", help="Shipped name, or file.")],
    reach: Annotated[
        str,
        typer.Option(
            metavar="R", help=f"Gains to allow for, {' or '.join(REACHES)}: limits, or rules."
        ),
    ] = "universe",
    json: options.Json = False,
) -> None:
    """Prove that no order of gains makes the error grow, or show one.

    The gains of the rule base may switch from step to step in any way, not only as the rules would
    have it.
    """
    rules = load_rulebase(name)
    found = certify_gains(rules, reach=reach)
    refuted = len(found.sequence) > 0
    sequence = [_step(rules, *map(float, pair)) for pair in found.sequence]
    if json:
        print_json(
            {
                "rulebase": rules.name,
                "reach": reach,
                "verdict": found.verdict,
                "rate": found.rate,
                "lyapunov": found.lyapunov,
                "vertices": found.vertices,
                "sequence": sequence,
                "growth": found.growth if refuted else None,
                "missed_plots_included": False,
            }
        )
        return
    say(f"{rules.name}: {found.verdict}")
    if refuted:
        alone = all(theory.is_stable(step["alpha"], step["beta"]) for step in sequence)
        say(
            f"Among gains {_reached(rules, reach)}\n"
            f"are these. Repeated in this order they make the error grow by a factor of "
            f"{found.growth:.4f} a step,\nthough each by itself is "
            f"{'stable' if alone else 'stable, or on the edge of stability'}:"
        )
        say()
        heads = [key for key in ("stiffness", "damping", "alpha", "beta") if key in sequence[0]]
        rows = [
            [str(number), *(show(step[key]) for key in heads), f"{step['modulus']:.4f}"]
            for number, step in enumerate(sequence, 1)
        ]
        print_table(["step", *heads, "largest pole"], rows)
    elif found.verdict == "certified":
        (_, x), (_, y) = found.lyapunov
        say(
            f"For gains {_reached(rules, reach)},\n"
            f"in any order, the error shrinks at every step to {found.rate:.4f} of what it was, or "
            "less.\nIts measure is √(eᵀPe), where e is the error of position and T times the error "
            "of\nvelocity, and"
        )
        say()
        say(f"  P = [{1:>9.4f} {x:>9.4f} ]")
        say(f"      [{x:>9.4f} {y:>9.4f} ]")
    else:
        say(
            f"For gains {_reached(rules, reach)},\n"
            "in any order, no measure of the error was found that always shrinks (the best one may "
            f"grow\nby a factor of {found.rate:.4f} a step), nor a sequence of gains that makes the"
            " error grow."
        )
    say()
    say("Missed plots, at which nothing is corrected, are not included.")


def _reached(rules: RuleBase, reach: str) -> str:
    if reach == "rules":
        return "between what the single rules conclude"
    limits = (
        f"{output.name} in [{output.universe.low:g}, {output.universe.high:g}]"
        for output in rules.outputs
    )
    return f"within the limits of the outputs, {', '.join(limits)}"


def _step(rules: RuleBase, alpha: float, beta: float) -> dict[str, float]:
    """One of the gains of a sequence, and what it is as stiffness and damping."""
    step = {"alpha": alpha, "beta": beta}
    u = 4 - 2 * alpha - beta
    if "stiffness" in rules.output_names and beta * u > 0:
        step |= {"stiffness": math.sqrt(beta / u), "damping": alpha / math.sqrt(beta * u)}
    return step | {"modulus": float(np.abs(theory.poles(alpha, beta)).max())}
