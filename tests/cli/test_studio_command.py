"""The command that serves the studio, as far as it can be run without a browser."""

import http.client
import re
import signal
import subprocess
import sys

import pytest
from waiting import PATIENCE


@pytest.mark.parametrize("missing", ["starlette", "uvicorn", "websockets"])
def test_without_the_extra_it_says_what_to_install(fails, monkeypatch, missing):
    for name in [n for n in sys.modules if n.startswith("fuzzytrack.studio")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    line = fails("studio", "--no-browser")
    assert line == (
        f"error: studio: needs {missing}, which is not installed; pip install 'fuzzytrack[studio]'"
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["no-such-folder"], "there is no folder no-such-folder"),
        (["--host", "0.0.0.0"], "--host and --token: others can reach"),
        (["--host", "127.0.0.1", "--token", "short"], "--token: needs 16 or more"),
        (["--host", "no.such.host.invalid", "--token", "x" * 20], "is no address of this"),
        (["--plugin", "no-such.py"], "no-such.py"),
    ],
)
def test_what_cannot_be_served_is_said(fails, tmp_path, monkeypatch, words, message):
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    monkeypatch.chdir(tmp_path)
    assert message in fails("studio", "--no-browser", *words)


def test_a_port_in_use_is_said(fails, tmp_path):
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    import socket

    with socket.create_server(("127.0.0.1", 0)) as taken:
        number = taken.getsockname()[1]
        line = fails("studio", tmp_path, "--no-browser", "--port", number)
    assert line.startswith(f"error: --port: cannot listen at 127.0.0.1, port {number}: ")


def test_it_serves_a_page_until_it_is_interrupted(tmp_path):
    pytest.importorskip("uvicorn", reason="needs the extra studio")
    words = [sys.executable, "-m", "fuzzytrack", "studio", str(tmp_path), "--no-browser"]
    with subprocess.Popen(
        [*words, "--port", "0"], stdout=subprocess.PIPE, text=True, encoding="utf-8"
    ) as server:
        try:
            line = server.stdout.readline()
            found = re.fullmatch(r"studio at http://(127\.0\.0\.1:\d+)/#token=[\w-]{32}\n", line)
            assert server.stdout.readline() == "stop it with Ctrl-C\n"
            # Unlike urllib it asks no proxy that the environment names.
            asking = http.client.HTTPConnection(found[1], timeout=PATIENCE)
            asking.request("GET", "/")
            assert asking.getresponse().status == 200
            asking.close()
            server.send_signal(signal.SIGINT)
            assert server.wait(PATIENCE) == 0
        finally:
            server.kill()
