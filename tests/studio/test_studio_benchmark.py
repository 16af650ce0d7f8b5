"""The benchmark of the studio: its rows, and its client, on a server of the tests."""

import pytest

from benchmarks.studio import ASKED, spread, table, talking

TOKEN = "a-token-of-the-tests"


def test_rows_say_what_is_asked_and_whether_it_is_met():
    found = spread("edit", [*range(1, 20), 1000])
    assert found["edit, median"] == 10.5
    assert found["edit, p95"] == pytest.approx(68.05)
    lines = table(found | {"growth": 50.0}).splitlines()
    assert " ".join(lines[0].split()) == "edit, median 10.50 ms asked: at most 50, met"
    assert lines[1].endswith("asked: at most 100, met")
    assert lines[2].split() == ["edit,", "number", "20.00"]
    assert table({"growth": 51.0}).endswith("MISSED")
    assert len({name for name, *_ in ASKED}) == len(ASKED)


def test_commands_are_answered(server):
    with talking(f"http://{server.host}/#token={TOKEN}") as ask:
        assert ask("hello")["commands"]
        assert len(ask("surface", outputs=["stiffness"], columns=5)) == 24 + 4 * 25
        with pytest.raises(RuntimeError, match="unknown 'nothing'"):
            ask("nothing")
