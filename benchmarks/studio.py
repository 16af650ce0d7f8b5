"""The studio: its start, how long an edit takes to be on the screen, and memory.

Run as ``python -m benchmarks.studio``. It starts ``fuzzytrack studio`` for a folder of its own and
drives Debian's Chromium with Playwright, of the extra ``browser``. Times of edits are those that
the page takes itself, from the edit to the end of drawing; on a machine with other work they are
those of its scheduler, and the processor times beside them say more.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

CHROMIUM = Path("/usr/bin/chromium")
STARTS, MIB = 5, 2**20
TRACKERS = [
    "editor", "chan-style", "fixed:alpha=0.5377:beta=0.2018", "kalman-cv:sigma_v=0.0075",
    "omega-schedule",
]  # fmt: skip
#: What is asked: row, largest value, unit.
ASKED = (
    ("start", 1.0, "s CPU"),
    ("page ready", 1.5, "s"),
    ("edit, median", 50.0, "ms"),
    ("edit, p95", 100.0, "ms"),
    ("drag, median", 50.0, "ms"),
    ("drag, p95", 100.0, "ms"),
    ("growth", 50.0, "MiB"),
)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="benchmarks.studio", description=__doc__)
    parser.add_argument("--edits", type=int, default=200, help="cell edits, and steps of a drag")
    parser.add_argument("--more-edits", type=int, default=1000, help="edits before memory is taken")
    parser.add_argument("--runs", type=int, default=20, help="experiments before memory is taken")
    parser.add_argument("-o", "--json", type=Path, metavar="FILE", help="write all figures")
    given = parser.parse_args(arguments)
    figures = measure(given.edits, given.more_edits, given.runs)
    print(table(figures))
    if given.json:
        given.json.write_text(json.dumps(figures, indent=2) + "\n")
    return 0


def measure(edits: int, more_edits: int, runs: int) -> dict[str, float]:
    """Every figure by the name of its row."""
    figures = starts()
    with TemporaryDirectory() as folder, serving(Path(folder)) as server, browsing() as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        figures["page ready"] = ready(page, server.address)
        begun = server.memory()
        for name, gesture in (("edit", edit_cells), ("drag", drag_set)):
            with processor_time(server, page) as taken:
                found = gesture(page, edits)
            figures |= spread(name, found)
            figures |= {f"{name}, {who}": 1000 * t / len(found) for who, t in taken.items()}
        page.close()
        figures |= memory(server, begun, more_edits, runs)
    return figures


# -------------------------------------------------------------------- server and browser


@dataclass(frozen=True)
class Server:
    """A server of the studio in a process of its own."""

    address: str
    process: subprocess.Popen[str]

    def cpu(self) -> float:
        """Processor time that it has taken (s)."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self) -> float:
        """Its memory without that of processes that it has started (MiB)."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / MIB


@contextlib.contextmanager
def serving(folder: Path) -> Iterator[Server]:
    """Serve the studio for a folder, at any free port."""
    command = [sys.executable, "-u", "-m", "fuzzytrack", "studio", str(folder), "--no-browser"]
    process = subprocess.Popen(
        [*command, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        assert process.stdout
        line = process.stdout.readline()
        found = re.search(r"http://\S+", line)
        if not found:
            raise RuntimeError(f"the studio did not start: {line}{process.stdout.read()}")
        yield Server(found[0], process)
    finally:
        process.terminate()
        process.wait(30)


@contextlib.contextmanager
def browsing() -> Iterator[Any]:
    """Start Debian's Chromium without a window."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        browser = player.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
        )
        yield browser
        browser.close()


