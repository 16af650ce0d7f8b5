"""The server as a browser sees it, and as somebody who attacks it does."""

import contextlib
import http.client
import json
import threading

import pytest

pytest.importorskip("uvicorn", reason="needs the extra studio")
from waiting import PATIENCE
from websockets.exceptions import ConnectionClosed, InvalidStatus


def get(server, path, host=None, method="GET"):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE)
    connection.request(method, path, headers={"Host": host or server.host})
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, {k.lower(): v for k, v in answer.getheaders()}, content


# -------------------------------------------------------------------- who may


def test_the_page_is_bare_and_strict(server, tmp_path, monkeypatch):
    monkeypatch.setattr("fuzzytrack.studio.app._STATIC", tmp_path)
    (tmp_path / "index.html").write_text("<!doctype html>")
    (tmp_path / "main.js").write_text("1")
    assert get(server, "/static/main.js")[1]["content-type"].startswith("text/javascript")
    status, headers, content = get(server, "/")
    assert status == 200
    assert headers["content-type"].startswith("text/html")
    policy = headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; script-src 'self'; style-src 'self';")
    assert "unsafe" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert "server" not in headers
    assert content == b"<!doctype html>"


@pytest.mark.parametrize(
    "path",
    ["/static/../session.py", "/static/..%2fsession.py", "/static/%2e%2e/session.py",
     "/static/index.html", "/static/no-such.js", "/static/", "/static/a/b.js", "/static/.js",
     "/static/%00.js", "/no-such", "//evil.example/", "/static/__init__.py"],
)  # fmt: skip
def test_no_other_file_is_served(server, path):
    status, headers, content = get(server, path)
    assert status == 404
    assert "content-security-policy" in headers
    assert b"import" not in content


def test_another_host_is_refused(server):
    for host in ("evil.example", f"evil.example:{server.port}", "127.0.0.1"):
        status, headers, content = get(server, "/", host)
        assert status == 400
        assert content == b"this server has another name\n"
        assert "content-security-policy" in headers


def test_other_methods_are_refused(server):
    assert get(server, "/", method="POST")[0] == 405


@pytest.mark.parametrize(
    "options",
    [
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"token": "another-token-of-somebody"},
        {"token": ""},
        {"host": "evil.example"},
    ],
)
def test_a_socket_of_somebody_else_is_refused(server, options):
    with pytest.raises(InvalidStatus) as caught:
        server.connect(**options)
    assert caught.value.response.status_code == 403


def test_a_socket_answers_with_the_protocol_and_not_with_the_token(server):
    with server.connect() as socket:
        assert socket.subprotocol == "fuzzytrack"


# -------------------------------------------------------------------- what may be sent


def test_before_hello_nothing_is_done(server):
    with server.connect() as socket:
        socket.send('{"seq": 1, "command": "undo"}')
        assert "say hello first" in json.loads(socket.recv(timeout=PATIENCE))["error"]


def test_a_message_of_two_mebibytes_ends_the_socket_only(server):
    with server.page() as page:
        assert page.ended_by("x" * 2**21) in (1009, None)
    with server.page() as page:
        assert page.ask("files")["files"] == []


def test_a_bomb_of_yaml_is_a_complaint(page):
    lines = ["a0: &a0 [x, x]"] + [f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]" for k in range(1, 30)]
    found = page.ask("set_text", text="\n".join(lines))["state"]
    assert found["complaints"][0]["message"] == "nested deeper than 12 levels"
    assert found["rulebase"]["name"] == "stiffness-damping"
    page.ask("undo")


def test_what_is_no_command_is_refused(server):
    with server.page() as page:
        for text in ("", "[]", "{}", "\x00", "[" * 1000, '{"seq": 1e99}', '{"seq": 5}'):
            page.socket.send(text)
            assert page.receive()[1]["error"]
        page.socket.send(b"\x00\x01")
        assert "binary" in page.receive()[1]["error"]
        assert page.ask("explain", inputs={"E": 0, "dE": 0})["rules"]


