"""Edits, files and surfaces as a page asks for them."""

import numpy as np
import pytest

from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase
from fuzzytrack.fuzzy.norms import T_NORMS
from fuzzytrack.fuzzy.system import FuzzySystem


def test_a_new_page_has_all_that_it_shows(page):
    found = page.hello
    assert found["state"]["name"] == "stiffness-damping"
    rules = found["state"]["rulebase"]
    assert [v["name"] for v in rules["inputs"]] == ["E", "dE"]
    assert rules["inputs"][0]["shared_with"] == ["dE"]
    table = rules["rules"]
    assert (table["columns"], table["rows"], len(table["cells"])) == ("E", "dE", 7)
    cell = table["cells"][0][0]
    assert set(cell["consequents"]) == {"stiffness", "damping"}
    assert (cell["weight"], rules["gains"]) == (1.0, True)
    assert rules["surfaces"] == ["stiffness", "damping", "alpha", "beta"]
    assert rules["operators"]["and"] == {"value": "product", "choices": list(T_NORMS)}
    assert found["scenario"]["scenario"]["axes"] == 2
    assert {"turn", "llinas-m1"} <= {each["name"] for each in found["scenarios"]}
    assert "stiffness-damping" in found["shipped"]
    trackers = {each["name"]: each for each in found["trackers"]}
    assert {"name": "alpha", "default": None, "help": ""} in trackers["fixed"]["parameters"]
    assert found["limits"]["runs"] == 100_000
    assert {"set_shapes", "paired", "certify"} <= set(found["commands"])


def test_edits_change_the_text_and_can_be_undone(page):
    before = page.hello["state"]["text"]
    found = page.ask("set_cell", row=0, column="nm", text="S-L@0.5")["state"]
    cell = found["rulebase"]["rules"]["cells"][0][1]
    assert (cell["text"], cell["weight"]) == ("S-L@0.5", 0.5)
    assert (found["undo"], found["saved"]) == (1, False)
    answer = page.ask("set_shape", variable="E", set="ze", parameters=[-0.2, 0, 0.2])
    assert answer["also"] == [{"variable": "dE", "set": "ze"}]
    answer = page.ask("set_shape", variable="E", set="ze", parameters=[-0.3, 0, 0.3],
                      shared="apart")  # fmt: skip
    assert answer["also"] == []
    page.ask("set_operator", operator="and", value="min")
    weighed = page.ask("set_weight", row=6, column=6, weight=0.25)["state"]
    assert weighed["rulebase"]["rules"]["cells"][6][6]["weight"] == 0.25
    assert page.ask("rename_set", variable="damping", set="L", name="large")["state"]["undo"] == 6
    for _ in range(6):
        found = page.ask("undo")["state"]
    assert (found["text"], found["undo"], found["redo"]) == (before, 0, 6)
    assert page.ask("redo")["state"]["redo"] == 5


def test_sets_come_and_go(page):
    answer = page.ask("add_set", variable="damping", set="XL", shape="trimf",
                      parameters=[0.8, 0.85, 0.89])  # fmt: skip
    sets = answer["state"]["rulebase"]["outputs"][1]["sets"]
    assert "XL" in [each["name"] for each in sets]
    found = page.ask("remove_set", variable="damping", set="XL")["state"]
    assert found["rulebase"]["outputs"][1]["sets"] != sets
    text = page.ask("write_out", variable="dE")["state"]
    assert text["rulebase"]["inputs"][0]["shared_with"] == []
    page.ask("add_set", variable="E", set="mid", shape="trimf", parameters=[0, 0.05, 0.1],
             like="ze")  # fmt: skip
    table = page.ask("undo")["state"]["rulebase"]["rules"]
    assert len(table["column_sets"]) == 7
    assert "is used by the rules for" in page.refused("remove_set", variable="damping", set="L")


def test_a_complaint_names_the_set_that_it_is_about(page):
    text = page.hello["state"]["text"]
    (complaint,) = page.ask("set_text", text=text.replace("trimf", "trymf", 1))["state"][
        "complaints"
    ]
    assert complaint["where"].keys() == {"variable", "set"}
    assert "unknown shape" in complaint["message"]


