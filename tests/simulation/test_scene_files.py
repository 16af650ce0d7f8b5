"""Scenes as files: what is read, what is refused and where, settings changed behind the name."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import Location, ScenarioError
from fuzzytrack.simulation.scenario_files import load_scenario
from fuzzytrack.simulation.scene import (
    CLUTTER,
    OwnShip,
    Radar,
    Region,
    ScanTimes,
    Scene,
    Shoreline,
    TargetGroup,
    UniformClutter,
    as_scene,
    load_scene,
    loads_scene,
    shipped_scenes,
    simulate_scans,
)
from fuzzytrack.simulation.scene.files import names_scene, scene_path, scene_source
from fuzzytrack.simulation.scene.schema import dumps_scene_schema, scene_schema, setting_rows
from fuzzytrack.simulation.scene.settings import settings_of

TEXT = """\
scenario: 1
name: bay
source: our own
scans: {count: 20, period: 2.5, antenna: at-once}
own: {at: [10, 20], speed: 3, course: 90}
radar:
  reach: [50, 5000]
  sigma_range: 5
  sigma_bearing: 0.2
  detection: [[0, 0.9], [5000, 0.5]]
  beam: 2
  range_cell: 30
region: {disc: [100, 4000], sector: [0, 180]}
traffic:
  boats:
    count: 10
    speed: [2, 8]
    turn_rate: 1
    leaves: yes
    within: {square: 500, at: [800, 0]}
  tug: {path: [[0, 100, 0], [50, 200, 0]], size: 20}
clutter:
  sea: {kind: uniform, count: 15}
  quay:
    kind: shoreline
    line: [[0, 0], [100, 50]]
    window: 90
