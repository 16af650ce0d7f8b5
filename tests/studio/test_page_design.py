"""The design side of the page in a real browser, by mouse and keys."""

import re

import pytest

from fuzzytrack.fuzzy.loading import rulebase_path

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright")
expect = playwright.expect


@pytest.fixture
def design(studio):
    """The page of a new session, its first surface drawn."""
    expect(surface(studio)).to_have_attribute("aria-label", re.compile("^stiffness over E and dE"))
    return studio


def cell(page, column, row):
    return page.get_by_role("gridcell", name=f"E {column}, dE {row}:")


def surface(page):
    return page.locator("#pane-surface canvas")


PIXELS = "document.querySelector('#pane-surface canvas').toDataURL()"


def pixels(page):
    """The picture of the surface, which changes with whatever is drawn in it."""
    return page.evaluate(PIXELS)


def expect_redrawn(page, before):
    page.wait_for_function(f"before => {PIXELS} != before", arg=before)


def corner(page, name):
    return page.get_by_role("slider", name=name)


def test_cell_is_typed_and_undone(design):
    cell(design, "ze", "nm").click()
    design.keyboard.press("Enter")
    design.keyboard.type("M-Z")
    design.keyboard.press("Enter")
    expect(cell(design, "ze", "nm")).to_have_text("M-Z")
    expect(cell(design, "ze", "nm")).to_be_focused()
    expect(design.locator("#bar")).to_contain_text("not saved")
    design.keyboard.press("Control+z")
    expect(cell(design, "ze", "nm")).to_have_text("L-L")
    design.keyboard.press("Control+Shift+z")
    expect(cell(design, "ze", "nm")).to_have_text("M-Z")


def test_words_and_keys_change_a_cell_and_its_mirror(design):
    cell(design, "nl", "nl").click()
    design.get_by_label("symmetric").check()
    design.get_by_role("group", name="damping").get_by_role("button", name="Z").click()
    expect(cell(design, "nl", "nl")).to_have_text("S-Z")
    expect(cell(design, "pl", "pl")).to_have_text("S-Z")
    cell(design, "nl", "nl").focus()
    design.keyboard.press("+")
    expect(cell(design, "nl", "nl")).to_have_text("M-Z")
    design.keyboard.press("ArrowRight")
    expect(cell(design, "nm", "nl")).to_be_focused()


def test_refused_cell_says_what_is_allowed_and_esc_leaves_it(design):
    cell(design, "ze", "nm").dblclick()
    design.keyboard.type("M-Q")
    design.keyboard.press("Enter")
    refusal = design.get_by_role("alert")
    expect(refusal).to_contain_text("'Q'")
    expect(refusal).to_contain_text("Z, S, M, L")
    design.keyboard.press("Escape")
    expect(cell(design, "ze", "nm")).to_have_text("L-L")


