"""What holds for every picture."""

import subprocess
import sys

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fuzzytrack as ft
from fuzzytrack import plotting
from fuzzytrack.plotting import _figures as shared

MAKERS = {
    "plot_surface": lambda f: plotting.plot_surface(f["shipped"], points=11),
    "plot_surface, map": lambda f: plotting.plot_surface(f["shipped"], points=11, style="contour"),
    "plot_gain_surfaces": lambda f: plotting.plot_gain_surfaces(f["shipped"], points=11),
    "plot_relation": lambda f: plotting.plot_relation(f["valve"], at=1.25),
    "plot_memberships": lambda f: plotting.plot_memberships(f["shipped"]),
    "plot_gain_plane": lambda f: plotting.plot_gain_plane(f["result"], f["shipped"]),
    "plot_track": lambda f: plotting.plot_track(f["result"], f["flight"][1]),
    "plot_errors": lambda f: plotting.plot_errors({"one": f["result"]}, f["flight"][1]),
}


@pytest.fixture
def things(shipped, valve, result, flight):
    return {"shipped": shipped, "valve": valve, "result": result, "flight": flight}


@pytest.mark.parametrize("name", MAKERS)
def test_returns_figure_and_axes_that_close(name, things):
    figure, axes = MAKERS[name](things)
    assert isinstance(figure, Figure)
    flat = np.ravel(axes)
    assert len(flat)
    assert all(isinstance(ax, Axes) and ax.figure is figure for ax in flat)
    assert plt.get_fignums() == [figure.number]
    plt.close(figure)
    assert plt.get_fignums() == []


@pytest.mark.parametrize("name", MAKERS)
def test_nothing_is_clipped(name, things):
    figure, _ = MAKERS[name](things)
    figure.canvas.draw()
    # 3-D labels reach into the margin on purpose; a pixel of rounding is none.
    tight, whole = figure.get_tightbbox(), figure.bbox_inches
    assert tight.x0 >= -0.01
    assert tight.y0 >= -0.01
    assert tight.x1 <= whole.x1 + 0.01
    assert tight.y1 <= whole.y1 + 0.01


@pytest.mark.parametrize("name", MAKERS)
def test_every_flat_axes_has_labels(name, things):
    figure, axes = MAKERS[name](things)
    for ax in np.ravel(axes):
        assert ax.get_xlabel()
        assert ax.get_ylabel()
    plt.close(figure)


def test_given_axes_are_used_and_leave_no_window(shipped, valve, result, flight):
    figure = Figure()
    flat, solid = figure.subplots(2, 4), None
    for ax in flat[1, 2:]:
        ax.remove()
    solid = [figure.add_subplot(2, 4, k, projection="3d") for k in (7, 8)]
    _, truth, _ = flight
    for answer in (
        plotting.plot_surface(shipped, points=5, axes=solid),
        plotting.plot_surface(shipped, "damping", points=5, style="contour", axes=flat[0, 0]),
        plotting.plot_gain_surfaces(shipped, points=5, style="contour", axes=flat[0, 1:3]),
        plotting.plot_relation(valve, axes=flat[0, 3]),
        plotting.plot_memberships(shipped, "E", axes=flat[1, 0]),
        plotting.plot_gain_plane(result, ax=flat[1, 0]),
        plotting.plot_track(result, ax=flat[1, 0]),
        plotting.plot_errors(result, truth, ax=flat[1, 1]),
    ):
        assert answer[0] is figure
    assert plt.get_fignums() == []


def test_axes_of_a_subfigure_belong_to_the_whole_figure(shipped):
    figure = Figure()
    left, _ = figure.subfigures(1, 2)
    got, _ = plotting.plot_memberships(shipped, "E", axes=left.subplots())
    assert got is figure


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: plotting.plot_memberships(r, axes=Figure().subplots(1, 3)), "axes: needs 4"),
        (lambda r: plotting.plot_memberships(r, "E", axes="left"), "axes: .* got str"),
        (lambda r: plotting.plot_memberships(r, "E", axes=[]), "axes: .* got nothing"),
        (
            lambda r: plotting.plot_surface(r, "damping", axes=Figure().subplots()),
            "axes: .*projection='3d'",
        ),
        (
            lambda r: plotting.plot_memberships(r, "E", axes=Figure().add_subplot(projection="3d")),
            "axes: needs flat axes",
        ),
        (lambda r: plotting.plot_memberships(r, "F"), "variables: unknown 'F'; one of E, dE"),
    ],
)
def test_wrong_arguments_say_so_and_leave_no_window(call, message, shipped):
    with pytest.raises(ValueError, match=message):
        call(shipped)
    assert plt.get_fignums() == []


def test_public_names():
    top = [name for name in plotting.__all__ if name in ft.__all__]
    assert len(top) == 5
    for name in top:
        assert getattr(ft, name) is getattr(plotting, name)


def test_importing_fuzzytrack_does_not_import_matplotlib():
    code = "import sys, fuzzytrack; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_ticks_name_both_ends():
    assert shared.ticks(-1.0, 1.0, 4) == [-1.0, -0.5, 0.0, 0.5, 1.0]
    found = shared.ticks(0.54, 0.89, 5)
    assert (found[0], found[-1]) == (0.54, 0.89)
    assert np.diff(found).min() > 0.03


def test_legends_use_the_room_there_is():
    _, ax = plt.subplots()
    for k in range(4):
        ax.plot([k], label="a very long name of a tracker with many settings")
    shared.legend_below(ax)
    assert ax.get_legend()._ncols == 1
    for line in ax.lines:
        line.set_label("short")
    shared.legend_below(ax)
    assert ax.get_legend()._ncols == 4


def test_long_legends_clear_the_label_of_the_axis():
    figure, (ax,) = shared.panels("ax", None, 1, columns=1, size=(6.4, 4.0))
    for k in range(9):
        ax.plot([k], label=f"a very long name of a tracker with many settings {k}")
    ax.set_xlabel("time (s)")
    shared.legend_below(ax)
    figure.draw_without_rendering()
    label = ax.xaxis.label.get_window_extent()
    assert ax.get_legend().get_window_extent().y1 < label.y0
