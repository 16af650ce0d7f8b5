"""Files that are broken in any way: read, or refused with a DataError."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("asterix.generated", reason="libasterix is not installed")
pytest.importorskip("pyais", reason="pyais is not installed")

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import fuzz_readers


@pytest.mark.untraced
@pytest.mark.parametrize("format", fuzz_readers.FORMATS)
def test_fuzzed_files_are_read_or_refused(format, monkeypatch):
    # A process of many tests is larger, and under their load slower.
    monkeypatch.setattr(fuzz_readers, "SECONDS", 60.0)
    monkeypatch.setattr(fuzz_readers, "MEGABYTES", 1e6)
    report = fuzz_readers.run(format, seed=1, start=0, count=150)
    assert report.failures == []
    assert report.total == 150
    # A fuzzer whose files all fail, or all pass, tests nothing.
    assert min(report.accepted, report.refused) > 15
