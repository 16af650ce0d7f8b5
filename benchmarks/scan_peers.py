"""Other track-while-scan trackers, each optional, on the same scans.

A peer is given the noise of the plots in range and bearing, as a covariance of each plot, and what
`Setting` says; it returns its tracks after every scan, and how long each scan took. Its objects for
the plots are made beforehand and are not timed.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers import Array, need
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scanners.catalog import as_scanner
from fuzzytrack.scan.scanners.loading import shipped_scanners
from fuzzytrack.scan.update.base import updates
from fuzzytrack.trackers.catalog import as_lane_tracker

__all__ = [
    "CONFIGURATIONS", "Followed", "Peer", "Setting", "Steps", "followed", "norfair",
    "plot_covariances", "shipped", "stonesoup",
]  # fmt: skip

#: Configurations of scan trackers that come with the package.
CONFIGURATIONS = shipped_scanners()


_BEGIN = datetime(2000, 1, 1)


@dataclass(frozen=True)
class Setting:
    """What a peer is told about the radar and its targets.

    Attributes
    ----------
    period : float
        Of a scan (s).
    range_noise, bearing_noise, extra_noise : float
        Standard deviations of a plot: m, rad, m.
    acceleration : float
        Of a target, in each axis, drawn anew each scan (m/s²).
    speed : float
        Standard deviation of the velocity of a new track in each axis (m/s).
    detection : float
        Probability that a target is seen in a scan.
    clutter : float
        Clutter plots a square meter and scan.
    gate : float
        Largest distance of a plot from its prediction, in standard deviations.
    hits : int
        Plots that confirm a track.
    tentative_misses, misses : int
        Scans in a row without a plot that end a track before it is confirmed, and after.
    """

    period: float
    range_noise: float = 1.0
    bearing_noise: float = 0.006
    extra_noise: float = 0.7
    acceleration: float = 0.12
    speed: float = 2.0
    detection: float = 0.9
    clutter: float = 1e-5
    gate: float = 4.0
    hits: int = 4
    tentative_misses: int = 2
    misses: int = 5


class Followed(NamedTuple):
    """Tracks as they were after each scan, one row a track and scan, and seconds a scan."""

    time: Array
    track_id: NDArray[np.int64]
    position: Array
    seconds: Array


Shown = tuple[NDArray[np.int64], Array]


class Steps(NamedTuple):
    """A tracker at work: what it gives scan by scan, and the tracks in that.

    Attributes
    ----------
    each : iterator
        Of what the tracker gives, one scan after another as it is asked.
    shown : callable
        From that to identities, shape (n,), and positions, shape (n, 2).
    """

    each: Iterator[Any]
    shown: Callable[[Any], Shown]


Peer = Callable[[Sequence[Scan], Setting], Steps]


def followed(
    peer: Peer,
    scans: Sequence[Scan],
    setting: Setting,
    clock: Callable[[], float] = time.perf_counter,
) -> Followed:
    """Let a tracker follow scans; its seconds are those of the clock."""
    steps = peer(scans, setting)
    seconds, found = np.empty(len(scans)), [(np.empty(0, np.int64), np.empty((0, 2)))]
    for k in range(len(scans)):
        begin = clock()
        step = next(steps.each)
        seconds[k] = clock() - begin
        found.append(steps.shown(step))
    identities, positions = (np.concatenate(each) for each in zip(*found, strict=True))
    counts = [len(each) for each, _ in found[1:]]
    times = np.repeat([scan.time for scan in scans], counts)
    return Followed(times, identities, positions, seconds)


def _shown(tracks: Mapping[int, Array]) -> Shown:
    return np.array(list(tracks), np.int64), np.array(list(tracks.values())).reshape(-1, 2)


def plot_covariances(scan: Scan, setting: Setting) -> Array:
    """Covariance of each plot (m²), shape (n, 2, 2): its own, or by range and bearing.

    Without noise in bearing it is round, with the deviations in range and in extra.
    """
    if scan.covariances is not None:
        xx, xy, yy = np.asarray(scan.covariances).T
        return np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -1)
    if not setting.bearing_noise:
        variance = setting.range_noise**2 + setting.extra_noise**2
        return np.broadcast_to(variance * np.eye(2), (len(scan), 2, 2))
    offset = scan.positions - np.asarray(scan.own)
    distance = np.maximum(np.hypot(*offset.T), 1e-9)
    along = offset / distance[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], -1)
    variances = setting.range_noise**2, (setting.bearing_noise * distance) ** 2
    found = setting.extra_noise**2 * np.eye(2) + sum(
        np.asarray(variance)[..., None, None] * direction[:, :, None] * direction[:, None, :]
        for variance, direction in zip(variances, (along, across), strict=True)
    )
    return np.asarray(found)


# -------------------------------------------------------------------- fuzzytrack


def shipped(name: str, tracker: str | None = None) -> Peer:
    """A shipped configuration, which has its own numbers; maybe with another tracker in it."""
    scanner = as_scanner(name)
    if tracker:
        scanner = replace(scanner, update=updates.get("tracker")(tracker))

    def follow(scans: Sequence[Scan], setting: Setting) -> Steps:
        session = scanner.start()
        return Steps(map(session.step, scans), lambda step: (step.track_id, step.position))

    return follow


# -------------------------------------------------------------------- Stone Soup


def stonesoup(association: str, tracker: str | None = None) -> Peer:
    """Stone Soup with the parts of its own examples: "GNN", "JPDA" or "JPDA by propagation".

    A Kalman filter for a target of nearly constant velocity; global nearest neighbor by Mahalanobis
    distance with two-dimensional assignment, or joint probabilistic data association, exact or by
    loopy belief propagation, for which the number of tracks does not matter; tracks from several
    plots, held by an initiator of their own. Without noise in bearing all plots have the same
    noise, and are searched in a KD-tree.

    With the text of a `tracker`, predictor, updater and first states are those of this package's
    plug-in, with the same standard deviations.
    """

    def follow(scans: Sequence[Scan], setting: Setting) -> Steps:
        places = 6 if tracker is not None and as_lane_tracker(tracker).uses_acceleration else 4
        detections = _detections(scans, setting, places)
        found = _tracker(association, detections, setting, tracker)
        numbers: dict[str, int] = {}

        def shown(step: Any) -> Shown:
            tracks = ((track.id, track.state.mean[[0, 2], 0]) for track in step[1])
            return _shown({
                numbers.setdefault(name, len(numbers) + 1): np.array(place, float)
                for name, place in tracks
            })  # fmt: skip

        return Steps(iter(found), shown)

    return follow


def _detections(
    scans: Sequence[Scan], setting: Setting, places: int
) -> list[tuple[datetime, set[Any]]]:
    """Times and detections, for states of so many places that begin with x, vx, y, vy."""
    detection = need("stonesoup.types.detection", "stonesoup").Detection
    linear = need("stonesoup.models.measurement.linear", "stonesoup").LinearGaussian
    # Plots of equal noise share a model, for which the KD-tree asks.
    model = functools.cache(
        lambda noise: linear(places, (0, 2), np.frombuffer(noise).reshape(2, 2))
    )
    found = []
    for scan in scans:
        when = _BEGIN + timedelta(seconds=float(scan.time))
        plots = {
            detection(
                position[:, None],
                timestamp=when,
                measurement_model=model(np.ascontiguousarray(covariance).tobytes()),
            )
            for position, covariance in zip(
                scan.positions, plot_covariances(scan, setting), strict=True
            )
        }
        found.append((when, plots))
    return found


def _tracker(
    association: str,
    detections: list[tuple[datetime, set[Any]]],
    setting: Setting,
    text: str | None,
) -> Any:
    parts = _kalman(detections, setting) if text is None else _plugged_in(text, setting)
    predictor, updater, first = parts
    nearest = _nearest(predictor, updater, setting)
    deleter = need("stonesoup.deleter.time", "stonesoup").UpdateTimeStepsDeleter
    initiator = need("stonesoup.initiator.simple", "stonesoup").MultiMeasurementInitiator(
        prior_state=None, deleter=deleter(setting.tentative_misses), data_associator=nearest,
        updater=updater, min_points=setting.hits, initiator=first,
    )  # fmt: skip
    trackers = need("stonesoup.tracker.simple", "stonesoup")
    kind, associator = trackers.MultiTargetTracker, nearest
    if association != "GNN":
        kind = trackers.MultiTargetMixtureTracker
        associator = _joint(association, predictor, updater, setting)
    return kind(
        initiator=initiator, deleter=deleter(setting.misses), detector=detections,
        data_associator=associator, updater=updater,
    )  # fmt: skip


def _kalman(detections: list[tuple[datetime, set[Any]]], setting: Setting) -> tuple[Any, Any, Any]:
    """Predictor, updater and initiator of Stone Soup."""
    models = need("stonesoup.models.transition.linear", "stonesoup")
    white = setting.acceleration**2 * setting.period
    each = models.ConstantVelocity(white)
    model = models.CombinedLinearGaussianTransitionModel([each, each])
    gaps = np.diff([(when - _BEGIN).total_seconds() for when, _ in detections])
    if np.allclose(gaps, setting.period, rtol=1e-6):
        # Matrices of equal scans are made once, which halves its time.
        step = timedelta(seconds=setting.period)
        model = models.LinearGaussianTimeInvariantTransitionModel(
            transition_matrix=model.matrix(time_interval=step),
            covariance_matrix=model.covar(time_interval=step),
        )
    predictor = need("stonesoup.predictor.kalman", "stonesoup").KalmanPredictor(model)
    updater = need("stonesoup.updater.kalman", "stonesoup").KalmanUpdater(None)
    start = need("stonesoup.types.state", "stonesoup").GaussianState(
        [[0.0]] * 4, np.diag([0.0, setting.speed**2] * 2)
    )
    first = need("stonesoup.initiator.simple", "stonesoup").SimpleMeasurementInitiator(start, None)
    return predictor, updater, first


def _plugged_in(text: str, setting: Setting) -> tuple[Any, Any, Any]:
    """Predictor, updater and initiator of this package's plug-in."""
    plugin = need("fuzzytrack.interop.stonesoup", "stonesoup")
    common = {"tracker": text, "position_mapping": (0, 2), "velocity_mapping": (1, 3)}
    motion: dict[str, float] = {}
    if as_lane_tracker(text).uses_acceleration:
        common["acceleration_mapping"] = (4, 5)
        motion["acceleration_deviation"] = setting.acceleration
    return (
        plugin.GainScheduledPredictor(**common, acceleration_noise=setting.acceleration),
        plugin.GainScheduledUpdater(**common),
        plugin.GainScheduledInitiator(**common, **motion, velocity_deviation=setting.speed),
    )


