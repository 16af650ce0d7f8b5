"""Scripts and commands that do what is on the page."""

import shlex

import pytest

from fuzzytrack.cli.studio_snippets import command_line


def run_script(text):
    """What a script prints, without running trackers for long."""
    printed = []
    exec(text, {"print": lambda *words: printed.append([str(word) for word in words])})
    return printed


def test_a_rule_base_that_is_not_saved_is_in_the_script(page):
    page.ask("set_cell", row=0, column=1, text="S-S")
    text = page.ask("snippet", what="python", trackers=["editor", "saved"], runs=3)["text"]
    assert "loads_rulebase(" in text
    assert "'saved': 'stiffness-damping'" in text
    (editor, *numbers), (saved, *others) = run_script(text)
    assert (editor, saved) == ("editor", "saved")
    assert numbers != others


def test_a_scenario_that_is_not_saved_is_in_the_script(page):
    page.ask("set_sensors", sigma=1)
    arguments = {"trackers": ["fixed:alpha=0.5:beta=0.2"], "runs": 2, "seed": 4}
    text = page.ask("snippet", what="python", **arguments)["text"]
    assert text.startswith("from fuzzytrack.simulation.scenario_files import loads_scenario\n")
    assert len(run_script(text)) == 1
    assert page.refused("snippet", what="command").startswith("what: there is no command here")


def test_a_command_names_a_tracker_once(page, server, monkeypatch):
    monkeypatch.setattr(server.studio(), "command", command_line)
    page.ask("open", name="chan-style")
    # The rule base in the editor is the shipped one.
    text = page.ask("snippet", what="command", trackers=["editor", "chan-style"])["text"]
    assert text.split()[3:5] == ["--trackers", "chan-style"]


def test_commands_name_what_is_saved(page, server, monkeypatch):
    monkeypatch.setattr(server.studio(), "command", command_line)
    arguments = {"trackers": ["editor:start=one-point", "chan-style"], "runs": 9, "seed": 2}
    text = page.ask("snippet", what="command", **arguments)["text"]
    assert text == (
        "fuzzytrack testbed turn --trackers stiffness-damping:start=one-point,chan-style "
        "--runs 9 --seed 2"
    )
    track = {"name": "a b.csv", "trackers": ["saved"], "id": "ship", "truth": ["x", "y"]}
    text = page.ask("snippet", what="command", of="track", **track)["text"]
    assert shlex.split(text) == [
        *["fuzzytrack", "compare", "a b.csv", "--trackers", "stiffness-damping"],
        *["--id", "ship", "--truth", "x,y"],
    ]
    polar = {"name": "a.csv", "trackers": ["chan-style"], "polar": ["r", "az"], "sigma_range": 30}
    polar |= {"sort": True, "duplicates": "first", "site": [52.5, 5]}
    text = page.ask("snippet", what="command", of="track", **polar)["text"]
    assert text == (
        "fuzzytrack compare a.csv --trackers chan-style --polar r,az --site 52.5,5.0 "
        "--sigma-range 30.0 --duplicates first --sort"
    )
    scan = {"name": "a.tsv", "polar": ["r", "az"], "id": "ship", "wrap": 60, "truth": ["x", "y"]}
    # There are no tracks yet that a gap could end.
    scan |= {"max_gap": 30}
    text = page.ask("snippet", what="command", of="scan", **scan)["text"]
    assert text == ("fuzzytrack scan a.tsv --wrap 60.0 --polar r,az --output tracks-of-a.csv")
    tune = {"free": "outputs, sets", "trials": 7, "sigma": 2.5}
    text = page.ask("snippet", what="command", of="tune", **tune)["text"]
    assert text == (
        "fuzzytrack tune turn --tracker stiffness-damping --free outputs,sets --trials 7 "
        "--sigma 2.5"
    )
    page.ask("set_sensors", sigma=1)
    assert "save the scenario first" in page.refused("snippet", what="command", **arguments)
    page.ask("set_cell", row=0, column=1, text="S-S")
    track["trackers"] = ["editor"]
    message = page.refused("snippet", what="command", of="track", **track)
    assert "save the rule base first" in message


@pytest.mark.parametrize("of", ["track", "scan", "tune"])
def test_scripts_of_recordings_are_python(page, of):
    page.ask("set_cell", row=0, column=1, text="S-S")
    arguments = {"on": "a.csv"} if of == "tune" else {"name": "a.csv", "truth": ["x", "y"]}
    text = page.ask("snippet", what="python", of=of, sigma=2, **arguments)["text"]
    compile(text, of, "exec")
    assert "'a.csv'" in text
    assert "sigma=2.0" in text


def test_the_script_of_a_run_is_of_its_own_texts(page, server, monkeypatch):
    monkeypatch.setattr(server.studio(), "command", command_line)
    page.ask("set_cell", row=0, column=1, text="S-S")
    page.ask("set_sensors", sigma=70)
    page.ask("save", name="ran.yaml")
    page.ask("set_cell", row=0, column=1, text="L-Z")
    arguments = {"trackers": ["editor", "saved"], "runs": 3, "seed": 5}
    last = page.job(page.ask("run", **arguments)["job"])[-1]
    rows = [
        [row["name"], str(row["predicted_rmse"]), str(row["predicted_rmse_se"])]
        for row in last["results"]["trackers"]
    ]
    assert rows[0][1] != rows[1][1]
    page.ask("set_sensors", sigma=20)
    page.ask("set_cell", row=2, column=2, text="S-Z")
    # The file is named while it has the rules as they were saved, and only then.
    kept = page.ask("snippet", what="python", **arguments)["text"]
    assert "'saved': 'ran.yaml'" in kept
    page.ask("save", name="ran.yaml")
    text = page.ask("snippet", what="python", **arguments)["text"]
    assert "'ran.yaml'" not in text
    assert run_script(text) == rows
    message = page.refused("snippet", what="command", **arguments)
    assert "save the rule base first, before it is run" in message
    # Of other runs, and of other numbers, it is what a run would now be.
    text = page.ask("snippet", what="python", **arguments | {"seed": 6})["text"]
    assert "'editor': 'ran.yaml'" in text
    assert "sigma: 20" in text
