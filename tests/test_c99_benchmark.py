"""The comparison of exported C with the library runs, and finds an error that is too large."""

import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

pytestmark = [
    pytest.mark.untraced,
    pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler"),
]


@pytest.fixture
def errors(monkeypatch):
    monkeypatch.syspath_prepend(ROOT)
    from benchmarks import c99_errors

    return c99_errors


def test_rule_bases_and_filters_hold_their_bounds(errors, capsys):
    assert errors.main(["omega-schedule", "--inputs", "3000"]) == 0
    printed = [line.split() for line in capsys.readouterr().out.splitlines()]
    rows = [line for line in printed if line[:1] == ["omega-schedule"]]
    assert [row[1] for row in rows] == ["double", "float", "q15", "double", "float"]
    assert all(row[-1] == "yes" for row in rows)


def test_an_error_beyond_its_bound_fails(errors, capsys, monkeypatch):
    monkeypatch.setattr(errors, "ULPS", -1.0)
    assert errors.main(["tipper", "--inputs", "500"]) == 1
    assert " no\n" in capsys.readouterr().out
