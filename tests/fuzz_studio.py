"""Fuzz the socket of the studio: every message is answered, or refused in one sentence.

Run as ``python tests/fuzz_studio.py --count 100000 --seed 1``. Messages of one page after the other
are made from the seed and the number of the page alone, so that any finding can be repeated. Pages
talk to the application in this process, without a browser or a port.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import logging
import random
import re
import resource
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.studio import connection, limits
from fuzzytrack.studio.access import PROTOCOL, Access
from fuzzytrack.studio.app import make_app
from fuzzytrack.studio.command_table import HANDLERS
from fuzzytrack.studio.folder import Folder
from fuzzytrack.studio.memory import give_back_at_once
from fuzzytrack.studio.notes import warnings_to_notes
from fuzzytrack.studio.pages import Studio

TOKEN, HOST = "a-token-of-the-tests", "127.0.0.1:8098"
# Messages of a page; seconds that an answer may take, which are more than after which the server
# answers that it has given up; letters of a refusal.
CHUNK, SECONDS, LETTERS = 250, limits.SECONDS + 30.0, 2000
# MiB that may be added after so many pages: by then what is kept for trackers and rule bases that
# come again is as large as it may be, and matplotlib has been imported.
MEBIBYTES, WARM_UP = 30, 240
# Pages after which memory is printed, and of how many: one may have a large job that goes on.
PAGES, MEDIAN = 40, 20

# -------------------------------------------------------------------- messages

SHIPPED = {n: rulebase_path(n).read_text("utf-8") for n in ("stiffness-damping", "tipper")}
RULES = "name: r\ninputs: {x: {universe: [0, 1], sets: {a: [trimf, 0, 0, 1], b: [trimf, 0, 1, 1]}}}"
CSV = "time,id,x,y\n" + "".join(f"{k},a,{k * k % 37},{k}\n" for k in range(30))
TRACKERS = (
    "editor", "saved", "fixed:alpha=0.5:beta=0.2", "kalman-cv:sigma_v=0.01", "chan-style",
    "editor:start=one-point", "rules.yaml", "no-such", "editor:no=1", "../x.yaml", "fixed:alpha=9",
)  # fmt: skip
NAMES = (
    "rules.yaml", "flight.csv", "new.yaml", "scan-style", "tipper", "stiffness-damping", "turn",
    "../x", "/etc/passwd", "link.yaml", "a/b.yaml", ".draft-x.json", "con",
)  # fmt: skip
WORDS = ("E", "dE", "stiffness", "damping", "ze", "nl", "ps", "Z", "S", "L", "x", "alpha")
SHAPES = ("trimf", "trapmf", "gaussmf", "gbellmf", "sigmf", "no-such")


def hostile(chance: random.Random, depth: int = 0) -> Any:
    """Any value of JSON, and some that Python writes and JSON does not have."""
    kinds = (
        None, True, False, -1, 0, 3, 10**9, 10**30, 10**400, 0.5, -0.0, 1e308, 5e-324, float("nan"),
        float("inf"), "", "\x00", "\ud800", "x" * 3000, "../x", "${HOME}", "<b>", "a: &a [*a]",
    )  # fmt: skip
    if depth > 3 or chance.random() < 0.8:
        return chance.choice(kinds)
    inside = [hostile(chance, depth + 1) for _ in range(chance.randrange(4))]
    return inside if chance.random() < 0.5 else dict(zip(WORDS, inside, strict=False))


def numbers(chance: random.Random, count: int, size: float = 1.0) -> list[float]:
    return [round(chance.uniform(-size, size), chance.choice((0, 1, 3))) for _ in range(count)]


def one_of(*words: Any) -> Callable[[random.Random], Any]:
    return lambda chance: chance.choice(words)


def shape_of_set(chance: random.Random) -> dict[str, Any]:
    return {"set": chance.choice(WORDS), "parameters": sorted(numbers(chance, 3))}


def broken_text(chance: random.Random) -> str:
    """A rule base with a part that is removed, repeated or replaced."""
    text = chance.choice((SHIPPED["stiffness-damping"], SHIPPED["tipper"], RULES))
    first = chance.randrange(len(text))
    last = min(len(text), first + chance.choice((1, 5, 80)))
    return (
        text[:first] + chance.choice(("", text[first:last] * 2, ": [", "&a", "9e9")) + text[last:]
    )


SWITCH = one_of(True, False)
AMOUNT = one_of(0.001, 0.5, 1, 3, 10, 1000.0)
COUNT = one_of(1, 2, 3, 5, 9)
#: Values that fit, by the name of the argument.
FITTING: dict[str, Callable[[random.Random], Any]] = {
    "row": one_of(*WORDS, 0, 3, 6), "column": one_of(*WORDS, 0, 3, 6), "index": COUNT,
    "text": one_of("S-L", "M-Z", "Z", "S-Q", "{S: 0.5, M: 0.5}-L", CSV, "{tip: cheap}"),
    "variable": one_of(*WORDS), "set": one_of(*WORDS), "like": one_of(*WORDS),
    "shape": one_of(*SHAPES), "parameters": lambda c: sorted(numbers(c, c.randrange(2, 5))),
    "shapes": lambda c: [shape_of_set(c) for _ in range(c.randrange(1, 4))],
    "shared": one_of("both", "apart"), "symmetric": SWITCH, "draft": SWITCH, "with_rules": SWITCH,
    "overwrite": SWITCH, "operator": one_of("and", "or", "defuzzification"),
    "value": one_of("min", "product", "centroid", "max", 0.1, [0.5, 2]), "name": one_of(*NAMES),
    "outputs": one_of(["stiffness"], ["alpha", "beta"], ["gamma"], ["tip"]),
    "columns": one_of(61, 61, 61, 201, 202), "rows": one_of(61, 61, 61, 1, "x"),
    "against": one_of("saved", "chan-style", "tipper", *NAMES),
    "inputs": one_of({"E": 0.1, "dE": -0.2}, {"E": 9}, ["E", "dE"], {"service": 3, "food": 8}),
    "at": one_of({}, {"E": 0.0}), "steps": one_of([1, 1], [0.5, 2], [0.9, 1.1]), "missed": COUNT,
    "points": lambda c: [numbers(c, 2, 5000) for _ in range(c.randrange(1, 6))],
    "speed": AMOUNT, "leg": AMOUNT, "period": AMOUNT, "acceleration": AMOUNT, "radius": AMOUNT,
    "heading": AMOUNT, "start": lambda c: numbers(c, 2, 100), "grid": COUNT, "spacing": AMOUNT,
    "reach": AMOUNT, "range_sigma": AMOUNT, "bearing_sigma": AMOUNT, "sigma": AMOUNT,
    "detection": one_of(1, 0.9, 0.2), "motion": one_of("constant-velocity", "turn", "no-such"),
    "kind": one_of("jitter", "alternate", "burst", "log-uniform"),
    "trackers": lambda c: c.choices(TRACKERS, k=c.randrange(1, 4)),
    "tracker": one_of(*TRACKERS), "first": one_of(*TRACKERS), "second": one_of(*TRACKERS),
    "runs": one_of(1, 3, 10**9), "run": one_of(0, 1, 5), "seed": one_of(0, 1, 2**31),
    "job": COUNT, "time": one_of("time", "none"), "id": one_of("id", "none"),
    "axes": one_of(["x", "y"], ["x"], ["z"]),
    "truth": one_of(["x", "y"], ["../x.csv"], ["/"], None),
    "polar": one_of(None, None, ["x", "y"], ["x"]), "geodetic": one_of(None, None, ["x", "y"]),
    "sigma_range": one_of(None, 3, "x"), "duplicates": one_of(None, "first", "x"),
    "site": one_of(None, [52.5, 5], [1]), "sort": one_of(True, False, 1),
    "key": one_of("a1", "", "../x", 3),
    "on": one_of("flight.csv", None), "free": one_of("outputs", "sets", "none"),
    "trials": one_of(1, 2), "folds": one_of(2, 3),
    "if": one_of({"service": "poor"}, {"E": "ze", "dE": "ze"}), "of": one_of("run", "track"),
    "then": one_of([{"output": "tip", "set": "cheap"}], [{}]), "weight": one_of(0, 0.5, 2),
    "output": one_of("stiffness", "tip"), "session": one_of(None, "x"),
    "what": one_of("yaml", "scenario", "python", "command"),
}  # fmt: skip
#: What is no number of a message.
NO_NUMBERS: tuple[Any, ...] = (None, True, -1, 0.5, 10**30, "1", [1], {}, float("nan"))
OPTIONAL = (
    "at", "inputs", "against", "rows", "columns", "shared", "like", "with_rules", "overwrite",
    "time", "id", "axes", "sigma", "truth", "polar", "geodetic", "sigma_range", "duplicates",
    "site", "sort", "symmetric", "draft", "steps", "missed", "period",
)  # fmt: skip
# What takes long is asked for less often; what mends a broken text, more often.
WEIGHT = {
    "undo": 4.0,
    "surface": 2.0,
    "set_text": 0.3,
    "run": 0.1,
    "tune": 0.05,
    "certify": 0.1,
    "track": 0.2,
    "open_scenario": 0.3,
}
COMMANDS = [name for name in HANDLERS if name != "hello"]
WEIGHTS = [WEIGHT.get(name, 1.0) for name in COMMANDS]


def command(chance: random.Random, seq: int) -> str:
    """A command with arguments of which most fit, at times one too many or too few."""
    name = chance.choices(COMMANDS, WEIGHTS)[0]
    given = {}
    for each in HANDLERS[name].names:
        if chance.random() < (0.5 if each in OPTIONAL else 0.97):
            fits = chance.random() < 0.95
            given[each] = FITTING.get(each, hostile)(chance) if fits else hostile(chance)
    if name in ("set_text", "set_scenario_text") and chance.random() < 0.8:
        given["text"] = broken_text(chance)
    if chance.random() < 0.03:
        given[chance.choice(WORDS)] = hostile(chance)
    if chance.random() < 0.03:
        name = chance.choice((name[:-1], name.upper(), "", "__class__", "x" * 5000))
    return json.dumps({"seq": seq, "command": name, "arguments": given})


def broken(chance: random.Random, seq: int) -> str | bytes:
    """What is no command."""
    text = command(chance, seq)
    return chance.choice(
        (
            text[: chance.randrange(len(text))],
            text.replace(":", chance.choice((",", "", "::"))),
            text.encode(),
            chance.randbytes(chance.randrange(200)),
            "[" * chance.choice((1, 1000, 200_000)),
            '{"seq": ' * chance.choice((10, 5000)),
            json.dumps(hostile(chance)),
            json.dumps({"seq": chance.choice(NO_NUMBERS), "command": "files"}),
            json.dumps({"seq": seq, "command": hostile(chance), "arguments": hostile(chance)}),
            json.dumps({"seq": seq, "command": "set_text", "arguments": {"text": "x" * 900_000}})
            if chance.random() < 0.1
            else "",
        )
    )


def message(chance: random.Random, seq: int) -> str | bytes:
    return broken(chance, seq) if chance.random() < 0.15 else command(chance, seq)


# -------------------------------------------------------------------- pages


@dataclass
class Report:
    """What came of some messages."""

    messages: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    slowest_message: str = ""
    sizes: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


class Socket:
    """A socket of the application, in this process."""

    def __init__(self, app: Any) -> None:
        self._incoming: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._outgoing: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        scope = {
            "type": "websocket",
            "path": "/socket",
            "headers": [(b"host", HOST.encode()), (b"origin", f"http://{HOST}".encode())],
            "subprotocols": [PROTOCOL, f"token.{TOKEN}"],
        }
        self._incoming.put_nowait({"type": "websocket.connect"})
        self.task = asyncio.create_task(app(scope, self._incoming.get, self._outgoing.put))

    async def receive(self) -> str | bytes:
        """The next message that is no event."""
        while True:
            found = await asyncio.wait_for(self._outgoing.get(), SECONDS)
            if found["type"] != "websocket.send":
                raise AssertionError(f"{found['type']} in place of an answer")
            content: str | bytes = found.get("text") or found["bytes"]
            if not (isinstance(content, str) and content.startswith('{"event"')):
                return content

    async def ask(self, content: str | bytes) -> str | bytes:
        kind = "text" if isinstance(content, str) else "bytes"
        self._incoming.put_nowait({"type": "websocket.receive", kind: content})
        return await self.receive()

    async def open(self) -> None:
        accepted = await self._outgoing.get()
        assert accepted["type"] == "websocket.accept", accepted
        await self.ask('{"seq": 0, "command": "hello", "arguments": {}}')

    async def close(self) -> None:
        self._incoming.put_nowait({"type": "websocket.disconnect", "code": 1000})
        await asyncio.wait_for(self.task, SECONDS)


def check(found: str | bytes, seq: int, sent: str | bytes, folder: Path) -> str:
    """What an answer is: done, a surface, refused or given up; raises if it is anything else."""
    if isinstance(found, bytes):
        assert int.from_bytes(found[:4], "little") == seq, "a surface of another message"
        return "surfaces"
    answer = json.loads(found)
    assert answer["seq"] in (seq, None), "an answer to another message"
    if "result" in answer:
        return "done"
    said = answer["error"]
    assert isinstance(said, str), "no sentence"
    assert said.strip(), "an empty refusal"
    assert len(said) <= LETTERS, f"a refusal of {len(said)} letters"
    assert "Traceback" not in said, "a traceback"
    assert "\n" not in said, "several lines"
    assert str(folder) not in said, f"the name of the folder: {said[:300]}"
    named = re.match("([a-z_]+): ", said)
    assert not named or named[1] in names_in(sent), f"no argument of the message: {said[:80]}"
    return "given up" if said.endswith("and was given up") else "refused"


def names_in(sent: str | bytes) -> tuple[str, ...]:
    """What a refusal of a message may begin with: its fields, and the arguments of its command."""
    try:
        name = json.loads(sent)["command"]
    except (KeyError, RecursionError, TypeError, ValueError):
        name = None
    known = HANDLERS[name].names if isinstance(name, str) and name in HANDLERS else ()
    return ("seq", "command", "arguments", *known)


async def talk(app: Any, seed: int, page: int, count: int, folder: Path, report: Report) -> None:
    """Send the messages of one page."""
    chance = random.Random(f"{seed}/{page}")
    socket = Socket(app)
    await socket.open()
    for seq in range(1, count + 1):
        sent = message(chance, seq)
        started = time.monotonic()
        try:
            kind = check(await socket.ask(sent), seq, sent, folder)
        except Exception as error:
            report.failures.append(f"page {page}, message {seq}: {error!r}: {sent[:300]!r}")
            if socket.task.done() or isinstance(error, TimeoutError):
                return
            continue
        report.messages += 1
        report.outcomes[kind] += 1
        if time.monotonic() - started > report.slowest:
            report.slowest = time.monotonic() - started
            report.slowest_message = str(sent[:200])
    await socket.close()


class Kept(logging.Handler):
    """Log of what nobody caught."""

    def __init__(self, report: Report) -> None:
        super().__init__(logging.WARNING)
        self._report = report

    def emit(self, record: logging.LogRecord) -> None:
        self._report.failures.append(f"log: {record.name}: {record.getMessage()}")


def run(seed: int, count: int, folder: Path, chunk: int = CHUNK) -> Report:
    """Send `count` messages, `chunk` of each page."""
    report = Report()
    (folder / "rules.yaml").write_text(SHIPPED["stiffness-damping"])
    (folder / "flight.csv").write_text(CSV)
    (folder / "link.yaml").symlink_to("/etc/hostname")
    studio = Studio(Folder(folder))
    app = make_app(lambda: studio, Access("127.0.0.1", 8098, TOKEN))

    def unexpected(error: BaseException) -> str:
        last = traceback.extract_tb(error.__traceback__)[-1]
        report.failures.append(f"{error!r:.300} at {last.filename}:{last.lineno}")
        return "unexpected"

    def shown(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        report.failures.append(f"on the console: {category.__name__}: {message}")

    log, was = Kept(report), connection.in_one_sentence
    logging.getLogger().addHandler(log)
    # What is answered by a general sentence is a mistake of the program.
    connection.in_one_sentence = unexpected
    stack = ExitStack()
    stack.enter_context(warnings.catch_warnings())
    warnings.showwarning = shown
    stack.enter_context(warnings_to_notes())
    try:
        for page in range(-(-count // chunk)):
            asyncio.run(talk(app, seed, page, min(chunk, count - page * chunk), folder, report))
            report.sizes.append(resident())
            if (page + 1) % PAGES == 0:
                sent, size = (page + 1) * chunk, median(report.sizes[-MEDIAN:])
                print(f"{sent} messages: {size:.0f} MiB", flush=True)
            if len(report.failures) > 20:
                break
    finally:
        stack.close()
        connection.in_one_sentence = was
        logging.getLogger().removeHandler(log)
        studio.close()
    warm, last = report.sizes[:WARM_UP][-MEDIAN:], report.sizes[WARM_UP:][-MEDIAN:]
    if last and median(last) - median(warm) > MEBIBYTES:
        report.failures.append(f"memory: from {median(warm):.0f} to {median(last):.0f} MiB")
    return report


def resident() -> float:
    """Memory of the process (MiB); the largest so far where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return pages * resource.getpagesize() / 2**20


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000, help="number of messages")
    parser.add_argument("--seed", type=int, default=1, help="which messages")
    given = parser.parse_args()
    give_back_at_once()
    with TemporaryDirectory() as folder:
        report = run(given.seed, given.count, Path(folder))
    kinds = ", ".join(f"{count} {kind}" for kind, count in report.outcomes.items())
    print(
        f"{report.messages} messages: {kinds}; slowest answer {report.slowest:.1f} s "
        f"({report.slowest_message}); memory {median(report.sizes[-MEDIAN:]):.0f} MiB at the end, "
        f"{max(report.sizes):.0f} at most"
    )
    for failure in report.failures:
        print(f"FAILED {failure}")
    return int(bool(report.failures))


if __name__ == "__main__":
    sys.exit(main())
