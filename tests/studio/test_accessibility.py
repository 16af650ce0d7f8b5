"""Every view of the page by the rules of WCAG 2.2, levels A and AA, as axe-core checks them."""

from importlib import resources

import pytest

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright")
pytest.importorskip("axe_playwright_python", reason="needs axe-core, of the extra browser")
expect = playwright.expect

AXE = resources.files("axe_playwright_python").joinpath("axe.min.js").read_text("utf-8")
LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
CSV = "time,x,y,tx,ty\n" + "".join(
    f"{k},{30 * k + k * k % 7},{k * k % 50},{30 * k},{20}\n" for k in range(60)
)


def findings(page):
    """What axe-core finds on the page as it is: rule, and first elements."""
    for _ in range(20):
        found = page.evaluate(
            "levels => axe.run(document, {runOnly: levels, resultTypes: ['violations']})", LEVELS
        )
        if not found["violations"]:
            break
        # Under load it may still be drawn.
        page.wait_for_timeout(500)
    return [
        (each["id"], [n["html"][:200] for n in each["nodes"][:3]]) for each in found["violations"]
    ]


def view(page, name):
    page.locator("#rail").get_by_role("button", name=name).click()


@pytest.fixture(params=["light", "dark"])
def studio(request, browser_page):
    """The page of a new session in one of the two color schemes."""
    page = browser_page
    page.emulate_media(color_scheme=request.param)
    page.evaluate("sessionStorage.clear()")
    page.reload()
    page.evaluate(AXE)
    expect(page.locator("#status")).to_contain_text("connected")
    expect(page.locator("html")).to_have_attribute("data-scheme", request.param)
    yield page
    page.emulate_media(color_scheme="light")


def test_rules_sets_and_surfaces(studio):
    studio.get_by_role("gridcell", name="E ze, dE nm:").click()
    studio.get_by_role("button", name="Explain the middle").click()
    assert findings(studio) == []
    studio.keyboard.press("Control+o")
    expect(studio.locator("dialog")).to_be_visible()
    assert findings(studio) == []
    studio.keyboard.press("Escape")
    studio.get_by_role("button", name="Text", exact=True).click()
    assert findings(studio) == []
    view(studio, "Surface")
    expect(studio.locator("#pane-contour")).to_be_visible()
    assert findings(studio) == []


def test_world_and_results(studio):
    view(studio, "World")
    studio.get_by_label("Maneuver", exact=True).select_option("waypoints")
    expect(studio.locator("table.waypoints")).to_be_visible()
    studio.get_by_role("button", name="sensor field").click()
    assert findings(studio) == []
    studio.keyboard.press("Control+z")
    view(studio, "Run")
    studio.get_by_role("textbox", name="Runs").first.fill("20")
    studio.keyboard.press("Control+Enter")
    expect(studio.locator("#pane-run [role=status]")).to_contain_text("20 runs in")
    for tab in ("All trackers", "Side by side", "One run"):
        studio.get_by_role("button", name=tab).click()
        assert findings(studio) == [], tab


def test_own_data(studio):
    view(studio, "Data")
    assert findings(studio) == []
    files = {"name": "mine.csv", "mimeType": "text/csv", "buffer": CSV.encode()}
    studio.locator("#pane-data input[type=file]").set_input_files(files)
    expect(studio.locator("#pane-data")).to_contain_text("60 plots")
    assert findings(studio) == []
