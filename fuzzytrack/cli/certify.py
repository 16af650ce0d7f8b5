"""The command that certifies a rule base."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack import gains as theory
from fuzzytrack.cli import options
from fuzzytrack.cli.covariance_certificate import print_covariance_certificate
from fuzzytrack.cli.output import paragraph, print_json, print_table, say, show
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.gains.certificate import Certificate
from fuzzytrack.gains.covariance_certificate import CovarianceCertificate
from fuzzytrack.numerals import as_number
from fuzzytrack.schedulers.reachable_gains import certify as certify_gains
from fuzzytrack.schedulers.reachable_gains import sequence_steps

__all__ = ["certify"]


def certify(
    name: Annotated[str, typer.Argument(metavar="RULEBASE", help="Shipped name, or file.")],
    reach: Annotated[
        str,
        typer.Option(
            metavar="R",
            help="Gains in question: universe, all within the limits of the outputs; or rules, "
            "all between the conclusions of single rules.",
        ),
    ] = "universe",
    steps: Annotated[
        str | None,
        typer.Option(
            metavar="LOW:HIGH",
            help="Limits of the time between rows (s; of gains from a covariance in units of τ₀), "
            "which may change from row to row. [default: constant]",
        ),
    ] = None,
    missed: Annotated[
        int, typer.Option(metavar="N", help="Most plots that are missed in a row.")
    ] = 0,
    period: Annotated[
        float | None,
        typer.Option(
            metavar="T",
            help="Sampling time to which the gains belong (s): they are converted to the time "
            "since the last plot. [default: that of the rule base]",
        ),
    ] = None,
    sigma_ratio: Annotated[
        float,
        typer.Option(
            metavar="R",
            help="For gains from a covariance: largest ratio between the standard deviations of a "
            "plot and of the first one.",
        ),
    ] = 1.0,
    json: options.Json = False,
) -> None:
    """Prove that the error shrinks for any order of gains, or show an order that makes it grow.

    The gains of the rule base may switch from plot to plot in any way, not only as the rules choose
    them, and so may the time between plots within its limits.
    """
    rules = load_rulebase(name)
    limits = None if steps is None else _limits(steps)
    found = certify_gains(
        rules, reach=reach, steps=limits, missed=missed, period=period, sigma_ratio=sigma_ratio
    )
    if isinstance(found, CovarianceCertificate):
        print_covariance_certificate(name, rules, reach, found, json)
        return
    sequence = sequence_steps(rules, found)
    if json:
        print_json(
            {
                "rulebase": rules.name,
                "reach": reach,
                "steps": limits,
                "missed": missed,
                "period": found.period,
                "covered": found.covered,
                "verdict": found.verdict,
                "rate": found.rate,
                "lyapunov": found.lyapunov,
                "polygon": found.polygon,
                "vertices": found.vertices,
                "sequence": sequence,
                "growth": found.growth,
            }
        )
        return
    say(f"{name}: {found.verdict}")
    paragraph(f"Covered: {found.covered}.")
    say()
    if found.verdict == "refuted":
        _print_sequence(rules, reach, found, sequence)
    elif found.verdict == "certified":
        _print_norm(rules, reach, found)
    else:
        paragraph(
            f"For gains {_reached(rules, reach)}, in any order, no measure of the error was found "
            f"that always shrinks (the best one may grow by a factor of {found.rate:.4f} a plot), "
            "nor a sequence of gains that makes the error grow."
        )


def _limits(text: str) -> tuple[float, float]:
    """Two times with a colon between them."""
    low, high = (as_number(part) for part in text.partition(":")[::2])
    if low is None or high is None:
        raise ValueError(f"--steps: expected LOW:HIGH, two times, got {text!r}")
    return low, high


def _print_sequence(
    rules: RuleBase, reach: str, found: Certificate, sequence: list[dict[str, float]]
) -> None:
    """Gains and times with which the error grows."""
    alone = all(theory.is_stable(step["alpha"], step["beta"]) for step in sequence)
    paragraph(
        f"Among gains {_reached(rules, reach)} are these. Repeated in this order they make the "
        f"error grow by a factor of {found.growth:.4f} a plot, though each by itself, at constant "
        f"T, is {'stable' if alone else 'stable, or on the edge of stability'}:"
    )
    say()
    heads = [key for key in ("stiffness", "damping", "alpha", "beta") if key in sequence[0]]
    varies = len(set(found.elapsed.tolist())) > 1
    rows = [
        [
            str(number),
            *([show(step["elapsed"]), f"{step['missed']:.0f}"] if varies else []),
            *(show(step[key]) for key in heads),
            f"{step['modulus']:.4f}",
        ]
        for number, step in enumerate(sequence, 1)
    ]
    times = ["time", "missed"] if varies else []
    print_table(["plot", *times, *heads, "largest pole"], rows)
    if varies:
        say()
        say("time: since the last plot (s); missed: plots missed meanwhile.")


def _print_norm(rules: RuleBase, reach: str, found: Certificate) -> None:
    """The norm that every plot reduces."""
    paragraph(
        f"For gains {_reached(rules, reach)}, in any order, the error shrinks at every plot to "
        f"{found.rate:.4f} of what it was, or less."
    )
    say()
    unit = "T" if found.times.low == found.times.high else f"{found.times.low:g} s"
    error = (
        f"e is the error of the position predicted for a time {unit} after a plot, and {unit} "
        "times the error of the velocity"
    )
    if len(found.polygon):
        paragraph(
            f"Its measure is 1 on a polygon of {len(found.polygon)} corners, which --json prints; "
            f"{error}."
        )
        return
    (_, x), (_, y) = found.lyapunov
    paragraph(f"Its measure is √(eᵀPe), where {error}, and")
    say()
    say(f"  P = [{1:>9.4f} {x:>9.4f} ]")
    say(f"      [{x:>9.4f} {y:>9.4f} ]")


def _reached(rules: RuleBase, reach: str) -> str:
    if reach == "rules":
        return "between what the single rules conclude"
    limits = (
        f"{output.name} in [{output.universe.low:g}, {output.universe.high:g}]"
        for output in rules.outputs
    )
    return f"within the limits of the outputs, {', '.join(limits)}"
