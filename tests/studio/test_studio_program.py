"""The studio as a program of its own, attacked, and ended in the middle of its work."""

import os
import signal
import time
from contextlib import suppress
from pathlib import Path

import pytest

pytest.importorskip("websockets", reason="needs the extra studio")
from waiting import wait_until
from websockets.exceptions import InvalidStatus

SCRIPT = """
import time
from dataclasses import dataclass

from fuzzytrack.schedulers import GainScheduler, schedulers


@schedulers.register("faulty")
@dataclass(frozen=True)
class Faulty(GainScheduler):
    source = "a test"
    uses_acceleration = False
    way: str = "raise"

    def initial_memory(self, n_axes):
        if self.way == "hang":
            time.sleep(3600)
        return ()

    def kernel(self, n_axes):
        def kernel(innovation, change, dt, sigma, memory):
            return 1.0 / (dt - dt), 0.0, 0.0, 1.0, memory

        return kernel
"""
BOMB = ["a0: &a0 [x, x]"] + [f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]" for k in range(1, 30)]
TRACKER = "fixed:alpha=0.3:beta=0.3"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "outside.yaml").write_text("secret")
    found = tmp_path / "folder"
    found.mkdir()
    (found / "link.yaml").symlink_to(tmp_path / "outside.yaml")
    return found


def test_each_attack_is_refused_and_the_program_answers_and_prints_nothing(
    folder, new_program, tmp_path
):
    (tmp_path / "faulty.py").write_text(SCRIPT)
    program = new_program(folder, "--plugin", tmp_path / "faulty.py")
    for options in (
        {"origin": "http://evil.example"},
        {"host": "evil.example"},
        {"token": "another-token-of-somebody"},
    ):
        with pytest.raises(InvalidStatus) as caught:
            program.connect(**options)
        assert caught.value.response.status_code == 403
    with program.page() as page:
        assert page.ended_by("x" * 2**21) in (1009, None)
    with program.page() as page:
        assert page.ask("files")["files"] == []
        asked = [
            ("open", {"name": "../outside.yaml"}, "name: '../outside.yaml' must be the name of"),
            ("open_scenario", {"name": "link.yaml"}, "link.yaml: is a symbolic link"),
            ("run", {"trackers": ["editor"], "runs": 10**9}, "runs: needs a whole number from 1"),
            ("run", {"trackers": ["editor"], "runs": 1e9}, "runs: needs a whole number from 1"),
            ("walk", {"tracker": "faulty"}, "walk: ZeroDivisionError: "),
        ]
        for command, arguments, said in asked:
            refusal = page.refused(command, **arguments)
            assert refusal.startswith(said)
            assert "\n" not in refusal
            assert page.ask("explain", inputs={"E": 0, "dE": 0})["rules"]
        found = page.ask("set_text", text="\n".join(BOMB))["state"]
        assert found["complaints"][0]["message"] == "nested deeper than 12 levels"
        page.ask("undo")

        last = page.job(page.ask("run", trackers=["faulty"], runs=1)["job"])[-1]
        assert last["error"] == "ZeroDivisionError: float division by zero"
        number = page.ask("run", trackers=["faulty:way=hang"], runs=1)["job"]
        assert page.ask("cancel", job=number)["job"]["state"] == "cancelled"
        assert page.job(number)[-1]["state"] == "cancelled"

        # Numbers that overflow, and warnings of trackers here and in other processes.
        page.ask("set_sensors", sigma=1e140)
        assert page.ask("walk", tracker="editor")["t"]
        page.ask("undo")
        page.ask("set_sampling", kind="alternate", value=[1, 500])
        (note,) = page.ask("walk", tracker=TRACKER)["notes"]
        assert note.startswith(f"{TRACKER}: its gains do not suit times between plots that differ")
        last = page.job(page.ask("run", trackers=[TRACKER], runs=150)["job"])[-1]
        assert last["results"]["notes"] == [note]
    program.process.send_signal(signal.SIGINT)
    assert program.end() == ""
    assert program.process.returncode == 0


def processes_of(number):
    """Processes that a process has begun."""
    found = []
    for each in Path(f"/proc/{number}/task").glob("*/children"):
        # A thread that has ended meanwhile has none.
        with suppress(OSError):
            found += map(int, each.read_text().split())
    return found


def is_running(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


@pytest.mark.parametrize(
    ("signals", "status"),
    [
        ((signal.SIGINT, signal.SIGINT), 0),
        ((signal.SIGTERM,), 0),
        ((signal.SIGHUP,), 0),
        ((signal.SIGKILL,), -9),
    ],
)
def test_a_program_that_ends_in_a_run_leaves_no_process(folder, new_program, signals, status):
    if not Path(f"/proc/self/task/{os.getpid()}/children").exists():
        pytest.skip("needs the processes of Linux in /proc")
    program = new_program(folder)
    with program.page() as page:
        page.ask("set_cell", row=0, column=0, text="L-L")
        page.ask("run", trackers=["editor"], runs=100_000)
        wait_until(lambda: processes_of(program.process.pid), program.process)
        begun = processes_of(program.process.pid)
        for each in signals:
            program.process.send_signal(each)
            # Signals that are sent at once may come as one.
            time.sleep(0.05)
    printed = program.end()
    assert program.process.returncode == status
    wait_until(lambda: not any(map(is_running, begun)))
    if status == 0:
        assert printed == ""
        assert len(list(folder.glob(".draft-*.json"))) == 1
