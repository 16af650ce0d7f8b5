import math

import fuzz_files


def test_changed_files_are_read_or_refused(monkeypatch):
    # Of the whole process, in which other tests have run.
    monkeypatch.setattr(fuzz_files, "MEBIBYTES", math.inf)
    monkeypatch.setattr(fuzz_files, "SECONDS", 30.0)
    report = fuzz_files.run((7, 0, 150))
    assert report.failures == []
    assert report.files == 150
    assert 0 < report.accepted < 150
