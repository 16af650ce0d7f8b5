"""Recordings that a page is given: tracked, compared, tuned on."""

import json
import shlex
import threading

import numpy as np
import pytest
from typer.testing import CliRunner
from waiting import PATIENCE

from fuzzytrack.cli.app import app
from fuzzytrack.cli.studio_snippets import command_line
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.studio.notes import warnings_to_notes
from fuzzytrack.studio.recorded import Recorded

TRACKERS = ["fixed:alpha=0.5377:beta=0.2018", "stiffness-damping"]


def tracked(page, **said):
    """What a job that tracks a recording ends with."""
    return page.job(page.ask("track", **said)["job"])[-1]


@pytest.fixture(scope="module")
def csv():
    """Two tracks of a target that turns, with the truth beside the plots."""
    random = np.random.default_rng(4)
    lines = ["time,id,x,y,true_x,true_y"]
    for name in "ab":
        for k in range(110):
            true = 900 * np.cos(k / 15), 900 * np.sin(k / 15 + ord(name))
            plot = random.normal(true, 10)
            lines.append(",".join(map(repr, [k, name, *map(float, plot), *map(float, true)])))
    return "\n".join(lines).replace("'", "") + "\n"


def test_a_recording_is_tracked_and_compared_as_by_the_command(page, csv, tmp_path):
    found = page.ask("upload", name="mine.csv", text=csv)
    assert found["columns"] == ["time", "id", "x", "y", "true_x", "true_y"]
    # The file is named without the folder of the server.
    assert found["problem"].startswith("mine.csv: row 112, column time")
    found = page.ask("upload", name="mine.csv", text=csv, id="id")
    assert (found["plots"], found["tracks"], found["axes"]) == (220, 2, 2)
    truth = ["true_x", "true_y"]
    events = page.job(
        page.ask("track", name="mine.csv", trackers=TRACKERS, id="id", sigma=10, truth=truth)["job"]
    )
    found = events[-1]["results"]
    # It begins, the file is read, and each tracker is a part.
    assert [each["done"] for each in events] == sorted(each["done"] for each in events)
    assert (events[0]["done"], events[-1]["done"], events[-1]["of"]) == (0, 100, 100)
    path = tmp_path / "mine.csv"
    path.write_text(csv)
    command = ["compare", str(path), "--trackers", ",".join(TRACKERS), "--sigma", "10"]
    command += ["--id", "id", "--truth", ",".join(truth), "--json"]
    expected = json.loads(CliRunner().invoke(app, command).output)["trackers"]
    for row, score in zip(found["comparison"]["rows"], expected, strict=True):
        assert row["rms"] == score["rms"]
        assert row["predicted"] == score["true"]["predicted"]
    assert found["comparison"]["columns"][0][0] == "predicted"
    assert [(t["id"], len(t["time"])) for t in found["drawn"]] == [("a", 110), ("b", 110)]
    drawn = found["drawn"][1]["trackers"]["stiffness-damping"]
    assert len(drawn["filtered"]) == 110
    assert drawn["innovation"][0] == [None, None]
    # The editor holds the same rule base; without a number the noise is estimated.
    other = tracked(page, name="mine.csv", trackers=["editor"], id="id")["results"]
    assert other["comparison"]["columns"][0][0] == "rms"


def test_a_rule_base_is_tuned_and_opens_in_the_editor(page, csv):
    page.ask("upload", name="mine.csv", text=csv)
    page.job(page.ask("run", trackers=TRACKERS[:1], runs=2)["job"])
    number = page.ask("tune", on="mine.csv", id="id", free="outputs", trials=4, folds=2)["job"]
    last = page.job(number)[-1]
    assert last["state"] == "done", last["error"]
    found = last["results"]
    # The file is named as the page names it.
    assert found["data"] == "mine.csv"
    assert "# Tuned on mine.csv with seed 0 by" in found["text"]
    hello = page.ask("hello", session=page.hello["session"])
    assert [each["kind"] for each in hello["jobs"]] == ["run", "tune"]
    assert hello["jobs"][0]["results"]["runs"] == 2
    assert found["before"] > 0
    assert loads_rulebase(found["text"]).output_names == ("stiffness", "damping")
    state = page.ask("set_text", text=found["text"])["state"]
    assert state["complaints"] == []
    assert page.ask("undo")["state"]["saved"]


@pytest.mark.parametrize(
    ("command", "arguments", "message"),
    [
        ("upload", {"name": "../x.csv", "text": ""}, "name: '../x.csv' must be the name of a file"),
        ("upload", {"name": "x.yaml", "text": ""}, "must be the name of a file that ends in .csv"),
        ("track", {"name": "no.csv", "trackers": ["editor"]}, "drop the file on the page"),
        ("track", {"name": "no.csv", "trackers": ["editor"], "sigma": "a"}, "drop the file"),
        ("tune", {"tracker": "/etc/x.yaml"}, "names a file outside of the folder"),
        ("tune", {"tracker": "editor:level=3"}, "takes no parameters here"),
        ("tune", {"folds": 1}, "folds: needs a whole number from 2 to 100, got 1"),
    ],
)
def test_what_cannot_be_done_with_a_recording_is_refused(page, command, arguments, message):
    assert message in page.refused(command, **arguments)


