"""Small random scenes: ships that come and go, misses, clutter, irregular times, a moving radar."""

from __future__ import annotations

import numpy as np

from fuzzytrack.scan import Scan

PERIOD = 1.678


def scene(seed, *, scans=30, ships=5, clutter=3.0, side=400.0, own_times=False, covariances=False):
    """Scans of a scene; some have no plot."""
    rng = np.random.default_rng(seed)
    own, drift = rng.uniform(-side, side, 2), rng.uniform(-2, 2, 2)
    begin, end = rng.integers(0, scans // 2, ships), rng.integers(scans // 2, scans + 10, ships)
    place = rng.uniform(0, side, (ships, 2))
    velocity = rng.normal(0, 3, (ships, 2))
    # Two ships side by side, one at rest, and something that jumps about a place, as a shore does.
    place[1], velocity[1] = place[0] + rng.uniform(10, 25, 2), velocity[0]
    velocity[2:3] = 0.0
    shore = rng.uniform(0, side, 2)
    found, time = [], 10.0
    for k in range(scans):
        time += PERIOD * (rng.uniform(0.2, 1.8) if rng.random() < 0.4 else 1.0)
        if rng.random() < 0.05:
            time += PERIOD * rng.integers(1, 6)
        seen = (begin <= k) & (k < end) & (rng.random(ships) < 0.85)
        plots = [place[i] + velocity[i] * (time - 10.0) for i in np.flatnonzero(seen)]
        plots = [plot + rng.normal(0, 1, 2) for plot in plots]
        plots += [shore + rng.normal(0, 10, 2) for _ in range(rng.random() < 0.8)]
        plots += list(rng.uniform(0, side, (rng.poisson(clutter), 2)))
        positions = np.array(plots if rng.random() < 0.97 else []).reshape(-1, 2)
        positions = positions[rng.permutation(len(positions))]
        count = len(positions)
        given = np.c_[rng.uniform(0.5, 4, count), rng.uniform(-0.3, 0.3, count)]
        found.append(
            Scan(
                time,
                positions,
                np.c_[given, rng.uniform(0.5, 4, count)] if covariances else None,
                time - rng.uniform(0, 0.19 * PERIOD, count) if own_times else None,
                own=tuple(own + drift * time),
                rows=np.arange(count) + 100 * k,
            )
        )
    return found
