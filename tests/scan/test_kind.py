"""What is reported of targets that rest, sail slowly, or leave."""

import dataclasses

import numpy as np
import pytest

from fuzzytrack.scan import KINDS, Scan, ScanTracker
from fuzzytrack.scan.kind import HypothesisBank

PERIOD, SCANS = 1.678, 90
MOVING, STATIC = KINDS.index("moving"), KINDS.index("static")


def scans_of(path, seed, clutter=2.0):
    """Scans of one target on a path, shape (n, 2), seen nine times of ten among clutter."""
    rng = np.random.default_rng(seed)
    found = []
    for k, place in enumerate(path):
        seen = [place + rng.normal(0, 0.8, 2)] if rng.random() < 0.9 else []
        plots = np.array([*seen, *rng.uniform(-300, 300, (rng.poisson(clutter), 2))])
        found.append(Scan(PERIOD * k, plots.reshape(-1, 2), own=(100.0, -80.0)))
    return found


def at_speed(speed, rest=0):
    """Path of a boat that rests for some scans and then sails with a speed (m/s)."""
    way = speed * PERIOD * np.maximum(np.arange(SCANS) - rest, 0)
    return np.array([40.0, 30.0]) + way[:, None] * np.array([0.6, 0.8])


def kinds_of(path, seed, after, until=SCANS):
    """Kinds of the tracks within 15 m of a target, in scans from `after` to `until`."""
    reports = ScanTracker().run(scans_of(path, seed)).reports
    near = np.linalg.norm(reports.position - path[reports.scan], axis=1) < 15.0
    return reports.kind[near & (reports.scan >= after) & (reports.scan < until)]


@pytest.mark.parametrize("seed", range(5))
def test_a_moored_boat_is_static(seed):
    kinds = kinds_of(at_speed(0.0), seed, after=25)
    assert len(kinds) > 40
    assert np.mean(kinds == STATIC) > 0.98


@pytest.mark.parametrize("seed", range(5))
def test_a_slow_boat_is_moving(seed):
    kinds = kinds_of(at_speed(0.4), seed, after=0)
    assert len(kinds) > 40
    assert np.mean(kinds == MOVING) > 0.98


@pytest.mark.parametrize("seed", range(5))
def test_a_boat_that_leaves_is_moving_after_some_scans(seed):
    path = at_speed(2.0, rest=40)
    assert np.mean(kinds_of(path, seed, after=25, until=40) == STATIC) > 0.9
    assert (kinds_of(path, seed, after=46) == MOVING).all()


@pytest.mark.parametrize("seed", range(3))
def test_nothing_but_the_kind_that_is_reported_depends_on_rest(seed):
    scans = scans_of(at_speed(0.5, rest=45), seed, clutter=5.0)
    found, plain = (
        ScanTracker(kind=HypothesisBank(rest=rest)).run(scans, tentative=True).reports
        for rest in (3.0, 0.0)
    )
    for each in dataclasses.fields(found):
        if each.name != "kind":
            assert np.array_equal(getattr(found, each.name), getattr(plain, each.name))
    changed = found.kind != plain.kind
    assert changed.any()
    assert (found.kind[changed] == STATIC).all()
    assert (plain.kind[changed] == MOVING).all()
