"""The plane of α and β: gains that a tracker used, and where gains are stable."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.stability import critical_curves
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.schedulers.gain_outputs import choices, find_gain_outputs
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains

__all__ = ["plot_gain_plane"]

Box = tuple[tuple[float, float], tuple[float, float]]
Visited = Gains | TrackResult

STIFFNESS_AND_DAMPING = ("stiffness", "damping")

# A cloud smaller than this part of the triangle gets an inset.
SMALL = 0.4


def plot_gain_plane(
    gains: Visited | Mapping[str, Visited],
    box: shared.Rules | Box | None = None,
    *,
    mark: Mapping[str, tuple[float, float]] | None = None,
    inset: bool | None = None,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Plane of α and β: gains that were used, inside the stability triangle.

    Parameters
    ----------
    gains : Gains, TrackResult, or mapping of str to either
        What to draw, with labels for the legend. Updates without gains (NaN) are left out, and
        gains that repeat are drawn once.
    box : RuleBase, FuzzySystem, str or path, or ((low, high), (low, high)), optional
        Outline of what can be reached: limits of stiffness and of damping, or a rule base whose
        outputs have limits: those of stiffness and damping, or of alpha and beta, are drawn as the
        edge of an area; that of stiffness alone as a part of Kalata's curve.
    mark : mapping of str to (alpha, beta), optional
        Points to mark, by label.
    inset : bool, optional
        Whether to enlarge the gains in an inset; where they fill little of the triangle unless
        given.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes
        The inset, if there is one, is ``ax.child_axes[0]``.

    Raises
    ------
    ValueError
        If an argument is not of an allowed form.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.16 to 2.24 and Figs. 5.2 and 5.3. The triangle is α > 0, β > 0,
    2α + β < 4. Equal poles (critical damping) lie on β = 2 - α ± 2√(1 - α), the gains of Benedict
    and Bordner on β = α²/(2 - α).
    """
    clouds = _clouds(gains)
    outline = {} if box is None else _outline(box)
    marks = {label: _pair(label, point) for label, point in (mark or {}).items()}
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 6.2))

    _references(plane)
    _draw(plane, clouds, outline, marks)
    plane.set(
        xlim=(-0.03, 2.06), ylim=(-0.06, 4.12), xlabel="position gain α", ylabel="velocity gain β"
    )
    plane.spines[["top", "right"]].set_visible(False)
    interesting = [*clouds.values(), *marks.values(), *outline.values()]
    points = np.concatenate([np.empty((0, 2)), *(np.reshape(p, (-1, 2)) for p in interesting)])
    # The gains of an unstable tracker may lie far outside; an inset does not show them.
    inside = points[(points >= 0).all(axis=1) & (points <= (2.0, 4.0)).all(axis=1)]
    if len(inside):
        low, high = inside.min(axis=0), inside.max(axis=0)
        small = bool(((high - low) <= SMALL * np.array([2.0, 4.0])).all())
        if small if inset is None else inset:
            _enlarge(plane, low, high, clouds, outline, marks)
    shared.legend_below(plane)
    return figure, plane


def _clouds(gains: object) -> dict[str, Array]:
    """For each label the distinct pairs (alpha, beta), shape (n, 2)."""
    if isinstance(gains, Gains | TrackResult):
        gains = {"gains visited": gains}
    if not isinstance(gains, Mapping):
        raise ValueError(
            "gains: must be Gains, a TrackResult or a mapping from labels to them, "
            f"got {type(gains).__name__}"
        )
    clouds = {}
    for label, visited in gains.items():
        found = visited.gains if isinstance(visited, TrackResult) else visited
        if not isinstance(found, Gains):
            raise ValueError(
                f"gains: {label!r} must be Gains or a TrackResult, got {type(visited).__name__}"
            )
        pairs = np.stack(np.broadcast_arrays(found.alpha, found.beta), axis=-1).reshape(-1, 2)
        clouds[str(label)] = np.unique(pairs[np.isfinite(pairs).all(axis=1)], axis=0)
    return clouds


def _pair(label: str, point: object) -> Array:
    pair = np.asarray(point, dtype=np.float64)
    if pair.shape != (2,) or not np.isfinite(pair).all():
        raise ValueError(f"mark: {label!r} must be a pair (alpha, beta), got {point!r}")
    return pair


def _outline(box: shared.Rules | Box) -> dict[str, Array]:
    """Trace the gains along the edge of what the outputs can reach, shape (n, 2), with a label."""
    if isinstance(box, RuleBase | FuzzySystem | str | os.PathLike):
        rules = shared.rules_of(box, "box")
        outputs = find_gain_outputs(rules.output_names)
        if outputs is None:
            raise ValueError(
                f"box: {rules.name} has outputs {', '.join(rules.output_names)}; "
                f"needed are {choices()}"
            )
        label = f"limits of {rules.name}"
        universes = [rules.output(name).universe for name in outputs.names]
        limits = np.array([[u.low, u.high] for u in universes])
    else:
        outputs, label = find_gain_outputs(STIFFNESS_AND_DAMPING), "limits of stiffness and damping"
        assert outputs is not None
        try:
            limits = np.asarray(box, dtype=np.float64)
        except TypeError as error:
            raise TypeError(
                "box must be ((low, high), (low, high)), a RuleBase, a FuzzySystem, or a name or "
                f"path of a rule base, got {type(box).__name__}"
            ) from error
        if limits.shape != (2, 2) or not (limits[:, 0] <= limits[:, 1]).all() or limits.min() < 0:
            raise ValueError(
                "box: must be ((low, high), (low, high)) of stiffness and damping, not negative, "
                f"got {box!r}"
            )
    gains = outputs.gains(dict(zip(outputs.names, _edge(limits), strict=True)))
    return {label: np.stack([gains["alpha"], gains["beta"]], axis=-1)}


