"""Commands about the scenario: targets, sensors, files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fuzzytrack.simulation.sampling import PATTERNS
from fuzzytrack.specs import is_file
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.handlers import Handler
from fuzzytrack.studio.limits import MOST_SCANS
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.scenario_text import (
    Entry,
    scenario_as_json,
    section_of,
    waypoint_times,
    with_sampling,
    with_sensors,
    with_target,
)

__all__ = ["HANDLERS", "scenario_state"]

Answer = Mapping[str, Any]

_MOTIONS = (
    "constant-velocity", "constant-acceleration", "turn", "turn-with-angular-acceleration",
)  # fmt: skip
_OF_MOTION = ("speed", "acceleration", "radius", "heading", "period")
_OF_SENSORS = ("reach", "range_sigma", "bearing_sigma", "sigma", "detection")
_MOST_SENSORS, _MOST_POINTS = 100, 1_000
_SPACINGS = ("dense", "medium", "sparse")


def scenario_state(page: Page) -> dict[str, Any]:
    """The scenario of a page, and what is wrong with its text."""
    session = page.session
    opened = session.texts.scenario
    undo, redo = session.steps
    return {
        "version": page.version,
        "name": opened.name,
        "file": opened.name if is_file(opened.name) else None,
        "saved": session.is_saved("scenario"),
        "undo": undo,
        "redo": redo,
        "text": opened.text,
        "complaints": [
            {"message": c.message, "line": c.line, "column": c.column}
            for c in session.reading.complaints["scenario"]
        ],
        "scenario": scenario_as_json(session.reading.scenario),
        "target": section_of(opened.text, "target"),
        "sensors": section_of(opened.text, "sensors"),
        "sampling": section_of(opened.text, "sampling"),
    }


def scenario(page: Page, given: Arguments) -> Answer:
    """The scenario as it is."""
    return {"state": scenario_state(page)}


def open_scenario(page: Page, given: Arguments) -> Answer:
    """Open a shipped scenario, or a file of the folder."""
    page.session.open("scenario", given.text("name"))
    return _changed(page)


def save_scenario(page: Page, given: Arguments) -> Answer:
    """Save the scenario in the folder."""
    name = given.text("name", page.session.texts.scenario.name, 100)
    name = name if is_file(name) else f"{name}.yaml"
    page.session.save("scenario", name, overwrite=given.flag("overwrite"))
    return _changed(page)


def set_scenario_text(page: Page, given: Arguments) -> Answer:
    """Take the whole text as it is typed; what is wrong with it is in the state."""
    page.session.replace("scenario", given.text("text"))
    return _changed(page)


def set_waypoints(page: Page, given: Arguments) -> Answer:
    """Let the target go through points, at a speed or with a time for each leg."""
    points = given.points("points")
    if not 2 <= len(points) <= _MOST_POINTS:
        raise ValueError(f"points: needs 2 to {_MOST_POINTS} points, got {len(points)}")
    entries: dict[str, Entry] = {"waypoints": points}
    if "speed" in given:
        entries["times"] = waypoint_times(points, given.number("speed"))
    elif "leg" in given:
        entries["leg"] = given.number("leg")
    elif len(points) != _count_of_times(page):
        # The times that are there belong to other points.
        entries["leg"] = _mean_leg(page)
    if "period" in given:
        entries["period"] = given.number("period")
    gesture = page.gesture(given.flag("draft"))
    return _put(page, with_target(page.session.texts.scenario.text, entries), gesture)


def _count_of_times(page: Page) -> int:
    target = section_of(page.session.texts.scenario.text, "target") or {}
    times = target.get("times")
    return len(times) if isinstance(times, list) else 0


def _mean_leg(page: Page) -> float:
    """Time of a leg as it was, s."""
    target = section_of(page.session.texts.scenario.text, "target") or {}
    times, leg = target.get("times"), target.get("leg")
    if isinstance(times, list) and len(times) > 1:
        return float(times[-1] - times[0]) / (len(times) - 1)
    return float(leg) if isinstance(leg, float) else 480.0


def set_motion(page: Page, given: Arguments) -> Answer:
    """Let the target move by one of the maneuvers of the report, with numbers."""
    entries: dict[str, Entry] = {"motion": given.choice("motion", _MOTIONS)}
    entries |= {name: given.number(name) for name in _OF_MOTION if name in given}
    if "start" in given:
        entries["start"] = given.numbers("start")
    if "steps" in given:
        entries["steps"] = float(given.whole("steps", 3, MOST_SCANS))
    return _put(page, with_target(page.session.texts.scenario.text, entries))


def set_sensors(page: Page, given: Arguments) -> Answer:
    """Change the sensor field, or let plain noise be everywhere with ``sigma``."""
    entries: dict[str, Entry] = {}
    if "grid" in given:
        entries["grid"] = float(given.whole("grid", 1, _MOST_SENSORS))
    if "spacing" in given:
        words = given.is_text("spacing")
        spacing = given.choice("spacing", _SPACINGS) if words else given.number("spacing")
        entries["spacing"] = spacing
    if "centre" in given:
        entries["centre"] = given.numbers("centre")
    entries |= {name: given.number(name) for name in _OF_SENSORS if name in given}
    if not entries:
        raise ValueError("grid: give at least one number of the sensors")
    return _put(page, with_sensors(page.session.texts.scenario.text, entries))


def set_sampling(page: Page, given: Arguments) -> Answer:
    """Let the target be seen at other times; regularly without a kind."""
    entries: dict[str, Entry] = {}
    if "kind" in given:
        kind = given.choice("kind", tuple(p for p in PATTERNS if p != "regular"))
        values = given.numbers("value") if given.is_list("value") else given.number("value")
        entries[kind] = values
    if "period" in given:
        entries["period"] = given.number("period")
    return _put(page, with_sampling(page.session.texts.scenario.text, entries))


def _put(page: Page, text: str, gesture: str | None = None) -> Answer:
    """Take a text that loads; another one is refused, and nothing has changed."""
    page.session.edit_scenario(text, gesture)
    return _changed(page)


def _changed(page: Page) -> Answer:
    page.version += 1
    return {"state": scenario_state(page)}


HANDLERS = {
    "scenario": Handler(scenario),
    "open_scenario": Handler(open_scenario, ("name",)),
    "save_scenario": Handler(save_scenario, ("name", "overwrite")),
    "set_scenario_text": Handler(set_scenario_text, ("text",)),
    "set_waypoints": Handler(set_waypoints, ("points", "speed", "leg", "period", "draft")),
    "set_motion": Handler(set_motion, ("motion", *_OF_MOTION, "start", "steps")),
    "set_sampling": Handler(set_sampling, ("kind", "value", "period")),
    "set_sensors": Handler(set_sensors, ("grid", "spacing", "centre", *_OF_SENSORS)),
}