def test_dragged_corner_is_one_step_of_undo(design):
    box = corner(design, "ze, right foot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = pixels(design)
    design.mouse.move(x, y)
    design.mouse.down()
    design.mouse.move(x + 30, y, steps=5)
    design.mouse.move(x + 60, y, steps=5)
    expect(design.get_by_label("ze, c", exact=True)).not_to_have_value("0.1")
    design.mouse.up()
    expect(design.get_by_role("button", name="Undo")).to_be_enabled()
    expect_redrawn(design, before)
    design.keyboard.press("Control+z")
    expect(design.get_by_label("ze, c", exact=True)).to_have_value("0.1")
    expect(design.locator("#bar")).to_contain_text("as shipped")


def test_corner_moves_by_keys_and_esc_takes_it_back(design):
    corner(design, "ze, right foot").focus()
    design.keyboard.down("ArrowRight")
    expect(design.get_by_label("ze, c", exact=True)).to_have_value("0.15")
    design.keyboard.press("Escape")
    expect(design.get_by_label("ze, c", exact=True)).to_have_value("0.1")


def test_number_and_shape_of_a_set(design):
    design.get_by_label("nl, d", exact=True).fill("-0.25")
    design.keyboard.press("Enter")
    expect(corner(design, "nl, right foot")).to_have_attribute("aria-valuenow", "-0.25")
    design.get_by_label("Shape of ze").select_option("gaussmf")
    expect(design.get_by_label("ze, mean")).to_have_value("0")


def test_surface_turns_and_a_click_explains(design):
    before = pixels(design)
    surface(design).focus()
    design.keyboard.press("ArrowLeft")
    expect_redrawn(design, before)
    surface(design).click()
    expect(design.locator("#pane-explain .results")).to_contain_text("stiffness")
    expect(design.locator("#pane-rules td.fired").first).to_be_visible()


def test_surface_view_shows_contours_and_gains(design):
    design.get_by_role("button", name="β", exact=True).click()
    design.get_by_role("navigation").get_by_role("button", name="Surface").click()
    contours = design.get_by_role("application", name="Contours of beta")
    contours.focus()
    design.keyboard.press("ArrowUp")
    expect(design.locator("#pane-explain").get_by_label("dE")).to_have_value("0.05")
    expect(design.get_by_role("img", name="Reachable: alpha from")).to_be_visible()
    design.get_by_role("button", name="Certify").click()
    expect(design.locator("#pane-gains .verdict")).to_contain_text("certified")


def test_text_with_mistakes_marks_its_cells(design):
    design.get_by_role("button", name="Text").click()
    area = design.get_by_label("YAML of the rule base")
    area.fill(area.input_value().replace("nm: [S-M,", "nm: [S-Q,"))
    expect(design.locator("#text-complaints")).to_contain_text("'Q'")
    design.get_by_role("button", name="Table").click()
    expect(cell(design, "nl", "nm")).to_have_attribute("aria-invalid", "")
    design.get_by_role("button", name="Undo").click()
    expect(design.locator("#pane-rules .complaint")).to_have_count(0)


def test_saved_and_there_after_a_reload(design, server):
    cell(design, "ze", "nm").click()
    design.keyboard.press("-")
    expect(cell(design, "ze", "nm")).to_have_text("M-L")
    design.keyboard.press("Control+s")
    design.get_by_label("Name of the file").fill("mine.yaml")
    design.keyboard.press("Enter")
    expect(design.locator("#bar")).to_contain_text("mine.yaml")
    assert "M-L" in (server.folder / "mine.yaml").read_text().split("nm:")[-1]
    design.get_by_role("navigation").get_by_role("button", name="Surface").click()
    design.reload()
    expect(design.locator("#main")).to_have_attribute("data-view", "surface")
    expect(design.locator("#bar")).to_contain_text("mine.yaml")


def test_pictures_are_saved(design):
    design.get_by_role("button", name="Save a picture of the surface").click()
    with design.expect_download() as download:
        design.get_by_role("menuitem", name="SVG").click()
    text = download.value.path().read_text()
    assert text.startswith("<svg")
    assert text.count("<polygon") > 1500


def test_rules_of_a_list_are_added_and_removed(design):
    design.keyboard.press("Control+o")
    design.get_by_role("button", name="tipper shipped").click()
    rules = design.locator("#pane-rules td.cell")
    expect(rules).to_have_count(5)
    design.get_by_role("button", name="Add a rule").click()
    design.get_by_label("if service").select_option("poor")
    design.get_by_label("if food").select_option("delicious")
    design.get_by_label("then tip").select_option("average")
    design.get_by_role("button", name="Add the rule").click()
    expect(rules).to_have_count(6)
    design.get_by_label("Confidence of the rule").fill("0.5")
    design.keyboard.press("Enter")
    expect(rules.last).to_have_text("tip average@0.5")
    design.get_by_role("button", name="Remove this rule").click()
    expect(rules).to_have_count(5)


def opened(page, name):
    page.keyboard.press("Control+o")
    page.get_by_label("Filter the names").fill(name)
    page.keyboard.press("Enter")
    expect(page.locator("#bar")).to_contain_text(name)


def test_a_rule_says_several_words_each_with_its_confidence(design):
    chosen = cell(design, "ze", "nm")
    chosen.click()
    design.get_by_label("several").check()
    stiffness = design.get_by_role("group", name="stiffness")
    stiffness.get_by_role("button", name="M").click()
    expect(chosen).to_have_attribute("aria-label", re.compile(r"\[M-L@0.5, L-L@0.5\]$"))
    design.get_by_label("Confidence of stiffness M").fill("0.3")
    design.keyboard.press("Enter")
    expect(chosen).to_have_attribute(
        "aria-label", re.compile(r"stiffness: \[M@0.3, L@0.5\], damping: L")
    )
    design.get_by_label("Confidence of damping L").fill("2")
    design.keyboard.press("Enter")
    expect(design.locator("#status")).to_contain_text("a number from 0 to 1")
    # Without the other word it is a rule as before; the keys do the same with Shift.
    stiffness.get_by_role("button", name="M").focus()
    design.keyboard.press("Enter")
    expect(chosen).to_have_attribute("aria-label", re.compile(": L-L"))
    design.get_by_label("several").uncheck()
    stiffness.get_by_role("button", name="M").focus()
    design.keyboard.press("Shift+Enter")
    expect(chosen).to_have_attribute("aria-label", re.compile(r"\[M-L@0.5, L-L@0.5\]$"))


def test_what_is_edited_as_text_leads_to_its_line(design, server):
    text = rulebase_path("tipper").read_text(encoding="utf-8")
    for old, new in [
        ("{gaussmf: [5, 1.5]}", "{not gaussmf: [5, 1.5]}"),
        ("{if: {service: good}, ", "{if: {service: good}, or: [{food: rancid, service: poor}],"),
        ('unit: "%"', "operators: {and: min, or: sum, defuzzification: centroid}"),
    ]:
        assert old in text
        text = text.replace(old, new)
    (server.folder / "other.yaml").write_text(text)
    opened(design, "other.yaml")
    area = design.get_by_label("YAML of the rule base")

    def expect_line(words):
        expect(area).to_be_focused()
        place = area.evaluate("area => area.value.slice(area.selectionStart).split('\\n')[0]")
        assert words in place
        design.keyboard.press("Escape")

    rules = design.locator("#pane-rules td.cell")
    expect(rules.nth(2).locator("xpath=..")).to_contain_text("or")
    rules.nth(2).click()
    design.get_by_role("button", name="text, line").first.click()
    expect_line("{if: {service: good}, or: [")
    design.locator(".operators").get_by_role("button", name="text, line").click()
    expect_line("operators: {and: min")
    # The numbers of a shape that is not dragged are typed.
    design.get_by_label("good, sigma").fill("2")
    design.keyboard.press("Enter")
    rules.nth(0).click()
    expect(design.locator("#pane-rules div.words")).to_contain_text("2 rules have this conclusion")
    design.get_by_role("button", name="not gaussmf").click()
    expect_line("good:      {not gaussmf: [5, 2]}")
