"""The scenario of a page."""

import numpy as np
import pytest

from fuzzytrack.simulation.scenario_files import loads_scenario


def test_waypoints_are_drawn_at_a_speed(page):
    page.ask("open_scenario", name="waypoints")
    before = page.ask("scenario")["state"]["text"]
    points = [[0, 0], [3000, 0], [3000, 4000]]
    found = page.ask("set_waypoints", points=points, speed=5)["state"]
    assert found["target"]["times"] == [0, 600, 1400]
    assert found["target"]["waypoints"] == points
    assert found["scenario"]["truth"][10] == pytest.approx([3000, 0])
    # The rest of the text is as it was.
    assert found["text"].partition("sensors:")[2] == before.partition("sensors:")[2]
    moved = page.ask("set_waypoints", points=[*points, [0, 4000]])["state"]
    assert moved["target"]["leg"] == 700
    assert loads_scenario(moved["text"]).position.shape[1] == 2
    assert page.ask("undo")["scenario"]["target"]["times"] == [0, 600, 1400]
    assert "needs 2 to 1000 points" in page.refused("set_waypoints", points=[[0, 0]])
    assert "speed: must be > 0" in page.refused("set_waypoints", points=points, speed=0)


def test_a_point_that_is_moved_leaves_comments_where_they_are(page):
    page.ask("open_scenario", name="waypoints")
    text = page.ask("set_waypoints", points=[[1, 2]] * 0 + [[k, 2 * k] for k in range(6)])["state"]
    assert "# s from one way-point to the next" in text["text"]
    assert text["target"]["leg"] == 480


def test_a_drag_of_a_point_is_undone_as_one(page):
    page.ask("open_scenario", name="waypoints")
    points = page.ask("scenario")["state"]["target"]["waypoints"]
    for x in (100, 200, 300):
        points[2][0] = x
        page.ask("set_waypoints", points=points, draft=True)
    assert page.ask("set_waypoints", points=points)["state"]["undo"] == 2
    assert page.ask("undo")["scenario"]["target"]["waypoints"][2][0] == 4000


def test_the_times_of_scans_are_chosen(page):
    found = page.ask("set_sampling", kind="burst", value=[3, 10])["state"]
    assert found["sampling"] == {"burst": [3, 10]}
    found = page.ask("set_sampling", kind="jitter", value=0.2, period=50)["state"]
    assert found["sampling"] == {"jitter": 0.2, "period": 50}
    assert page.refused("set_sampling", kind="jitter", value=0.9)
    found = page.ask("set_sampling")["state"]
    assert found["sampling"] is None
    assert found["complaints"] == []


def test_sensors_become_a_field_and_noise_again(page):
    page.ask("open_scenario", name="turn")
    field = {"grid": 5, "spacing": "sparse", "reach": 20000, "range_sigma": 14, "bearing_sigma": 3}
    found = page.ask("set_sensors", **field)["state"]
    assert found["scenario"]["sensors"]["kind"] == "field"
    assert len(found["scenario"]["sensors"]["positions"]) == 25
    assert found["sensors"] == {**field, "spacing": "sparse"}
    found = page.ask("set_sensors", spacing=2500.5)["state"]
    assert found["sensors"]["spacing"] == 2500.5
    assert found["sensors"]["grid"] == 5
    found = page.ask("set_sensors", centre=[250, -100])["state"]
    assert np.mean(found["scenario"]["sensors"]["positions"], axis=0) == pytest.approx([250, -100])
    found = page.ask("set_sensors", sigma=80, detection=0.9)["state"]
    assert found["sensors"] == {"sigma": 80, "detection": 0.9}
    # What would be no scenario changes nothing.
    message = page.refused("set_sensors", detection=1.5)
    assert "detection" in message
    assert page.ask("scenario")["state"]["sensors"] == {"sigma": 80, "detection": 0.9}


def test_a_motion_is_chosen(page):
    page.ask("open_scenario", name="waypoints")
    found = page.ask("set_motion", motion="turn", speed=6, radius=4500, start=[100, 0])["state"]
    target = {"motion": "turn", "speed": 6, "radius": 4500, "start": [100, 0]}
    assert found["target"] == {**target, "period": 60}
    assert found["scenario"]["scans"] == 20
    # The radius is none of a straight line.
    found = page.ask("set_motion", motion="constant-velocity", speed=7)["state"]
    assert found["target"] == {"motion": "constant-velocity", "speed": 7, "start": [100, 0],
                               "period": 60}  # fmt: skip
    assert "unknown 'loop'" in page.refused("set_motion", motion="loop")


def test_a_motion_keeps_the_numbers_that_the_next_one_is_given_too(page):
    page.ask("open_scenario", name="turn")
    given = {"speed": 6, "acceleration": 0.01, "radius": 3000}
    found = page.ask("set_motion", motion="turn-with-angular-acceleration", **given)["state"]
    assert found["target"].items() >= given.items()


def test_a_text_that_is_no_scenario_keeps_the_last(page):
    found = page.ask("set_scenario_text", text="scenario: 1\nname: x\n")["state"]
    assert found["complaints"][0]["message"] == "the scenario lacks the key 'target'"
    assert found["scenario"]["name"] == "turn"
    assert found["target"] is None
    # It is shown, but no numbers are made of it as if it were the text.
    message = page.refused("run", trackers=["chan-style"], runs=1)
    assert message.startswith("the text of the scenario does not load: the scenario lacks the key")
    assert page.refused("walk", tracker="chan-style") == message
    assert page.refused("tune", tracker="chan-style") == message
    text = "scenario: 1\nname: x\ntarget: {file: ../x.csv}\nsensors: {sigma: 1}\n"
    found = page.ask("set_scenario_text", text=text)["state"]
    assert "with no folder before it" in found["complaints"][0]["message"]


def test_a_scenario_is_saved(server, page):
    page.ask("set_sensors", sigma=77)
    assert page.ask("save_scenario", name="world")["state"]["file"] == "world.yaml"
    assert "sigma: 77" in (server.folder / "world.yaml").read_text()
    (server.folder / "world.yaml").unlink()


def test_a_scenario_of_too_many_scans_is_refused_and_one_of_many_is_not_walked(page):
    page.ask("open_scenario", name="turn")
    found = page.ask("set_sampling", kind="alternate", value=[0.5, 2], period=0.1)["state"]
    scans = found["scenario"]["scans"]
    assert scans > 5000
    said = page.refused("walk", tracker="editor")
    assert said == f"run: has {scans} scans; at most 5000 can be walked"
    refusal = page.refused("set_sampling", kind="alternate", value=[0.5, 2], period=0.001)
    assert refusal.endswith("scans; at most 100000 here: make the period longer")
    assert page.ask("scenario")["state"]["scenario"]["scans"] == scans
    page.ask("undo")
