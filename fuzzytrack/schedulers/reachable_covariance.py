"""Limits of the noise and the retention that a rule base can choose for a covariance."""

from __future__ import annotations

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.gains.covariance_certificate import CovarianceLimits
from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.schedulers.maneuver_covariance import ManeuverCovariance
from fuzzytrack.schedulers.reachable_outputs import output_values
from fuzzytrack.schedulers.settings import read_settings

__all__ = ["covariance_limits"]


def covariance_limits(
    rules: RuleBase, reach: str, times: ElapsedTimes, sigma_ratio: float
) -> CovarianceLimits | None:
    """Limits of a rule base whose gains follow from a covariance; None for other rule bases.

    Parameters
    ----------
    rules : RuleBase
    reach : {"universe", "rules"}
        See `fuzzytrack.schedulers.reachable_outputs.output_values`.
    times : ElapsedTimes
        Times between plots, in τ₀.
    sigma_ratio : float
        See `CovarianceLimits`.

    Returns
    -------
    CovarianceLimits or None

    Raises
    ------
    RuleBaseError
        If its settings do not fit, or ``rules`` is not valid for the algebra.
    ValueError
        If an argument is out of range.
    """
    if dict(rules.scheduler).get("gains") != "covariance":
        return None
    settings = read_settings(rules)
    names = rules.output_names
    converter = settings.outputs.converter(names, (1.0,) * len(names), **settings.numbers)
    assert isinstance(converter, ManeuverCovariance)
    noise, retention = (output_values(rules, (name,), reach)[0] for name in ("noise", "retention"))
    return CovarianceLimits(
        (float(noise.min()), float(noise.max())),
        (float(retention.min()), float(retention.max())),
        converter.delay,
        converter.gap,
        times,
        sigma_ratio,
    )
