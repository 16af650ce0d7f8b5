"""The two pictures of the home page and of README.md, for light and for dark pages.

    python docs/images/home.py [FOLDER]

A target flies straight and turns. The track has the color of the gain that the rule base chose; its
errors are compared with those of small and of large fixed gains.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from numpy.typing import NDArray

import fuzzytrack as ft
from fuzzytrack.trackers import TrackResult

SIGMA, SPEED = 250.0, 200.0  # m, m/s
# When turns begin and end (s), and through how many degrees they go: about 5 m/s².
TURNS = ((100, 226, 180), (330, 424, -135))
TRACKERS = {
    "small fixed gains": "fixed:alpha=0.3:beta=0.05",
    "large fixed gains": "fixed:alpha=0.75:beta=0.5",
    "rule base": "maneuver:level=5",
}


@dataclass(frozen=True)
class Palette:
    """Colors on pages of one kind; those of lines in the order of the trackers."""

    ink: str
    plots: str
    shade: str
    lines: tuple[str, str, str]
    gains: tuple[str, str, str]


PALETTES = {
    "light": Palette(
        ink="#1f2933",
        plots="#8d99a6",
        shade="#e8edf2",
        lines=("#7a56b3", "#9a6a14", "#0b8280"),
        gains=("#27408b", "#12a19a", "#ff8c1a"),
    ),
    "dark": Palette(
        ink="#e4e9ee",
        plots="#8492a0",
        shade="#29313b",
        lines=("#bda2f2", "#e0b45c", "#45d0c4"),
        gains=("#6f9bff", "#3fd0c4", "#ffb057"),
    ),
}


def target() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (s), one every 4 s, and true positions (m)."""
    fine = np.arange(0.0, 525.0)
    course = np.full_like(fine, np.pi / 2)
    for begin, end, degrees in TURNS:
        course -= np.radians(degrees) * np.clip((fine - begin) / (end - begin), 0, 1)
    path = SPEED * np.cumsum(np.stack([np.cos(course), np.sin(course)], axis=-1), axis=0)
    return fine[::4], path[::4]


def draw_track(ax: Axes, track: TrackResult, palette: Palette) -> None:
    """Draw plots, and the track in the color of its gains."""
    ax.plot(*(track.measured.T / 1e3), ".", color=palette.plots, markersize=5)
    points = track.filtered / 1e3
    line = LineCollection(
        np.stack([points[1:-1], points[2:]], axis=1),
        cmap=LinearSegmentedColormap.from_list("gains", palette.gains),
        linewidths=3.5,
        capstyle="round",
    )
    line.set_array(track.gains.alpha[2:, 0])
    line.set_clim(0.2, 0.7)
    ax.add_collection(line)
    ax.set(xlabel="east (km)", ylabel="north (km)", aspect="equal")
    ax.set_title("Plots of a radar, and their track", loc="left")
    bar = ax.figure.colorbar(
        line, ax=ax, orientation="horizontal", shrink=0.8, aspect=35, extend="both"
    )
    bar.set_label("gain α that the rule base chose")
    bar.outline.set_visible(False)


def draw_errors(ax: Axes, t: NDArray[np.float64], errors: dict[str, NDArray[np.float64]],
                palette: Palette) -> None:  # fmt: skip
    """Draw errors over time, with the turns shaded; those of the first plots have no prediction."""
    for begin, end, _ in TURNS:
        ax.axvspan(begin, end, color=palette.shade, linewidth=0)
        ax.text((begin + end) / 2, 40, "turn", ha="center", color=palette.plots)
    for (name, error), color in zip(errors.items(), palette.lines, strict=True):
        wide = 3.0 if name == "rule base" else 1.8
        ax.plot(t[3:], error[3:], color=color, linewidth=wide, label=name)
    ax.set(xlabel="time (s)", ylabel="error of the prediction (m)", xlim=(0, t[-1]), ylim=(0, 1300))
    ax.legend(loc="upper center", bbox_to_anchor=(0.45, -0.16), ncol=3, columnspacing=1.4)


def style(palette: Palette) -> dict[str, object]:
    """Return settings of matplotlib for a picture without a background."""
    ink = ("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color")
    bare = dict.fromkeys(("axes.spines.top", "axes.spines.right", "legend.frameon"), False)
    text = {"font.size": 11, "axes.titleweight": "bold"}
    return dict.fromkeys(ink, palette.ink) | bare | text


def main(folder: Path, runs: int = 500) -> None:
    """Write track-light.png, track-dark.png, errors-light.png and errors-dark.png."""
    t, truth = target()
    plots = truth[:, None, :] + np.random.default_rng(4).normal(0, SIGMA, (len(t), runs, 2))
    trackers = {name: ft.AlphaBetaTracker(text) for name, text in TRACKERS.items()}
    results = {name: tracker.run(t, plots, SIGMA) for name, tracker in trackers.items()}
    errors = {
        name: np.sqrt(np.sum((result.predicted - truth[:, None]) ** 2, axis=-1).mean(axis=1))
        for name, result in results.items()
    }
    shown = trackers["rule base"].run(t, plots[:, 0], SIGMA)
    for page, palette in PALETTES.items():
        with mpl.rc_context(style(palette)):
            for name in ("track", "errors"):
                figure, ax = plt.subplots(figsize=(5.6, 4.6), layout="constrained")
                if name == "track":
                    draw_track(ax, shown, palette)
                else:
                    draw_errors(ax, t, errors, palette)
                    ax.set_title(f"RMS error of {runs} such tracks", loc="left")
                figure.savefig(folder / f"{name}-{page}.png", dpi=120, transparent=True)
                plt.close(figure)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