def test_polar_plots_are_tracked_as_by_the_command(page, server, tmp_path):
    path = server.folder / "radar.csv"
    assert CliRunner().invoke(app, ["sample", "radar", "-o", str(path)]).exit_code == 0
    found = page.ask("recording", name="radar.csv")
    assert found["columns"] == ["time", "track", "range", "azimuth"]
    # The remedy in the refusal, which the page offers, is one of its arguments.
    assert "`polar`=range,azimuth" in found["problem"]
    said = {"id": "track", "polar": ["range", "azimuth"], "sigma_range": 30, "sigma_azimuth": 0.1}
    found = page.ask("recording", name="radar.csv", **said)
    assert found["problem"] is None
    assert found["found"] == {
        "time": "time",
        "id": "track",
        "position": "polar",
        "places": ["range", "azimuth"],
        "axes": ["x", "y"],
    }
    assert [(each["sigma"], each["unit"]) for each in found["noise"]] == [(30, "m"), (0.1, "°")]
    found = page.ask("recording", name="radar.csv", id="track", polar=["range", "azimuth"])
    estimated = [(each["sigma"], each["error"]) for each in found["noise"]]
    for (sigma, error), true in zip(estimated, (30, 0.1), strict=True):
        assert abs(sigma - true) < 4 * error < true
    # The noise differs between x and y, so that each has a covariance of its own.
    page.ask("open", name="maneuver")
    trackers = ["maneuver", *TRACKERS]
    found = tracked(page, name="radar.csv", trackers=[*trackers, "editor"], **said)["results"]
    command = ["compare", str(path), "--trackers", ",".join(trackers), "--id", "track", "--json"]
    command += ["--polar", "range,azimuth", "--sigma-range", "30", "--sigma-azimuth", "0.1"]
    expected = json.loads(CliRunner().invoke(app, command).output)["trackers"]
    own = [row["rms"] for row in found["comparison"]["rows"]]
    assert own == [*(s["rms"] for s in expected), expected[0]["rms"]]
    shared = tracked(page, name="radar.csv", trackers=["maneuver:axes=shared"], **said)["results"]
    assert shared["comparison"]["rows"][0]["rms"] != own[0]


def test_a_moving_sensor_noise_in_a_column_and_a_clock_that_restarts_are_read_as_by_the_command(
    page, tmp_path
):
    random, lines = np.random.default_rng(5), ["time,range,bearing,noise,own_x,own_y,heading"]
    for k in range(40):
        x, y, heading, noise = 3000 - 20 * k, 1500 + 5 * k, 40 + k, 4 + k % 3
        distance = np.hypot(x, y) + random.normal(0, noise)
        bearing = np.degrees(np.arctan2(x, y)) + random.normal(0, 0.1) - heading
        row = [k % 30, distance, bearing, noise, k * k, -3 * k, heading]
        lines.append(",".join(f"{each:.6f}" for each in row))
    text = "\n".join(lines) + "\n"
    said = {
        "polar": ["range", "bearing"],
        "own_ship": ["own_x", "own_y"],
        "own_heading": "heading",
        "sigma_range": "noise",
        "sigma_azimuth": 0.1,
        "wrap": 30,
    }
    found = page.ask("upload", name="ship.csv", text=text, **said)
    assert (found["plots"], found["tracks"]) == (40, 1)
    assert [each["sigma"] for each in found["noise"]] == ["noise", 0.1]
    found = tracked(page, name="ship.csv", trackers=TRACKERS[:1], **said)["results"]
    path = tmp_path / "ship.csv"
    path.write_text(text)
    words = command_line("compare", [str(path)], {"trackers": TRACKERS[:1], **said, "json": True})
    expected = json.loads(CliRunner().invoke(app, shlex.split(words)[1:]).output)["trackers"]
    assert [row["rms"] for row in found["comparison"]["rows"]] == [s["rms"] for s in expected]
    # Each of these matters.
    for name in ("own_ship", "own_heading", "wrap"):
        less = {key: value for key, value in said.items() if key != name}
        other = tracked(page, name="ship.csv", trackers=TRACKERS[:1], **less)["results"]
        rows = other["comparison"]["rows"] if other else []
        assert [row["rms"] for row in rows] != [s["rms"] for s in expected], name


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"sigma": -1}, "sigma"),
        ({"sigma": ["no"]}, "no column 'no'"),
        ({"own_ship": ["x"]}, "own_ship"),
        ({"wrap": ["a"]}, "wrap: ['a']; expected a number of seconds above 0, or auto"),
        ({"comment": 3}, "comment: must be one or two marks"),
        ({"na": 7}, "na: must be several texts, got 7"),
    ],
)
def test_what_cannot_be_said_of_a_recording_is_its_problem(page, csv, said, message):
    """The page is told of the columns nevertheless, of which others may do."""
    found = page.ask("upload", name="mine.csv", text=csv, id="id", **said)
    assert message in found["problem"]
    assert found["columns"][:2] == ["time", "id"]


