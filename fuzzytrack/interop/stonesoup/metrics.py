"""Metrics of Stone Soup on tracks of either kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from typing import Any

import numpy as np
from stonesoup.dataassociator.tracktotrack import TrackToTruth
from stonesoup.measures import Euclidean
from stonesoup.metricgenerator.manager import MultiManager
from stonesoup.metricgenerator.ospametric import GOSPAMetric, OSPAMetric
from stonesoup.metricgenerator.tracktotruthmetrics import SIAPMetrics
from stonesoup.types.state import StateMutableSequence

from fuzzytrack.interop.stonesoup.exchange import EPOCH, as_positions, from_stonesoup, to_stonesoup
from fuzzytrack.scoring.metrics import Settings
from fuzzytrack.scoring.positions import Positions

__all__ = ["FAMILIES", "stonesoup_metrics"]

#: Metrics that there are.
FAMILIES = ("ospa", "gospa", "siap")

_SIAP = {
    "SIAP Completeness": "completeness",
    "SIAP Ambiguity": "ambiguity",
    "SIAP Spuriousness": "spuriousness",
    "SIAP Position Accuracy": "position_accuracy",
    "SIAP Velocity Accuracy": "velocity_accuracy",
    "SIAP Rate of Track Number Change": "rate_of_number_changes",
    "SIAP Longest Track Segment": "longest_segment",
}


def stonesoup_metrics(
    tracks: Any,
    truth: Any,
    *,
    families: str | Sequence[str] = FAMILIES,
    cutoff: float = 20.0,
    order: float = 1.0,
    match: float = 15.0,
    position_mapping: Sequence[int] = (0, 2),
    velocity_mapping: Sequence[int] | None = (1, 3),
    epoch: datetime = EPOCH,
) -> dict[str, float]:
    """OSPA, GOSPA and SIAP as Stone Soup computes them.

    Parameters
    ----------
    tracks : TrackResult, ScanResult, TrackReports, Positions, mapping or tuple, or set of Track
        As for `to_stonesoup`; or tracks of Stone Soup.
    truth : Positions, mapping or tuple, or set of GroundTruthPath
        True positions in the same ways, at the times of the tracks: nothing is interpolated.
    families : str or sequence of str
        Which metrics, some of ``ospa``, ``gospa`` and ``siap``.
    cutoff, order : float
        Cut-off c (m) and order p of OSPA and GOSPA.
    match : float
        Largest distance of a track from its true object (m), for SIAP.
    position_mapping, velocity_mapping : sequence of int
        Places in the state vectors of tracks and paths of Stone Soup; None as the second is without
        velocities.
    epoch : datetime
        Time 0.

    Returns
    -------
    dict of str to float
        ``ospa``, ``gospa`` (m): means over the instants at which there is a track or an object; and
        ``completeness``, ``ambiguity``, ``spuriousness``, ``position_accuracy`` (m),
        ``velocity_accuracy`` (m/s; if both have velocities), ``rate_of_number_changes`` (1/s),
        ``longest_segment``.

    Raises
    ------
    TypeError, ValueError
        As for `to_stonesoup`; if a distance or the order is out of its range, there is no such
        family, positions have different numbers of axes, or there is neither a track nor an object;
        or, for SIAP, if a track or path lacks a state between its first and its last one, or there
        is one instant only.

    Notes
    -----
    The names are those of `fuzzytrack.score`. OSPA of order 1 and GOSPA have the same values there,
    at the same instants; of a higher order, the assignment of Stone Soup's OSPA minimizes the sum
    of distances rather than that of their powers. SIAP has other associations there: those of Stone
    Soup begin after three instants in a row.
    """
    chosen = _checked_families(families)
    # Their limits are those of the metrics of this package.
    Settings(cutoff=cutoff, order=order, match=match)
    mappings = {"position_mapping": position_mapping, "velocity_mapping": velocity_mapping}
    found, known = _with_equal_axes(
        _given(tracks, "tracks", epoch, mappings), _given(truth, "truth", epoch, mappings)
    )
    moving, n_axes = found.velocity is not None, found.n_axes
    places = 2 if moving else 1
    measure = Euclidean(mapping=list(range(0, places * n_axes, places)))
    speeds = Euclidean(mapping=list(range(1, 2 * n_axes, 2))) if moving else measure
    generators = {
        "ospa": OSPAMetric(c=cutoff, p=order, measure=measure),
        "gospa": GOSPAMetric(c=cutoff, p=order, measure=measure),
        "siap": SIAPMetrics(position_measure=measure, velocity_measure=speeds),
    }
    manager = MultiManager(
        [generators[name] for name in chosen],
        TrackToTruth(association_threshold=match, measure=measure),
    )
    paths = {
        "tracks": to_stonesoup(found, epoch=epoch),
        "groundtruth_paths": to_stonesoup(known, epoch=epoch, truth=True),
    }
    if "siap" in chosen:
        _check_whole(*paths.values())
    manager.add_data(paths)
    return _numbers(manager.generate_metrics(), moving)


def _checked_families(families: str | Sequence[str]) -> tuple[str, ...]:
    chosen = (families,) if isinstance(families, str) else tuple(families)
    for name in chosen:
        if name not in FAMILIES:
            raise ValueError(f"families: unknown {name!r}; some of {', '.join(FAMILIES)}")
    return chosen


def _with_equal_axes(tracks: Positions, truth: Positions) -> tuple[Positions, Positions]:
    """Both with velocities, or both without."""
    if tracks.n_axes != truth.n_axes:
        raise ValueError(
            f"tracks and truth: positions have {tracks.n_axes} and {truth.n_axes} axes; expected "
            "equally many"
        )
    if not len(tracks) and not len(truth):
        raise ValueError("tracks and truth: both are empty; give at least one of the two")
    if tracks.velocity is None or truth.velocity is None:
        return replace(tracks, velocity=None), replace(truth, velocity=None)
    return tracks, truth


def _numbers(values: dict[str, dict[str, Any]], moving: bool) -> dict[str, float]:
    """Numbers of what a manager of metrics returns, by their names here."""
    found: dict[str, float] = {}
    for name in ("ospa", "gospa"):
        for metric in values.get(f"{name}_generator", {}).values():
            found[name] = _mean(metric)
    siap = values.get("siap_generator", {})
    for title, name in _SIAP.items():
        if title in siap and (moving or name != "velocity_accuracy"):
            found[name] = float(siap[title].value)
    return found


def _check_whole(tracks: set[Any], truth: set[Any]) -> None:
    """Raise ValueError for what Stone Soup's SIAP cannot compute."""
    instants = sorted({state.timestamp for path in (*tracks, *truth) for state in path})
    if len(instants) < 2:
        raise ValueError("families: SIAP needs two instants or more; leave 'siap' out")
    for name, paths in (("tracks", tracks), ("truth", truth)):
        for path in paths:
            own = {state.timestamp for state in path}
            for when in instants:
                if min(own) < when < max(own) and when not in own:
                    raise ValueError(
                        f"{name}: {path.id} has no state at {when}, and SIAP needs one at every "
                        "instant between the first and the last of a track; leave 'siap' out of "
                        "families, or add coasting states"
                    )


def _given(paths: Any, name: str, epoch: datetime, mappings: dict[str, Any]) -> Positions:
    """Positions of what a user gave."""
    if isinstance(paths, StateMutableSequence | set | frozenset | list):
        found = from_stonesoup(paths, epoch=epoch, **mappings)
        if isinstance(found, Positions):
            return found
        raise TypeError(f"{name}: detections; expected tracks or true paths")
    return as_positions(paths, name)


def _mean(metric: Any) -> float:
    """Mean over time of a metric of one number, or of one called ``distance``."""
    values = metric.value
    each = [one.value for one in values] if isinstance(values, list) else [values]
    numbers = [one["distance"] if isinstance(one, dict) else one for one in each]
    return float(np.mean(numbers))
