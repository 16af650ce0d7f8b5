"""The command that describes fixed gains."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack import gains as theory
from fuzzytrack.cli import options
from fuzzytrack.cli.gain_card import print_card
from fuzzytrack.cli.options import Dt, Sigma
from fuzzytrack.cli.output import print_json

__all__ = ["gains"]


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
    """Show properties of fixed gains: stability, poles, noise and lag."""
    found = theory.gain_card(alpha, beta, gamma, dt, sigma)
    if json:
        print_json(found)
    else:
        print_card(found)
