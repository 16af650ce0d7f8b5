"""Certified stability of a rule base that schedules gains."""

from __future__ import annotations

import math
import os

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.gains import certificate
from fuzzytrack.gains.certificate import Certificate, polygon_in_gains
from fuzzytrack.gains.covariance_certificate import CovarianceCertificate, certify_covariance
from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.gains.polygons import convex_hull
from fuzzytrack.gains.stability import poles
from fuzzytrack.schedulers.gain_outputs import find_gain_outputs
from fuzzytrack.schedulers.reachable_covariance import covariance_limits
from fuzzytrack.schedulers.reachable_outputs import output_values
from fuzzytrack.schedulers.settings import check_period, read_settings

__all__ = ["certify", "reachable_gains", "sequence_steps"]


def certify(
    gains: ArrayLike | RuleBase | str | os.PathLike[str],
    *,
    reach: str = "universe",
    steps: tuple[float, float] | None = None,
    missed: int = 0,
    period: float | None = None,
    sigma_ratio: float = 1.0,
    max_length: int = 48,
) -> Certificate | CovarianceCertificate:
    """Certify a set of gains, or all gains that a rule base can reach, under arbitrary switching.

    Without `steps` and `missed` it is about tracks with constant time between plots and no missed
    plots.

    Parameters
    ----------
    gains : array_like, shape (n, 2), or RuleBase, str or path
        (α, β) pairs, whose convex hull is the set; or a rule base that schedules gains, itself or
        as for `fuzzytrack.load_rulebase`.
    reach : {"universe", "rules"}
        For a rule base, see `reachable_gains`.
    steps : (float, float), optional
        Shortest and longest time between rows, s. It may change from row to row within these
        limits, in any way. Without a period only their ratio matters. For gains from a covariance
        in units of τ₀, and 1 unless given.
    missed : int
        Most plots that are missed in a row.
    period : float, optional
        Sampling time to which the gains belong, s; that of the rule base unless given. The gains
        are then converted to the time since the last plot, and constant T means this one.
    sigma_ratio : float
        For gains from a covariance the largest ratio, >= 1, of the standard deviation of a plot to
        that of the first one, or the other way round. Other gains do not depend on it.
    max_length : int
        Longest sequence of gains tried as a counter-example.

    Returns
    -------
    Certificate or CovarianceCertificate
        The latter for a rule base whose gains follow from a covariance; see
        `fuzzytrack.gains.covariance_certificate`.

    Raises
    ------
    RuleBaseError
        If there is no such rule base, or it does not schedule α and β, see `reachable_gains`.
    TypeError
        If `gains` is something else.
    ValueError
        If an argument is out of range.

    Examples
    --------
    >>> certify("stiffness-damping", steps=(1, 2)).verdict
    'certified'
    >>> certify("stiffness-damping", steps=(1, 4)).verdict
    'refuted'
    >>> certify("stiffness-damping", steps=(1, 4), period=4).verdict
    'certified'
    """
    if not isinstance(gains, RuleBase | str | os.PathLike):
        around, reached = _pairs(gains), None
    else:
        rules = as_rulebase(gains, "gains")
        times = ElapsedTimes(*(steps or (1.0, 1.0)), missed)
        limits = covariance_limits(rules, reach, times, sigma_ratio)
        if limits is not None and period is not None:
            raise ValueError(
                f"period: the covariance of {rules.name} follows the time; leave it out"
            )
        if limits is not None:
            return certify_covariance(limits)
        around, reached = _gains(rules, reach)
        period = _period(rules, period)
    times = ElapsedTimes(*(steps or (period or 1.0, period or 1.0)), missed)
    return certificate.certify(around, max_length, reached=reached, times=times, period=period)


def _period(rules: RuleBase, period: float | None) -> float | None:
    """Sampling time to which the gains of a rule base belong."""
    if period is not None:
        outputs = find_gain_outputs(rules.output_names)
        assert outputs is not None  # `_gains` refuses others
        check_period(rules, outputs, period)
        return period
    return read_settings(rules).period if "period" in dict(rules.scheduler) else None


def _pairs(gains: ArrayLike) -> Array:
    try:
        return np.asarray(gains, dtype=np.float64)
    except TypeError as error:
        raise TypeError(
            "gains must be pairs (alpha, beta), a RuleBase, the name of a shipped one or the path "
            f"of a file, got {type(gains).__name__}"
        ) from error


