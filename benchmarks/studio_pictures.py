"""Pictures of every view of the studio for docs/studio.md, in light and dark.

Run as ``python -m benchmarks.studio_pictures [FOLDER]``; they go to docs/images unless a folder is
given. It needs what `benchmarks.studio` needs.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image

from benchmarks.studio import browsing, serving
from fuzzytrack.io.formats import write_table
from fuzzytrack.simulation.samples import make_sample

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
SIZE = {"width": 1280, "height": 800}
# Bytes of a file; a larger one is written with fewer colors.
MOST = 150_000
# Least difference of two of these, of all three channels together.
APART = 16


def main(folder: Path = IMAGES) -> None:
    """Write studio-VIEW-light.png and studio-VIEW-dark.png."""
    with browsing() as browser:
        for scheme in ("light", "dark"):
            with TemporaryDirectory() as files, serving(Path(files)) as server:
                page = browser.new_page(viewport=SIZE, color_scheme=scheme)
                page.goto(server.address)
                page.locator("#pane-surface canvas[aria-label^='stiffness over']").wait_for()
                for name, show in VIEWS.items():
                    show(page)
                    page.mouse.move(0, 0)
                    page.wait_for_timeout(500)
                    save(page, folder / f"studio-{name}-{scheme}.png")
                page.close()


def save(page: Any, path: Path) -> None:
    page.screenshot(path=path)
    with Image.open(path) as picture:
        colors = picture.convert("RGB")
    colors.save(path, optimize=True)
    if path.stat().st_size > MOST:
        fewer(colors).save(path, optimize=True)


def fewer(picture: Image.Image) -> Image.Image:
    """The picture in 256 colors: the frequent ones that differ, so that lines keep theirs."""
    pixels = np.asarray(picture, np.int32)
    colors, place, count = np.unique(
        pixels.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True
    )
    chosen = colors[:0]
    for color in colors[np.argsort(-count)]:
        if len(chosen) == 256:
            break
        if not len(chosen) or np.abs(chosen - color).sum(axis=1).min() > APART:
            chosen = np.vstack([chosen, color])
    nearest = [int(np.abs(chosen - color).sum(axis=1).argmin()) for color in colors]
    indices = np.array(nearest, np.uint8)[place].reshape(pixels.shape[:2])
    found = Image.fromarray(indices, "P")
    found.putpalette(chosen.astype(np.uint8).tobytes())
    return found


# -------------------------------------------------------------------- views


def open_view(page: Any, name: str) -> None:
    page.locator("#rail").get_by_role("button", name=name).click()


def rules(page: Any) -> None:
    """A cell is chosen, and a point explained."""
    open_view(page, "Rules")
    page.get_by_role("gridcell", name="E ps, dE ns:").click()
    explain(page, 0.25, -0.15)


def explain(page: Any, *point: float) -> None:
    for k, value in enumerate(point):
        page.locator("#pane-explain input").nth(k).fill(str(value))
        page.keyboard.press("Enter")


def surface(page: Any) -> None:
    """After a run, with what it visited."""
    open_view(page, "Surface")
    page.get_by_label("visits").check()
    page.get_by_role("button", name="reachable").click()
    explain(page, 0.25, -0.15)


def world(page: Any) -> None:
    """Way-points on the curve of the scenario."""
    open_view(page, "World")
    page.get_by_label("Maneuver", exact=True).select_option("waypoints")
    page.locator("table.waypoints").wait_for()


def results(page: Any) -> None:
    """Five trackers."""
    open_view(page, "Run")
    page.get_by_role("textbox", name="Runs").first.fill("200")
    page.get_by_role("textbox", name="Seed").fill("3")
    page.keyboard.press("Control+Enter")
    status = page.locator("#pane-run [role=status]")
    status.filter(has_text=re.compile("200 runs in")).wait_for(timeout=120_000)


def walk(page: Any) -> None:
    """One scan in the middle of a turn."""
    page.get_by_role("button", name="One run").click()
    slider = page.get_by_role("slider", name="Scan")
    page.wait_for_timeout(3000)
    slider.fill("9")


def data(page: Any) -> None:
    """The file of a radar, read as the page proposes."""
    open_view(page, "Data")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "radar.csv"
        write_table(str(path), make_sample("radar", 0).plots)
        page.locator("#pane-data input[type=file]").set_input_files(path)
        page.get_by_role("button", name="Use range, azimuth").click()
    page.get_by_role("button", name="Use track as").click(timeout=120_000)
    page.locator("#pane-data .what").filter(has_text="6 tracks").wait_for(timeout=120_000)


VIEWS = {
    "rules": rules,
    "world": world,
    "results": results,
    "walk": walk,
    "surface": surface,
    "data": data,
}


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=IMAGES)
    main(parser.parse_args().folder)
