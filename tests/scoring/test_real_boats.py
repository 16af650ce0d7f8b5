"""Tracks of real radar plots, scored as in the tests of the scan tracker, by other code."""

import sys
from pathlib import Path

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.scan.scanners import load_scanner

sys.path.insert(0, str(Path(__file__).parents[1] / "scan"))
import autoferry


@pytest.mark.parametrize("scenario", autoferry.LAGS)
def test_the_same_figures(scenario):
    scans = autoferry.scans_of(scenario)
    rows = autoferry.rows("ground_truth.csv", scenario)
    truth = (
        [float(row["t_s"]) for row in rows],
        [row["target_id"] for row in rows],
        [autoferry.numbers(row, "north_m", "east_m") for row in rows],
    )
    result = load_scanner("default").run(scans)
    reports = result.reports
    tracked = [
        {
            int(id): position
            for id, position in zip(
                reports.track_id[reports.scan == k],
                reports.position[reports.scan == k],
                strict=True,
            )
        }
        for k in range(len(scans))
    ]
    ospa, near, switches, false = autoferry.score(scenario, tracked)
    found = ft.score(
        result, truth, lag=autoferry.LAGS[scenario], truth_lists="moving", moving_above=0.5
    )
    assert found["ospa"] == pytest.approx(ospa, rel=1e-9)
    # Theirs are counts; and a boat keeps its track here, where the nearest one is taken there.
    assert found["share_tracked"] == pytest.approx(near, abs=0.01)
    assert found["switches"] == switches / 2
    assert (found["moving_false_per_minute"] == 0) == (false == 0)
    assert found.groups[0].at_ends == 0
    assert np.isfinite(found["first_match"])
