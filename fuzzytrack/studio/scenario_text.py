"""The scenario of a page: read from its text, which is the one truth, changed there, and shown."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fuzzytrack.errors import FileError, ScenarioError
from fuzzytrack.numerals import is_number
from fuzzytrack.simulation.scenario import FieldSensors, PlotNoise, Scenario
from fuzzytrack.yamltree import Document, Node
from fuzzytrack.yamltree import Mapping as MappingNode
from fuzzytrack.yamltree import Sequence as ListNode
from fuzzytrack.yamlvalues import Value, remove_value, set_value

__all__ = [
    "Entry", "scenario_as_json", "section_of", "waypoint_times", "with_sampling", "with_sensors",
    "with_target",
]  # fmt: skip

#: A number, a word, numbers, or points.
Entry = Value

_OF_WAYPOINTS = ("waypoints", "leg", "times", "period")
_OF_EVERY_MOTION = ("motion", "speed", "heading", "start", "steps", "period")
_OF_MOTION = (*_OF_EVERY_MOTION, "acceleration", "radius")
_OF_GRID = (
    "grid", "spacing", "reach", "range_sigma", "bearing_sigma", "detection", "centre", "linear",
    "correlation", "freedom", "sigma_from",
)  # fmt: skip
_OF_NOISE = (
    "sigma", "detection", "clean", "factors", "spread", "outliers", "told", "correlation",
    "freedom",
)  # fmt: skip
# Points of a true track that are drawn.
_MOST_DRAWN = 2_000


def with_target(text: str, given: Mapping[str, Entry]) -> str:
    """Text with another target: points of ``waypoints``, or numbers of a ``motion``.

    Parameters
    ----------
    text : str
        A scenario in YAML.
    given : mapping of str to Entry
        Entries; others that can stay do so.

    Raises
    ------
    ScenarioError
        If the text is no YAML, or has no target.
    """
    now = section_of(text, "target") or {}
    kept: tuple[str, ...] = _OF_WAYPOINTS
    if "motion" in given:
        # Numbers of another motion would be refused.
        kept = _OF_MOTION if now.get("motion") == given["motion"] else _OF_EVERY_MOTION
    drop = [name for name in now if name not in (*kept, *given)]
    other = {"times": "leg", "leg": "times"}
    drop += [other[name] for name in given if other.get(name) in now]
    return _with_entries(text, "target", given, drop)


def with_sensors(text: str, given: Mapping[str, Entry]) -> str:
    """Text with other sensors: a ``grid``, plain noise, ``sigma``, or other numbers of these.

    Parameters
    ----------
    text, given
        As for `with_target`.

    Raises
    ------
    ScenarioError
        If the text is no YAML, or has no sensors.
    """
    now = section_of(text, "sensors") or {}
    kept = _OF_NOISE if "sigma" in given else _OF_GRID if "grid" in given else tuple(now)
    return _with_entries(text, "sensors", given, [name for name in now if name not in kept])


def with_sampling(text: str, given: Mapping[str, Entry]) -> str:
    """Text with another sampling; the regular one if nothing is given.

    Raises
    ------
    ScenarioError
        As for `with_target`.
    """
    now = section_of(text, "sampling")
    if not given:
        return text if now is None else remove_value(text, ["sampling"], failure=ScenarioError)
    if now is None:
        # A mapping that is not there yet is written as a whole.
        entries = ", ".join(f"{name}: {value}" for name, value in given.items())
        end = "" if text.endswith("\n") else "\n"
        return f"{text}{end}\nsampling: {{{entries}}}\n"
    return _with_entries(text, "sampling", given, [name for name in now if name not in given])


def _with_entries(text: str, section: str, given: Mapping[str, Entry], drop: Sequence[str]) -> str:
    """Text with entries of a part of it set, or added, and others removed."""
    if section_of(text, section) is None:
        # That it is no YAML is said with its place.
        Document(text, "<text>", failure=ScenarioError)
        raise ScenarioError(f"the text has no {section} to be changed; mend it first, or undo")
    for name, value in given.items():
        text = set_value(text, [section, name], value, failure=ScenarioError)
    for name in dict.fromkeys(drop):
        text = remove_value(text, [section, name], failure=ScenarioError)
    return text


def section_of(text: str, section: str) -> dict[str, Any] | None:
    """Entries of a part of a scenario, numbers as numbers; None if it cannot be read."""
    try:
        document = Document(text, "<text>", failure=ScenarioError)
        found = document.entries(document.root, "the scenario")[section][1]
    except (FileError, KeyError):
        return None
    values = _values(found)
    return values if isinstance(values, dict) else None


def waypoint_times(points: Sequence[Sequence[float]], speed: float) -> list[float]:
    """Times of way-points (s) on straight legs at a constant speed (m/s), to a tenth of a second.

    Raises
    ------
    ValueError
        If the speed is not positive.
    """
    if not speed > 0:
        raise ValueError(f"speed: must be > 0 m/s, got {speed:g}")
    legs = (math.dist(a, b) / speed for a, b in itertools.pairwise(points))
    return [round(t, 1) for t in itertools.accumulate(legs, initial=0.0)]


def _values(node: Node) -> Any:
    if isinstance(node, MappingNode):
        return {name: _values(value) for name, (_, value) in node.entries.items()}
    if isinstance(node, ListNode):
        return [_values(item) for item in node.items]
    word = node.text  # type: ignore[attr-defined]
    return float(word) if is_number(word) else word


def scenario_as_json(found: Scenario) -> dict[str, Any]:
    """A scenario as the page draws it."""
    position = found.position if found.position.ndim == 2 else found.position[:, 0]
    step = -(-len(position) // _MOST_DRAWN)
    return {
        "name": found.name,
        "source": found.source,
        "axes": found.n_axes,
        "scans": len(found.time),
        "first_scored": found.first_scored,
        "tracks": 1 if found.position.ndim == 2 else found.position.shape[1],
        "time": found.scan_time[::step],
        "truth": position[::step],
        "sensors": _sensors_as_json(found),
        "trackers": found.trackers,
    }


def _sensors_as_json(found: Scenario) -> dict[str, Any]:
    sensors = found.sensors
    if isinstance(sensors, FieldSensors):
        field = sensors.field
        return {
            "kind": "field",
            "positions": field.position,
            "reach": field.reach,
            "range_sigma": field.range_sigma,
            "bearing_sigma": np.degrees(field.bearing_sigma),
            "detection": field.detection,
        }
    if isinstance(sensors, PlotNoise):
        return {"kind": "noise", "sigma": sensors.sigma, "detection": sensors.detection}
    return {"kind": "other"}
