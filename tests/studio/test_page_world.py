"""The experiment side of the page in a real browser: scenario, runs, results, own data."""

import re
import threading

import numpy as np
import pytest
from typer.testing import CliRunner
from waiting import PATIENCE

from fuzzytrack.cli.app import app
from fuzzytrack.cli.studio_snippets import command_line
from fuzzytrack.studio.notes import warnings_to_notes
from fuzzytrack.studio.recorded import Recorded
from fuzzytrack.testbed.montecarlo import monte_carlo

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright")
expect = playwright.expect

TRACKERS = [
    "fixed:alpha=0.5377:beta=0.2018",
    "chan-style",
    "stiffness-damping",
    "kalman-cv:sigma_v=0.0075",
]


def view(page, name):
    page.locator("#rail").get_by_role("button", name=name).click()


def waypoint(page, number):
    return page.get_by_role("button", name=f"Way-point {number}:")


def coordinate(page, number, axis):
    return page.get_by_label(f"Way-point {number}, {axis} in meters")


def run(page, runs):
    page.get_by_role("textbox", name="Runs").first.fill(str(runs))
    page.get_by_role("textbox", name="Seed").fill("3")
    page.keyboard.press("Control+Enter")


def test_waypoints_are_drawn_dragged_inserted_typed_deleted_and_undone(studio):
    view(studio, "World")
    studio.get_by_role("button", name="Draw way-points").click()
    map_box = studio.locator("#pane-world svg.map").bounding_box()
    for k, (right, down) in enumerate(
        [(0.2, 0.8), (0.3, 0.4), (0.5, 0.6), (0.7, 0.3), (0.85, 0.5)], 1
    ):
        studio.mouse.click(
            map_box["x"] + right * map_box["width"], map_box["y"] + down * map_box["height"]
        )
        expect(studio.locator(".waypoint")).to_have_count(k)
    studio.keyboard.press("Enter")
    expect(studio.get_by_label("Maneuver", exact=True)).to_have_value("waypoints")
    rows = studio.locator("table.waypoints tbody tr")
    expect(rows).to_have_count(5)

    # By mouse: while it is dragged the numbers follow, and the drag is one step of undo.
    before = coordinate(studio, 3, "x").input_value()
    box = waypoint(studio, 3).locator(".knob").bounding_box()
    studio.mouse.move(box["x"] + 6, box["y"] + 6)
    studio.mouse.down()
    studio.mouse.move(box["x"] + 40, box["y"] + 30)
    studio.mouse.move(box["x"] + 66, box["y"] + 46)
    expect(coordinate(studio, 3, "x")).not_to_have_value(before)
    studio.mouse.up()
    expect(waypoint(studio, 3)).to_be_focused()
    studio.keyboard.press("Control+z")
    expect(coordinate(studio, 3, "x")).to_have_value(before)

    # By keys, and by numbers.
    waypoint(studio, 3).focus()
    studio.keyboard.press("ArrowRight")
    expect(coordinate(studio, 3, "x")).not_to_have_value(before)
    expect(waypoint(studio, 3)).to_be_focused()
    studio.get_by_role("button", name="Insert a way-point after 3").first.focus()
    studio.keyboard.press("Enter")
    expect(rows).to_have_count(6)
    expect(waypoint(studio, 4)).to_be_focused()
    studio.keyboard.press("Delete")
    expect(rows).to_have_count(5)
    coordinate(studio, 2, "y").fill("1234.5")
    studio.keyboard.press("Enter")
    expect(waypoint(studio, 2)).to_have_attribute("aria-label", re.compile("y 1234.5 m"))


def test_a_sensor_field_as_it_is_offered_can_be_run(studio):
    view(studio, "World")
    # The target of this scenario starts in the middle of the map.
    studio.get_by_role("button", name="sensor field").click()
    expect(studio.locator(".facts")).to_contain_text("positions within reach")
    expect(studio.get_by_role("textbox", name="Range σ")).to_have_value("14.14")
    view(studio, "Run")
    run(studio, 20)
    expect(studio.locator("#pane-run [role=status]")).to_contain_text("20 runs in")


