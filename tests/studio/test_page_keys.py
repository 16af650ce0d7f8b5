"""The page by keys alone: every control is reached, none loses the focus, all that a mouse does."""

import re

import pytest

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright")
expect = playwright.expect

# What has the focus, and whether it is to be seen: by an outline, or by another shape of a handle.
FOCUSED = """() => {
    const one = document.activeElement;
    if (one === document.body) return null;
    const mark = one.matches("g") ? getComputedStyle(one.querySelector(".reach")).stroke : "";
    const { outlineStyle, outlineWidth } = getComputedStyle(one);
    const box = one.getBoundingClientRect();
    return {
        name: one.getAttribute("aria-label") ?? one.labels?.[0]?.textContent ?? one.textContent,
        marked: (outlineStyle !== "none" && outlineWidth !== "0px") || mark.startsWith("rgb"),
        inside: box.right > 0 && box.bottom > 0 && box.left < innerWidth && box.top < innerHeight,
        place: [one.tagName, box.left, box.top].join(),
    };
}"""


@pytest.fixture
def studio(studio):
    """The page of a new session, its first surface drawn."""
    surface = studio.locator("#pane-surface canvas")
    expect(surface).to_have_attribute("aria-label", re.compile("^stiffness over E and dE"))
    return studio


@pytest.fixture(params=[("light", 1280, 800), ("dark", 820, 1100)], ids=["light-1280", "dark-820"])
def sized(request, studio):
    """The same in two sizes and color schemes."""
    scheme, width, height = request.param
    studio.emulate_media(color_scheme=scheme)
    studio.set_viewport_size({"width": width, "height": height})
    yield studio
    studio.emulate_media(color_scheme="light")
    studio.set_viewport_size({"width": 1280, "height": 800})


def by_keys(page, view):
    page.locator("#rail").get_by_role("button", name=view).focus()
    page.keyboard.press("Enter")


def tabbed(page):
    """What the Tab key comes to, from the start of the page to its end."""
    page.evaluate("document.activeElement.blur()")
    page.locator(".skip").focus()
    found = []
    for _ in range(200):
        page.keyboard.press("Tab")
        now = page.evaluate(FOCUSED)
        if now is None or now["place"] in [each["place"] for each in found]:
            break
        found.append(now)
    else:
        pytest.fail("the end of the page is never reached")
    return found


@pytest.mark.parametrize("view", ["Rules", "Surface", "World", "Run"])
def test_tab_comes_to_all_controls_and_the_focus_is_seen(sized, view):
    by_keys(sized, view)
    if view == "World":
        sized.get_by_label("Maneuver", exact=True).select_option("waypoints")
        expect(sized.locator("table.waypoints")).to_be_visible()
    found = tabbed(sized)
    names = [each["name"] for each in found]
    last = {
        "Rules": "dE",
        "Surface": "Save a picture of the gain plane",
        "World": "Scenario in YAML",
        "Run": "Keep",
    }[view]
    assert any(name.startswith(last) for name in names[-8:]), names
    assert [each["name"] for each in found if not (each["marked"] and each["inside"])] == []


def test_controls_keep_the_focus_when_they_are_pressed(studio):
    for name, key in [("Snap", "ArrowDown"), ("Shape of nm", "ArrowDown"), ("Operator or", "End")]:
        control = studio.get_by_label(name, exact=True)
        before = control.input_value()
        control.focus()
        studio.keyboard.press(key)
        expect(control).not_to_have_value(before)
        expect(control).to_be_focused()
    studio.get_by_role("button", name="Undo").focus()
    studio.keyboard.press("Enter")
    studio.keyboard.press("Enter")
    expect(studio.locator("#bar")).to_contain_text("as shipped")
    expect(studio.get_by_role("button", name="Undo")).to_be_focused()
    studio.get_by_role("button", name="Text", exact=True).focus()
    studio.keyboard.press("Enter")
    expect(studio.locator("#pane-text").get_by_role("button", name="Text")).to_be_focused()
    studio.keyboard.press("ArrowLeft")
    expect(studio.locator("#pane-text").get_by_role("button", name="Table")).to_be_focused()
    studio.keyboard.press("Tab")
    studio.keyboard.press("Tab")
    studio.keyboard.press("Escape")
    expect(studio.get_by_role("gridcell", name="E nl, dE nl:")).to_be_focused()


def test_escape_takes_back_what_is_typed(studio):
    number = studio.get_by_label("nm, b", exact=True)
    number.focus()
    studio.keyboard.type("7")
    studio.keyboard.press("Escape")
    expect(number).to_have_value("-0.3")
    studio.keyboard.press("Tab")
    expect(studio.locator("#bar")).to_contain_text("as shipped")


def test_a_set_is_moved_as_a_whole(studio):
    whole = studio.get_by_role("slider", name="ze, whole set")
    whole.focus()
    studio.keyboard.press("ArrowRight")
    expect(whole).to_be_focused()
    for name, value in [("a", "-0.05"), ("b", "0.05"), ("c", "0.15")]:
        expect(studio.get_by_label(f"ze, {name}", exact=True)).to_have_value(value)


def test_a_rule_base_is_opened_by_its_name(studio):
    studio.keyboard.press("Control+o")
    studio.keyboard.type("omega")
    studio.keyboard.press("Enter")
    expect(studio.locator("#bar")).to_contain_text("omega-schedule")


def test_waypoints_are_put_and_distances_measured(studio):
    by_keys(studio, "World")
    draw = studio.get_by_role("button", name="Draw way-points")
    draw.focus()
    studio.keyboard.press("Enter")
    for k, way in enumerate(["ArrowUp", "ArrowRight", "ArrowDown"], 1):
        studio.keyboard.press(f"Shift+{way}")
        studio.keyboard.press("Space")
        expect(studio.locator(".waypoint")).to_have_count(k)
    studio.keyboard.press("Enter")
    expect(studio.locator("table.waypoints tbody tr")).to_have_count(3)
    studio.get_by_role("button", name="Measure").first.focus()
    studio.keyboard.press("Enter")
    studio.keyboard.press("Space")
    studio.keyboard.press("Space")
    studio.keyboard.press("Shift+ArrowRight")
    expect(studio.locator("#pane-world .ruler-text")).to_have_text(re.compile(r"m, 0°$"))
    expect(studio.locator("#pane-world .coordinates")).to_have_text(re.compile(r"m, 0°$"))
    studio.keyboard.press("Escape")
    expect(studio.locator("#pane-world .ruler-text")).to_have_count(0)
    expect(studio.locator("#pane-world svg.map")).to_be_focused()
