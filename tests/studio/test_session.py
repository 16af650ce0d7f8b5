"""A session without a browser."""

import json

import pytest

from fuzzytrack.errors import FileError, RuleBaseError, ScenarioError
from fuzzytrack.studio.folder import Folder, FolderError
from fuzzytrack.studio.session import Session

WHERE = {"E": "ze", "dE": "ze"}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "files").mkdir()
    return Folder(tmp_path / "files")


def shown(session):
    return session.explain({"E": 0, "dE": 0})["rules"][0]["then"][0]["set"]


def test_edits_are_drawn_undone_and_made_again():
    session = Session()
    first = session.texts.rules.text
    assert session.do("cell", {"where": WHERE, "says": "S-S"}) == ()
    assert shown(session) == "S"
    for width in (0.2, 0.3):
        shape = {"variable": "E", "set": "ze", "parameters": [-width, 0, width]}
        assert session.do("shape", shape, gesture="drag") == (("dE", "ze"),)
    assert session.steps == (2, 0)
    assert session.undo()
    assert session.undo()
    assert session.texts.rules.text == first
    assert shown(session) == "L"
    assert not session.undo()
    assert session.redo()
    assert shown(session) == "S"
    assert session.steps == (1, 1)


def test_a_refused_edit_changes_nothing():
    session = Session()
    before = session.texts, session.steps
    with pytest.raises(RuleBaseError, match="unknown set of stiffness 'X'"):
        session.do("cell", {"where": WHERE, "says": "X-L"})
    with pytest.raises(RuleBaseError, match="is used by the rules"):
        session.do("remove-set", {"variable": "damping", "set": "L"})
    assert (session.texts, session.steps) == before


def test_a_text_that_does_not_load_keeps_the_last_rule_base():
    session = Session()
    text = session.texts.rules.text
    session.replace("rules", text.replace("nl: [S-L, M-L", "nl: [S-L, M-X"))
    (complaint,) = session.reading.complaints["rules"]
    assert complaint.cell == {"E": "nm", "dE": "nl"}
    assert session.texts.rules.text != text
    assert session.surfaces(["alpha"], 5).values["alpha"].shape == (5, 5)
    with pytest.raises(FileError, match=r"does not load: unknown set of damping 'X'.*or undo"):
        session.do("cell", {"where": WHERE, "says": "L-L"})
    session.undo()
    assert session.reading.complaints["rules"] == ()
    with pytest.raises(ValueError, match="text: is longer than 128 KiB"):
        session.replace("rules", "x" * 200_000)
    with pytest.raises(ValueError, match="kind: must be one of rules, scenario, got 'x'"):
        session.replace("x", "")


def test_scenarios():
    session = Session(scenario="waypoints")
    assert session.reading.scenario.position.shape[-1] == 2
    name = session.reading.scenario.name
    session.replace("scenario", session.texts.scenario.text.replace("sigma: 115", "sigma: -1"))
    (complaint,) = session.reading.complaints["scenario"]
    assert list(complaint.path[:2]) == ["sensors", "sigma"]
    assert session.reading.scenario.name == name
    session.undo()
    assert session.reading.complaints["scenario"] == ()


def test_values_of_either_text():
    session = Session(scenario="waypoints")
    first = session.texts
    place = {"kind": "scenario", "path": ["target", "waypoints", 2]}
    session.do("set-value", {**place, "value": [4100, 1800]}, gesture="drag")
    session.do("set-value", {**place, "value": [4200, 1900.5]}, gesture="drag")
    expected = first.scenario.text.replace("[4000, 1800]", "[4200, 1900.5]")
    assert session.texts.scenario.text == expected
    session.do("insert-value", {**place, "value": [3000, 1000]})
    assert "[3000, 1000], [4200, 1900.5]" in session.texts.scenario.text
    session.do("remove-value", place)
    assert session.texts.scenario.text == expected
    session.do("set-value", {"kind": "rules", "path": ["scheduler", "period"], "value": 60})
    assert dict(session.reading.rules.scheduler)["period"] == "60"
    with pytest.raises(ScenarioError, match="sigma"):
        session.do("set-value", {"kind": "scenario", "path": ["sensors", "sigma"], "value": -1})
    with pytest.raises(ScenarioError, match="none was given at the start"):
        session.do("set-value", {"kind": "scenario", "path": ["trackers", 1], "value": "../a.yaml"})
    with pytest.raises(ValueError, match="kind: must be one of"):
        session.do("set-value", {"path": ["name"], "value": 1})
    assert session.texts.scenario.text == expected
    while session.undo():
        pass
    assert session.texts == first


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("  - chan-style\n", "  - ../secret.yaml\n"),
        ("  - chan-style\n", "  - /etc/secret\n"),
        ("  - chan-style\n", "  - fuzzy:rules=../a.yaml\n"),
        ("  motion: turn\n", "  file: ../secret.csv\n"),
    ],
)
def test_scenarios_name_files_of_the_folder_only(folder, old, new):
    session = Session(folder)
    assert session.texts.scenario.text.count(old) == 1
    session.replace("scenario", session.texts.scenario.text.replace(old, new))
    (complaint,) = session.reading.complaints["scenario"]
    assert "must be the name of a file" in complaint.message
    assert complaint.line


