"""The benchmark of metrics runs, and what it times gives the same as its peers."""

import pytest

from benchmarks.scoring import INSTANTS, OBJECTS, ours, positions


def test_everything_that_is_timed_runs():
    tracks, truth = positions(3000.0)
    assert len(truth) == OBJECTS * INSTANTS
    found = {name: run() for name, run in ours(tracks, truth).items()}
    assert found["CLEAR MOT"].switches == 0
    assert found["score, from arrays"]["ospa"] == pytest.approx(found["OSPA"].distance.mean())
