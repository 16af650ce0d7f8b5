"""The command that certifies a rule base."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack import gains as theory
from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, say, show
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
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
    json: options.Json = False,
) -> None:
    """Prove that the error shrinks for any order of gains, or show an order that makes it grow.

    The gains of the rule base may switch from step to step in any way, not only as the rules choose
    them.
    """
    rules = load_rulebase(name)
    found = certify_gains(rules, reach=reach)
    refuted = len(found.sequence) > 0
    sequence = sequence_steps(rules, found)
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
    say(f"{name}: {found.verdict}")
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
    say("Missed plots, at which no correction is made, are not included.")


def _reached(rules: RuleBase, reach: str) -> str:
    if reach == "rules":
        return "between what the single rules conclude"
    limits = (
        f"{output.name} in [{output.universe.low:g}, {output.universe.high:g}]"
        for output in rules.outputs
    )
    return f"within the limits of the outputs, {', '.join(limits)}"
