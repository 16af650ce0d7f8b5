"""A small harbor for pictures: scans of plots, true paths, and reports made by hand."""

from dataclasses import dataclass

import numpy as np

from fuzzytrack.scan import KINDS, STATUSES, Scan, TrackReports

PERIOD = 2.0


@dataclass(frozen=True, eq=False)
class Harbor:
    """What a scan tracker got, what it should have found, and what it is said to have reported."""

    scans: list
    truth: tuple
    reports: TrackReports


def paths(count, steps, seed=1):
    """Boats on gentle curves, shape (steps, count, 2)."""
    random = np.random.default_rng(seed)
    start = random.uniform(-400, 400, (count, 2))
    course = random.uniform(0, 2 * np.pi, count) + np.cumsum(
        random.normal(0, 0.02, count) * np.ones((steps, 1)), axis=0
    )
    speed = random.uniform(2, 6, count)[:, None]
    step = PERIOD * speed * np.stack([np.sin(course), np.cos(course)], axis=-1)
    return start + np.cumsum(step, axis=0)


def harbor(boats=4, buoys=3, steps=60, seed=1, clutter=6):
    """Boats that are tracked from their fourth scan on, missed for some scans, and lost once.

    Track ``k + 1`` follows boat ``k``; boat 0 changes to track 100 in the middle. Buoys are the
    tracks from 50 on. Boat 1 coasts over the scans 20 to 24.
    """
    random = np.random.default_rng(seed)
    boat = paths(boats, steps, seed)
    buoy = random.uniform(-450, 450, (buoys, 2))
    own = np.stack([np.linspace(-60, 60, steps), np.full(steps, -20.0)], axis=1)
    scans, rows = [], []
    for k in range(steps):
        time = PERIOD * k
        seen = np.concatenate([boat[k], buoy]) + random.normal(0, 3, (boats + buoys, 2))
        clouds = random.uniform(-500, 500, (random.poisson(clutter), 2))
        scans.append(Scan(time, np.concatenate([seen, clouds]), own=tuple(own[k])))
        for number in range(boats + buoys):
            if k < 3:
                continue
            static = number >= boats
            track = 50 + number - boats if static else number + 1
            if number == 0 and boats and k >= steps // 2:
                track = 100
            coasts = number == 1 and 20 <= k < 25
            status = "coasting" if coasts else "tentative" if k < 6 else "confirmed"
            kind = "undecided" if k < 5 else "static" if static else "moving"
            velocity = np.zeros(2) if static else (boat[k, number] - boat[k - 1, number]) / PERIOD
            place = buoy[number - boats] if static else boat[k, number]
            since = PERIOD * (k - 19) if coasts else 0.0
            words = STATUSES.index(status), KINDS.index(kind)
            held = place + random.normal(0, 2, 2)
            plot = -1 if coasts else number
            noise = [2.0, 2.0, 0.4, 0.4]
            rows.append((k, time, track, held, velocity, noise, *words, 0.97, since, plot))
    truth = (
        np.repeat(PERIOD * np.arange(steps), boats),
        np.tile([f"boat {k}" for k in range(boats)], steps),
        boat.reshape(-1, 2),
    )
    return Harbor(scans, truth, reports_of(rows))


def reports_of(rows):
    """Reports of rows of values in the order of the attributes."""
    if not rows:
        return TrackReports.none()
    columns = list(zip(*rows, strict=True))
    kinds = (np.int64, float, np.int64, float, float, float, np.uint8, np.uint8, float, float)
    return TrackReports(
        *(np.array(c, dtype=k) for c, k in zip(columns, (*kinds, np.int64), strict=True))
    )
