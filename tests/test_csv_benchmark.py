"""The measurement of parsers of CSV, on a small file."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_parsers_take_turns(capsys, monkeypatch):
    pytest.importorskip("pyarrow")
    pytest.importorskip("resource")
    monkeypatch.syspath_prepend(ROOT)
    monkeypatch.chdir(ROOT)
    from benchmarks import csv_files

    # Measured here: there is no time for a process each.
    monkeypatch.setattr(
        csv_files, "_in_a_process", lambda name, path: csv_files.measure(name, str(path))
    )
    names = ["pyarrow_stream", "standard_library", "tables", "tables_with_times"]
    assert csv_files.main(["--rows", "2000", "--readers", *names]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == names
