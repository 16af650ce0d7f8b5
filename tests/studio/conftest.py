import contextlib
import inspect
import json
import re
import socket
import struct
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from waiting import PATIENCE

TOKEN = "a-token-of-the-tests"
CHROMIUM = Path("/usr/bin/chromium")


class Client:
    """A page without a browser: sends commands, and waits for their answers."""

    def __init__(self, socket):
        self.socket = socket
        self.events = []
        self.seq = 0

    def send(self, command, **arguments):
        self.seq += 1
        message = {"seq": self.seq, "command": command, "arguments": arguments}
        self.socket.send(json.dumps(message))
        return self.seq

    def receive(self):
        """The next message: its number and content; a surface as an array."""
        message = self.socket.recv(timeout=PATIENCE)
        if isinstance(message, bytes):
            seq, rows, columns, layers, *_ = struct.unpack("<6I", message[:24])
            return seq, np.frombuffer(message[24:], "<f4").reshape(layers, rows, columns)
        found = json.loads(message)
        return found.get("seq"), found

    def wait(self, seq):
        while True:
            number, found = self.receive()
            if number == seq:
                return found
            self.events.append(found)

    def ask(self, command, **arguments):
        """Result of a command; fails if it is refused."""
        found = self.wait(self.send(command, **arguments))
        if isinstance(found, dict):
            assert "result" in found, found
            return found["result"]
        return found

    def refused(self, command, **arguments):
        """The sentence with which a command is refused."""
        return self.wait(self.send(command, **arguments))["error"]

    def ended_by(self, text):
        """Send a text for which the server closes the socket; its code of closing, or None.

        It may reset the connection while the text is still being sent, and the code is lost then.
        """
        from websockets.exceptions import ConnectionClosed

        try:
            self.socket.send(text)
            answer = self.receive()
        except ConnectionClosed as closed:
            return closed.rcvd.code if closed.rcvd else None
        return pytest.fail(f"the socket is still open, and answered {answer}")

    def job(self, number):
        """Events of a job, to its end."""
        found = [e["job"] for e in self.events if e.get("event") == "job"]
        while not found or found[-1]["state"] in ("waiting", "running"):
            message = self.receive()[1]
            if message.get("event") == "job":
                found.append(message["job"])
        assert {each["id"] for each in found} == {number}
        self.events.clear()
        return found


class Address:
    """Where a server listens: `host` with its `port`, and the `token` of its start."""

    def connect(self, *, origin=None, token=None, host=None, **options):
        from websockets.sync.client import connect

        address = f"ws://{host or self.host}/socket"
        if host is not None:
            options["sock"] = socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)
        if "proxy" in inspect.signature(connect).parameters:
            # Before version 15 of websockets none is used.
            options["proxy"] = None
        return connect(
            address,
            origin=origin or f"http://{self.host}",
            open_timeout=PATIENCE,
            subprotocols=["fuzzytrack", f"token.{self.token if token is None else token}"],
            compression=None,
            max_size=None,
            **options,
        )

    @contextlib.contextmanager
    def page(self, session=None):
        """A client that has said hello, with what it was told as `hello`."""
        with self.connect() as socket:
            client = Client(socket)
            client.hello = client.ask("hello", session=session)
            yield client


class Server(Address):
    """A server of the studio in this process, at a port of its own."""

    token = TOKEN

    def __init__(self, folder):
        from fuzzytrack.studio.access import Access
        from fuzzytrack.studio.folder import Folder
        from fuzzytrack.studio.server import StudioOnce, listen, make_server

        self.folder = folder
        self.studio = StudioOnce(Folder(folder))
        self.listening = listen("127.0.0.1", 0)
        self.port = self.listening.getsockname()[1]
        self.host = f"127.0.0.1:{self.port}"
        self.server = make_server(self.studio, Access("127.0.0.1", self.port, TOKEN))
        self.thread = threading.Thread(
            target=self.server.run, kwargs={"sockets": [self.listening]}, daemon=True
        )
        self.thread.start()

    def close(self):
        self.server.should_exit = True
        self.thread.join(PATIENCE)
        assert not self.thread.is_alive()
        self.listening.close()


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    from fuzzytrack.studio import jobs, threads

    with pytest.MonkeyPatch.context() as patch:
        # A second process takes as long to start as it saves.
        patch.setattr(jobs, "_processes", lambda: 1)
        patch.setattr(threads, "SECONDS", PATIENCE)
        found = Server(tmp_path_factory.mktemp("studio"))
        yield found
        found.close()


