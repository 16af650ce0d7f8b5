"""The kinds of clutter by the names that files have for them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from fuzzytrack.simulation.scene.clutter import Clutter
from fuzzytrack.simulation.scene.passing_clutter import Arcs, CreepingGlints, EchoGroups
from fuzzytrack.simulation.scene.shore_clutter import Shoreline, SteadyPoints
from fuzzytrack.simulation.scene.uniform_clutter import UniformClutter

__all__ = ["CLUTTER"]

#: Kinds of clutter by name.
CLUTTER: Mapping[str, type[Clutter]] = MappingProxyType(
    {
        "uniform": UniformClutter,
        "points": SteadyPoints,
        "shoreline": Shoreline,
        "glints": CreepingGlints,
        "arcs": Arcs,
        "groups": EchoGroups,
    }
)
