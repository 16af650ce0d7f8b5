"""Simulated targets, sensors and plots, and scenarios made of them."""

from fuzzytrack.simulation.fusion import fuse, fuse_pair
from fuzzytrack.simulation.noise import Noise, Plots, noisy_plots
from fuzzytrack.simulation.published import (
    TrackSet,
    kim_lee,
    llinas_maneuver,
    s3,
    track_set,
    warship,
)
from fuzzytrack.simulation.samples import SAMPLES, Sample, make_sample
from fuzzytrack.simulation.scenario import FieldSensors, PlotNoise, Scenario
from fuzzytrack.simulation.sensor_field import SensorField, canonical_field, sensor_grid
from fuzzytrack.simulation.starting import prepare_start
from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
    turning_target,
    waypoints,
)

__all__ = [
    "SAMPLES",
    "FieldSensors",
    "Noise",
    "PlotNoise",
    "Plots",
    "Sample",
    "Scenario",
    "SensorField",
    "TrackSet",
    "canonical_field",
    "constant_acceleration",
    "constant_velocity",
    "fuse",
    "fuse_pair",
    "kim_lee",
    "llinas_maneuver",
    "make_sample",
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
