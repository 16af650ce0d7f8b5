"""The command `scan --follow`: plots that come through a pipe or a port."""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest
from waiting import PATIENCE, wait_until

from fuzzytrack.recordings.scan_state import ScanState

COMMAND = (sys.executable, "-m", "fuzzytrack", "scan")


def harbor():
    rng = np.random.default_rng(5)
    lines = ["scan,t,x,y"]
    for k in range(20):
        t = 1.5 * k
        for x, y in [(3 * t, 40), (-70, 4 * t)]:
            dx, dy = rng.normal(0, 0.7, 2).tolist()
            lines.append(f"{k},{t},{x + dx:.3f},{y + dy:.3f}")
    return "\n".join(lines) + "\n"


def test_a_pipe_gives_what_a_file_gives(run, csv, tmp_path):
    path, out = csv(harbor()), tmp_path / "tracks.csv"
    assert run("scan", path, "-o", out).exit_code == 0
    done = subprocess.run(
        [*COMMAND, "-", "--follow"], input=harbor(), capture_output=True, text=True, check=False,
        timeout=PATIENCE,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout == out.read_text()
    assert done.stderr.splitlines()[0] == "columns: time t; position x, y"
    assert done.stderr.splitlines()[-1] == "20 scans; 40 plots; 2 tracks"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plots.csv"], "--follow: reads standard input or a port; write - or udp://127.0.0.1"),
        (["udp://1.2.3.4:5"], "expected udp://127.0.0.1:PORT"),
        (["-", "--plot", "a.png"], "--plot: needs the whole recording; not with --follow"),
        (["-", "--group", "g"], "--group: needs the whole recording"),
        (["-", "--sort"], "--sort: needs the whole recording"),
        (["-", "-o", "a.parquet"], "--output: a.parquet: needs the whole recording"),
        (["-", "-o", "a.ast"], "--output: a.ast: --follow writes CSV"),
    ],
)
def test_what_a_feed_cannot_do(fails, words, said):
    assert said in fails("scan", *words, "--follow")


