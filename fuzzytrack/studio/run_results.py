"""Results of Monte Carlo runs as the page shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.testbed.marks import marks_of
from fuzzytrack.testbed.operations import OperationCount, count_operations
from fuzzytrack.testbed.results import Results
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["operations", "paired_as_json", "results_as_json"]

_BARS = 40
_BAND = (0.1, 0.9)


def results_as_json(
    found: Results, counts: Mapping[str, dict[str, float]] | None = None
) -> dict[str, Any]:
    """Results for tables and pictures.

    Parameters
    ----------
    found : Results
    counts : mapping of str to dict, optional
        Operations of the trackers by name, see `operations`.

    Returns
    -------
    dict
        What `Results.to_json_dict` gives, which is what the command line writes; and ``marks``
        (which tracker is best, which are worse than the plots), ``bands`` (for each tracker
        quantiles of the distance of prediction over runs, 10 and 90 %), ``distribution``
        (``edges`` and for each tracker ``counts`` of these distances), ``sample`` (run 0 in full)
        and ``operations``.
    """
    return {
        **found.to_json_dict(),
        "marks": marks_of(found.rmse(), found.rmse("filtered"), found.measured_rmse),
        "bands": _bands(found),
        "distribution": _distribution(found),
        "sample": _sample(found),
        "operations": counts or {},
    }


def _bands(found: Results) -> dict[str, dict[str, Array]]:
    low, high = found.quantiles(_BAND)
    return {name: {"low": low[k], "high": high[k]} for k, name in enumerate(found.names)}


def _distribution(found: Results) -> dict[str, Any]:
    """How often each distance of prediction occurs; the last bar holds all above 99 %."""
    scored = [distance[found.scored] for distance in found.predicted_distance]
    known = np.concatenate(scored)
    if not len(known):
        return {"edges": [], "counts": {}}
    edges = np.linspace(0.0, float(np.quantile(known, 0.99)) or 1.0, _BARS + 1)
    counts = {
        name: np.histogram(np.minimum(distance, edges[-1]), edges)[0]
        for name, distance in zip(found.names, scored, strict=True)
    }
    return {"edges": edges, "counts": counts}


def _sample(found: Results) -> dict[str, Any]:
    sample = found.sample
    trackers = {
        name: {
            "predicted": sample.predicted[k],
            "filtered": sample.filtered[k],
            "alpha": sample.alpha[k],
            "beta": sample.beta[k],
            "gamma": sample.gamma[k],
        }
        for k, name in enumerate(found.names)
    }
    return {
        "time": sample.time,
        "truth": sample.truth,
        "plots": sample.plots,
        "seen": ~np.isnan(sample.plots).any(axis=-1),
        "trackers": trackers,
    }


def paired_as_json(found: Results, first: str, second: str) -> dict[str, Any]:
    """Difference of the errors of prediction of two trackers, second minus first.

    Parameters
    ----------
    found : Results
    first, second : str
        Names of trackers.

    Returns
    -------
    dict
        ``difference`` of the RMSE of a run, its standard error ``se``, and its interval, ``low`` to
        ``high`` at ``level``, over ``runs``; ``over_time``: for each scan the mean ``difference``
        of the distances, with its ``se``.

    Raises
    ------
    ValueError
        If there is no such tracker.
    """
    pair = found.paired_difference(first, second)
    a, b = (found.predicted_distance[found.names.index(name)] for name in (first, second))
    difference = np.where(found.compared, b - a, np.nan)
    counts = found.compared.sum(axis=0)
    known = np.where(found.compared, b - a, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = known.sum(axis=0) / counts
        spread = np.where(found.compared, np.square(difference - mean), 0.0).sum(axis=0)
        error = np.sqrt(spread / (counts - 1) / counts)
    return {
        "first": first,
        "second": second,
        "quantity": "predicted_rmse",
        "difference": pair.difference,
        "se": pair.standard_error,
        "low": pair.low,
        "high": pair.high,
        "level": pair.level,
        "runs": pair.runs,
        "over_time": {"difference": mean, "se": error},
    }


def operations(trackers: Mapping[str, Tracker], n_axes: int) -> dict[str, dict[str, float]]:
    """Operations of trackers for one axis at one scan; of trackers of another form not known."""
    found = {}
    for name, tracker in trackers.items():
        if isinstance(tracker, LaneTracker):
            count = _count(tracker, n_axes)
            found[name] = {
                "scheduler": count.scheduler_per_update,
                "recursion": count.recursion_per_update,
                "per_update": count.per_update,
            }
    return found


def _count(tracker: LaneTracker, n_axes: int) -> OperationCount:
    return count_operations(tracker, n_axes=n_axes)
