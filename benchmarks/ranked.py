"""The trackers that are ranked: every scheduler of the package, with its defaults or tuned once.

The numbers are those of the random sets, where the noise, the period and the unit of acceleration
are 1: found by ``fuzzytrack.tuning`` on 120 tracks of each set, for all three sets together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from benchmarks.work import ROOT

_TUNED = ROOT / "benchmarks" / "tuned"


@dataclass(frozen=True)
class Conditions:
    """What a tracker is set for; those of the random sets unless others are given.

    Attributes
    ----------
    level : float
        Strongest maneuver expected (m/s²).
    sigma : float
        Standard deviation of the plots (m).
    period : float
        Time between scans (s).
    """

    level: float = 3.0
    sigma: float = 1.0
    period: float = 1.0

    @property
    def acceleration(self) -> float:
        """Unit of acceleration (m/s²)."""
        return self.level / 3

    def stay(self, probability: float) -> float:
        """Probability to stay in a model for one scan, from that for one unit of time."""
        return probability ** (self.period / math.sqrt(self.sigma / self.acceleration))


def defaults() -> dict[str, str]:
    """Trackers as they come, or with the numbers of their papers."""
    rules = ("chan-style", "stiffness-damping", "stiffness-damping-cog", "stiffness-damping-wide")
    return {
        **{name: name for name in (*rules, "omega-schedule")},
        "fixed (published)": "fixed:alpha=0.5377:beta=0.2018",
        "growing memory": "growing-memory",
        "linear combination": "linear-combination",
        "track quality": "track-quality",
        "bank": "bank",
        "window search": "window-search",
    }


def tuned(conditions: Conditions) -> dict[str, str]:
    """Trackers whose numbers were tuned once for all sets, for the conditions given."""
    a, stay = conditions.acceleration, conditions.stay
    return {
        "fixed .543 .548": "fixed:alpha=.543:beta=.548",
        "Benedict-Bordner (tuned)": "benedict-bordner:alpha=0.7446",
        "fading memory (tuned)": "fading-memory:xi=0.5921",
        "growing memory (tuned)": "growing-memory:limit=3",
        "linear combination (tuned)": "linear-combination:alpha=0.8188:weight=0.9494",
        "Kalman CV": f"kalman-cv:sigma_v={0.8697 * a}",
        "Kalman CA": f"kalman-ca:sigma_v={0.2078 * a}:acceleration_sigma={0.005041 * a}",
        "innovation variance (tuned)": f"innovation:sigma_d={0.3445 * a}:window=9",
        "track quality (tuned)": "track-quality:cap=1.763",
        "window search (tuned)": "window-search:window=12:alpha=0.6529",
        "bank (tuned)": "bank:lowest=0.3621:highest=0.9048:forget=0.6779",
        "stiffness-damping (tuned)": str(_TUNED / "stiffness-damping-tuned.yaml"),
        "omega-schedule (tuned)": str(_TUNED / "omega-schedule-tuned.yaml"),
        "IMM CV/CV": (
            f"imm:quiet_sigma={0.221 * a}:maneuver_sigma={1.879 * a}"
            f":quiet_stay={stay(0.9706)}:maneuver_stay={stay(0.883)}:maneuver=cv"
        ),
        "IMM CV/CA": (
            f"imm:quiet_sigma={0.003112 * a}:maneuver_sigma={0.4009 * a}"
            f":quiet_stay={stay(0.9319)}:maneuver_stay={stay(0.8489)}"
        ),
    }


def with_level(conditions: Conditions) -> dict[str, str]:
    """Trackers that are told the strongest maneuver to expect, with their defaults else."""
    names = ("maneuver", "maneuver-two-rules", "imm-two", "imm-three")
    return {name: f"{name}:level={conditions.level}" for name in names}


def with_period(conditions: Conditions) -> dict[str, str]:
    """Dimensionless gains that are converted from the period that they belong to."""
    given = {**defaults(), **tuned(conditions)}
    names = ("fixed .543 .548", "Benedict-Bordner (tuned)", "stiffness-damping", "omega-schedule")
    return {f"{name} + period": f"{given[name]}:period={conditions.period}" for name in names}


def ranked(conditions: Conditions) -> dict[str, str]:
    """All of them by name, as `fuzzytrack.trackers.catalog.make_tracker` reads them."""
    given = (defaults(), tuned(conditions), with_level(conditions), with_period(conditions))
    return {name: spec for group in given for name, spec in group.items()}