def test_warnings_about_tracks_are_notes_with_the_names_of_trackers(page, server):
    path = server.folder / "radar.csv"
    CliRunner().invoke(app, ["sample", "radar", "-o", str(path)])
    with warnings_to_notes():
        trackers = ["editor", *TRACKERS]
        last = tracked(page, name="radar.csv", trackers=trackers, polar=["range", "azimuth"])
    found = last["results"]
    (said,) = [note for note in found["notes"] if "its gains do not suit times" in note]
    assert said.startswith("editor, fixed:alpha=0.5377:beta=0.2018, stiffness-damping: its gains")


def test_a_tracker_that_needs_an_unknown_noise_is_left_out_and_the_others_are_compared(page):
    text = "time,x,y\n" + "".join(f"{k},{3 * k},5\n" for k in range(30))
    page.ask("upload", name="still.csv", text=text)
    found = tracked(page, name="still.csv", trackers=["maneuver", *TRACKERS])["results"]
    assert [row["name"] for row in found["comparison"]["rows"]] == TRACKERS
    assert list(found["drawn"][0]["trackers"]) == TRACKERS
    said = "compared without maneuver: the noise of the plots is needed; give `sigma`"
    assert said in found["notes"]
    last = tracked(page, name="still.csv", trackers=["maneuver"])
    assert last["error"] == "sigma: maneuver needs the standard deviation of the plots (m)"
    last = tracked(page, name="still.csv", trackers=["maneuver", *TRACKERS], sigma=1)
    assert len(last["results"]["comparison"]["rows"]) == 3


def test_the_truth_is_in_columns_or_a_file_of_the_folder(page, server, csv, tmp_path):
    (server.folder / "true.csv").write_text(csv)
    outside = tmp_path / "outside"
    outside.mkdir(exist_ok=True)
    (outside / "true.csv").write_text(csv)
    page.ask("upload", name="mine.csv", text=csv)
    said = {"name": "mine.csv", "trackers": TRACKERS[:1], "id": "id"}
    found = tracked(page, truth=["true.csv"], **said)["results"]
    assert found["comparison"]["columns"][0][0] == "predicted"
    for truth in (f"{outside}/true.csv", "../outside/true.csv"):
        assert "must be the name of a file" in page.refused("track", truth=[truth], **said)
    for truth in (["/etc/passwd"], ["true_x", "."]):
        assert f"`truth`: no column {truth[-1]!r}" in tracked(page, truth=truth, **said)["error"]


def test_a_refusal_does_not_name_the_folder(page, csv):
    page.ask("upload", name="mine.csv", text=csv, id="id")
    said = tracked(
        page, name="mine.csv", trackers=TRACKERS[:1], id="id", axes=["x"], truth=["x", "y"]
    )["error"]
    assert "/" not in said
    assert "mine.csv" in said or "truth" in said


def test_more_plots_than_there_may_be_are_refused(page, monkeypatch):
    monkeypatch.setattr("fuzzytrack.studio.uploads.MOST_PLOTS", 20)
    text = "time,x\n" + "".join(f"{k},{k}\n" for k in range(30))
    found = page.ask("upload", name="many.csv", text=text)
    assert "has more than 20 plots" in found["problem"]


def test_sixteen_recordings_are_kept(server, page):
    text = "time,x\n" + "".join(f"{k},{k * k % 7}\n" for k in range(9))
    for number in range(17):
        page.ask("upload", name=f"r{number}.csv", text=text)
    assert "is not in the folder" in page.refused("track", name="r0.csv", trackers=["editor"])
    found = tracked(page, name="r1.csv", trackers=["fixed:alpha=0.5:beta=0.2"])["results"]
    assert found["plots"] == 9


def test_tracking_is_canceled_by_its_page_or_when_something_else_is_said_of_the_recording(
    page, server, csv, monkeypatch
):
    read = threading.Event()
    page.ask("upload", name="mine.csv", text=csv, id="id")
    with monkeypatch.context() as patch:
        # The work waits where it reads the file.
        patch.setattr(Recorded, "read", lambda self: read.wait(PATIENCE) and None)
        number = page.ask("track", name="mine.csv", trackers=TRACKERS, id="id")["job"]
        page.ask("cancel", job=number)
        assert page.job(number)[-1]["state"] == "cancelled"
        number = page.ask("track", name="mine.csv", trackers=TRACKERS, id="id")["job"]
    found = page.ask("recording", name="mine.csv", id="id", sigma=10)
    assert found["tracks"] == 2
    assert page.job(number)[-1]["state"] == "replaced"
    read.set()
