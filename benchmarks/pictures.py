"""Pictures of throughput against tracks and threads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["draw"]

Curve = list[dict[str, Any]]
COLORS = {"fixed gains": "#1f6fb4", "fuzzy exact": "#c8501e"}


def draw(figures: dict[str, Any], folder: Path) -> list[Path]:
    """Write the pictures of a run into a folder; a curve that was not measured is left out."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    written = []
    for name, key, label, scale in (
        ("speed-tracks.png", "tracks", "number of tracks", "log"),
        ("speed-threads.png", "threads", "threads", "linear"),
    ):
        curve = figures["curves"].get(key)
        if not curve:
            continue
        figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
        for tracker, color in COLORS.items():
            points = [(p[key], p[tracker]) for p in curve if tracker in p]
            axes.plot(*zip(*points, strict=True), "o-", color=color, label=tracker)
        axes.set(xlabel=label, ylabel="million updates a second", xscale=scale)
        if key == "threads":
            axes.set_xticks([p[key] for p in curve])
            axes.set_ylim(bottom=0.0)
        else:
            axes.set_yscale("log")
        axes.set_title(figures["machine"]["processor"], fontsize="medium")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False)
        path = folder / name
        figure.savefig(path, dpi=150)
        plt.close(figure)
        written.append(path)
    return written
