"""Scenarios from files and texts."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzytrack.errors import ScenarioError
from fuzzytrack.shipped import Shipped
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_reader import ScenarioReader
from fuzzytrack.simulation.scene.files import names_scene
from fuzzytrack.yamltree import Document

__all__ = [
    "as_scenario",
    "load_scenario",
    "loads_scenario",
    "scenario_path",
    "scenario_source",
    "shipped_scenarios",
]

_SHIPPED = Shipped("scenario", "scenarios", "warship.yaml", ScenarioError)


def loads_scenario(text: str | bytes, file: str = "<text>") -> Scenario:
    """Read a scenario from YAML text.

    Parameters
    ----------
    text : str or bytes
        At most 128 KiB; bytes are UTF-8.
    file : str
        Name for messages; files that the scenario names are looked for in its folder.

    Returns
    -------
    Scenario

    Raises
    ------
    ScenarioError
        If the text is not a complete and consistent scenario; names file, line, column, the
        offending word and the allowed words.

    Examples
    --------
    >>> from fuzzytrack.simulation.scenario_files import loads_scenario
    >>> scenario = loads_scenario('''
    ... scenario: 1
    ... name: slow turn
    ... target: {motion: turn, speed: 6, radius: 4500}
    ... sensors: {sigma: 115}
    ... ''')
    >>> scenario.position.shape
    (20, 2)
    """
    return ScenarioReader(Document(text, file, failure=ScenarioError)).scenario()


def load_scenario(name_or_path: str | os.PathLike[str]) -> Scenario:
    """Read a shipped scenario, or a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_scenarios`, or a path: anything that ends in ``.yaml`` or ``.yml``,
        holds a separator or is a path object.

    Returns
    -------
    Scenario

    Raises
    ------
    ScenarioError
        If there is no such name, or the file cannot be read, or is no scenario.
    """
    if isinstance(name_or_path, str) and names_scene(name_or_path):
        raise ScenarioError(
            f"{name_or_path} is a scene of many targets; this needs a scenario with one"
        )
    return ScenarioReader(_SHIPPED.document(name_or_path)).scenario()


def as_scenario(scenario: Scenario | str | os.PathLike[str]) -> Scenario:
    """The scenario itself, or the one of a name or path; see `load_scenario`.

    Raises
    ------
    ScenarioError
        As for `load_scenario`.
    TypeError
        If it is something else.
    """
    if isinstance(scenario, str | os.PathLike):
        return load_scenario(scenario)
    if not isinstance(scenario, Scenario):
        raise TypeError(
            "scenario must be a Scenario, the name of a shipped one or the path of a file, "
            f"got {type(scenario).__name__}"
        )
    return scenario


def scenario_source(name_or_path: str | os.PathLike[str]) -> str:
    """Paper or other source of a scenario, read without making its tracks; see `load_scenario`."""
    return ScenarioReader(_SHIPPED.document(name_or_path)).source()


def shipped_scenarios() -> tuple[str, ...]:
    """Names of the scenarios that come with fuzzytrack, in alphabetical order."""
    return _SHIPPED.names()


def scenario_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a shipped scenario by name, or the path that was given.

    Parameters
    ----------
    name_or_path : str or path
        As for `load_scenario`.

    Returns
    -------
    Path
        The file need not exist if a path was given.

    Raises
    ------
    ScenarioError
        If it is the name of no shipped scenario.
    """
    return _SHIPPED.path(name_or_path)
