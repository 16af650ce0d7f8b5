"""Simulated targets and sensors, and trackers run and compared on simulated noise."""

from fuzzytrack.testbed.comparison import Comparison, compare, compare_tracks
from fuzzytrack.testbed.fusion import fuse, fuse_pair
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.noise import Noise, Plots, noisy_plots
from fuzzytrack.testbed.published import TrackSet, kim_lee, llinas_maneuver, s3, track_set, warship
from fuzzytrack.testbed.results import Results
from fuzzytrack.testbed.scenario import FieldSensors, PlotNoise, Scenario
from fuzzytrack.testbed.sensor_field import SensorField, canonical_field, sensor_grid
from fuzzytrack.testbed.starting import prepare_start
from fuzzytrack.testbed.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
    turning_target,
    waypoints,
)

__all__ = [
    "Comparison",
    "FieldSensors",
    "Noise",
    "PlotNoise",
    "Plots",
    "Results",
    "Scenario",
    "SensorField",
    "TrackSet",
    "canonical_field",
    "compare",
    "compare_tracks",
    "constant_acceleration",
    "constant_velocity",
    "fuse",
    "fuse_pair",
    "kim_lee",
    "llinas_maneuver",
    "monte_carlo",
    "noisy_plots",
    "prepare_start",
    "s3",
    "sensor_grid",
    "track_set",
    "turn",
    "turn_with_angular_acceleration",
    "turning_target",
    "warship",
    "waypoints",
]
