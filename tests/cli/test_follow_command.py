"""`fuzzytrack track - --follow` as a process: pipes, interrupts, states."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from waiting import PATIENCE, wait_until

import fuzzytrack as ft
from fuzzytrack.cli.app import app
from fuzzytrack.recordings.live_state import LiveState

ROOT = Path(__file__).resolve().parents[2]
FIXED = ["--tracker", "fixed:alpha=0.5:beta=0.3", "--no-compile"]


@contextmanager
def following(*options, **extra):
    """A process that follows; killed at the end if it has not ended."""
    command = [sys.executable, "-m", "fuzzytrack", "track", "-", "--follow", *options]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        **extra,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait(PATIENCE)
        for pipe in (process.stdin, process.stdout, process.stderr):
            with suppress(BrokenPipeError):
                pipe.close()


def send(process, *lines):
    process.stdin.write("".join(line + "\n" for line in lines).encode())
    process.stdin.flush()


def answer(process):
    """The next line of the answers."""
    return process.stdout.readline().decode().rstrip("\n")


@pytest.fixture
def follow(tmp_path, monkeypatch, capfd):
    """Status, answers and remarks of a feed that ends, in this process."""

    def call(text, *options):
        feed = tmp_path / "feed.txt"
        feed.write_text(text)
        with feed.open() as stream, monkeypatch.context() as patch:
            patch.setattr(sys, "stdin", stream)
            with pytest.raises(SystemExit) as ended:
                app(["track", "-", "--follow", *options])
        return ended.value.code, *capfd.readouterr()

    return call


def test_each_line_is_answered_before_the_next_one_comes():
    # Compiled first, since this feed has not ended yet; code of other tests, which is kept on disk.
    with following("--tracker", "fixed:alpha=0.5:beta=0.2:gamma=0.05") as process:
        send(process, "time,x")
        for time_, x in (0, 10), (1, 12), (2, 14):
            send(process, f"{time_},{x}")
            if not time_:
                assert answer(process).startswith("time,x,x_predicted,")
            assert answer(process).startswith(f"{time_},{x}.0,")
        process.stdin.close()
        assert process.wait(PATIENCE) == 0
        assert "4 lines; 3 answers; 1 track" in process.stderr.read().decode()


def test_lines_of_json_are_answered_in_json(follow):
    feed = (
        '{"t": 0, "id": 3, "x": 1.5}\n{"t": 1, "id": 3, "x": null}\n{"t": 2, "id": 3, "x": "2"}\n'
    )
    status, answers, _ = follow(feed, *FIXED, "--id", "id")
    rows = [json.loads(line) for line in answers.splitlines()]
    assert status == 0
    assert [(row["t"], row["id"], row["x"]) for row in rows] == [
        (0, 3, 1.5),
        (1, 3, None),
        (2, 3, 2),
    ]
    assert rows[1]["coasted"] is True
    assert rows[2]["x_velocity"] == 0.25


def test_json_is_given_of_csv_as_well(follow):
    status, answers, _ = follow("t,id,x\n0,007,1\n", *FIXED, "--id", "id", "--json")
    row = json.loads(answers)
    assert status == 0
    assert (row["t"], row["id"], row["x"], row["revision"]) == (0, "007", 1.0, 0)


def test_a_late_plot_is_put_in_its_place_and_what_changes_is_written_again(follow):
    status, answers, said = follow("t,x\n0,0\n1,1\n3,9\n2,4\n", *FIXED, "--lateness", "5")
    rows = [line.split(",") for line in answers.splitlines()[1:]]
    assert status == 0
    assert [(row[0], row[-1]) for row in rows] == [
        *(("0", "0"), ("1", "0"), ("3", "0"), ("2", "0"), ("3", "1")),
    ]
    assert "5 answers, 1 of them again after 1 late plot; 1 track" in said


def test_plots_that_are_too_late_and_faulty_lines_are_counted_and_the_first_is_named(follow):
    feed = "t,x\n0,0\n1,1\n5,5\n1.5,9\n5,6\n5,5\nwhat,7\n6,7,8\n6\n7,7\n"
    status, answers, said = follow(feed, *FIXED, "--lateness", "2")
    assert status == 0
    assert [line.split(",")[0] for line in answers.splitlines()[1:]] == ["0", "1", "5", "7"]
    assert "line 5: time 1.5: 3.5 s older than its track; not used" in said
    assert "line 6: time 5: its track has a plot at this time already; not used" in said
    assert "the feed: row 8, column t: 'what'" in said
    assert "3 faulty lines, left out" in said
    assert "1 exact copy of a row dropped" in said


@pytest.mark.parametrize(
    ("feed", "what"),
    [
        ("t,q\n0,1\n", "no columns x, y"),
        ("1,2\n3,4\n", "holds numbers"),
        ("", "is empty"),
        ('\n"t"x,x\n0,1\n', "row 2: not CSV"),
        ("t,x\n", "holds no rows"),
        ("[1, 2]\n[2, 3]\n", "no column t, time"),
        ('{"t": 1\n', "not JSON"),
    ],
)
def test_a_feed_that_does_not_begin_as_one_ends_with_status_2(feed, what, follow):
    status, answers, said = follow(feed, *FIXED)
    assert status == 2
    assert answers == ""
    assert what in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--sort"], "--lateness puts late plots in place"),
        (["--plot", "a.png"], "--plot: needs the whole recording"),
        (["--jobs", "2"], "--jobs: needs the whole recording"),
        (["--sigma", "auto"], "--sigma: auto needs the whole recording"),
        (["-o", "a.parquet"], "a.parquet: needs the whole recording"),
        (["--duplicates", "mean"], "--duplicates: mean needs the rows to come"),
        (["--max-coast", "5", "--lateness", "1"], "--max-coast"),
        (["--lateness", "-1"], "--lateness: must be"),
        (["--lateness", "5", "--forget", "3"], "--forget: must be"),
        (["--format", "ais"], "--format: ais"),
        (["--feed", "again"], "--state names its file"),
        (["--state", "s", "--feed", "back"], "--feed: expected again or onward"),
    ],
)
def test_what_needs_a_whole_recording_is_refused_in_one_line(options, what, follow):
    status, _, said = follow("t,x\n0,1\n", *FIXED, *options)
    assert status == 2
    assert what in said
    assert len(said.splitlines()) == 1


def test_a_standard_input_that_is_closed_is_told_of_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(SystemExit) as ended:
        app(["track", "-", "--follow", *FIXED])
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith("error: --follow: reads standard input, which is")


@pytest.mark.parametrize("option", [["--lateness", "1"], ["--state", "s"], ["--no-compile"]])
def test_options_of_a_live_run_are_refused_without_follow(fails, plots, option):
    assert "give --follow as well" in fails("track", plots, *option)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_a_stop_end_a_run_with_its_sums_and_status_130(number, tmp_path):
    state = tmp_path / "state"
    with following(*FIXED, "--state", str(state)) as process:
        send(process, "t,x", "0,1", "1,2")
        for _ in range(3):
            answer(process)
        process.send_signal(number)
        assert process.wait(PATIENCE) == 130
        said = process.stderr.read().decode()
    assert "3 lines; 2 answers; 1 track" in said
    assert "Traceback" not in said
    assert LiveState.load(state).lines == 3


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_a_full_disk_ends_the_run_and_is_named(follow, monkeypatch):
    full = os.open("/dev/full", os.O_WRONLY)
    monkeypatch.setattr("fuzzytrack.io.line_target._STANDARD_OUTPUT", full)
    status, _, said = follow("t,x\n0,1\n", *FIXED)
    os.close(full)
    assert status == 2
    assert said.splitlines()[-1].startswith("error: standard output: No space left")


def test_a_reader_that_goes_away_ends_the_run_without_a_traceback():
    with following(*FIXED) as process:
        send(process, "t,x", "0,1")
        answer(process)
        process.stdout.close()
        # Its answer cannot be written.
        send(process, "1,1")
        assert process.wait(PATIENCE) == 0
        assert "Traceback" not in process.stderr.read().decode()


def feed_of(count):
    """Plots of three tracks, some of them late."""
    rows = [(k // 3 - 2 * (k % 7 == 5), "abc"[k % 3], k % 11 + 0.25) for k in range(count)]
    return ["t,id,x", *(f"{t},{id},{x}" for t, id, x in rows)]


OPTIONS = [*FIXED, "--id", "id", "--lateness", "4"]


@pytest.mark.parametrize("way", ["again", "onward"])
def test_a_run_that_is_resumed_writes_what_an_uninterrupted_one_does(tmp_path, way, follow):
    lines = feed_of(300)
    whole, parts, state = (str(tmp_path / name) for name in ("whole.csv", "parts.csv", "state"))
    assert follow("\n".join(lines), *OPTIONS, "-o", whole)[0] == 0
    given = [*OPTIONS, "-o", parts, "--state", state]
    assert follow("\n".join(lines[:100]), *given)[0] == 0
    # Answers that a killed process has written after its last save are cut off.
    with open(parts, "a") as file:
        file.write("half a li")
    rest = lines if way == "again" else [lines[0], *lines[100:]]
    status, _, said = follow("\n".join(rest), *given, "--feed", way)
    assert status == 0
    assert "goes on after line 100 of the feed" in said
    with open(whole) as one, open(parts) as other:
        assert one.read() == other.read()


def test_a_killed_run_goes_on_from_its_last_state(tmp_path, monkeypatch, follow):
    lines = feed_of(60)
    whole, parts, state = (str(tmp_path / name) for name in ("whole.csv", "parts.csv", "state"))
    assert follow("\n".join(lines), *OPTIONS, "-o", whole)[0] == 0
    given = [*OPTIONS, "-o", parts, "--state", state]
    with following(*given) as process:
        send(process, *lines[:20])
        wait_until(lambda: os.path.exists(state), process)
        answered = os.path.getsize(parts)
        send(process, *lines[20:30])
        # Answers that the state does not know of.
        wait_until(lambda: os.path.getsize(parts) > answered, process)
        process.send_signal(signal.SIGKILL)
        process.wait(PATIENCE)
    assert follow("\n".join(lines), *given)[0] == 0
    with open(whole) as one, open(parts) as other:
        assert one.read() == other.read()


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (["--lateness", "3"], "was made with lateness 4.0, and not 3.0"),
        (["--tracker", "fixed:alpha=0.6:beta=0.3"], "which is not this"),
        (["--gate", "none"], "was made with gate auto"),
    ],
)
def test_a_state_of_other_options_is_refused_in_one_line(tmp_path, change, what, follow):
    state = str(tmp_path / "state")
    assert follow("\n".join(feed_of(9)), *OPTIONS, "--state", state)[0] == 0
    status, _, said = follow("\n".join(feed_of(9)), *OPTIONS, "--state", state, *change)
    assert status == 2
    assert what in said.splitlines()[-1]


def test_another_feed_is_refused_by_its_first_lines(tmp_path, follow):
    state = str(tmp_path / "state")
    assert follow("\n".join(feed_of(9)), *OPTIONS, "--state", state)[0] == 0
    status, _, said = follow("\n".join(["t,id,x", "9,z,1"]), *OPTIONS, "--state", state)
    assert status == 2
    assert "give --feed onward if it goes on" in said
    status, _, said = follow("\n".join(feed_of(4)), *OPTIONS, "--state", state)
    assert status == 2
    assert "ends after 5 lines, of which 10 were taken" in said


def test_a_file_that_is_no_state_is_refused(tmp_path, follow):
    state = tmp_path / "state"
    state.write_bytes(b"PK\x03\x04 no state")
    status, _, said = follow("t,x\n0,1\n", *FIXED, "--state", str(state))
    assert status == 2
    assert "is no state of a live run" in said


def test_answers_are_added_to_a_file_of_answers_and_to_no_other(tmp_path, follow):
    out = tmp_path / "out.csv"
    for text in ("t,x\n0,1\n", "t,x\n5,2\n"):
        assert follow(text, *FIXED, "-o", str(out))[0] == 0
    assert [line.split(",")[0] for line in out.read_text().splitlines()] == ["t", "0", "5"]
    out.write_text("something,else\n")
    status, _, said = follow("t,x\n0,1\n", *FIXED, "-o", str(out))
    assert status == 2
    assert "holds something else than these answers" in said
    assert out.read_text() == "something,else\n"


def test_without_noise_the_tracker_that_needs_none_is_taken_with_a_note(follow):
    status, answers, said = follow("t,x\n0,1\n1,2\n", "--no-compile")
    assert status == 0
    assert answers
    assert "Tracked with stiffness-damping: maneuver needs it" in said
    assert "--sigma gives it" in said


def test_a_feed_in_order_is_answered_as_its_file_is_tracked(tmp_path, follow):
    feed = "\n".join(f"{k // 2},{'ab'[k % 2]},{k % 5},{k % 3}" for k in range(40))
    file = tmp_path / "plots.csv"
    file.write_text(f"time,id,x,y\n{feed}\n")
    options = ["--id", "id", "--sigma", "2", "--tracker", "kalman-cv:sigma_v=1"]
    status, answers, _ = follow(file.read_text(), *options, "--no-compile")
    ft.track(file, "kalman-cv:sigma_v=1", id="id", sigma=2.0).write(tmp_path / "tracks.csv")
    assert status == 0
    live = [line.rsplit(",", 1)[0] for line in answers.splitlines()]
    whole = (tmp_path / "tracks.csv").read_text().splitlines()
    assert live[0] == whole[0]
    assert sorted(live) == sorted(whole)


def test_the_example_of_the_guide_is_what_it_prints(follow):
    page = (ROOT / "docs" / "live.md").read_text()
    (feed,) = re.findall(r"^`feed.csv`.*?```text\n(.*?)^```", page, flags=re.M | re.S)
    page = page.replace("\\\n", "")
    ((command, shown),) = re.findall(r"^```console\n\$ (.*?)\n(.*?)^```", page, flags=re.M | re.S)
    program, _, _, _, *options = shlex.split(command.partition("<")[0])
    assert program == ".venv/bin/fuzzytrack"
    status, answers, said = follow(feed, *options)
    assert status == 0
    assert answers + "".join(said.splitlines(keepends=True)[2:]) == shown
