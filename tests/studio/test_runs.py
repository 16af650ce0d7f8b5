"""Monte Carlo experiments of a page: the numbers of the command line, progress, and an end."""

import json
import re

import pytest
from typer.testing import CliRunner

from fuzzytrack.cli.app import app

TRACKERS = ["fixed:alpha=0.5377:beta=0.2018", "stiffness-damping"]


def run_and_wait(page, **arguments):
    return page.job(page.ask("run", **arguments)["job"])


def run_script(text):
    """Words of the lines that a script prints."""
    printed = []
    exec(text, {"print": lambda *words: printed.append([str(word) for word in words])})
    return printed


def test_a_run_gives_what_the_command_gives_and_can_be_canceled(page, server, waiting_runs):
    page.ask("open_scenario", name="turn")
    events = run_and_wait(page, trackers=["editor", *TRACKERS], runs=150, seed=3)
    last = events[-1]
    assert (last["state"], last["done"], last["of"]) == ("done", 150, 150)
    assert [e["done"] for e in events] == sorted(e["done"] for e in events)
    found = last["results"]
    command = ["testbed", "turn", "--trackers", ",".join(TRACKERS), "--runs", "150", "--seed", "3"]
    expected = json.loads(CliRunner().invoke(app, [*command, "--json"]).output)
    # To the last digit, and the rule base in the editor is the shipped one still.
    assert found["curves"] == {
        **expected["curves"],
        "editor": expected["curves"]["stiffness-damping"],
    }
    rows = {row["name"]: row for row in found["trackers"]}
    for row in expected["trackers"]:
        for name in ("predicted_rmse", "predicted_rmse_se", "filtered_mean", "peak"):
            assert rows[row["name"]][name] == row[name]
    assert found["operations"]["editor"]["per_update"] > 0
    assert sum(found["distribution"]["counts"]["editor"]) == 150 * 18
    sample = found["sample"]["trackers"]["editor"]["filtered"]

    walked = page.ask("walk", tracker="editor", run=0, seed=3)
    assert walked["estimates"] == sample
    assert walked["inputs"][1] == [None, None]
    lane = walked["inputs"][5][0]
    explained = page.ask("explain", inputs=lane["values"])
    assert lane["rules"][0]["index"] == explained["rules"][0]["index"]

    assert "<img" in page.ask("report")["text"]
    assert run_script(page.ask("snippet", what="python")["text"]) == [
        [name, str(rows[name]["predicted_rmse"]), str(rows[name]["predicted_rmse_se"])]
        for name in ["editor", *TRACKERS]
    ]

    paired = page.ask("paired", first="editor", second=TRACKERS[0])
    row = next(row for row in expected["trackers"] if row["name"] == "stiffness-damping")
    assert paired["difference"] == pytest.approx(-row["change"])
    assert len(paired["over_time"]["se"]) == 20
    assert "no such tracker" in page.refused("paired", first="editor", second="no")

    visits = page.ask("visits")
    # Two axes, and no rules are asked for the first two plots.
    assert sum(map(sum, visits["counts"])) >= 150 * 18 * 2
    gains = page.ask("gains")
    assert sum(count for _, _, count in gains["visited"]) == 150 * 18 * 2

    with waiting_runs():
        number = page.ask("run", trackers=["editor"], runs=100_000, seed=0)["job"]
        assert "a job (run) is running" in page.refused("run", trackers=["editor"], runs=1)
        # Edits go on meanwhile.
        assert page.ask("set_cell", row=0, column=0, text="S-L")["state"]
        with server.page() as other:
            assert other.refused("cancel", job=number) == (
                f"job: this page has no job {number}; a page cancels only its own"
            )
            # What another page starts waits, and begins when this one has ended.
            waits = other.ask("run", trackers=["editor"], runs=5)["job"]
            while not other.events:
                other.events.append(other.receive()[1])
            assert other.events[0]["job"]["state"] == "waiting"
            page.ask("cancel", job=number)
            assert page.job(number)[-1]["state"] == "cancelled"
            other.ask("cancel", job=waits)
            assert other.job(waits)[-1]["state"] == "cancelled"
        assert page.ask("cancel", job=number)["job"]["state"] == "cancelled"
    # The next one has new processes.
    assert run_and_wait(page, trackers=["editor"], runs=5)[-1]["state"] == "done"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"runs": 10**9}, "runs: needs a whole number from 1 to 100000, got 1000000000"),
        ({"runs": 0}, "runs: needs a whole number"),
        ({"runs": 5, "seed": -1}, "seed: needs a whole number"),
        ({"runs": 5, "trackers": []}, "trackers: needs a list of texts"),
        ({"runs": 5, "trackers": ["no-such"]}, "no such tracker"),
        ({"runs": 5, "trackers": ["../x.yaml"]}, "outside of the folder"),
        ({"runs": 5, "trackers": ["missing.yaml"]}, "missing.yaml is not in the folder"),
        ({"runs": 5, "trackers": ["editor", "editor"]}, "is given twice"),
        ({"runs": 5, "trackers": ["editor:no=1"]}, "tracker 'editor:no=1': "),
        ({"runs": 5, "trackers": [f"fixed:alpha=0.5:beta=0.{k}" for k in range(1, 42)]}, "at most"),
        (
            {"runs": 100_000, "trackers": [f"fixed:alpha=0.5:beta=0.{k}" for k in range(1, 40)]},
            "GiB of memory; give at most",
        ),
    ],
)
def test_what_cannot_be_run_is_refused(page, arguments, message):
    assert message in page.refused("run", **{"trackers": ["editor"], **arguments})


def test_large_results_of_another_page_are_dropped_for_new_ones(tmp_path, new_server, monkeypatch):
    server = new_server(tmp_path)
    monkeypatch.setattr("fuzzytrack.studio.jobs._processes", lambda: 1)
    with server.page() as page, server.page() as other:
        run_and_wait(page, trackers=["editor"], runs=5)
        run_and_wait(other, trackers=["editor"], runs=5)
        # Several at once are drawn one after the other, and are the same.
        asked = {page.send("report") for _ in range(3)}
        told = [page.receive() for _ in asked]
        assert {number for number, _ in told} == asked
        drawings = [re.findall("<img [^>]*>", each["result"]["text"]) for _, each in told]
        assert len(drawings[0]) > 3
        assert drawings[0] == drawings[1] == drawings[2]
        kept = 2 * server.studio().open(page.hello["session"]).run.size
        monkeypatch.setattr("fuzzytrack.studio.pages.RESULT_BYTES", kept - 1)
        run_and_wait(other, trackers=["editor"], runs=5)
        said = "the results were dropped for large ones of another page; run it again"
        assert page.refused("report") == said
        assert page.refused("paired", first="editor", second="editor") == said
        assert other.ask("report")["text"]