def test_sensors_and_their_reach_are_shown_and_changed(studio):
    view(studio, "World")
    studio.get_by_role("button", name="Scenario turn").click()
    studio.get_by_role("menuitem", name="llinas-m3-medium").click()
    expect(studio.locator(".facts")).to_contain_text("8 of 20 positions within reach")
    studio.get_by_label("Spacing").select_option("dense")
    expect(studio.locator(".facts")).not_to_contain_text("8 of 20")
    studio.get_by_role("textbox", name="Reach").fill("nonsense")
    studio.keyboard.press("Enter")
    reach = studio.get_by_role("textbox", name="Reach")
    expect(reach).to_have_attribute("aria-invalid", "true")
    assert reach.evaluate("field => field.validationMessage").startswith("Type a number")
    studio.keyboard.press("Escape")
    expect(studio.get_by_role("textbox", name="Reach")).to_have_value("1000")


def test_trackers_run_and_the_table_has_the_numbers_of_the_testbed(studio):
    view(studio, "Run")
    run(studio, 20)
    rows = studio.locator(".results-all .result-table tbody tr")
    expect(rows).to_have_count(5)
    expect(studio.locator("#pane-run [role=status]")).to_contain_text("20 runs in")
    expected = monte_carlo("turn", TRACKERS, runs=20, seed=3)
    for name, row in zip(TRACKERS, expected.table(), strict=True):
        shown = rows.filter(has=studio.locator(f'button[title*="{name} in"]'))
        for key in ("predicted_rmse", "filtered_rmse", "predicted_variance", "peak"):
            cell = shown.locator(f'[data-key="{key}"]')
            assert float(cell.get_attribute("data-value")) == row[key]
    studio.get_by_role("button", name="Side by side").click()
    expect(studio.locator(".difference")).to_contain_text("paired over 20 runs")

    about = studio.locator("#pane-results header")
    expect(about).to_contain_text("turn, 20 runs, seed 3")
    view(studio, "World")
    studio.get_by_role("textbox", name="Plot σ").first.fill("90")
    studio.keyboard.press("Enter")
    view(studio, "Run")
    expect(about).to_contain_text("seed 3; scenario changed since")
    studio.keyboard.press("Control+z")
    expect(about).not_to_contain_text("changed since")

    # One run, scan by scan.
    studio.get_by_role("button", name="One run").click()
    slider = studio.get_by_role("slider", name="Scan")
    slider.focus()
    for _ in range(5):
        studio.keyboard.press("ArrowRight")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("scan 5 of 19"))
    expect(studio.locator(".fired-rules").first).to_contain_text("if E is")

    for kind in ("SVG", "PNG"):
        studio.get_by_role("button", name="Save a picture of innovation").click()
        with studio.expect_download() as download:
            studio.get_by_role("menuitem", name=kind).click()
        content = download.value.path().read_bytes()
        assert content.startswith({"SVG": b"<svg", "PNG": b"\x89PNG"}[kind])

    # The page comes back as it was.
    studio.reload()
    expect(slider).to_have_attribute("aria-valuetext", re.compile("scan 0 of 19"))
    studio.get_by_role("button", name="All trackers").click()
    expect(rows).to_have_count(5)


def test_a_run_is_canceled_and_another_one_can_begin(studio, waiting_runs):
    view(studio, "Run")
    status = studio.locator("#pane-run [role=status]")
    with waiting_runs():
        run(studio, 100_000)
        expect(status).to_contain_text("left")
        studio.get_by_role("button", name="Cancel").first.click()
        expect(status).to_contain_text("Canceled after")
    expect(studio.locator("#pane-run").get_by_role("button", name="Run")).to_be_visible()


