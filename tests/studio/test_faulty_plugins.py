"""Plug-ins that raise, hang or end their process, and what remains of the page."""

import multiprocessing

import pytest
from waiting import PATIENCE

from fuzzytrack.plugins import scripts
from fuzzytrack.plugins.scripts import load_script
from fuzzytrack.trackers import trackers

SCRIPT = """
import os
import time
from dataclasses import dataclass

from fuzzytrack.trackers import trackers
from fuzzytrack.trackers.base import Tracker


@trackers.register("faulty")
@dataclass(frozen=True)
class Faulty(Tracker):
    way: str = "raise"

    def __post_init__(self):
        if self.way == "raise at once":
            raise RuntimeError("at once")

    def run(self, t, z, sigma=None):
        if self.way == "raise":
            raise RuntimeError("no way")
        if self.way == "end":
            os._exit(1)
        time.sleep(3600)
"""


@pytest.fixture
def faulty(tmp_path, monkeypatch):
    monkeypatch.setattr(scripts, "_loaded", {})
    path = tmp_path / "faulty.py"
    path.write_text(SCRIPT)
    load_script(path)
    yield
    trackers.unregister("faulty")


@pytest.mark.usefixtures("faulty")
def test_a_plug_in_takes_nothing_else_with_it(tmp_path, new_server, monkeypatch):
    monkeypatch.setattr("fuzzytrack.studio.jobs._processes", lambda: 1)
    before = set(multiprocessing.active_children())
    server = new_server(tmp_path)
    with server.page() as page:
        assert "faulty" in {each["name"] for each in page.hello["trackers"]}
        message = page.refused("run", trackers=["faulty:way=raise at once"], runs=1)
        assert message == "run: RuntimeError: at once"
        assert page.refused("walk", tracker="faulty") == "walk: RuntimeError: no way"

        last = page.job(page.ask("run", trackers=["faulty"], runs=1)["job"])[-1]
        assert (last["state"], last["error"]) == ("failed", "RuntimeError: no way")

        last = page.job(page.ask("run", trackers=["faulty:way=end"], runs=1)["job"])[-1]
        assert last["state"] == "failed"
        assert "a process ended" in last["error"]

        number = page.ask("run", trackers=["faulty:way=hang"], runs=1)["job"]
        monkeypatch.setattr("fuzzytrack.studio.jobs.SILENCE", 0.0)
        # The next job finds out that this one is stuck.
        page.ask("run", trackers=["fixed:alpha=0.5:beta=0.2"], runs=1)
        (found,) = [e["job"] for e in page.events if e["job"]["state"] == "failed"]
        assert found["id"] == number
        assert "may hang" in found["error"]
    server.close()
    begun = set(multiprocessing.active_children()) - before
    for child in begun:
        child.join(PATIENCE)
    assert not begun & set(multiprocessing.active_children())


@pytest.mark.usefixtures("faulty")
def test_an_answer_that_never_comes_is_given_up(tmp_path, new_server, monkeypatch):
    with new_server(tmp_path).page() as page:
        page.send("walk", tracker="faulty:way=hang")
        assert page.ask("set_cell", row=0, column=0, text="M-Z")["state"]
        with monkeypatch.context() as patch:
            patch.setattr("fuzzytrack.studio.threads.SECONDS", 1.0)
            said = page.refused("walk", tracker="faulty:way=hang")
        assert said == "this took longer than 1 s, and was given up"
        assert page.ask("undo")["state"]
