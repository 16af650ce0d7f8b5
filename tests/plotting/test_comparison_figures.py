import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from fuzzytrack.plotting import plot_comparison, plot_error_over_time

WHERE = ["calm", "brisk", "windy"]
VALUES = {"one": [3.0, 5.0, np.nan], "two": [4.0, 2.0, 8.0]}


def points(ax):
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def rows(ax):
    return [label.get_text() for label in ax.get_yticklabels()]


def test_points_of_all_trackers_are_in_the_row_of_their_category():
    _, ax = plot_comparison(VALUES, categories=WHERE)
    assert rows(ax) == WHERE
    for label, line in points(ax).items():
        assert line.get_linestyle() == "None"
        np.testing.assert_array_equal(line.get_xdata(), VALUES[label])
        assert list(np.round(line.get_ydata())) == [0, 1, 2]
    one, two = (line.get_ydata() for line in points(ax).values())
    assert (one < two).all()
    # The first category is on top.
    assert ax.get_ylim() == (2.5, -0.5)
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["one", "two"]


def test_a_row_for_each_tracker_without_categories():
    intervals = {"b": (1.5, 2.75)}
    _, ax = plot_comparison({"a": 1.0, "b": [2.0]}, intervals, what="error", unit="km")
    assert rows(ax) == ["a", "b"]
    assert ax.get_legend() is None
    assert [float(line.get_ydata()[0]) for line in points(ax).values()] == [0, 1]
    (bar,) = ax.collections
    np.testing.assert_array_equal(bar.get_segments()[0], [[1.5, 1], [2.75, 1]])
    assert ax.get_xlabel() == "error (km)"
    assert ax.get_xlim()[0] == 0


def test_the_least_is_bold_and_long_names_are_cut():
    names = ["a", "b$", "x" * 60, "none", r"\$c"]
    figure, ax = plot_comparison(dict(zip(names, [3.0, 2.0, 9.0, np.nan, 4.0], strict=True)))
    figure.canvas.draw()
    assert [t.get_fontweight() == "bold" for t in ax.get_yticklabels()] == [0, 1, 0, 0, 0]
    assert rows(ax) == ["a", r"b\$", "x" * 39 + "…", "none", r"\$c"]


def test_a_reference_is_a_line_with_its_name():
    _, ax = plot_comparison({"a": 1.0}, reference={"plots": 5.0})
    assert [5.0, 5.0] in [list(line.get_xdata()) for line in ax.lines]
    (text,) = ax.texts
    assert text.get_text() == "plots"
    assert text.get_position()[0] == 5.0
    assert ax.get_xlim()[1] > 5


def test_colors_are_those_of_other_pictures():
    time = np.arange(3.0)
    _, lines = plot_error_over_time(time, {"one": time, "two": time})
    _, ax = plot_comparison(VALUES, categories=WHERE)
    colors = {label: to_hex(line.get_color()) for label, line in points(ax).items()}
    assert colors == {x.get_label(): to_hex(x.get_color()) for x in lines.lines}


@pytest.mark.parametrize(
    ("values", "scale", "least"),
    [([1.0, 2.0], "linear", 0.0), ([1.0, 900.0], "log", None), ([-1.0, 2.0], "linear", None)],
)
def test_scale(values, scale, least):
    figure, ax = plot_comparison(dict(zip("ab", values, strict=True)))
    figure.canvas.draw()
    assert ax.get_xscale() == scale
    assert least is None or ax.get_xlim()[0] == least
    if scale == "log":
        shown = [t.get_text() for t in ax.get_xticklabels() if t.get_text()]
        assert {"1", "10", "100"} <= set(shown)


def test_nothing_known_is_still_a_picture():
    figure, ax = plot_comparison({"a": np.nan, "b": np.inf})
    figure.canvas.draw()
    assert rows(ax) == ["a", "b"]


def test_drawn_into_axes_that_are_given():
    mine = Figure().subplots()
    assert plot_comparison(VALUES, categories=WHERE, ax=mine) == (mine.figure, mine)
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (({},), "values: must be a mapping"),
        (([1.0],), "values: must be a mapping"),
        (({"a": [1.0, 2.0]},), r"values: 'a': needs shape \(1,\), got \(2,\)"),
        ((VALUES, None, WHERE[:2]), r"values: 'one': needs shape \(2,\), got \(3,\)"),
        (({"a": 1.0}, {"b": (0, 1)}), "intervals: unknown 'b'; one of a"),
        (({"a": 1.0}, {"a": ([0, 1], 1)}), r"intervals: 'a': needs shape \(1,\)"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises(ValueError, match=message):
        plot_comparison(*arguments)
    assert plt.get_fignums() == []
