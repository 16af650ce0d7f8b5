"""Scenes of a few objects for tests: by hand, at random, and as strategies of Hypothesis."""

import numpy as np
from hypothesis import strategies as st

from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.positions import KINDS, Positions
from fuzzytrack.scoring.scored_scene import ObjectRows, ScoredScene


def rows(entries, kind=None, axes=2):
    """Objects at instants, from (instant, id, x, y) in any order; velocity 0."""
    entries = sorted(entries, key=lambda each: each[:2])
    instant = np.array([each[0] for each in entries], dtype=np.int64)
    id = np.array([each[1] for each in entries], dtype=np.int64)
    position = np.array([each[2:] for each in entries], dtype=float).reshape(-1, axes)
    names = np.arange(id.max() + 1) if len(id) else np.arange(0)
    kinds = None if kind is None else np.array([KINDS.index(kind[i]) for i in id], dtype=np.int64)
    return ObjectRows(instant, id, position, np.zeros_like(position), names, kinds)


def scene(truth, tracks, instants=None, kind=None, step=1.0):
    """A scene of (instant, id, x, y), with instants a second apart."""
    last = max([each[0] for each in (*truth, *tracks)], default=-1) + 1
    count = last if instants is None else instants
    return ScoredScene(step * np.arange(count, dtype=float), rows(truth), rows(tracks, kind))


def one_instant(truth, tracks):
    """A scene of one instant from positions."""
    return scene(
        [(0, k, *p) for k, p in enumerate(np.reshape(truth, (-1, 2)).tolist())],
        [(0, k, *p) for k, p in enumerate(np.reshape(tracks, (-1, 2)).tolist())],
        instants=1,
    )


def pairs(of, reach=1e9):
    """All close pairs of a scene."""
    return ClosePairs.of(of, reach)


def swapped(of):
    """A scene in which truth and tracks have changed places."""
    return ScoredScene(of.time, of.tracks, of.truth)


def random_scene(seed, objects=5, tracks=7, instants=20, noise=3.0, spread=30.0):
    """Objects that wander, and tracks of them that change, come back, break and are of nothing."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, spread, (objects, 2))
    speed = rng.normal(0, 1.5, (objects, 2))
    truth, found = [], []
    follows = rng.integers(-1, objects, tracks)
    for k in range(instants):
        there = [i for i in range(objects) if rng.random() < 0.93]
        place = start + speed * k
        truth += [(k, i, *place[i]) for i in there]
        for j in range(tracks):
            if rng.random() < 0.15:
                follows[j] = rng.integers(-1, objects)
            if rng.random() < 0.85:
                at = rng.uniform(0, spread, 2) if follows[j] < 0 else place[follows[j]]
                found.append((k, j, *(at + rng.normal(0, noise, 2))))
    return scene(truth, found, instants)


coordinates = st.integers(-40, 40).map(float)
points = st.lists(st.tuples(coordinates, coordinates), max_size=4)


def positions(entries, **more):
    """Positions of (time, id, x, y)."""
    table = np.array([[each[0], *each[2:]] for each in entries], dtype=float).reshape(-1, 3)
    id = np.array([each[1] for each in entries])
    return Positions.make("tracks", table[:, 0], id, table[:, 1:], **more)
