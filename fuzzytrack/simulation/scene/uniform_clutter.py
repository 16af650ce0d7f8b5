"""Clutter anywhere in a region."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.simulation.scene.clutter import Clutter, ClutterPlots, View, refuse_too_many
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.settings import setting
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["UniformClutter"]


@dataclass(frozen=True, repr=False)
class UniformClutter(Clutter):
    """Plots anywhere in a region; as many in each scan on average, or exactly."""

    summary = "anywhere in a region, in each scan elsewhere"

    count: float | None = setting(None, "mean number of plots in a scan", "", least=0, most=1e7)
    density: float | None = setting(
        None, "instead: mean number of plots on a square meter in a scan", "1/m²", least=0
    )
    exact: str = setting(
        "no",
        "`yes`: exactly this number in each scan; `no`: Poisson",
        "",
        "word",
        ("no", "yes"),
    )
    within: Region | None = setting(  # noqa: RUF009 (a setting is no shared value)
        None, "region, instead of that of the scene", "", "part"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.count is None) == (self.density is None):
            raise ValueError("count or density must be given, and not both")

    def plots(self, view: View, streams: Streams) -> ClutterPlots:
        """Draw its plots in all scans."""
        region = self.within or view.region
        mean = (self.density or 0.0) * region.area if self.count is None else self.count
        scans = len(view.times)
        refuse_too_many(mean * scans)
        if self.exact == "yes":
            numbers = np.full(scans, round(mean))
        else:
            numbers = streams.stream("count").poisson(mean, scans)
        places = region.draw(streams.stream("place"), int(numbers.sum()))
        return np.repeat(np.arange(scans), numbers), places
