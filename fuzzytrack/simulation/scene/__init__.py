"""Scenes of many targets: what a radar makes of them, scan by scan, and the truth beside it."""

from fuzzytrack.simulation.scene.clutter import UniformClutter
from fuzzytrack.simulation.scene.radar import OwnShip, Radar, ScanTimes
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.simulate import SimulatedScans, simulate_scans
from fuzzytrack.simulation.scene.targets import TargetGroup
from fuzzytrack.simulation.scene.truth import Truth

__all__ = [
    "OwnShip",
    "Radar",
    "Region",
    "ScanTimes",
    "Scene",
    "SimulatedScans",
    "TargetGroup",
    "Truth",
    "UniformClutter",
    "simulate_scans",
]