def test_files(folder):
    session, other = Session(folder), Session(folder)
    assert session.is_saved("rules")
    session.do("cell", {"where": WHERE, "says": "S-S"})
    assert not session.is_saved("rules")
    with pytest.raises(FolderError, match="must be the name of a file that ends in"):
        session.save("rules")
    session.save("rules", "mine.yaml")
    assert session.texts.rules.name == "mine.yaml"
    assert session.is_saved("rules")
    other.open("rules", "mine.yaml")
    other.do("cell", {"where": WHERE, "says": "M-M"})
    other.save("rules")
    session.do("cell", {"where": WHERE, "says": "Z-Z"})
    with pytest.raises(FolderError, match="has been changed since"):
        session.save("rules")
    with pytest.raises(FolderError, match="exists already"):
        Session(folder).save("rules", "mine.yaml")
    session.save("rules", overwrite=True)
    assert shown(Session(folder, rules="mine.yaml")) == "Z"
    with pytest.raises(FolderError, match="cannot be opened"):
        session.open("rules", "none.yaml")
    with pytest.raises(FolderError, match="none was given"):
        Session().save("rules", "mine.yaml")


def test_what_another_session_has_saved_is_not_lost(folder):
    session, other = Session(folder), Session(folder)
    session.save("rules", "mine.yaml")
    session.do("cell", {"where": WHERE, "says": "S-S"})
    session.save("rules")
    session.undo()
    session.save("rules")  # over what was saved here
    other.open("rules", "mine.yaml")
    other.do("cell", {"where": WHERE, "says": "M-M"})
    other.save("rules")
    # Neither a look at the file, nor to open it and go back, is leave to replace it.
    session.surfaces(["alpha"], 3, less="mine.yaml")
    with pytest.raises(FolderError, match="has been changed since"):
        session.save("rules")
    session.open("rules", "mine.yaml")
    session.undo()
    with pytest.raises(FolderError, match="has been changed since"):
        session.save("rules")
    session.autosave()
    third = Session(folder, key="3")
    third.restore("0")
    with pytest.raises(FolderError, match="has been changed since"):
        third.save("rules")
    session.redo()
    session.save("rules")
    assert shown(session) == "M"


def test_differences(folder):
    session = Session(folder)
    session.do("cell", {"where": WHERE, "says": "Z-L"})
    found = session.surfaces(["stiffness"], 5, less="saved").values["stiffness"]
    assert found[2, 2] == pytest.approx(-0.1)
    assert abs(found).sum() == pytest.approx(0.1)
    wide = session.surfaces(["alpha"], 5, less="stiffness-damping-wide")
    assert abs(wide.values["alpha"]).max() > 0.1
    session.save("rules", "mine.yaml")
    assert not session.surfaces(["alpha"], 5, less="saved").values["alpha"].any()
    assert not session.surfaces(["alpha"], 5, less="mine.yaml").values["alpha"].any()


def test_drafts(folder):
    session = Session(folder, key="a1")
    # What is shipped needs no draft.
    assert not session.autosave()
    session.do("cell", {"where": WHERE, "says": "S-S"})
    assert session.autosave()
    assert not session.autosave()
    other = Session(folder, key="a2")
    other.restore("a1")
    assert other.texts == session.texts
    assert shown(other) == "S"
    assert other.undo()
    session.save("rules", "drafted.yaml")
    assert not session.autosave()
    assert folder.drafts() == ()
    for damaged in ("{", "[]", '{"rules": 3}', json.dumps({"rules": {"name": 1, "text": "x"}})):
        folder.save_draft("a1", damaged)
        with pytest.raises(FolderError, match="draft a1: is damaged"):
            other.restore("a1")
    assert not Session().autosave()


@pytest.mark.parametrize("at", [{}, {"E": 0}, {"E": 0, "dE": "x"}, {"E": 0, "dE": float("nan")}])
def test_points_are_checked(at):
    with pytest.raises(ValueError, match="at: must give a number for E, dE; got"):
        Session().explain(at)
