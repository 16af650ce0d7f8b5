"""Shipped configurations, files and texts that name a scan tracker."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft202012Validator

from fuzzytrack.errors import ScannerError
from fuzzytrack.scan.part import declared
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners import (
    as_scanner,
    dumps_scanner,
    load_scanner,
    loads_scanner,
    make_scanner,
    save_scanner,
    scanner_path,
    shipped_scanners,
)
from fuzzytrack.scan.scanners.copying import new_configuration
from fuzzytrack.scan.scanners.loading import load_configuration
from fuzzytrack.scan.scanners.numbers import declarations, values, with_values
from fuzzytrack.scan.scanners.roles import MEANINGS, ROLES, parts
from fuzzytrack.scan.scanners.schema import dumps_scanner_schema, scanner_schema
from fuzzytrack.scan.sensor import Sensor

SCHEMA = scanner_schema(Sensor, ROLES, MEANINGS)


# -------------------------------------------------------------------- what is shipped


def test_the_roles_are_those_of_the_tracker():
    assert tuple(ROLES) == ScanTracker.roles()


def test_the_default_is_the_tracker_without_arguments():
    assert load_scanner("default") == ScanTracker()


@pytest.mark.parametrize("name", shipped_scanners())
def test_shipped_ones_are_named_as_their_files_and_say_what_they_are_for(name):
    configuration = load_configuration(name)
    assert configuration.name == name
    assert configuration.description


@pytest.mark.parametrize("name", shipped_scanners())
def test_shipped_ones_are_valid(name):
    Draft202012Validator(SCHEMA).validate(yaml.safe_load(scanner_path(name).read_text()))


@pytest.mark.parametrize("name", shipped_scanners())
def test_every_number_of_shipped_ones_has_a_comment_with_its_unit(name):
    """A unit is written as the part declares it."""
    configuration, found = load_configuration(name), {}
    role = ""
    for line in scanner_path(name).read_text().splitlines():
        if top := re.match(r"(\w+):", line):
            role = top[1]
        elif entry := re.match(r"  (\w+): \S+ +# (.+)", line):
            found[f"{role}.{entry[1]}"] = entry[2]
        elif entry := re.match(r"  (\w+):", line):
            assert entry[1] == "part", f"{role}.{entry[1]} lacks a comment"
    known = declarations(configuration)
    assert configuration.based_on or found.keys() == known.keys()
    for key, comment in found.items():
        unit = getattr(known[key], "unit", "")
        assert unit in comment, f"{name}: {key} has the unit {unit}"
        assert len(comment) > len(unit) + 5


@pytest.mark.parametrize("name", shipped_scanners())
def test_shipped_ones_are_written_and_read(name):
    tracker = load_scanner(name)
    assert loads_scanner(dumps_scanner(tracker, "For a test.")) == tracker
    assert loads_scanner(dumps_scanner(tracker, based_on="default")) == tracker


def test_the_schema_that_is_shipped_is_the_generated_one():
    shipped = scanner_path("default").with_name("scanner.schema.json").read_text(encoding="utf-8")
    assert shipped == dumps_scanner_schema(Sensor, ROLES, MEANINGS), (
        "write it anew: fuzzytrack scanner schema -o scanners/scanner.schema.json"
    )
    Draft202012Validator.check_schema(json.loads(shipped))


# -------------------------------------------------------------------- by name


def test_numbers_can_be_changed_behind_the_name():
    found = make_scanner("default:clutter.cell=20:sensor.detection=.8")
    default = ScanTracker()
    assert found == replace(
        default,
        clutter=replace(default.clutter, cell=20.0),
        sensor=replace(default.sensor, detection=0.8),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("default:clutter.cel=20", "no number 'clutter.cel'; did you mean 'clutter.cell'?"),
        ("default:clutter.cell=0", r"clutter.cell must be a number > 0 \(m\), not 0.0"),
        ("default:sensor.detection=1.2", "sensor.detection must be a number > 0 and < 1"),
        ("default:clutter.cell=far", "not 'far'"),
        ("default:clutter.cell", "'clutter.cell' changes no number; expected role.number=value"),
        ("default:clutter.cell=1:clutter.cell=2", "given twice"),
        ("defalt", "unknown configuration 'defalt'; did you mean 'default'?"),
    ],
)
def test_a_text_that_names_none_is_refused(text, message):
    with pytest.raises(ValueError, match=message):
        make_scanner(text)


def test_a_number_that_does_not_fit_the_part_is_refused():
    with pytest.raises(ValueError, match="side must be a power of 2"):
        make_scanner("default:clutter.side=1000")


def test_what_takes_a_tracker_takes_its_name(tmp_path):
    tracker = replace(ScanTracker(), name="mine")
    save_scanner(tracker, tmp_path / "mine.yaml")
    for each in (tracker, tmp_path / "mine.yaml", str(tmp_path / "mine.yaml")):
        assert as_scanner(each) == tracker
    with pytest.raises(TypeError, match="got int"):
        as_scanner(3)


def test_values_of_a_configuration():
    configuration = load_configuration("default")
    found = values(configuration)
    assert found["clutter.cell"] == 31.0
    assert found.keys() == declarations(configuration).keys()
    assert with_values(configuration, found) == configuration


# -------------------------------------------------------------------- files that change others


def chain(folder, number):
    """Files of which each is based on the next one."""
    for k in range(number):
        base = f"./{k + 1}.yaml" if k < number - 1 else "default"
        (folder / f"{k}.yaml").write_text(f"name: number {k}\nbased_on: {base}\n")
    return folder / "0.yaml"


def test_a_file_is_based_on_a_file_beside_it(tmp_path, monkeypatch):
    (tmp_path / "base.yaml").write_text("name: b\nbased_on: default\nclutter: {cell: 20}\n")
    mine = tmp_path / "mine.yaml"
    mine.write_text("name: mine\nbased_on: base.yaml\nsensor: {detection: .8}\n")
    monkeypatch.chdir("/")
    found = load_scanner(mine)
    assert (found.clutter.cell, found.sensor.detection) == (20.0, 0.8)


def test_chains_of_files_are_bounded(tmp_path):
    assert load_scanner(chain(tmp_path, 8)) == replace(ScanTracker(), name="number 0")
    with pytest.raises(ScannerError, match="more than 8 files are based on one another"):
        load_scanner(chain(tmp_path, 12))
    (tmp_path / "self.yaml").write_text("name: a\nbased_on: self.yaml\n")
    with pytest.raises(ScannerError, match=r"self.yaml:2:11: based_on: .* a circle: .*, .*self"):
        load_scanner(tmp_path / "self.yaml")


def test_a_mistake_in_the_base_has_its_place_there(tmp_path):
    (tmp_path / "base.yaml").write_text("name: b\nbased_on: default\nclutter: {cel: 20}\n")
    (tmp_path / "mine.yaml").write_text("name: mine\nbased_on: base.yaml\n")
    with pytest.raises(ScannerError, match=r"base.yaml:3:11: .*did you mean 'cell'"):
        load_scanner(tmp_path / "mine.yaml")


# -------------------------------------------------------------------- new ones


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("name", shipped_scanners())
def test_a_new_one_is_what_it_begins_with(tmp_path, name, whole):
    path = tmp_path / "mine.yaml"
    path.write_text(new_configuration(name, str(path), whole=whole))
    found = load_configuration(path)
    assert found.parts == load_configuration(name).parts
    assert (found.name, found.based_on) == ("mine", "" if whole else name)


def test_a_new_one_may_begin_with_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("base.yaml").write_text("name: b\nbased_on: default\nclutter: {cell: 20}\n")
    Path("below").mkdir()
    for whole in (False, True):
        Path("below/mine.yaml").write_text(
            new_configuration("base.yaml", "below/mine.yaml", whole=whole)
        )
        assert load_configuration("below/mine.yaml").part("clutter").cell == 20.0


# -------------------------------------------------------------------- parts


@pytest.mark.parametrize("part", parts(), ids=lambda each: f"{each.role}-{each.name}")
def test_every_part_says_what_it_does_and_what_its_numbers_mean(part):
    assert (part.kind.__doc__ or "").strip()
    assert part.package == "fuzzytrack"
    for key, told in part.numbers().items():
        assert told["meaning"]
        assert declared(part.kind)[key].allows(told["default"])
