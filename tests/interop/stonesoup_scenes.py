"""Plots, detections and components of Stone Soup that several tests use."""

from datetime import datetime, timedelta

import numpy as np
from stonesoup.dataassociator.neighbour import NearestNeighbour
from stonesoup.deleter.time import UpdateTimeStepsDeleter
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.measures import Mahalanobis
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.tracker.simple import SingleTargetTracker
from stonesoup.types.detection import Detection

from fuzzytrack.interop.stonesoup import (
    GainScheduledInitiator,
    GainScheduledPredictor,
    GainScheduledUpdater,
)
from fuzzytrack.trackers.catalog import make_tracker

EPOCH = datetime(2030, 1, 1)
SIGMA = 2.0


def at(seconds):
    return EPOCH + timedelta(seconds=float(seconds))


def mappings(n_axes, accelerating):
    """Mappings of a state vector that is one axis after the other."""
    order = 3 if accelerating else 2
    places = [tuple(range(k, order * n_axes, order)) for k in range(order)]
    return dict(
        zip(("position_mapping", "velocity_mapping", "acceleration_mapping"), places, strict=False)
    )


def components(spec, n_axes=2, noise=1.0, **mapped):
    """Predictor, updater and initiator of a tracker."""
    tracker = make_tracker(spec)
    places = mapped or mappings(n_axes, tracker.uses_acceleration)
    common = {"tracker": spec, **places}
    first = {"acceleration_deviation": noise} if "acceleration_mapping" in places else {}
    return (
        GainScheduledPredictor(**common, acceleration_noise=noise),
        GainScheduledUpdater(**common),
        GainScheduledInitiator(**common, velocity_deviation=30.0, **first),
    )


def linear(mapping, ndim, sigma=SIGMA):
    return LinearGaussian(ndim, mapping, np.eye(len(mapping)) * sigma**2)


def plots(seed, n_axes=2, steps=60, missed=0.2, sigma=SIGMA):
    """Irregular times in milliseconds, a maneuvering target, plots of which some are missed."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.5, 2.0, steps))
    t = np.round(t - t[0], 3)
    turn = 10.0 * np.sin(0.05 * t[:, None] * np.arange(1, n_axes + 1))
    truth = 1000.0 + 12.0 * t[:, None] + 20.0 * turn
    z = truth + rng.normal(0.0, sigma, truth.shape)
    z[1:][rng.random(steps - 1) < missed] = np.nan
    return t, z


def detected(t, z, model):
    """What a detector gives."""
    for when, plot in zip(t, z, strict=True):
        found = set()
        if not np.isnan(plot).any():
            found.add(Detection(plot, timestamp=at(when), measurement_model=model))
        yield at(when), found


def followed(parts, detector, gate=np.inf):
    """The track of Stone Soup's tracker of one target."""
    predictor, updater, initiator = parts
    # A distance of infinity is no hypothesis.
    gate = min(gate, 1e12)
    hypothesiser = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=gate)
    tracker = SingleTargetTracker(
        initiator, UpdateTimeStepsDeleter(100), detector, NearestNeighbour(hypothesiser), updater
    )
    _, (track,) = list(tracker)[-1]
    return track


def states(track):
    """State vectors of a track, a row each."""
    return np.array([np.asarray(state.state_vector, float).ravel() for state in track])
