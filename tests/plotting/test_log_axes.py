"""Numbers on logarithmic axes."""

import pytest
from matplotlib.figure import Figure

from fuzzytrack.plotting._figures import log_axis


def shown(low, high):
    figure = Figure()
    ax = figure.subplots()
    ax.set_ylim(low, high)
    log_axis(ax, "y")
    ax.set_ylim(low, high)
    figure.canvas.draw()
    assert not any(label.get_text() for label in ax.yaxis.get_minorticklabels())
    inside = [t for t in ax.get_yticks() if low <= t <= high]
    texts = dict(zip(ax.get_yticks(), [t.get_text() for t in ax.get_yticklabels()], strict=True))
    return [texts[t] for t in inside]


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.01, 1000.0, ["0.01", "0.1", "1", "10", "100", "1000"]),
        (3.0, 40.0, ["5", "10", "20"]),
        (0.03, 0.6, ["0.05", "0.1", "0.2", "0.5"]),
        (1e-6, 1e-4, ["$10^{-6}$", "$10^{-5}$", "$10^{-4}$"]),
        (1.5e6, 9e6, ["$2·10^{6}$", "$5·10^{6}$"]),
        (1e5, 1e7, ["$10^{5}$", "$10^{6}$", "$10^{7}$"]),
    ],
)
def test_plain_numbers(low, high, expected):
    assert shown(low, high) == expected


def test_less_than_a_step_has_ticks_as_well():
    assert len(shown(210.0, 380.0)) >= 2
