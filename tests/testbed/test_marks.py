"""Which trackers of a table are best, and which worse than the plots."""

import math

import numpy as np
import pytest

from fuzzytrack.testbed import compare
from fuzzytrack.testbed.marks import best_of, marks_of


@pytest.mark.parametrize(
    ("errors", "best"),
    [
        ([3.0, 1.0, 2.0], 1),
        ([3.0, 1.0, 1.0], 1),
        ([math.nan, math.inf, 5.0], 2),
        ([math.nan, math.inf], None),
        ([1.0], None),
        ([], None),
    ],
)
def test_best(errors, best):
    assert best_of(errors) == best


def test_marks():
    assert marks_of([3.0, 1.0, 2.0, 9.0], [5.0, 4.0, 4.1, math.nan], 4.0) == [
        "worse",
        "best",
        "worse",
        "worse",
    ]
    assert marks_of([1.0, 2.0], [4.1, 4.0], 4.0) == ["best, worse", ""]
    assert marks_of([1.0], [1.0], math.nan) == [""]


def test_a_comparison_marks_what_its_numbers_say():
    t = np.arange(40.0)
    truth = np.stack([10 * t, 0.5 * t**2], axis=1)
    names = ["fixed:alpha=.5:beta=.2", "fixed:alpha=.05:beta=.001", "fixed:alpha=.9:beta=.5"]
    found = compare(names, t, truth, 1.0, 10, 0)
    assert found.marks == marks_of(found.predicted_rmse, found.filtered_rmse, found.measured_rmse)
    assert found.marks[1] == "worse"
    told = found.to_json_dict()
    assert told["best"] == found.names[int(np.argmin(found.predicted_rmse))]
    assert [one["worse_than_plots"] for one in told["trackers"]] == [
        "worse" in mark for mark in found.marks
    ]
