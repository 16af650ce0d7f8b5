"""Refusals begin with the argument of the message that they are about, under the page's name."""

import shutil

import pytest

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.studio.arguments import Arguments, renamed
from fuzzytrack.studio.folder import Folder
from fuzzytrack.studio.messages import error


@pytest.mark.parametrize(
    ("command", "arguments", "begin"),
    [
        ("surface", {"outputs": ["gamma"]}, "outputs: gamma does not follow from"),
        ("surface", {"outputs": ["x"]}, "outputs: unknown output 'x'"),
        ("surface", {"outputs": ["alpha"], "against": "../x"}, "against: '../x' must be the name"),
        ("surface", {"outputs": ["alpha"], "against": "tipper"}, "against: tipper has inputs"),
        ("set_operator", {"operator": "or", "value": "product"}, "value: unknown or 'product'"),
        ("set_weight", {"row": 0, "column": 0, "weight": 2}, "weight: must be within [0, 1]"),
        ("set_weight", {"row": 0, "column": 0}, "weight: is missing"),
        ("set_rule", {"text": "L-L"}, "index: is missing"),
        ("remove_rule", {}, "index: is missing"),
        ("add_rule", {"if": {}, "then": [{}]}, "then: output: is missing"),
        ("add_rule", {"if": {}, "then": [{"output": 1}]}, "then: output: needs a text"),
        (
            "set_shapes",
            {"variable": "E", "shapes": [{"set": "ze", "parameters": [10**400]}]},
            "shapes: parameters: needs finite numbers",
        ),
        (
            "set_shape",
            {"variable": "x", "set": "ze", "parameters": [1, 2, 3]},
            "unknown variable 'x'; one of E, dE, stiffness, damping",
        ),
        (
            "set_shape",
            {"variable": "E", "set": "ze", "parameters": [-1e301, 0, 1e301]},
            "parameters: must be a list of numbers",
        ),
        ("walk", {"tracker": "../x.yaml"}, "tracker: '../x.yaml' names a file outside"),
        ("tune", {"on": "../x.csv"}, "on: '../x.csv' must be the name of"),
    ],
)
def test_a_refusal_names_an_argument_of_its_command(page, command, arguments, begin):
    page.ask("open", name="stiffness-damping")
    assert page.refused(command, **arguments).startswith(begin)


def test_a_list_of_rules_has_no_rows(page):
    page.ask("open", name="tipper")
    said = page.refused("set_cell", row=0, column=0, text="{tip: cheap}")
    assert said.startswith("row: there is none, the rules are a list")


@pytest.mark.parametrize("command", ["set_waypoints", "set_sensors", "set_motion"])
def test_a_text_without_its_part_cannot_be_edited_in_it(page, command):
    page.ask("set_scenario_text", text="scenario: 1\n")
    arguments = {"set_waypoints": {"points": [[0, 0], [1, 1]]}, "set_motion": {"motion": "turn"}}
    part = "sensors" if command == "set_sensors" else "target"
    found = page.refused(command, **arguments.get(command, {"sigma": 3}))
    assert found == f"the text has no {part} to be changed; mend it first, or undo"
    page.ask("undo")


def test_names_are_those_of_the_page_and_places_stay():
    with pytest.raises(ValueError, match=r"^outputs: must be x$"), renamed(names="outputs"):
        raise ValueError("names: must be x")
    with pytest.raises(ValueError, match=r"^must be: x$"), renamed(names=None):
        raise ValueError("names: must be: x")
    with pytest.raises(ValueError, match=r"^no names here$"), renamed(names="outputs"):
        raise ValueError("no names here")
    place = Location("a.yaml", 3, 4)
    with pytest.raises(RuleBaseError) as caught, renamed(says="text"):
        raise RuleBaseError("says: unknown", place)
    assert (caught.value.message, caught.value.location) == ("text: unknown", place)


def test_arguments_within_a_list_name_the_list():
    (inner,) = Arguments({"then": [{"set": 1}]}).objects("then")
    with pytest.raises(ValueError, match=r"^then: set: needs a text$"):
        inner.text("set")


def test_files_of_the_folder_are_named_without_their_path(tmp_path):
    folder = Folder(tmp_path)
    said = ValueError(f"z: cannot follow load('{tmp_path / 'rules.yaml'}')")
    assert "load('rules.yaml')" in error(1, said, folder.without_path)


def test_a_folder_that_is_gone_is_said_and_may_come_back(tmp_path, new_server):
    path = tmp_path / "folder"
    path.mkdir()
    with new_server(path).page() as page:
        shutil.rmtree(path)
        gone = "the folder folder cannot be read any more: No such file or directory; put it back"
        assert page.refused("files").startswith(gone)
        said = page.refused("save", name="x.yaml")
        assert said == "x.yaml: cannot be saved: there is no folder folder; export the text"
        assert page.ask("set_cell", row=0, column=0, text="L-L")["state"]["undo"] == 1
        path.mkdir()
        assert [each["name"] for each in page.ask("save", name="x.yaml")["files"]] == ["x.yaml"]