@pytest.fixture
def new_server(monkeypatch):
    """Start a server for a folder; it is closed with the test."""
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    monkeypatch.setattr("fuzzytrack.studio.threads.SECONDS", PATIENCE)
    made = []

    def start(folder):
        made.append(Server(folder))
        return made[-1]

    yield start
    for each in made:
        each.close()


class Program(Address):
    """A server of the studio as a program of its own, at a port of its own."""

    def __init__(self, folder, *options):
        words = [sys.executable, "-m", "fuzzytrack", "studio", folder, "--no-browser", *options]
        self.process = subprocess.Popen(
            [*map(str, words), "--port", "0"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
        )
        line = self.process.stdout.readline()
        found = re.fullmatch(r"studio at http://(127\.0\.0\.1:(\d+))/#token=([\w-]+)\n", line)
        assert found, line + self.process.stdout.read()
        self.host, self.port, self.token = found[1], int(found[2]), found[3]
        assert self.process.stdout.readline() == "stop it with Ctrl-C\n"

    def end(self):
        """What it has printed; it has been told to end."""
        printed, _ = self.process.communicate(timeout=PATIENCE)
        return printed


@pytest.fixture
def new_program():
    """Start a program for a folder; it is killed with the test."""
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    made = []

    def start(*words):
        made.append(Program(*words))
        return made[-1]

    yield start
    for each in made:
        each.process.kill()
        each.process.communicate()


@pytest.fixture
def waiting_runs(monkeypatch):
    """A context in which jobs that make runs wait after their first progress, to its end."""
    from fuzzytrack.studio import run_jobs

    monte_carlo = run_jobs.monte_carlo

    @contextlib.contextmanager
    def wait():
        over = threading.Event()

        def waiting(*given, progress, **options):
            def report(share):
                progress(share)
                over.wait()

            return monte_carlo(*given, progress=report, **options)

        with monkeypatch.context() as patch:
            patch.setattr(run_jobs, "monte_carlo", waiting)
            try:
                yield
            finally:
                over.set()

    return wait


@pytest.fixture
def page(server):
    with server.page() as client:
        yield client


@pytest.fixture(scope="module")
def browser_page(server):
    """A page of the studio in a browser; mistakes in its scripts fail the test."""
    api = pytest.importorskip("playwright.sync_api", reason="needs Playwright")
    if not CHROMIUM.exists():
        pytest.skip(f"needs Debian's Chromium, {CHROMIUM}")
    # Milliseconds; under the load of other tests a page may need a while.
    api.expect.set_options(timeout=1000 * PATIENCE)
    mistakes = []
    with api.sync_playwright() as player:
        browser = player.chromium.launch(
            executable_path=CHROMIUM,
            args=["--no-sandbox", "--disable-gpu"],
            timeout=1000 * PATIENCE,
        )
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.set_default_timeout(1000 * PATIENCE)
        page.on("pageerror", lambda mistake: mistakes.append(mistake))
        page.goto(f"http://{server.host}/#token={TOKEN}")
        yield page
        browser.close()
    assert not mistakes


@pytest.fixture
def studio(browser_page):
    """The page of a new session."""
    from playwright.sync_api import expect

    browser_page.evaluate("sessionStorage.clear()")
    browser_page.reload()
    expect(browser_page.locator("#status")).to_contain_text("connected")
    return browser_page
