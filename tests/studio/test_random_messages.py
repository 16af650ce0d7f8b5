"""Messages of any kind to the socket: answered, or refused in one sentence."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="needs the extra studio")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import fuzz_studio


@pytest.mark.untraced
def test_fuzzed_messages_are_answered_or_refused(tmp_path, monkeypatch):
    # Trackers would be compiled, and processes started.
    slow = ("run", "tune", "walk", "track", "certify", "open_scenario")
    quick = [name for name in fuzz_studio.COMMANDS if name not in slow]
    monkeypatch.setattr(fuzz_studio, "COMMANDS", quick)
    monkeypatch.setattr(fuzz_studio, "WEIGHTS", [1.0] * len(quick))
    report = fuzz_studio.run(1, 300, tmp_path, chunk=60)
    assert report.failures == []
    assert sum(report.outcomes.values()) == report.messages == 300
    # A fuzzer whose messages all fail, or all pass, tests nothing.
    assert min(report.outcomes["done"], report.outcomes["refused"]) > 50