def reachable_gains(rules: RuleBase | str | os.PathLike[str], reach: str = "universe") -> Array:
    """Gains whose convex hull contains all gains that a rule base can schedule.

    Parameters
    ----------
    rules : RuleBase, str or path
        With outputs stiffness and damping, stiffness alone (damping on Kalata's curve), or alpha
        and beta; itself or as for `fuzzytrack.load_rulebase`.
    reach : {"universe", "rules"}
        ``universe``: all gains within the universes of the outputs, for any rules. ``rules``: the
        hull of the conclusions of the single rules, which is smaller; it is valid where every
        value is a mean of these: weighted centers with product and sum.

    Returns
    -------
    ndarray, shape (n, 2)
        (α, β).

    Raises
    ------
    RuleBaseError
        If the outputs are others, or ``rules`` is not valid for the algebra.
    ValueError
        If `reach` is unknown.

    Notes
    -----
    The defaults of the outputs are included if there are inputs at which no rule fires. The gains
    of an opening (`fuzzytrack.schedulers.fuzzy.FuzzyScheduler`) are not: it ends after a few plots,
    so whether the error shrinks in the long run does not depend on it.
    """
    return _gains(as_rulebase(rules), reach)[0]


def sequence_steps(
    rules: RuleBase | str | os.PathLike[str], found: Certificate
) -> list[dict[str, float]]:
    """Steps of a sequence of gains that makes the error grow.

    Parameters
    ----------
    rules : RuleBase, str or path
        The rule base that was certified.
    found : Certificate

    Returns
    -------
    list of dict
        For each plot ``alpha`` and ``beta``; ``elapsed``, the time since the last plot, and
        ``missed``, how many plots are missed before it; ``stiffness`` and ``damping``, if the rule
        base has a stiffness, no period, and the gains a stiffness that is positive; and
        ``modulus``, that of the largest pole. Empty unless refuted.
    """
    w_domain = "stiffness" in as_rulebase(rules).output_names and found.period is None
    steps = []
    for (alpha, beta), elapsed in zip(found.sequence.tolist(), found.elapsed.tolist(), strict=True):
        time = {"elapsed": elapsed, "missed": found.times.missed_within(elapsed)}
        steps.append(time | _step(alpha, beta, w_domain))
    return steps


def _step(alpha: float, beta: float, w_domain: bool) -> dict[str, float]:
    step = {"alpha": alpha, "beta": beta}
    u = 4 - 2 * alpha - beta
    # Also on the edge of stability, where `fuzzytrack.gains.w_from_alpha_beta` refuses.
    if w_domain and beta * u > 0:
        step |= {"stiffness": math.sqrt(beta / u), "damping": alpha / math.sqrt(beta * u)}
    return step | {"modulus": float(np.abs(poles(alpha, beta)).max())}


def _gains(rules: RuleBase, reach: str) -> tuple[Array, Array]:
    """Gains that enclose those a rule base can reach, and gains that it does reach."""
    outputs = find_gain_outputs(rules.output_names)
    if outputs is None or "gamma" in outputs.names:
        raise RuleBaseError(
            f"{rules.name} cannot be certified: needed are outputs stiffness and damping, "
            f"stiffness alone, or alpha and beta; it has {', '.join(rules.output_names)}"
        )
    points, reached = output_values(rules, outputs.names, reach)
    if outputs.setting != "direct" and points.min() < 0:
        raise RuleBaseError(
            f"{rules.name} cannot be certified: {' and '.join(outputs.names)} must not be "
            f"negative, and reach {points.min():g}"
        )
    if outputs.setting == "w-domain":
        around = polygon_in_gains(convex_hull(points))[0]
    elif outputs.setting == "kalata":
        around = _around_kalata_curve(float(points.min()), float(points.max()))
    else:
        around = points
    to_gains = outputs.conversion(outputs.names)
    return around, np.array([to_gains(tuple(point))[:2] for point in reached.tolist()])


def _around_kalata_curve(lowest: float, highest: float, pieces: int = 32) -> Array:
    """Corners of an outline around Kalata's gains between two stiffnesses.

    With r = √(1 - α) they are (1 - r², 2(1 - r)²), a parabola. Between r₁ and r₂ it lies within the
    triangle of its ends and the control point (1 - r₁r₂, 2(1 - r₁)(1 - r₂)).
    """
    squares = np.array([lowest, highest]) ** 2
    # Root of (1 - r)² = 2rω₀².
    ends = 1 / (1 + squares + np.sqrt(squares * (2 + squares)))
    r = np.linspace(ends[0], ends[1], pieces + 1)
    knots = np.stack([1 - r * r, 2 * (1 - r) ** 2], axis=1)
    between = np.stack([1 - r[1:] * r[:-1], 2 * (1 - r[1:]) * (1 - r[:-1])], axis=1)
    return np.concatenate([knots, between])
