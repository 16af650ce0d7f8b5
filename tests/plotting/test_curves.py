import numpy as np
import pytest
from matplotlib import pyplot as plt

from fuzzytrack.plotting.curves import plot_curves

X = np.array([1.0, 10.0, 100.0])


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_curves_marks_and_words_are_drawn():
    curves = {"one": X**2, "other": [3.0, 2.0, np.nan]}
    _, ax = plot_curves(
        X, curves, xlabel="x (m)", ylabel="y (s)", title="Both", xlog=True, ylog=True,
        marks={"published": (10.0, 7.0)},
    )  # fmt: skip
    one, other, mark = ax.lines
    np.testing.assert_array_equal(one.get_xydata(), np.stack([X, X**2], axis=1))
    np.testing.assert_array_equal(other.get_ydata(), curves["other"])
    assert mark.get_xydata().tolist() == [[10.0, 7.0]]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "one",
        "other",
        "published",
    ]
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_title()) == ("x (m)", "y (s)", "Both")
    assert len({line.get_color() for line in (one, other)}) == 2


def test_truth_and_plots_look_as_in_pictures_of_tracks():
    curves = {"true": X, "one": X, "plots": X, "other": X}
    _, ax = plot_curves(X, curves, xlabel="x", ylabel="y")
    _, alone = plot_curves(X, {"one": X, "other": X}, xlabel="x", ylabel="y")
    looks = {line.get_label(): (line.get_color(), line.get_linestyle()) for line in ax.lines}
    assert looks["true"] == ("black", "-")
    assert looks["plots"][0] == "0.55"
    for line in alone.lines:
        assert looks[line.get_label()] == (line.get_color(), line.get_linestyle())


def test_given_axes_are_used():
    given = plt.figure().subplots()
    figure, ax = plot_curves(X, {"one": X}, xlabel="", ylabel="", ax=given)
    assert ax is given
    assert figure is given.figure


def test_nothing_to_draw_is_refused():
    with pytest.raises(ValueError, match="curves: needs at least one"):
        plot_curves(X, {}, xlabel="x", ylabel="y")
    with pytest.raises(ValueError, match="x must be finite, got nan at index 1"):
        plot_curves([0.0, np.nan], {"one": [1.0, 2.0]}, xlabel="x", ylabel="y")
