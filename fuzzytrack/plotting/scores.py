"""Scores of tracks over time."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._position_axes import time_unit
from fuzzytrack.scoring.scores import GroupScores, Scores

__all__ = ["plot_scores"]


def plot_scores(
    scores: Scores, group: str | None = None, *, axes: Any = None
) -> tuple[Figure, tuple[Axes, Axes]]:
    """OSPA with its parts over time, above the numbers of true objects, tracks and matched pairs.

    Parameters
    ----------
    scores : Scores
        From `fuzzytrack.score`.
    group : str, optional
        Name of the recording; the first one unless given.
    axes : sequence of two Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    axes : tuple of two Axes

    Raises
    ------
    ValueError
        If there is no such recording.
    """
    one = _chosen(scores, group)
    figure, (above, below) = shared.panels("axes", axes, 2, columns=1, size=(6.8, 2.9), sharex=True)
    unit, second = time_unit(one.time)
    time, curves = one.time / second, one.curves
    localization, whole = curves["ospa_localization"], curves["ospa"]
    above.fill_between(
        time, 0, localization, step="mid", color=shared.SKY, alpha=0.35, linewidth=0,
        label="OSPA, localization",
    )  # fmt: skip
    above.step(time, whole, where="mid", color=shared.BLUE, linewidth=1.4, label="OSPA")
    above.step(
        time, curves["ospa2"], where="mid", color=shared.VERMILION, linewidth=1.4,
        linestyle="--", label="OSPA(2)",
    )  # fmt: skip
    above.set(ylabel="distance (m)", ylim=(0, 1.02 * scores.settings.cutoff))
    if one.name:
        above.set_title(one.name, loc="left")
    for name, label, color, style in (
        ("n_true", "true objects", shared.INK, "-"),
        ("n_tracks", "tracks", shared.VERMILION, "--"),
        ("n_matched", "matched", shared.BLUE, ":"),
    ):
        below.step(
            time, curves[name], where="mid", color=color, linestyle=style, linewidth=1.6,
            label=label,
        )  # fmt: skip
    below.set(xlabel=f"time ({unit})", ylabel="number")
    below.yaxis.get_major_locator().set_params(integer=True)
    below.set_ylim(bottom=0)
    for ax in (above, below):
        ax.margins(x=0.01)
        shared.finish(ax)
    above.legend(frameon=False, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    shared.legend_below(below)
    return figure, (above, below)


def _chosen(scores: Scores, group: str | None) -> GroupScores:
    if group is None:
        return scores.groups[0]
    for one in scores.groups:
        if one.name == group:
            return one
    names = ", ".join(repr(one.name) for one in scores.groups)
    raise ValueError(f"group: no recording {group!r}; one of {names}")
