import numpy as np
import pytest

from fuzzytrack.papers import reproduce
from fuzzytrack.papers.zhang_jiang import experiment, gate_factor


@pytest.fixture(scope="module")
def found():
    """Rows of the formulas; the experiment is tested by itself."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiment, "experiment_rows", lambda *given: [])
        return reproduce("zhang-jiang")


@pytest.mark.parametrize(
    ("quantity", "value", "digits"),
    [
        ("α at N = 1", 0.8333333, 7),
        ("β at N = 1", 0.7003401714778812, 12),
        ("α at N = 30", 0.119318, 6),
        ("α at N = 10", 0.294872, 6),
        ("F at N = 2", 2.2360680, 7),
        ("F at N = 30", 0.3744728, 7),
        ("F at N = 46", 0.2997584, 7),
        ("first N with F <= 0.3", 46, 12),
    ],
)
def test_exact_figures(found, quantity, value, digits):
    assert found.ours(quantity) == pytest.approx(value, abs=0.6 * 10.0**-digits)


def test_the_gate_factor_is_that_of_a_line_through_the_plots():
    for n in (2, 3, 7, 20):
        model = np.stack([np.ones(n), np.arange(n)], axis=1)
        ahead = np.array([1.0, n])
        variance = ahead @ np.linalg.inv(model.T @ model) @ ahead
        assert gate_factor(n) == pytest.approx(np.sqrt(variance), rel=1e-12)


def test_a_quality_below_one_is_refused():
    with pytest.raises(ValueError, match=r"n must be >= 1, got 0.5 at index 1"):
        gate_factor([1.0, 0.5])


def test_verdicts(found):
    verdicts = {r.quantity: r.verdict for r in found.rows if r.published is not None}
    assert verdicts == {
        "α at N = 1": "matches",
        "β at N = 1": "matches",
        "F at N = 1, largest of the table": "differs",
        "F at N = 30, smallest of the table": "differs",
        "first N with F <= 0.3": "differs",
    }
    assert "Table 1 cannot be reproduced" in found.notes[0]