def _edge(limits: Array) -> list[Array]:
    """Values of one output from limit to limit, or of two around the area between their limits.

    A third one, on which α and β do not depend, keeps its lower limit.
    """
    up = np.linspace(0.0, 1.0, 51)
    parts = [up]
    if len(limits) > 1:
        first = np.concatenate([up, np.ones(51), up[::-1], np.zeros(51)])
        second = np.concatenate([np.zeros(51), up, np.ones(51), up[::-1]])
        parts = [first, second, np.zeros(204)][: len(limits)]
    return [low + (high - low) * part for (low, high), part in zip(limits, parts, strict=True)]


def _references(ax: Axes, labels: bool = True) -> None:
    def named(text: str) -> str:
        return text if labels else "_nolegend_"

    ax.fill([0, 2, 0], [0, 0, 4], facecolor="0.96", edgecolor="none", zorder=0)
    ax.plot(
        [0, 2, 0, 0],
        [0, 0, 4, 0],
        color=shared.INK,
        linewidth=1.2,
        label=named("edge of stability"),
        zorder=1,
    )
    alpha = 1.0 - np.linspace(1.0, 0.0, 201) ** 2
    lower, upper = critical_curves(alpha)
    ax.plot(
        np.concatenate([alpha, alpha[::-1]]),
        np.concatenate([lower, upper[::-1]]),
        color=shared.GRAY,
        linestyle="--",
        linewidth=1.1,
        label=named("critical damping"),
        zorder=1,
    )
    # It leaves the triangle at 4 - 2√2; its ends, not stable themselves, are drawn.
    alpha = np.linspace(0.0, 4.0 - 2.0 * np.sqrt(2.0), 201)
    ax.plot(
        alpha,
        alpha**2 / (2.0 - alpha),
        color=shared.GRAY,
        linestyle=":",
        linewidth=1.6,
        label=named("Benedict–Bordner"),
        zorder=1,
    )


def _draw(
    ax: Axes,
    clouds: Mapping[str, Array],
    outline: Mapping[str, Array],
    marks: Mapping[str, Array],
    size: float = 4.0,
) -> None:
    # A fixed pair of gains is one point; it is drawn above the spread gains of the others.
    spread = {"markersize": size, "markeredgewidth": 0, "alpha": 0.65, "zorder": 3}
    point = {
        "markersize": 2 * size,
        "markeredgewidth": 0.8,
        "markeredgecolor": "white",
        "zorder": 4,
    }
    for number, (label, pairs) in enumerate(clouds.items()):
        look: dict[str, Any] = point if len(pairs) == 1 else spread
        ax.plot(
            *pairs.T,
            linestyle="none",
            marker=shared.MARKERS[number % len(shared.MARKERS)],
            color=shared.COLORS[number % len(shared.COLORS)],
            label=label,
            **look,
        )
    for label, curve in outline.items():
        ax.plot(*curve.T, color=shared.INK, linewidth=1.0, label=label, zorder=2)
    for number, (label, pair) in enumerate(marks.items()):
        style: dict[str, Any] = {"marker": "*+x"[number % 3], "markersize": 2.0 * size + 3}
        ax.plot(
            *pair[:, None],
            linestyle="none",
            color="black",
            markeredgewidth=1.0,
            markerfacecolor="white",
            label=label,
            zorder=4,
            **style,
        )


def _enlarge(
    ax: Axes,
    low: Array,
    high: Array,
    clouds: Mapping[str, Array],
    outline: Mapping[str, Array],
    marks: Mapping[str, Array],
) -> None:
    """Inset above the triangle's long side, where the plane is empty."""
    margin = np.maximum(0.15 * (high - low), (0.01, 0.02))
    window = ax.inset_axes((0.60, 0.55, 0.39, 0.41))
    _references(window, labels=False)
    _draw(window, clouds, outline, marks, size=5.0)
    window.set_xlim(low[0] - margin[0], high[0] + margin[0])
    window.set_ylim(low[1] - margin[1], high[1] + margin[1])
    window.locator_params(nbins=5)
    window.tick_params(labelsize=8)
    window.set_title("inside the dashed frame", fontsize=9)
    # The frame alone: lines from it to the inset would cross the curves.
    frame = ax.indicate_inset_zoom(window, edgecolor=shared.INK, alpha=0.8, linestyle="--")
    for connector in frame.connectors or ():
        connector.set_visible(False)
    for side in window.spines.values():
        side.set(linestyle="--", alpha=0.8)
