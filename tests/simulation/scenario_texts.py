"""Texts of scenarios, loaded, and what is complained of."""

import pytest

from fuzzytrack.errors import ScenarioError
from fuzzytrack.simulation.scenario_files import (
    loads_scenario,
)

HEAD = "scenario: 1\nname: a test\n"


SENSORS = "sensors: {sigma: 10}\n"


TARGET = "target: {maneuver: M1}\n"


def with_target(text):
    return loads_scenario(f"{HEAD}target: {text}\n{SENSORS}")


def with_sensors(text, target="{maneuver: M1}"):
    return loads_scenario(f"{HEAD}target: {target}\nsensors: {text}\n").sensors


def complaint(text):
    with pytest.raises(ScenarioError) as caught:
        loads_scenario(text, "s.yaml")
    assert "\n" not in str(caught.value)
    return str(caught.value)
