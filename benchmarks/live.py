"""A live feed: latency and memory of `fuzzytrack track - --follow`, and a run that is killed.

A process writes plots of many tracks through a pipe at a steady pace and stamps them; this one
takes the answers and subtracts. Run as ``python -m benchmarks.live``.

On a machine with other work the figures are those of its scheduler. With ``--cpu`` no time is
waited: lines are pushed in the parts in which they would be there if the processor time that each
part takes were all, and so the latency is that on a processor of its own, without pipes.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.live_state import LiveState

# Lines that are written together, and so have one stamp.
TOGETHER = 10
HEADER = b"time,track,x,y\n"
# Lines that the command takes together, at most.
MOST = 500
# The first seconds do not count.
WARM_UP = 2.0
COMMAND = [
    sys.executable, "-m", "fuzzytrack", "track", "-", "--follow", "--id", "track", "--sigma", "10",
    "--least-step", "0.001",
]  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="benchmarks.live", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--tracks", type=int, default=1000)
    parser.add_argument("--hz", type=float, default=10.0, help="plots of a track a second")
    parser.add_argument("--lateness", type=float, default=0.0, help="of --follow (s)")
    parser.add_argument(
        "--late", type=float, default=0.0, help="share of plots that are late, with --lateness"
    )
    parser.add_argument("--no-state", action="store_true", help="save no state meanwhile")
    parser.add_argument("--cpu", action="store_true", help="by processor time, without pipes")
    parser.add_argument("--no-kill", action="store_true", help="leave out kill -9 and resume")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures")
    # The process that writes is this module, too.
    parser.add_argument("--write-to", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.write_to:
        write_plots(given)
        return 0
    if given.cpu:
        show(by_processor_time(given), given)
        return 0
    with TemporaryDirectory() as folder:
        figures = latencies(given, Path(folder))
        show(figures, given)
        if not given.no_kill:
            figures["identical"] = same_after_kill(given, Path(folder))
            print(f"killed and resumed, output identical: {figures['identical']}")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=2) + "\n")
    return 0


# -------------------------------------------------------------------- the feed


def plots(tracks: int, hz: float, scans: int, lateness: float, late: float) -> Iterator[bytes]:
    """Lines of plots, so many together: each track has a plot in every scan.

    A plot that is late comes with those of a later scan.
    """
    draw = random.Random(1)
    speed = [(draw.uniform(-200, 200), draw.uniform(-200, 200)) for _ in range(tracks)]
    # Deviations are repeated, since to draw them takes longer than to write them.
    noise = [draw.gauss(0, 10) for _ in range(4099)]
    scan, held, lines, k = 0, {}, [], 0
    most = max(1, int(lateness * hz) - 1)
    while scan < scans:
        for track in range(tracks):
            t = (scan + track / tracks) / hz
            k += 2
            x = speed[track][0] * t + noise[k % 4099]
            y = speed[track][1] * t + noise[(k + 1) % 4099]
            line = b"%.4f,T%d,%.2f,%.2f\n" % (t, track, x, y)
            if late and draw.random() < late and scan + most < scans:
                held.setdefault((scan + draw.randint(1, most), track), []).append(line)
            else:
                lines.append(line)
            lines += held.pop((scan, track), [])
            if len(lines) >= TOGETHER:
                yield b"".join(lines[:TOGETHER])
                del lines[:TOGETHER]
        scan += 1
    if lines:
        yield b"".join(lines)


def write_plots(given: argparse.Namespace) -> None:
    """Write plots to standard output at a steady pace, and the time of each write to a file."""
    scans = int((given.minutes * 60 + WARM_UP) * given.hz)
    pause = TOGETHER / (given.tracks * given.hz)
    stamps = np.memmap(given.write_to, np.float64, "r+")
    begin = math.inf
    for k, lines in enumerate(plots(given.tracks, given.hz, scans, given.lateness, given.late)):
        if k == 1:
            # The last number is set when the first answer has come: all is compiled.
            while not stamps[-1]:
                time.sleep(0.02)
            begin = time.monotonic()
        wait = begin + k * pause - time.monotonic() if k else 0.0
        if wait > 0:
            time.sleep(wait)
        stamps[k] = time.monotonic()
        rest = memoryview(lines if k else HEADER + lines)
        while rest:
            rest = rest[os.write(1, rest) :]


# -------------------------------------------------------------------- latency and memory


def latencies(given: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Run the feed, and take the time of every answer."""
    count = int((given.minutes * 60 + WARM_UP) * given.hz) * given.tracks
    stamps = np.memmap(folder / "stamps", np.float64, "w+", shape=(count // TOGETHER + 2,))
    command = [*COMMAND, "--lateness", str(given.lateness)]
    if not given.no_state:
        command += ["--state", str(folder / "state")]
    feeder = subprocess.Popen(
        [sys.executable, "-m", "benchmarks.live", "--write-to", str(folder / "stamps"),
         "--minutes", str(given.minutes), "--tracks", str(given.tracks), "--hz", str(given.hz),
         "--lateness", str(given.lateness), "--late", str(given.late)],
        stdout=subprocess.PIPE,
    )  # fmt: skip
    tracker = subprocess.Popen(
        command, stdin=feeder.stdout, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert feeder.stdout is not None
    feeder.stdout.close()
    found, memory = take_answers(tracker, stamps)
    assert tracker.stderr is not None
    said = tracker.stderr.read().decode()
    tracker.wait()
    feeder.wait()
    return {
        "answers": len(found),
        "p50_ms": float(np.quantile(found, 0.5) * 1e3),
        "p99_ms": float(np.quantile(found, 0.99) * 1e3),
        "max_ms": float(found.max() * 1e3),
        "memory_mb": memory,
        "load_average": os.getloadavg(),
        "said": said,
    }


def take_answers(
    tracker: subprocess.Popen[bytes], stamps: NDArray[np.float64]
) -> tuple[NDArray[np.float64], list[float]]:
    """Latency of every first answer after the warm-up (s), and memory minute by minute (MB)."""
    assert tracker.stdout is not None
    pipe, answered, rest = tracker.stdout.fileno(), -1, b""
    times, ends, memory, minute = [], [], [], math.inf
    while part := os.read(pipe, 1 << 16):
        now = time.monotonic()
        whole, _, left = (rest + part).rpartition(b"\n")
        rest = left
        # The header is no answer, and those that are given again answer no line of their own.
        lines = whole.split(b"\n") if whole else []
        answered += sum(line.endswith(b",0") for line in lines) if answered >= 0 else len(lines)
        times.append(now)
        ends.append(answered)
        if not stamps[-1] and answered > 0:
            stamps[-1], minute = 1.0, now + 60
        if now > minute:
            memory.append(_resident(tracker.pid))
            minute += 60
    last = np.array(ends)
    count = int(last[-1])
    when = np.array(times)[np.searchsorted(last, np.arange(count), side="right")]
    written = np.array(stamps)[np.arange(count) // TOGETHER]
    measured = written > written[0] + WARM_UP
    return (when - written)[measured], memory


def _resident(process: int) -> float:
    """Memory of a process (MB)."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return math.nan


def show(figures: dict[str, Any], given: argparse.Namespace) -> None:
    """Print the figures."""
    print(
        f"{given.tracks} tracks at {given.hz:g} Hz, {given.minutes:g} min: "
        f"{figures['answers']} answers; latency p50 {figures['p50_ms']:.1f} ms, "
        f"p99 {figures['p99_ms']:.1f} ms, max {figures['max_ms']:.0f} ms"
    )
    print("memory by the minute (MB): " + " ".join(f"{m:.0f}" for m in figures["memory_mb"]))
    print("load average: " + " ".join(f"{load:.1f}" for load in figures["load_average"]))
    print(figures["said"].strip())


def by_processor_time(given: argparse.Namespace) -> dict[str, Any]:
    """Latency if a line waited only for the processor time of this feed."""
    reading = Reading.of(id="track", sigma=10.0, least_step=0.001)
    feed = LiveFeed(reading, lateness=given.lateness, begin=lambda tracks: tracks.warm_up())
    scans = int((given.minutes * 60 + WARM_UP) * given.hz)
    text = b"".join(plots(given.tracks, given.hz, scans, given.lateness, given.late))
    first, *lines = text.splitlines(keepends=True)
    feed.push([HEADER, first])
    come = np.arange(len(lines)) / (given.tracks * given.hz)
    answered, now, place, save = np.empty(len(lines)), 0.0, 0, 5.0
    while place < len(lines):
        now = max(now, come[place])
        end = min(int(np.searchsorted(come, now, side="right")), place + MOST)
        begin = time.thread_time()
        feed.push(lines[place:end])
        if now > save and not given.no_state:
            LiveState.of(feed, 0)
            save = now + max(5.0, (time.thread_time() - begin) / 0.005)
        now += time.thread_time() - begin
        answered[place:end], place = now, end
    found = (answered - come)[come > WARM_UP]
    return {
        "answers": len(found),
        "p50_ms": float(np.quantile(found, 0.5) * 1e3),
        "p99_ms": float(np.quantile(found, 0.99) * 1e3),
        "max_ms": float(found.max() * 1e3),
        "memory_mb": [_resident(os.getpid())],
        "load_average": os.getloadavg(),
        "said": "by processor time, without pipes",
    }


# -------------------------------------------------------------------- kill -9


def same_after_kill(given: argparse.Namespace, folder: Path) -> bool:
    """Whether a run that is killed and resumed writes what an uninterrupted one writes."""
    lateness, late = given.lateness or 2.0, given.late or 0.05
    feed = folder / "feed.csv"
    scans = int(60 * given.hz)
    some = plots(min(given.tracks, 100), given.hz, scans, lateness, late)
    feed.write_bytes(HEADER + b"".join(some))
    common = [*COMMAND, "--lateness", str(lateness)]
    outputs = folder / "whole.csv", folder / "killed.csv"
    with feed.open("rb") as lines:
        subprocess.run([*common, "-o", str(outputs[0])], stdin=lines, check=True,
                       stderr=subprocess.DEVNULL)  # fmt: skip
    resumed = [*common, "-o", str(outputs[1]), "--state", str(folder / "kill.state")]
    _kill_midway(resumed, feed, folder / "kill.state")
    with feed.open("rb") as lines:
        subprocess.run(resumed, stdin=lines, check=True, stderr=subprocess.DEVNULL)
    return outputs[0].read_bytes() == outputs[1].read_bytes()


def _kill_midway(command: list[str], feed: Path, state: Path) -> None:
    """Feed the first half slowly, until a state is saved and more is answered; then kill."""
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert process.stdin is not None
    lines = feed.read_bytes().splitlines(keepends=True)
    for k in range(0, len(lines), 200):
        process.stdin.write(b"".join(lines[k : k + 200]))
        process.stdin.flush()
        time.sleep(0.1)
        if state.exists() and k > len(lines) // 3:
            break
    time.sleep(0.5)
    process.send_signal(signal.SIGKILL)
    process.wait()


if __name__ == "__main__":
    sys.exit(main())