"""


def refused(text, **changed):
    with pytest.raises(ScenarioError) as error:
        loads_scene(text, "bay.yaml", changed or None)
    return str(error.value)


def test_a_scene_is_read_with_angles_in_degrees():
    scene = loads_scene(TEXT)
    assert scene.name == "bay"
    assert scene.source == "our own"
    assert scene.scans == ScanTimes(count=20, period=2.5, antenna="at-once")
    assert scene.own == OwnShip(at=(10, 20), speed=3, course=math.pi / 2)
    assert scene.radar == Radar(
        reach=(50, 5000),
        sigma_range=5,
        sigma_bearing=math.radians(0.2),
        detection=((0, 0.9), (5000, 0.5)),
        beam=math.radians(2),
        range_cell=30,
    )
    assert scene.region == Region(disc=(100, 4000), sector=(0, math.pi))
    assert dict(scene.traffic) == {
        "boats": TargetGroup(
            count=10,
            speed=(2, 8),
            turn_rate=math.radians(1),
            leaves="yes",
            within=Region(square=500, at=(800, 0)),
        ),
        "tug": TargetGroup(path=((0, 100, 0), (50, 200, 0)), size=20),
    }
    assert dict(scene.clutter) == {
        "sea": UniformClutter(count=15),
        "quay": Shoreline(line=((0, 0), (100, 50)), window=math.pi / 2),
    }


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("sigma_range: 5", "sigma_rnge: 5", "8:3: unknown key in radar: 'sigma_rnge'; did you "),
        ("sigma_range: 5", "sigma_range: -5", "8:16: sigma_range must be a number >= 0, got -5"),
        ("sigma_range: 5", "sigma_range: abc", "8:16: sigma_range must be a finite number, not "),
        ("sigma_range: 5", "sigma_range: [5]", "8:16: sigma_range must be "),
        ("0.9]", "1.9]", "10:19: detection must be a number >= 0 and <= 1, got 1.9"),
        ("0.9]", "0.9, 3]", "10:15: detection must be pairs of numbers, got 3"),
        ("[5000, 0.5]", "[0, 0.5]", "10:14: detection must be pairs whose first numbers increase"),
        ("beam: 2", "beam: 200", "11:9: beam must be a number >= 0 and <= 180 (degrees), got 200"),
        ("[50, 5000]", "[5000, 50]", "7:10: reach must be the least number and the largest"),
        ("[50, 5000]", "[5, 6, 7]", "7:10: reach must be a number or two, the least and the la"),
        ("at-once", "once", "4:42: unknown antenna 'once'; did you mean 'at-once'? allowed: turn"),
        ("count: 20", "count: 2.5", "4:16: count must be a whole number >= 1 and <= 100000, got"),
        ("period: 2.5, ", "", "4:8: scans lacks the key 'period'"),
        ("disc: [100, 4000]", "disk: 4", "13:10: unknown key in region: 'disk'; did you mean 'di"),
        ("{disc: [100, 4000], s", "{square: 4, s", "13:29: sector must be a part of a disc" ),
        ("[0, 180]", "[0, 400]", "13:37: sector must be a part of a disc, more than 0 and at mo"),
        ("leaves: yes", "leaves: maybe", "19:13: unknown leaves 'maybe'; allowed: no, yes"),
        ("{square: 500, at", "{square: 0, at", "20:22: square must be a number > 0, got 0"),
        ("size: 20", "speed: 3", "21:51: speed has no meaning beside path"),
        ("[50, 200, 0]", "[0, 2, 0]", "21:15: path must have increasing times"),
        ("[50, 200, 0]", "[0, 2]", "21:15: path must have 3 numbers in a row, got 2"),
        ("[[0, 100, 0], [50, 200, 0]]", "3", "21:15: path must be a list, not '3'"),
        ("kind: uniform", "kind: unform", "23:15: unknown kind of clutter 'unform'; did you mea"),
        ("kind: uniform, ", "", "23:8: the clutter 'sea' lacks the key 'kind'; kinds: uniform"),
        ("count: 15}", "count: 15, density: 1}", "23:31: count or density must be given, and n"),
        ("window: 90", "window: 0", "27:13: window must be a number > 0 and <= 360 (degrees), "),
        ("[[0, 0], [100, 50]]", "[[0, 0]]", "26:11: line must have two different points"),
        ("scenario: 1\n", "", "1:1: the scene lacks its format version, 'scenario: 1'"),
        ("scenario: 1", "scenario: 2", "1:11: unknown format version '2'; allowed: 1"),
        ("traffic:", "trafic:", "14:1: unknown key in the scene: 'trafic'; did you mean 'traffic'"),
        ("own:", "target: 3\nown:", "5:1: target is that of a scenario with one target; a scene h"),
        ("  sea: {kind", "  sea: [kind", "23:8: not YAML: '[' is closed by no ']'"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_with_its_place(old, new, message):
    assert TEXT.count(old) == 1, old
    assert refused(TEXT.replace(old, new)).startswith(f"bay.yaml:{message}")


def test_a_scene_without_a_region_needs_a_reach_with_an_end():
    text = re.sub(r"region: .*\n", "", TEXT)
    assert loads_scene(text).surroundings == Region(disc=(50, 5000), at=(10, 20))
    text = text.replace("  reach: [50, 5000]\n", "")
    assert "region must be given, unless the reach of the radar has an end" in refused(text)


# -------------------------------------------------------------------- settings behind the name


@pytest.mark.parametrize(
    ("path", "text", "found"),
    [
        ("radar.detection", "0.8", lambda s: s.radar.detection == ((0, 0.8),)),
        ("radar.detection", "[[0, 1], [9, 0.5]]", lambda s: s.radar.detection[1] == (9, 0.5)),
        ("scans.lost", "0.1", lambda s: s.scans.lost == 0.1),
        ("own.course", "180", lambda s: s.own.course == math.pi),
        ("traffic.boats.within.square", "9", lambda s: s.traffic["boats"].within.square == 9),
        ("traffic.boats", "{count: 3}", lambda s: s.traffic["boats"].count == 3),
        ("clutter.sea.count", "0", lambda s: s.clutter["sea"].count == 0),
        ("clutter.rain.kind", "groups", None),
        ("region", "{square: 70}", lambda s: s.region.square == 70),
    ],
)
def test_settings_are_changed_by_their_path(path, text, found):
    if found is None:
        # One path cannot give all that a new part needs.
        assert refused(TEXT, **{path: text}) == (
            f"{path}={text}: groups clutter lacks the key 'births'"
        )
        return
    before, after = loads_scene(TEXT), loads_scene(TEXT, changed={path: text})
    assert found(after)
    assert not found(before)


@pytest.mark.parametrize(
    ("path", "text", "message"),
    [
        ("radar.detection", "1.5", "detection must be a number >= 0 and <= 1, got 1.5"),
        ("radar.detect", "1", "unknown key in radar: 'detect'; did you mean 'detection'?"),
        ("radar.reach.least", "1", "radar.reach has no settings of its own"),
        ("radr.reach", "1", "unknown setting 'radr'; did you mean 'radar'? allowed: source, scans"),
        ("traffic.boats", "3", "the targets 'boats' must be a mapping, 'word: value', not '3'"),
        ("radar..reach", "3", "a name is missing between two points"),
        ("radar.reach", "3}, a: {b: 3", "text after the end"),
        ("radar.reach", "[3", "'[' is closed by no ']'"),
        ("radar.reach", "", "reach must be a finite number, not nothing"),
    ],
)
def test_a_wrong_setting_has_no_place_in_the_file(path, text, message):
    told = refused(TEXT, **{path: text})
    assert told.startswith(f"{path}={text}: ")
    assert message in told


def test_a_change_leaves_what_an_alias_repeats():
    text = TEXT.replace("boats:", "boats: &boats").replace("  tug:", "  others: *boats\n  tug:")
    changed = loads_scene(text, changed={"traffic.others.count": "3"})
    assert changed.traffic["boats"].count == 10
    assert changed.traffic["others"].count == 3


def test_names_and_paths(tmp_path):
    scene = load_scene("dense-traffic:traffic.ships.count=50:radar.detection=0.5")
    assert scene.traffic["ships"].count == 50
    assert scene.surroundings.area == pytest.approx(50 * 5000)
    assert scene.radar.detection == ((0, 0.5),)
    file = tmp_path / "bay.yaml"
    file.write_text(TEXT)
    assert load_scene(file).name == load_scene(f"{file}:scans.count=3").name == "bay"
    assert load_scene(f"{file}:scans.count=3").scans.count == 3
    assert as_scene(scene) is scene
    assert as_scene("harbor").name == "harbor"
    assert scene_source(file) == "our own"
    assert scene_source("harbor:scans.count=3").startswith("our own")
    assert scene_path(f"{file}:scans.count=3") == file
    assert names_scene(file)
    assert names_scene("harbor:scans.count=3")
    assert not names_scene("warship")
    assert not names_scene("harbor:scans.count=3:scans.count=4")
    assert not names_scene(tmp_path / "none.yaml")
    with pytest.raises(ScenarioError, match=r"parameter 'scans\.count' is given twice"):
        load_scene("harbor:scans.count=3:scans.count=4")
    with pytest.raises(ScenarioError, match="unknown scene 'harbur'; did you mean 'harbor'"):
        load_scene("harbur")
    with pytest.raises(TypeError, match="scene must be a Scene"):
        as_scene(3)
    with pytest.raises(ScenarioError, match="harbor is a scene of many targets; this needs"):
        load_scenario("harbor")


# -------------------------------------------------------------------- what is shipped


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_shipped_scene_is_simulated(name):
    scene = load_scene(name)
    assert scene.name == name
    assert scene.source
    found = simulate_scans(scene, seed=1)
    truth = found.truth
    assert len(found.scans) == scene.scans.count
    assert (truth.plot >= 0).mean() > 0.5
    assert 0.1 < (found.target_id == 0).mean() < 0.9
    places = np.concatenate([each.positions for each in found.scans])
    seen = truth.plot >= 0
    fastest = np.hypot(*truth.velocity.T).max()
    # Nowhere is a plot farther off than a merged pair, noise, and the motion in a scan explain.
    off = np.hypot(*(places[truth.plot] - truth.position)[seen].T)
    distance = np.hypot(*truth.position[seen].T) + 200
    radar = scene.radar
    noise = 6 * (radar.sigma_range + radar.sigma_position + radar.sigma_bearing * distance)
    cells = 4 * (radar.range_cell + radar.beam * distance) + 30
    assert (off < noise + cells + fastest * scene.scans.period).all()


def test_coastal_traffic_is_that_of_the_study():
    found = simulate_scans(load_scene("coastal-traffic"), seed=1)
    truth = found.truth
    assert found.truth.n_targets == 200
    start = np.hypot(*truth.position[:200].T)
    assert start.min() > 1480
    assert start.max() < 20_040
    speed = np.hypot(*truth.velocity.T)
    assert 4 <= speed.min() < speed.max() <= 12
    assert (truth.plot >= 0).mean() == pytest.approx(0.95, abs=4 * math.sqrt(0.0475 / 60_000))
    assert (found.target_id == 0).sum() / 300 == pytest.approx(50, abs=4 * math.sqrt(50 / 300))


# -------------------------------------------------------------------- schema


def test_the_schema_allows_what_is_shipped_and_refuses_typos():
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(dumps_scene_schema())
    jsonschema.Draft202012Validator.check_schema(schema)
    check = jsonschema.Draft202012Validator(schema)
    texts = [scene_path(name).read_text() for name in shipped_scenes()]
    for text in (TEXT, *texts):
        assert not [error.message for error in check.iter_errors(yaml.safe_load(text))]
    for old, new in (
        ("sigma_range: 5", "sigma_rnge: 5"),
        ("0.9]", "1.9]"),
        ("beam: 2", "beam: 200"),
        ("kind: uniform", "kind: unform"),
        ("leaves: yes", "leaves: maybe"),
        ("{square: 500, at", "{disc: 3, square: 500, at"),
        ("count: 20", "count: 2.5"),
        ("[50, 200, 0]", "[50, 200]"),
    ):
        assert not check.is_valid(yaml.safe_load(TEXT.replace(old, new))), new


def test_tables_of_settings_have_every_setting_with_unit_and_default():
    for part in (Radar, ScanTimes, OwnShip, Region, TargetGroup, *CLUTTER.values()):
        rows = setting_rows(part)
        assert [row[0] for row in rows] == list(settings_of(part))
    rows = {row[0]: row[1:] for row in setting_rows(TargetGroup)}
    assert rows["turn"][1:] == ("a number > 0, or two (degrees)", "[30, 90]")
    assert rows["speed"][1:] == ("a number >= 0, or two (m/s)", "0")
    assert rows["leaves"][1:] == ("`no` or `yes`", "no")
    assert rows["life"][2] == ""
    rows = {row[0]: row[1:] for row in setting_rows(ScanTimes)}
    assert rows["count"][1:] == ("a whole number >= 1 and <= 100000", "required")


# -------------------------------------------------------------------- any values


def numbers(declared):
    """Numbers that a setting allows, as they stand in a file."""
    limits = declared.limits_in_file()
    low = max(limits.least, -1e6)
    high = min(limits.most, 1e6 if limits.whole is False else 1000)
    if limits.whole:
        return st.integers(int(low), int(high))
    return st.floats(low, high, exclude_min=limits.above, exclude_max=limits.below)


def values(declared):
    """Values that a setting allows, as they stand in a file."""
    each = numbers(declared)
    forms = {
        "number": each,
        "whole": each,
        "interval": st.lists(each, min_size=2, max_size=2).map(sorted),
        "point": st.lists(each, min_size=2, max_size=2),
        "curve": each,
        "word": st.sampled_from(declared.words or ("",)),
    }
    return forms[declared.form]


@pytest.mark.untraced
@given(data=st.data())
def test_what_is_written_is_read(data):
    """Any allowed values of the radar and of the scans are read as they were written."""
    for role, part, needed in (
        ("radar", Radar, {"reach"}),
        ("scans", ScanTimes, {"count", "period"}),
    ):
        chosen = {
            name: data.draw(values(declared), name)
            for name, declared in settings_of(part).items()
            if name in needed or data.draw(st.booleans())
        }
        content = yaml.safe_load(TEXT)
        content[role] = chosen
        scene = loads_scene(json.dumps(content))
        for name, value in chosen.items():
            declared = settings_of(part)[name]
            read = getattr(getattr(scene, role), name)
            if declared.form == "word":
                assert read == value
                continue
            written = np.array(value) * declared.in_file
            read = read[0][1] if declared.form == "curve" else read
            np.testing.assert_allclose(read, written, rtol=1e-12)


@given(st.text(max_size=40), st.integers(0, len(TEXT)), st.integers(0, 30))
def test_any_text_is_read_or_refused(inserted, at, removed):
    text = TEXT[:at] + inserted + TEXT[at + removed :]
    found = None
    try:
        found = loads_scene(text)
    except ScenarioError as error:
        found = error.location
    assert isinstance(found, Scene | Location)


def test_the_schema_has_every_kind_of_clutter():
    kinds = scene_schema()["properties"]["clutter"]["additionalProperties"]["oneOf"]
    assert [each["properties"]["kind"]["const"] for each in kinds] == list(CLUTTER)


def test_the_example_of_the_page_is_read_and_its_error_is_the_one_shown():
    page = (Path(__file__).parents[2] / "docs" / "scenes.md").read_text("utf-8")
    text, *_ = re.findall(r"```yaml\n(.*?)```", page, flags=re.S)
    assert simulate_scans(loads_scene(text)).truth.n_targets > 10
    (shown,) = re.findall(r"```text\n(bay.yaml.*)\n```", page)
    assert refused(text.replace("0.95", "1.95")) == shown
    (table,) = re.findall(r"\| Scene \| Is \|\n\|---\|---\|\n(.*?)\n\n", page, flags=re.S)
    assert sorted(re.findall(r"^\| `([\w-]+)`", table, flags=re.M)) == list(shipped_scenes())
