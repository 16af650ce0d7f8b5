"""The commands that compute gains by a design rule."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from fuzzytrack import gains as theory
from fuzzytrack.cli import options
from fuzzytrack.cli.complaints import Command
from fuzzytrack.cli.gain_card import print_card
from fuzzytrack.cli.options import Dt, Sigma
from fuzzytrack.cli.output import print_json, say, show

__all__ = ["design"]

design = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Compute gains by a design rule, and show their properties.",
    rich_markup_mode=None,
)

MaybeDt = Annotated[float | None, typer.Option("--dt", metavar="T", help="Sampling time, s.")]
Order = Annotated[
    int, typer.Option("--order", min=2, max=3, help="2: alpha and beta. 3: gamma as well.")
]


def _print_design(
    name: str,
    parameters: dict[str, Any],
    found: tuple[Any, ...],
    dt: float,
    sigma: float | None,
    json: bool,
) -> None:
    alpha, beta, gamma = (float(gain) for gain in (*found, 0.0)[:3])
    answer = theory.gain_card(alpha, beta, gamma, dt, sigma)
    if json:
        print_json({"design": name, "parameters": parameters, **answer})
        return
    words = (f"{key} = {show(value)}" for key, value in parameters.items())
    say(f"{name}: {', '.join(words)}")
    print_card(answer)


def _one_of(**given: float | None) -> None:
    """Raise ValueError unless exactly one option is given."""
    if sum(value is not None for value in given.values()) != 1:
        names = " or ".join(f"--{name.replace('_', '-')}" for name in given)
        raise ValueError(f"give either {names}")


@design.command(cls=Command)
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


@design.command(cls=Command)
def benedict_bordner(
    alpha: Annotated[float, typer.Option(metavar="A", help="Position gain.")],
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """The least transient error for a given noise, at constant velocity."""
    found = alpha, theory.benedict_bordner(alpha)
    _print_design("benedict-bordner", {"alpha": alpha}, found, dt, sigma, json)


@design.command(cls=Command)
def critically_damped(
    alpha: Annotated[float | None, typer.Option(metavar="A", help="Position gain.")] = None,
    xi: Annotated[float | None, typer.Option(metavar="X", help="The pole, 0 <= ξ < 1.")] = None,
    order: Order = 2,
    dt: Dt = 1.0,
    sigma: Sigma = None,
    json: options.Json = False,
) -> None:
    """All poles at one place: a filter with fading memory."""
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


@design.command(cls=Command)
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


@design.command(cls=Command)
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


@design.command(cls=Command)
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
