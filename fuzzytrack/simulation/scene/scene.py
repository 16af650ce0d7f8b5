"""A scene: a radar, the targets around it, and clutter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from fuzzytrack.reprs import summary
from fuzzytrack.simulation.scene.clutter import Clutter
from fuzzytrack.simulation.scene.radar import OwnShip, Radar, ScanTimes
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.targets import TargetGroup

__all__ = ["Scene"]


@dataclass(frozen=True, eq=False)
class Scene:
    """Many targets, as a radar sees them: births and deaths, missed plots, clutter, merged plots.

    Parameters
    ----------
    name : str
        Name of the scene.
    scans : ScanTimes
        When the radar scans.
    radar : Radar
        What it sees.
    traffic : mapping of str to TargetGroup
        Groups of targets, by name.
    clutter : mapping of str to Clutter
        Kinds of clutter, by name.
    region : Region, optional
        Where targets appear and clutter lies unless they say otherwise; the reach of the radar
        unless given.
    own : OwnShip
        Where the radar is.
    source : str
        Paper, or other origin.

    Raises
    ------
    ValueError
        If there is no region, and the reach of the radar has no end.
    """

    name: str
    scans: ScanTimes
    radar: Radar
    traffic: Mapping[str, TargetGroup]
    clutter: Mapping[str, Clutter] = field(default_factory=dict)
    region: Region | None = None
    own: OwnShip = field(default_factory=OwnShip)
    source: str = ""

    def __repr__(self) -> str:
        return summary(self, "name", scans=self.scans.count, traffic=list(self.traffic))

    def __post_init__(self) -> None:
        for name in ("traffic", "clutter"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        if self.region is None and math.isinf(self.radar.reach[1]):
            raise ValueError("region must be given, unless the reach of the radar has an end")

    def __reduce__(self) -> tuple[object, ...]:
        mappings = (dict(self.traffic), dict(self.clutter))
        return Scene, (
            self.name,
            self.scans,
            self.radar,
            *mappings,
            self.region,
            self.own,
            self.source,
        )

    @property
    def surroundings(self) -> Region:
        """The region, with its size."""
        if self.region is None:
            return Region(disc=self.radar.reach, at=self.own.at)
        return self.region.for_targets(sum(group.at_start for group in self.traffic.values()))
