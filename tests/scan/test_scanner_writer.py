"""Configurations written as YAML."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_parts import (
    BASE,
    ROLES,
    Bank,
    NoKind,
    Ring,
    Round,
    SmallSensor,
    Unregistered,
    read,
)

from fuzzytrack.errors import ScannerError
from fuzzytrack.scan.scanners.reader import Configuration
from fuzzytrack.scan.scanners.writer import SCHEMA_LINE, dumps_configuration

POSITIVE = st.floats(1e-300, 1e300, allow_nan=False)
NAMES = st.text(st.characters(codec="ascii", categories=("L", "N", "P", "Zs")), min_size=1)
CONFIGURATIONS = st.builds(
    lambda name, description, sensor, gate, kind: Configuration(
        name, description, (("sensor", sensor), ("gate", gate), ("kind", kind))
    ),
    NAMES,
    st.text(st.characters(codec="ascii", categories=("L", "P", "Zs"))),
    st.builds(SmallSensor, POSITIVE, st.floats(0, 1)),
    st.one_of(
        st.builds(Round, POSITIVE, st.sampled_from(["circle", "square"])),
        st.just(Ring()),
    ),
    st.one_of(st.just(NoKind()), st.builds(Bank, st.integers(1, 10**9), NAMES)),
)


@given(CONFIGURATIONS)
def test_it_loads_to_an_equal_one(configuration):
    assert read(dumps_configuration(configuration, ROLES)) == configuration


@given(CONFIGURATIONS)
def test_what_differs_from_another_one_loads_to_an_equal_one(configuration):
    base = read(BASE)
    changed = Configuration(
        configuration.name, configuration.description, configuration.parts, "base"
    )
    assert read(dumps_configuration(changed, ROLES, base)) == changed


def test_what_it_writes():
    configuration = read(BASE + "kind: {part: bank, tracker: imm}\n")
    assert (
        dumps_configuration(configuration, ROLES)
        == f"""\
{SCHEMA_LINE}
scanner: 1
name: base

sensor:
  noise: 2                        # noise of a plot (m)
  detection: 0.8                  # probability of a plot

gate:
  part: round
  radius: 30                      # radius of the circle (m)
  shape: circle                   # what it looks like (circle, square)

kind:
  part: bank
  hits: 3                         # plots before a decision (hits)
  tracker: imm                    # tracker of the hypothesis
"""
    )


def test_it_writes_what_differs():
    changed = read("name: mine\nbased_on: base\ngate: {radius: 1e-7}\nkind: bank\n")
    assert (
        dumps_configuration(changed, ROLES, read(BASE))
        == f"""\
{SCHEMA_LINE}
scanner: 1
name: mine
based_on: base

gate:
  part: round
  radius: 1.0e-07                 # radius of the circle (m)

kind:
  part: bank
  hits: 3                         # plots before a decision (hits)
  tracker: "kalman-cv:sigma_v=1"  # tracker of the hypothesis
"""
    )


def test_a_part_that_is_not_registered_cannot_be_written():
    configuration = read(BASE).with_part("kind", Unregistered())
    with pytest.raises(ScannerError, match="kind Unregistered is not registered"):
        dumps_configuration(configuration, ROLES)