def test_runs_wait_for_those_of_another_page(studio, server, waiting_runs):
    view(studio, "Run")
    status = studio.locator("#pane-run [role=status]")
    with server.page() as other:
        with waiting_runs():
            number = other.ask("run", trackers=["editor"], runs=100_000)["job"]
            run(studio, 20)
            expect(status).to_contain_text("Waiting: another job runs")
            other.ask("cancel", job=number)
            expect(status).to_contain_text("of 20 runs")
        expect(status).to_contain_text("20 runs in")


def test_a_run_that_the_server_has_lost_can_be_started_again(studio, server, waiting_runs):
    view(studio, "Run")
    status = studio.locator("#pane-run [role=status]")
    with waiting_runs():
        run(studio, 100_000)
        expect(status).to_contain_text("left")
        # As a server that was started again: it knows no jobs, and the connection was lost.
        found = server.studio()
        for page in found._pages.values():
            page.jobs.clear()
        for connection in list(server.server.server_state.connections):
            connection.loop.call_soon_threadsafe(connection.transport.close)
        expect(status).to_contain_text("the server was started again")
        found.jobs.close()
    run(studio, 20)
    expect(status).to_contain_text("20 runs in")


def test_the_file_of_a_radar_is_tracked_as_the_page_proposes(studio, server, monkeypatch):
    path = server.folder / "radar.csv"
    assert CliRunner().invoke(app, ["sample", "radar", "-o", str(path)]).exit_code == 0
    studio.reload()
    view(studio, "Data")
    studio.get_by_label("File", exact=True).select_option("radar.csv")
    expect(studio.get_by_role("alert")).to_have_text(
        "radar.csv: no columns x, y.Use range, azimuth as range and azimuth"
    )
    studio.get_by_role("button", name="Use range, azimuth as range and azimuth").click()
    facts = studio.locator("#pane-data .what")
    with warnings_to_notes():
        studio.get_by_role("button", name="Use track as the track column").click()
        expect(facts).to_contain_text("6 tracks")
        expect(studio.get_by_text("radar.csv is being")).not_to_be_visible()
    studio.get_by_role("button", name="Save a picture of innovations").click()
    with studio.expect_download() as download:
        studio.get_by_role("menuitem", name="SVG").click()
    assert download.value.suggested_filename == "radar-innovations.svg"
    expect(studio.get_by_label("Positions")).to_have_value("polar")
    # What is estimated stands where it can be typed; 30 m and 0.1 degrees are true.
    expect(studio.get_by_role("combobox", name="Range σ")).to_have_attribute("placeholder", "≈ 30")
    studio.get_by_role("combobox", name="Range σ").fill("25")
    studio.keyboard.press("Enter")
    expect(facts).to_contain_text("σ 25 m")
    status = studio.locator("#pane-data .progress [role=status]")
    expect(status).to_contain_text("Done in")
    read = threading.Event()
    with monkeypatch.context() as patch:
        # The work waits where it reads the file.
        patch.setattr(Recorded, "read", lambda self: read.wait(PATIENCE) and None)
        studio.get_by_role("button", name="Track and compare").click()
        expect(status).to_contain_text("Starting")
        studio.locator("#pane-data").get_by_role("button", name="Cancel").click()
        expect(status).to_have_text("Canceled after 0 %.")
        read.set()
    studio.get_by_role("button", name="Track and compare").click()
    expect(status).to_contain_text("Done in")
    studio.reload()
    expect(facts).to_contain_text("σ 25 m")


@pytest.fixture(scope="module")
def csv():
    """Two tracks of a target that turns, with the truth beside the plots."""
    random = np.random.default_rng(4)
    lines = ["time,id,x,y,true_x,true_y"]
    for name in "ab":
        for k in range(110):
            true = 900 * np.cos(k / 15), 900 * np.sin(k / 15 + ord(name))
            numbers = map(repr, map(float, [*random.normal(true, 10), *true]))
            lines.append(f"{k},{name},{','.join(numbers)}")
    return "\n".join(lines) + "\n"


def drop(page, name, text):
    transfer = page.evaluate_handle(
        """([name, text]) => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], name, {type: "text/csv"}));
            return transfer;
        }""",
        [name, text],
    )
    page.dispatch_event("#main", "drop", {"dataTransfer": transfer})