def _nearest(predictor: Any, updater: Any, setting: Setting) -> Any:
    hypothesiser = need("stonesoup.hypothesiser.distance", "stonesoup").DistanceHypothesiser(
        predictor, updater, need("stonesoup.measures", "stonesoup").Mahalanobis(),
        missed_distance=setting.gate,
    )  # fmt: skip
    if setting.bearing_noise > 0:
        neighbors = need("stonesoup.dataassociator.neighbour", "stonesoup")
        return neighbors.GNNWith2DAssignment(hypothesiser)
    tree = need("stonesoup.dataassociator.tree", "stonesoup").DetectionKDTreeGNN2D
    return tree(hypothesiser, predictor, updater, number_of_neighbours=5,
                max_distance_covariance_multiplier=setting.gate)  # fmt: skip


def _joint(association: str, predictor: Any, updater: Any, setting: Setting) -> Any:
    from scipy.stats import chi2

    hypothesiser = need("stonesoup.hypothesiser.probability", "stonesoup").PDAHypothesiser(
        predictor, updater, clutter_spatial_density=setting.clutter,
        prob_detect=setting.detection, prob_gate=float(chi2.cdf(setting.gate**2, 2)),
    )  # fmt: skip
    joint = need("stonesoup.dataassociator.probability", "stonesoup")
    return {"JPDA": joint.JPDA, "JPDA by propagation": joint.JPDAwithLBP}[association](hypothesiser)