def test_a_drag_is_undone_as_one(page):
    for width in (0.11, 0.12, 0.13):
        drag = {"variable": "E", "set": "ze", "parameters": [-width, 0, width]}
        page.ask("set_shape", draft=True, **drag)
    assert page.ask("set_shape", **drag)["state"]["undo"] == 1
    # The next drag of the same set is another one.
    page.ask("set_shape", variable="E", set="ze", parameters=[-0.2, 0, 0.2], draft=True)
    assert page.ask("set_shape", variable="E", set="ze", parameters=[-0.25, 0, 0.25])
    assert page.ask("undo")["state"]["undo"] == 1


def test_neighbors_that_share_a_corner_move_along(page):
    shapes = [
        {"set": "ze", "parameters": [-0.1, 0, 0.12]},
        {"set": "ps", "parameters": [0, 0.12, 0.3]},
    ]
    found = page.ask("set_shapes", variable="E", shapes=shapes)
    assert {each["set"] for each in found["also"]} == {"ze", "ps"}
    assert found["state"]["undo"] == 1
    text = found["state"]["text"]
    wrong = [{**shapes[0], "parameters": [-0.1, 0, 0.2]}, {"set": "no", "parameters": [1]}]
    assert "no set 'no'" in page.refused("set_shapes", variable="E", shapes=wrong)
    assert page.ask("set_text", text=text)["state"]["text"] == text
    assert page.ask("undo")["state"]["saved"]


def test_a_text_that_does_not_load_keeps_the_last_rule_base(page):
    text = page.hello["state"]["text"]
    state = page.ask("set_text", text=text.replace("S-S", "S-Q", 1))["state"]
    (complaint,) = state["complaints"]
    assert "unknown set of damping 'Q'" in complaint["message"]
    row, column = complaint["where"]["cell"]
    assert state["rulebase"]["rules"]["cells"][row][column]["text"] == "S-S"
    assert complaint["line"] == 1 + text[: text.index("S-S")].count("\n")
    assert "does not load" in page.refused("set_cell", row=0, column=0, text="M-Z")
    assert "does not load" in page.refused("run", trackers=["editor"], runs=1)
    assert "does not load" in page.refused("walk", tracker="editor:start=one-point")
    assert "does not load" in page.refused("tune")
    assert "does not load" in page.refused("certify")
    assert page.ask("set_text", text=text)["state"]["complaints"] == []


def test_surfaces_are_those_of_the_library(page):
    found = page.ask("surface", outputs=["stiffness", "alpha"], columns=5, rows=5)
    assert found.shape == (2, 5, 5)
    rules = load_rulebase("stiffness-damping")
    system = FuzzySystem(rules)
    x, y = np.meshgrid(*(np.linspace(v.universe.low, v.universe.high, 5) for v in rules.inputs))
    np.testing.assert_array_equal(found[0], system(E=x, dE=y)["stiffness"].astype("f4"))
    assert not page.ask("surface", outputs=["beta"], columns=7, against="saved").any()
    page.ask("set_cell", row=3, column=3, text="S-Z")
    assert page.ask("surface", outputs=["beta"], columns=7, against="saved").any()
    message = page.refused("surface", outputs=["beta"], columns=202)
    assert message == "columns: needs a whole number from 2 to 201, got 202"
    assert "unknown output" in page.refused("surface", outputs=["bet"])


def test_a_point_is_explained(page):
    found = page.ask("explain", inputs={"E": 0.1, "dE": -0.2})
    assert found["rules"][0]["place"] is not None
    assert sum(found["memberships"]["E"].values()) == pytest.approx(1)
    system = FuzzySystem("stiffness-damping")
    assert found["outputs"] == system(E=0.1, dE=-0.2)
    assert set(found["gains"]) == {"alpha", "beta"}
    assert page.refused("explain", inputs={"E": 0.1}) == "inputs: needs a number for each of E, dE"