# -------------------------------------------------------------------- pages


def test_a_reload_goes_on_where_it_was(server):
    with server.page() as page:
        key = page.hello["session"]
        page.ask("set_cell", row=0, column=1, text="S-L")
    with server.page(key) as page:
        assert page.hello["session"] == key
        assert page.hello["state"]["undo"] == 1
        assert page.hello["state"]["rulebase"]["rules"]["cells"][0][1]["text"] == "S-L"


def test_a_page_that_is_opened_twice_goes_on_in_the_newer(server):
    with server.page() as first, server.page(first.hello["session"]) as second:
        assert "opened again elsewhere" in first.receive()[1]["text"]
        with pytest.raises(ConnectionClosed) as caught:
            first.socket.recv(timeout=PATIENCE)
        assert caught.value.rcvd.code == 4001
        assert second.ask("files")["files"] == []


def test_eight_pages_can_be_open(tmp_path, new_server):
    server = new_server(tmp_path)
    with contextlib.ExitStack() as stack:
        pages = [stack.enter_context(server.page()) for _ in range(8)]
        with server.connect() as ninth:
            ninth.send('{"seq": 1, "command": "hello"}')
            assert "8 pages are open" in json.loads(ninth.recv(timeout=PATIENCE))["error"]
            pages[3].socket.close()
            # The one that was closed makes room.
            for seq in range(2, 50):
                ninth.send(json.dumps({"seq": seq, "command": "hello"}))
                found = json.loads(ninth.recv(timeout=PATIENCE))
                if "result" in found:
                    break
            assert found["result"]["session"] not in {page.hello["session"] for page in pages}


def test_a_draft_outlives_the_server(tmp_path, new_server):
    first = new_server(tmp_path)
    with first.page() as page:
        page.ask("rename_set", variable="stiffness", set="M", name="mid")
        key = page.hello["session"]
    first.close()
    with new_server(tmp_path).page(key) as page:
        assert page.hello["session"] == key
        names = [s["name"] for s in page.hello["state"]["rulebase"]["outputs"][0]["sets"]]
        assert "mid" in names


def test_a_draft_of_a_closed_page_is_opened_by_another_and_goes_when_saved(tmp_path, new_server):
    server = new_server(tmp_path)
    with server.page() as page:
        page.ask("rename_set", variable="stiffness", set="M", name="mid")
        key = page.hello["session"]
        with server.page() as other:
            # A page that is open keeps its draft to itself.
            server.studio().open(key).save_draft()
            assert other.ask("drafts")["drafts"] == []
            assert "another page has it open" in other.refused("restore", key=key)
    with server.page() as page:
        found = page.ask("drafts")["drafts"]
        assert abs(found[0].pop("time") - (tmp_path / f".draft-{key}.json").stat().st_mtime) < 1
        assert found == [{"key": key, "rules": "stiffness-damping", "scenario": "turn"}]
        state = page.ask("restore", key=key)["state"]
        assert "mid" in [s["name"] for s in state["rulebase"]["outputs"][0]["sets"]]
        assert page.ask("drafts")["drafts"] == []
        own = server.studio().open(page.hello["session"])
        own.save_draft()
        assert len(list(tmp_path.glob(".draft-*"))) == 1
        page.ask("save", name="mine.yaml")
        own.save_draft()
        assert list(tmp_path.glob(".draft-*")) == []


def test_work_that_is_given_up_at_the_end_is_not_logged(tmp_path, new_server, monkeypatch, caplog):
    go = threading.Event()
    server = new_server(tmp_path)

    def save_draft(page):
        # As on a slow disk; the end of the server itself waits for none.
        if threading.current_thread() is not server.thread:
            go.wait(PATIENCE)

    monkeypatch.setattr("fuzzytrack.studio.pages.Page.save_draft", save_draft)
    with server.page() as page:
        assert page.ask("files")["files"] == []
        server.close()
    go.set()
    assert [record for record in caplog.records if record.name == "uvicorn.error"] == []