# -------------------------------------------------------------------- norfair


def norfair(scans: Sequence[Scan], setting: Setting) -> Steps:
    """Norfair, made for pictures: fixed noise, greedy pairs by distance, scans of equal period.

    It is given its units as they are, one step a scan; its gate is the distance in meters that
    `Setting.gate` deviations of plot and of a step at the speed of a new track make.
    """
    package = need("norfair", "norfair")
    filters = need("norfair.filter", "norfair").OptimizedKalmanFilterFactory
    detections = [
        [package.Detection(points=position[None]) for position in scan.positions] for scan in scans
    ]
    variance = setting.range_noise**2 + setting.extra_noise**2
    step = (setting.speed * setting.period) ** 2
    tracker = package.Tracker(
        distance_function="euclidean",
        distance_threshold=setting.gate * float(np.sqrt(variance + step)),
        hit_counter_max=setting.misses,
        initialization_delay=setting.hits - 1,
        filter_factory=filters(
            R=variance, Q=(setting.acceleration * setting.period**2) ** 2, pos_variance=variance,
            vel_variance=step,
        ),
    )  # fmt: skip

    def shown(step: Any) -> Shown:
        return _shown({each.id: np.array(each.estimate[0], float) for each in step})

    return Steps((tracker.update(detections=plots) for plots in detections), shown)
