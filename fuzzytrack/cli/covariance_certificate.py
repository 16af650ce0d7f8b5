"""The certificate of gains from a covariance as text and as JSON."""

from __future__ import annotations

from fuzzytrack.cli.output import paragraph, print_json, say
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.gains.covariance_certificate import CovarianceCertificate

__all__ = ["print_covariance_certificate"]


def print_covariance_certificate(
    name: str, rules: RuleBase, reach: str, found: CovarianceCertificate, json: bool
) -> None:
    """Print what holds, by which theorem and for which limits, and how fast errors shrink."""
    limits = found.limits
    if json:
        print_json(
            {
                "rulebase": rules.name,
                "reach": reach,
                "steps": (limits.times.low, limits.times.high),
                "missed": limits.times.missed,
                "sigma_ratio": limits.sigma_ratio,
                "covered": found.covered,
                "verdict": found.verdict,
                "missing": found.missing,
                "noise": limits.noise,
                "retention": limits.retention,
                "contraction": found.contraction,
                "contraction_is": "sampled",
            }
        )
        return
    say(f"{name}: {found.verdict}")
    paragraph(f"Covered: {found.covered}.")
    say()
    if found.missing:
        paragraph(f"The theorem does not apply: {found.missing}.")
        return
    paragraph(
        "Proven: the error shrinks exponentially, with whatever noise and retention the rules "
        "choose at each plot, since the gains are those of a Kalman filter whose noise, retention, "
        "times and variances are bounded (Deyst & Price 1968, 1973; Jazwinski 1970, theorem 7.4)."
    )
    say()
    for quantity, (low, high), unit in (
        ("noise", limits.noise, "a₀"),
        ("retention", limits.retention, "τ₀"),
        (
            "time since the last plot",
            limits.times.intervals[0][:1] + limits.times.intervals[-1][1:],
            "τ₀",
        ),
        ("σ of a plot", (1 / limits.sigma_ratio, limits.sigma_ratio), "σ of the first one"),
    ):
        say(f"  {quantity} in [{low:g}, {high:g}] {unit}")
    say()
    say("Units: a₀ = level/3, τ₀ = √(σ/a₀) with σ of the first plot, for a given level.")
    say()
    left = ", ".join(
        f"{share:.3f} after {plots} plots" for plots, share in found.contraction.items()
    )
    paragraph(
        f"Sampled, not proven: in the worst sequences that a search found {left} is left of "
        "the error, measured in standard deviations of the filter's own covariance."
    )