@contextmanager
def following(*options):
    """A process that follows; killed at the end if it has not ended."""
    process = subprocess.Popen(
        [*COMMAND, "-", "--follow", *options],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.kill()
        process.communicate(timeout=PATIENCE)


def _follow(text, *options):
    return subprocess.run(
        [*COMMAND, "-", "--follow", *options], input=text, capture_output=True, text=True,
        check=False, timeout=PATIENCE,
    )  # fmt: skip


@pytest.mark.parametrize("way", ["again", "onward"])
def test_a_run_that_was_killed_within_a_scan_goes_on_from_its_state(way, csv, tmp_path):
    lines = harbor().splitlines(keepends=True)
    whole, parts, state = (str(tmp_path / name) for name in ("whole.csv", "parts.csv", "state"))
    assert _follow(harbor(), "-o", whole).returncode == 0
    given = ["--scan", "scan", "-o", parts, "--state", state]
    with following(*given) as process:
        process.stdin.write("".join(lines[:26]).encode())
        process.stdin.flush()
        wait_until(lambda: os.path.exists(state), process)
        process.send_signal(signal.SIGKILL)
        process.wait(PATIENCE)
    # What it has written after its last save is cut off.
    with open(parts, "a") as file:
        file.write("half a li")
    rest = harbor() if way == "again" else "".join(lines[26:])
    done = _follow(rest, *given, "--feed", way)
    assert done.returncode == 0, done.stderr
    assert "goes on after line 26 of the feed" in done.stderr
    with open(whole) as one, open(parts) as other:
        assert one.read() == other.read()


def test_a_run_that_is_refused_leaves_no_file(tmp_path):
    state, out = tmp_path / "state", tmp_path / "tracks.csv"
    state.write_text("no state")
    done = _follow(harbor(), "-o", str(out), "--state", str(state))
    assert done.returncode == 2
    assert done.stderr.endswith("is no state of a live run of scan; name another file\n")
    assert not out.exists()
    out.write_text("something else\n")
    assert _follow(harbor(), "-o", str(out), "--state", str(state)).returncode == 2
    assert out.read_text() == "something else\n"


def test_a_feed_without_tracks_is_answered_with_the_header(run, csv, tmp_path):
    text, out = "t,x,y\n0,1,2\n", tmp_path / "tracks.csv"
    assert run("scan", csv(text), "--period", "2", "-o", out).exit_code == 0
    done = _follow(text, "--period", "2")
    assert done.returncode == 0, done.stderr
    assert done.stdout == out.read_text() != ""


def test_ctrl_c_within_a_scan_saves_it_and_ends_with_status_130(tmp_path):
    state = tmp_path / "state"
    with following("--scan", "scan", "--state", str(state)) as process:
        process.stdin.write("".join(harbor().splitlines(keepends=True)[:4]).encode())
        process.stdin.flush()
        wait_until(state.exists, process)
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 130
        said = process.stderr.read().decode()
    assert "Traceback" not in said
    assert ScanState.load(state).lines == 4


def block(plots):
    """Category 048: 010, 140, 020, 040 of (time, range in m, azimuth in deg)."""
    body = b""
    for when, distance, azimuth in plots:
        body += bytes([0b11110000, 1, 2]) + struct.pack(">I", round(when * 128))[1:]
        body += bytes([0b00100000])
        body += struct.pack(
            ">HH", round(distance / 1852 * 256), round(azimuth / 360 * 65536) % 65536
        )
    return bytes([48]) + struct.pack(">H", len(body) + 3) + body


def test_datagrams_of_asterix(tmp_path):
    pytest.importorskip("asterix.generated", reason="libasterix is not installed")
    # A range in 1/256 nmi: the noise is that of its steps.
    command = [*COMMAND, "udp://127.0.0.1:0", "--follow", "--period", "1.5",
               "--sigma-range", "3", "--sigma-azimuth", "0.1"]  # fmt: skip
    out = tmp_path / "answers.csv"
    with out.open("wb") as stream, subprocess.Popen(
        command, stdout=stream, stderr=subprocess.PIPE, text=True
    ) as process, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:  # fmt: skip
        try:
            line = process.stderr.readline()
            listening = re.fullmatch(r"listening at udp://127\.0\.0\.1:(\d+)\n", line)
            assert listening, line + process.stderr.read()
            address = "127.0.0.1", int(listening[1])
            for k in range(25):
                plots = [(1.5 * k, 900 + 4.5 * k, 20), (1.5 * k, 700, 200 + 0.3 * k)]
                sender.sendto(block(plots), address)
            sender.sendto(b"0\xff\xff", address)
            sender.sendto(b"", address)
            _, said = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert process.returncode == 0, said
    assert said.splitlines()[-2:] == [
        "25 scans; 50 plots; 2 tracks",
        "the feed: ends of datagrams that are no whole block: 1 left out, first at datagram 26, "
        "byte 0",
    ]
    rows = out.read_text().splitlines()
    assert rows[0].startswith("t,track_id,x,y,")
    assert len({row.split(",")[1] for row in rows[1:]}) == 2


def test_asterix_in_and_out_over_midnight(run, tmp_path):
    pytest.importorskip("asterix.generated", reason="libasterix is not installed")
    plots, tracks = tmp_path / "plots.ast", tmp_path / "tracks.ast"
    data = b""
    for k in range(25):
        clock = (86390 + 1.5 * k) % 86400
        data += block([(clock, 900 + 4.5 * k, 20), (clock, 700, 200 + 0.3 * k)])
    plots.write_bytes(data)
    result = run(
        "scan", plots, "--sigma-range", "3", "--sigma-azimuth", "0.1", "-o", tracks
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "scans: plots of equal time are a scan; one every 1.5 s" in result.stdout
    assert "1 time that the clock started again" in result.stdout
    again = run("track", tracks)
    assert again.exit_code == 0, again.output
    assert [line.split()[0] for line in again.stdout.splitlines() if line[:1] == "T"] == [
        "T1", "T2",
    ]  # fmt: skip
