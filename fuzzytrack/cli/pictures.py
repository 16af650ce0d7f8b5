"""Pictures as files, without a display."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzytrack.fuzzy.system import FuzzySystem
    from fuzzytrack.io.files import PathLike

__all__ = ["check_picture", "save_picture", "surfaces"]

FORMATS = (".png", ".pdf", ".svg", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".eps", ".ps")


def check_picture(path: PathLike, inputs: tuple[PathLike, ...] = ()) -> None:
    """Check that a picture can be written, before it is drawn; ValueError or OSError if not."""
    from fuzzytrack.io.files import check_output

    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(
            f"{path}: cannot draw {suffix or 'without suffix'}; one of {', '.join(FORMATS)}"
        )
    check_output(path, inputs)


def save_picture(
    path: PathLike, draw: Callable[[], Figure], inputs: tuple[PathLike, ...] = ()
) -> None:
    """Draw a picture and write it, whole or not at all.

    Parameters
    ----------
    path : str or path
        Its suffix gives the format.
    draw : callable
        Makes the figure.
    inputs : tuple of str or path
        Files that must not be overwritten.
    """
    check_picture(path, inputs)
    import matplotlib as mpl

    from fuzzytrack.io.files import whole_file

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure = draw()
    try:
        with whole_file(path, inputs) as draft:
            figure.savefig(draft, format=Path(path).suffix[1:].lower(), dpi=150)
    finally:
        plt.close(figure)


def surfaces(
    system: FuzzySystem, points: int, at: dict[str, float] | None = None, *, style: str = "surface"
) -> Figure:
    """Surfaces of all outputs, and of α and β where the outputs are no gains but give them."""
    from matplotlib.figure import Figure

    from fuzzytrack.plotting import plot_gain_surfaces, plot_surface
    from fuzzytrack.schedulers.gain_outputs import find_gain_outputs

    gains = find_gain_outputs(system.rules.output_names)
    if at or gains is None or gains.setting == "direct":
        return plot_surface(system, points=points, at=at, style=style)[0]
    # Stiffness beside the two gains, or stiffness and damping above them.
    alone = len(system.rules.outputs) == 1
    figure = Figure(figsize=(14.4, 4.4) if alone else (11.2, 8.8), layout="constrained")
    flat = style == "contour" or len(system.rules.inputs) == 1
    kind = None if flat else {"projection": "3d"}
    axes = figure.subplots(1 if alone else 2, 3 if alone else 2, subplot_kw=kind).ravel()
    outputs, gains = axes[:-2], axes[-2:]
    plot_surface(system, points=points, style=style, axes=outputs)
    plot_gain_surfaces(system, points=points, style=style, axes=gains)
    return figure