def test_gains_and_their_certificate(page):
    found = page.ask("gains")
    assert found["visited"] == []
    assert len(found["hull"]) < len(found["reachable"])
    assert page.ask("certify")["verdict"] == "certified"
    refuted = page.ask("certify", steps=[1, 4])
    assert refuted["verdict"] == "refuted"
    assert refuted["counter_example"][0].keys() >= {"alpha", "beta"}


def test_gains_that_do_not_follow_from_the_outputs_alone(page):
    """Those of a covariance depend on what came before."""
    page.ask("open", name="maneuver")
    found = page.ask("gains")
    assert (found["reachable"], found["hull"]) == ([], [])
    assert page.ask("certify")["verdict"] in ("certified", "not decided")
    inputs = page.ask("open", name="maneuver")["state"]["rulebase"]["inputs"]
    point = {v["name"]: sum(v["universe"][:2]) / 2 for v in inputs}
    assert page.ask("explain", inputs=point)["gains"] is None


def test_a_list_of_rules_and_one_input_are_shown(page):
    rules = page.ask("open", name="maneuver")["state"]["rulebase"]
    assert rules["rules"]["form"] == "list"
    rule = rules["rules"]["rules"][0]
    assert rule["if"]
    changed = page.ask("set_rule", index=0, text=rule["text"])["state"]
    assert changed["rulebase"] == rules
    then = rule["parts"]
    removed = page.ask("remove_rule", index=0)["state"]["rulebase"]["rules"]["rules"]
    kept = [rule | {"line": rule["line"] - 1} for rule in rules["rules"]["rules"][1:]]
    assert removed == kept
    added = page.ask("add_rule", **{"if": rule["if"], "then": then})["state"]
    assert added["rulebase"]["rules"]["rules"][-1]["parts"] == then
    rules = page.ask("open", name="omega-schedule")["state"]["rulebase"]
    assert len(rules["inputs"]) == 1
    found = page.ask("surface", outputs=rules["surfaces"][:1], columns=9, rows=9)
    assert found.shape == (1, 1, 9)


def test_files_are_saved_in_the_folder_and_not_overwritten(server, page):
    page.ask("set_cell", row=0, column=0, text="M-Z")
    found = page.ask("save", name="mine")
    assert found["state"]["file"] == "mine.yaml"
    assert {"name": "mine.yaml", "kind": "rules"}.items() <= found["files"][0].items()
    path = server.folder / "mine.yaml"
    assert loads_rulebase(path.read_text()).rules[0] != load_rulebase("stiffness-damping").rules[0]
    assert page.ask("export", what="yaml") == {"name": "mine.yaml", "text": path.read_text()}
    with server.page() as other:
        assert "exists already" in other.refused("save", name="mine.yaml")
        other.ask("open", name="mine.yaml")
        other.ask("set_cell", row=0, column=0, text="M-L")
        other.ask("save")
    page.ask("surface", outputs=["alpha"], against="mine.yaml")
    assert "has been changed since it was opened" in page.refused("save")
    assert page.ask("save", overwrite=True)["state"]["saved"]
    path.unlink()


@pytest.mark.parametrize("name", ["../x.yaml", "/etc/passwd", "a/b.yaml", ".x.yaml"])
def test_no_file_outside_of_the_folder_is_reached(page, name):
    assert "must be the name of a file" in page.refused("open", name=name)
    assert page.refused("save", name=name)
    assert page.refused("open_scenario", name=name)
    assert page.refused("surface", outputs=["alpha"], against=name)


def test_a_link_out_of_the_folder_is_not_followed(server, page, tmp_path):
    (tmp_path / "secret.yaml").write_text("rulebase: 1\n")
    link = server.folder / "link.yaml"
    link.symlink_to(tmp_path / "secret.yaml")
    assert "symbolic link" in page.refused("open", name="link.yaml")
    assert "symbolic link" in page.refused("run", trackers=["link.yaml"], runs=1)
    assert "link.yaml" not in [each["name"] for each in page.ask("files")["files"]]
    link.unlink()


def test_commands_say_what_they_take(page):
    assert "unknown 'set_cel'" in page.refused("set_cel")
    assert "did you mean 'row'" in page.refused("set_cell", rwo=1)
    assert page.refused("undo", x=1) == "unknown argument 'x'; it takes none"