def test_a_dropped_recording_is_compared_and_a_tuned_rule_base_opens(
    studio, csv, server, monkeypatch
):
    monkeypatch.setattr(server.studio(), "command", command_line)
    drop(studio, "mine.yaml", "rulebase: 1")
    expect(studio.locator("#status")).to_contain_text("mine.yaml is no CSV file")
    # Dropped anywhere, in any view.
    drop(studio, "mine.csv", csv)
    expect(studio.locator("#pane-data")).to_be_visible()
    # Two tracks without the column that tells them apart: the page says so, and takes the name.
    expect(studio.get_by_role("alert")).to_contain_text("mine.csv: row 112")
    studio.get_by_role("button", name="No column has it").click()
    dialog = studio.get_by_role("dialog")
    expect(dialog).to_contain_text("fuzzytrack scan mine.csv --output tracks-of-mine.csv")
    studio.keyboard.press("Escape")
    studio.get_by_label("Track column").select_option("id")
    rows = studio.locator("#pane-data .result-table tbody tr")
    expect(rows).to_have_count(5)
    expect(studio.locator("#pane-data")).to_contain_text("220 plots")
    studio.get_by_role("combobox", name="Track", exact=True).select_option("1")
    # The noise may be in a column, and the table fits on a tablet.
    studio.get_by_label("Truth").fill("true_x,true_y")
    studio.get_by_role("combobox", name="Plot σ").fill("true_x")
    studio.keyboard.press("Tab")
    expect(studio.get_by_role("alert")).to_contain_text("column true_x")
    studio.get_by_role("combobox", name="Plot σ").fill("9,5")
    studio.keyboard.press("Tab")
    expect(studio.locator("#pane-data .what")).to_contain_text("σ 9.5 m")
    expect(rows.first.locator('[data-key="filtered"]')).to_be_visible()
    size = studio.viewport_size
    studio.set_viewport_size({"width": 820, "height": 1180})
    table = studio.get_by_role("region", name="Comparison")
    assert table.evaluate("table => table.scrollWidth <= table.clientWidth")
    studio.set_viewport_size(size)

    studio.get_by_role("button", name="the recording").click()
    for label, text in [("Numbers to tune", "outputs"), ("Trials", "3"), ("Folds", "2")]:
        studio.get_by_role("textbox", name=label).fill(text)
        studio.keyboard.press("Tab")
    studio.get_by_role("button", name="Tune", exact=True).click()
    expect(studio.locator(".tuned")).to_contain_text("worth it", ignore_case=True)
    studio.get_by_role("button", name="Open in the editor").click()
    expect(studio.locator("#bar")).to_contain_text("not saved")
    expect(studio.locator("#pane-rules")).to_be_visible()
    studio.keyboard.press("Control+z")
    expect(studio.locator("#bar")).to_contain_text("as shipped")
    # The trackers name what is open now.
    studio.get_by_role("button", name="Open", exact=True).click()
    studio.get_by_role("dialog").get_by_text("omega-schedule").click()
    view(studio, "Run")
    expect(studio.locator("#pane-run")).to_contain_text("editor: omega-schedule")


def test_notes_of_a_walk_are_beside_it(studio):
    view(studio, "World")
    studio.get_by_label("Intervals").select_option("burst")
    view(studio, "Run")
    notes = studio.locator(".results-walk").get_by_role("list", name="Notes")
    with warnings_to_notes():
        studio.get_by_role("button", name="One run").click()
        studio.get_by_role("combobox", name="Tracker", exact=True).select_option("editor")
        expect(notes).to_contain_text("editor: its gains do not suit times")
        expect(notes.get_by_role("listitem")).to_have_count(1)
        # At equal times the gains are right, and nothing is to be said.
        studio.keyboard.press("Control+z")
        expect(notes).not_to_be_visible()
        expect(studio.get_by_role("slider", name="Scan")).to_be_visible()
