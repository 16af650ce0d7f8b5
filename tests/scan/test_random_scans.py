"""Scans of any kind: taken, or refused without a change."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import fuzz_scans


@pytest.fixture(autouse=True)
def limits_of_a_process_of_many_tests(monkeypatch):
    """It is larger than one of the fuzzer, and under its load slower."""
    monkeypatch.setattr(fuzz_scans, "SECONDS", 600.0)
    monkeypatch.setattr(fuzz_scans, "MEBIBYTES", 1e6)


@pytest.mark.untraced
def test_fuzzed_scans_are_tracked_or_refused():
    report = fuzz_scans.run((1, 0, 30, 2000))
    assert report.failures == []
    # A fuzzer whose scans all fail, or all pass, tests nothing.
    assert min(report.taken, report.refused) > 30
    assert report.scans == report.taken + report.refused


@pytest.mark.untraced
def test_a_session_that_is_resumed_chooses_the_same_plots_of_a_crowd():
    """Recording 40 has 297 plots at one spot, more than a track looks at."""
    assert fuzz_scans.run((1, 40, 1, 2000)).failures == []
