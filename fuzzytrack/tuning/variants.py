"""Conditions under which trackers are ranked: when plots come, and how good they are."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.reprs import constructor_code
from fuzzytrack.simulation.sampling import REGULAR, Sampling
from fuzzytrack.simulation.scenario import PlotNoise

__all__ = ["VARIANTS", "Variant"]


_USUAL = PlotNoise(1.0)


@dataclass(frozen=True)
class Variant:
    """When plots come and how good they are, in units of the tracks' noise and period.

    Attributes
    ----------
    sampling : Sampling
        Times of the scans.
    sensors : PlotNoise
        Noise, missed plots, and what the tracker is told of the noise.
    """

    sampling: Sampling = REGULAR
    sensors: PlotNoise = _USUAL

    def __repr__(self) -> str:
        return constructor_code(self)


#: Variants by name. The patterns of irregular time have the mean period of the set: scans that are
#: early or late by up to 0.4 of a period; intervals that alternate, one ten times as long as the
#: other, and first the long one, from which a start knows the velocity; bursts of five plots with
#: gaps 20 times as long as the time between two of them, so that a gap lasts 4.2 periods. The
#: standard deviation of each plot is log-uniform from one half to twice the usual one. Of outliers
#: there are 2 %, with ten times the standard deviation.
VARIANTS: dict[str, Variant] = {
    "constant T": Variant(),
    "T=.5": Variant(Sampling(period=0.5)),
    "T=2": Variant(Sampling(period=2.0)),
    "Pd.9": Variant(sensors=PlotNoise(1.0, detection=0.9)),
    "Pd.7": Variant(sensors=PlotNoise(1.0, detection=0.7)),
    "Pd.5": Variant(sensors=PlotNoise(1.0, detection=0.5)),
    "Pd.3": Variant(sensors=PlotNoise(1.0, detection=0.3)),
    "jitter": Variant(Sampling("jitter", 0.4)),
    "alternate 1:10": Variant(Sampling("alternate", (10, 1))),
    "burst": Variant(Sampling("burst", (5, 20))),
    "sigma/plot": Variant(sensors=PlotNoise(1.0, spread=2.0)),
    "jit+Pd.7+sigma": Variant(
        Sampling("jitter", 0.4), PlotNoise(1.0, detection=0.7, spread=2.0)
    ),
    "outliers": Variant(sensors=PlotNoise(1.0, outliers=(0.02, 10.0))),
    "told x.5": Variant(sensors=PlotNoise(1.0, told=0.5)),
    "told x2": Variant(sensors=PlotNoise(1.0, told=2.0)),
}  # fmt: skip
