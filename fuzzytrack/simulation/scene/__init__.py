"""Scenes of many targets: what a radar makes of them, scan by scan, and the truth beside it."""

from fuzzytrack.simulation.scene.clutter import Clutter
from fuzzytrack.simulation.scene.clutter_kinds import CLUTTER
from fuzzytrack.simulation.scene.files import as_scene, load_scene, loads_scene, shipped_scenes
from fuzzytrack.simulation.scene.passing_clutter import Arcs, CreepingGlints, EchoGroups
from fuzzytrack.simulation.scene.radar import OwnShip, Radar, ScanTimes
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.shore_clutter import Shoreline, SteadyPoints
from fuzzytrack.simulation.scene.simulate import SimulatedScans, simulate_scans
from fuzzytrack.simulation.scene.targets import TargetGroup
from fuzzytrack.simulation.scene.truth import Truth
from fuzzytrack.simulation.scene.uniform_clutter import UniformClutter

__all__ = [
    "CLUTTER",
    "Arcs",
    "Clutter",
    "CreepingGlints",
    "EchoGroups",
    "OwnShip",
    "Radar",
    "Region",
    "ScanTimes",
    "Scene",
    "Shoreline",
    "SimulatedScans",
    "SteadyPoints",
    "TargetGroup",
    "Truth",
    "UniformClutter",
    "as_scene",
    "load_scene",
    "loads_scene",
    "shipped_scenes",
    "simulate_scans",
]
