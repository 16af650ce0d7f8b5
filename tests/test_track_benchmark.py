"""The measurement of files that are tracked, on a small file."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_jobs_take_turns(capsys, monkeypatch):
    pytest.importorskip("pyarrow")
    monkeypatch.syspath_prepend(ROOT)
    monkeypatch.chdir(ROOT)
    from benchmarks import track_files

    written = []

    # Done here: there is no time for a process each.
    def measure(job, path, output):
        track_files.run(job, path, output)
        written.append((job, Path(output).exists()))
        return {"seconds": 1.0, "cpu": 0.5, "peak": 100.0}

    monkeypatch.setattr(track_files, "measure", measure)
    assert track_files.main(["--rows", "400", "--tracks", "4"]) == 0
    assert written == [("parse", False), ("track", True), ("fixed", True)]
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[-3:]] == ["parse", "track", "fixed"]
    assert lines[-1].split() == (
        ["fixed", "1.0", "s", "0.5", "s", "CPU", "400", "rows/s", "100", "MiB", "1.00", "x"]
    )
