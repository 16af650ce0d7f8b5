"""What is minimized when a scan tracker is tuned: a metric, or a weighted sum of several."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fuzzytrack.scoring.metrics import METRICS
from fuzzytrack.yamltree import suggestion

__all__ = ["STUDY", "ScanCriterion", "scan_criterion"]

#: Name of the weighted sum of the study that the default configuration comes from.
STUDY = "study"

# Its J: meters of OSPA, switches and breaks an object, false tracks in seconds a minute.
_STUDY = {
    "ospa": 1.0,
    "switches": 0.5,
    "moving_false_per_minute": 0.05,
    "false_per_minute": 0.01,
    "breaks": 0.2,
}


@dataclass(frozen=True)
class ScanCriterion:
    """A weighted sum of metrics; less is better.

    Attributes
    ----------
    name : str
    weights : tuple of (str, float)
        Metrics and their weights; a metric of which most is best has a negative one.
    """

    name: str
    weights: tuple[tuple[str, float], ...]

    @property
    def text(self) -> str:
        """In words."""
        if len(self.weights) == 1:
            ((name, weight),) = self.weights
            metric = METRICS[name]
            best = "" if weight > 0 else ", the most is best"
            return f"{metric.family}: {metric.label}{best}"
        return " + ".join(f"{weight:g} {name}" for name, weight in self.weights)

    def value(self, metrics: Mapping[str, float]) -> float:
        """Value of some metrics; infinite where one of them is not a number."""
        total = sum(weight * metrics[name] for name, weight in self.weights)
        return total if math.isfinite(total) else math.inf


def scan_criterion(name: str) -> ScanCriterion:
    """Criterion of a name: ``study``, or any of `fuzzytrack.scoring.metrics.METRICS`.

    Raises
    ------
    ValueError
        If there is no such metric, or neither least nor most of it is best.
    """
    if name == STUDY:
        return ScanCriterion(STUDY, tuple(_STUDY.items()))
    usable = [STUDY, *(key for key, metric in METRICS.items() if metric.best != "one")]
    if name not in usable:
        raise ValueError(f"metric: unknown {name!r}{suggestion(name, usable)}")
    return ScanCriterion(name, ((name, 1.0 if METRICS[name].best == "least" else -1.0),))