@contextlib.contextmanager
def processor_time(server: Server, page: Any) -> Iterator[dict[str, float]]:
    """Processor time (s) of the server, and of the thread that draws the page."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def now() -> dict[str, float]:
        metrics = session.send("Performance.getMetrics")["metrics"]
        tasks = next(each["value"] for each in metrics if each["name"] == "TaskDuration")
        return {"CPU of server": server.cpu(), "CPU of page": tasks}

    taken: dict[str, float] = {}
    begun = now()
    yield taken
    taken |= {name: value - begun[name] for name, value in now().items()}
    session.detach()


# -------------------------------------------------------------------- measurements


def starts() -> dict[str, float]:
    """Processor time and time until the address is printed: medians of some starts."""
    cpu, wall = [], []
    for _ in range(STARTS):
        with TemporaryDirectory() as folder:
            begun = time.monotonic()
            with serving(Path(folder)) as server:
                wall.append(time.monotonic() - begun)
                cpu.append(server.cpu())
    return {"start": statistics.median(cpu), "start, elapsed": statistics.median(wall)}


def ready(page: Any, address: str) -> float:
    """Open the page: seconds from navigation to the first surface on it."""
    page.goto(address)
    page.locator("#pane-surface canvas[aria-label^='stiffness over']").wait_for()
    return float(page.evaluate("performance.now()")) / 1000


def edit_cells(page: Any, edits: int) -> list[float]:
    """Change a cell by keys, back and forth: milliseconds from each edit to the end of drawing."""
    page.get_by_role("gridcell", name="E ze, dE nm:").click()
    for k in range(edits):
        page.keyboard.press("-" if k % 2 == 0 else "+")
        until_drawn(page, k + 1)
    return times(page)[-edits:]


def drag_set(page: Any, steps: int) -> list[float]:
    """Drag a corner of a set by mouse, 60 moves a second: times of the steps that were drawn.

    While a step is on its way to the server, the newest of those that come replaces the others.
    """
    before = len(times(page))
    box = page.get_by_role("slider", name="ze, right foot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(10 * steps):
        page.mouse.move(x + 20 + abs(k % 80 - 40), y)
        page.wait_for_timeout(1000 / 60)
        if len(times(page)) - before >= steps:
            break
    page.mouse.up()
    return times(page)[before : before + steps]


def times(page: Any) -> list[float]:
    return [float(took) for took in page.evaluate("window.studioTimes.map(each => each.took)")]


def until_drawn(page: Any, count: int) -> None:
    """Wait until so many edits have been drawn."""
    for _ in range(1000):
        if page.evaluate("window.studioTimes.length") >= count:
            return
        page.wait_for_timeout(5)
    raise RuntimeError(f"edit {count} was not drawn within 5 s")


def spread(name: str, found: Sequence[float]) -> dict[str, float]:
    """Rows of some times (ms): median, 95th percentile, number."""
    p95 = statistics.quantiles(found, n=20, method="inclusive")[-1]
    middle = statistics.median(found)
    return {f"{name}, median": middle, f"{name}, p95": p95, f"{name}, number": len(found)}


def memory(server: Server, begun: float, edits: int, runs: int) -> dict[str, float]:
    """Memory of the server (MiB) after edits with their surfaces, and after experiments."""
    with talking(server.address) as ask:
        ask("hello")
        for k in range(edits):
            text = ("S-L", "M-Z")[k % 2]
            ask("set_cell", row=k % 7, column=k // 7 % 7, text=text)
            ask("surface", outputs=["stiffness"], columns=61)
        after_edits = server.memory()
        for seed in range(runs):
            ask("run", trackers=TRACKERS, runs=200, seed=seed)
            ask.until_done()
        after = server.memory()
    return {
        "memory, page ready": begun,
        "memory, edits": after_edits,
        "memory, experiments": after,
        "growth": after - begun,
    }


class Talk:
    """Commands to a server without a browser, one after the other."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket
        self._seq = 0

    def __call__(self, command: str, **arguments: Any) -> Any:
        """Result of a command; a surface as it was sent."""
        self._seq += 1
        message = {"seq": self._seq, "command": command, "arguments": arguments}
        self._socket.send(json.dumps(message))
        while True:
            found = self._socket.recv(timeout=60)
            if isinstance(found, bytes):
                return found
            content = json.loads(found)
            if content.get("seq") == self._seq:
                if "error" in content:
                    raise RuntimeError(content["error"])
                return content["result"]

    def until_done(self) -> None:
        """Wait for the end of the job."""
        while True:
            content = json.loads(self._socket.recv(timeout=300))
            if content.get("event") == "job" and content["job"]["state"] != "running":
                if content["job"]["state"] != "done":
                    raise RuntimeError(str(content["job"]))
                return


@contextlib.contextmanager
def talking(address: str) -> Iterator[Talk]:
    """Open a socket as the page does."""
    from websockets.sync.client import connect

    host, token = re.fullmatch(r"http://([^/]+)/#token=(.+)", address).groups()  # type: ignore[union-attr]
    protocols: Any = ["fuzzytrack", f"token.{token}"]
    origin: Any = f"http://{host}"
    with connect(
        f"ws://{host}/socket", origin=origin, subprotocols=protocols, proxy=None, max_size=None
    ) as socket:
        yield Talk(socket)


# -------------------------------------------------------------------- the table


def table(figures: dict[str, float]) -> str:
    """Rows with what is asked, and whether it is met."""
    asked = {name: (most, unit) for name, most, unit in ASKED}
    lines = []
    for name, value in figures.items():
        line = f"{name:<21} {value:8.2f}"
        if name in asked:
            most, unit = asked[name]
            verdict = "met" if value <= most else "MISSED"
            line += f" {unit:<6} asked: at most {most:g}, {verdict}"
        lines.append(line)
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
