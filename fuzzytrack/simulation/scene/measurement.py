"""What a radar receives of targets and of clutter."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.scene.clutter import View
from fuzzytrack.simulation.scene.echoes import Echoes
from fuzzytrack.simulation.scene.population import Population
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.shadows import hidden
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["clutter_echoes", "polar_from", "target_echoes"]

Bools = NDArray[np.bool_]
_TURN = 2 * math.pi
# The beam moves much faster than a target seen from the radar: each step takes away more than nine
# tenths of the error, for a target that needs ten scans around the radar or more.
_BEAM_STEPS = 6


def polar_from(own: Array, places: Array) -> tuple[Array, Array]:
    """Range (m) and bearing (rad, clockwise from y, from 0 to a turn) of places."""
    east, north = (places - own).T
    return np.hypot(east, north), np.mod(np.arctan2(east, north), _TURN)


def target_echoes(
    scene: Scene, population: Population, view: View, durations: Array, seed: int
) -> tuple[Echoes, Bools]:
    """Echoes of the targets that are detected, and which states are visible."""
    time, place = _when_seen(scene, population, view, durations)
    draw = _Draws(scene, population, seed)
    own = scene.own.places(view.start, time)
    distance, bearing = polar_from(own, place)
    shaded = _shaded(scene, population, distance, bearing)
    visible = _in_reach(scene, distance) & ~shaded
    probability = _probability(scene, population, time, distance)
    probability = np.where(shaded, probability * (1 - scene.radar.shadowing), probability)
    # A target that appeared after the beam had passed its place has no plot yet.
    there = time >= population.born[population.target]
    seen = there & (draw.uniform("detection") < probability)
    place = place + _wander(population, scene, draw)
    noise = _noise(scene, draw, own, place)
    states = np.flatnonzero(seen)
    echoes = Echoes(
        population.scan[states],
        time[states],
        place[states],
        noise[states],
        population.target[states] + 1,
        np.full(len(states), -1),
        states,
    )
    return echoes, visible


def clutter_echoes(scene: Scene, view: View, durations: Array, seed: int) -> list[Echoes]:
    """Echoes of each clutter of a scene, in its order."""
    found = []
    for number, (name, part) in enumerate(scene.clutter.items()):
        scan, place = part.plots(view, Streams(seed, "clutter", name))
        distance, bearing = polar_from(view.own[scan], place)
        low, high = scene.radar.reach
        kept = (low <= distance) & (distance <= high)
        scan, place, bearing = scan[kept], place[kept], bearing[kept]
        time = view.times[scan]
        if scene.scans.turning:
            time = time - durations[scan] * (1 - bearing / _TURN)
        none = np.zeros(len(scan), np.int64)
        found.append(
            Echoes(scan, time, place, np.zeros((len(scan), 2)), none, none + number, none - 1)
        )
    return found


class _Draws:
    """Random numbers for each state, from arrays with a row for each target of a group."""

    def __init__(self, scene: Scene, population: Population, seed: int) -> None:
        self._streams = [Streams(seed, "plots", name) for name in population.names]
        self._counts = np.bincount(population.group, minlength=len(population.names))
        self._scans = scene.scans.count
        self._at = (population.target, population.scan)

    def uniform(self, purpose: str) -> Array:
        """Uniform numbers in [0, 1), one for each state."""
        return self._table(purpose, lambda rng, shape: rng.random(shape))[self._at]

    def normal(self, purpose: str, needed: bool) -> Array | float:
        """Normal numbers of variance 1, one for each state; 0 if there is no need for any."""
        return self.table(purpose)[self._at] if needed else 0.0

    def table(self, purpose: str) -> Array:
        """Normal numbers for each target and scan."""
        return self._table(purpose, lambda rng, shape: rng.standard_normal(shape))

    def _table(
        self, purpose: str, draw: Callable[[np.random.Generator, tuple[int, int]], Array]
    ) -> Array:
        parts = [
            draw(streams.stream(purpose), (int(count), self._scans))
            for streams, count in zip(self._streams, self._counts, strict=True)
        ]
        return np.concatenate(parts)


def _noise(scene: Scene, draw: _Draws, own: Array, place: Array) -> Array:
    """By what each state is measured elsewhere (m), shape (n, 2)."""
    radar = scene.radar
    noise = np.zeros_like(place)
    if radar.sigma_range or radar.sigma_bearing:
        distance, bearing = polar_from(own, place)
        distance += radar.sigma_range * draw.normal("range", radar.sigma_range > 0)
        bearing += radar.sigma_bearing * draw.normal("bearing", radar.sigma_bearing > 0)
        noise = np.stack([distance * np.sin(bearing), distance * np.cos(bearing)], axis=1)
        noise += own - place
    for axis in (0, 1) if radar.sigma_position else ():
        noise[:, axis] += radar.sigma_position * draw.normal(f"axis {axis}", True)
    return noise


def _when_seen(
    scene: Scene, population: Population, view: View, durations: Array
) -> tuple[Array, Array]:
    """When the beam passes each state, and where it then is."""
    ends = view.times[population.scan]
    if not scene.scans.turning:
        return ends, population.position
    time, place = ends.copy(), population.position.copy()
    _, first = polar_from(view.own[population.scan], place)
    bearing, rows = first, np.arange(len(time))
    for _ in range(_BEAM_STEPS):
        # Not across north, where the beam is a whole scan away: the scan has its plot at its end.
        moved = np.mod(bearing - first[rows] + math.pi, _TURN) - math.pi
        share = np.clip((first[rows] + moved) / _TURN, 0.0, 1.0)
        before = time[rows]
        time[rows] = ends[rows] - durations[population.scan[rows]] * (1 - share)
        place[rows] = population.paths.at(population.target[rows], time[rows])[0]
        rows = rows[abs(time[rows] - before) > 1e-6]
        if not len(rows):
            break
        bearing = polar_from(scene.own.places(view.start, time[rows]), place[rows])[1]
    return time, place


def _per_target(scene: Scene, population: Population, name: str) -> Array:
    """A setting of the group of each state."""
    values = np.array([getattr(group, name) for group in scene.traffic.values()], np.float64)
    return np.asarray(values[population.group[population.target]])


def _in_reach(scene: Scene, distance: Array) -> Bools:
    low, high = scene.radar.reach
    return np.asarray((low <= distance) & (distance <= high))


def _probability(scene: Scene, population: Population, time: Array, distance: Array) -> Array:
    """Probability of detection of each state, without shadows."""
    found = scene.radar.probability(distance) * _per_target(scene, population, "detection")
    fade = _per_target(scene, population, "fade_in")
    if not fade.any():
        return found
    age = np.maximum(time - population.born[population.target], 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(age < fade, found * age / fade, found)


def _shaded(scene: Scene, population: Population, distance: Array, bearing: Array) -> Bools:
    """States in the shadow of another target."""
    found = np.zeros(len(distance), bool)
    size = _per_target(scene, population, "size")
    if scene.radar.shadowing == 0 or not size.any():
        return found
    ends = np.searchsorted(population.scan, np.arange(scene.scans.count + 1))
    for low, high in itertools.pairwise(ends):
        rows = slice(low, high)
        found[rows] = hidden(distance[rows], bearing[rows], size[rows], scene.radar.shadow_margin)
    return found


def _wander(population: Population, scene: Scene, draw: _Draws) -> Array | float:
    """Where along a target its echo comes from, as a displacement (m) of each state."""
    groups = scene.traffic.values()
    if not any(group.wander for group in groups):
        return 0.0
    normal = draw.table("wander")
    group = population.group
    deviation = np.array([each.wander for each in groups])[group]
    kept = np.exp(-scene.scans.period / np.array([each.wander_time for each in groups]))[group]
    # A stationary sequence with this correlation from one scan to the next.
    fresh = np.sqrt(1 - kept**2)
    for k in range(1, normal.shape[1]):
        normal[:, k] = kept * normal[:, k - 1] + fresh * normal[:, k]
    shift = (deviation[:, None] * normal)[population.target, population.scan]
    speed = np.hypot(*population.velocity.T)
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = np.where(
            speed[:, None] > 0, population.velocity / speed[:, None], np.array([1.0, 0.0])
        )
    return shift[:, None] * ahead
