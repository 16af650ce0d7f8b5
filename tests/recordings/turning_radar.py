"""Plots of targets and clutter as a turning antenna sees them, one by one."""

import numpy as np


def turning_radar(
    seed, *, targets=20, turns=40, period=2.5, detection=0.9, clutter=20, clockwise=True, noise=1.0,
    drift=0.0,
):  # fmt: skip
    """Columns t, x, y in order of time; for each the target, or -1; where targets are over time.

    `drift` is the change of the period from turn to turn, in parts.
    """
    rng = np.random.default_rng(seed)
    distance, bearing = rng.uniform(200, 3000, targets), rng.uniform(0, 2 * np.pi, targets)
    start = np.stack([distance * np.sin(bearing), distance * np.cos(bearing)], axis=1)
    velocity = rng.normal(0, 3, (targets, 2))
    length = period * (1 + drift) ** np.arange(turns)
    begin = np.append(0, np.cumsum(length))
    rows = []
    for turn in range(turns):
        share = np.zeros(targets)
        # When the beam meets each target.
        for _ in range(8):
            time = begin[turn] + share * length[turn]
            place = start + velocity * time[:, None]
            share = np.arctan2(place[:, 0], place[:, 1]) / (2 * np.pi) % 1
            share = share if clockwise else (1 - share) % 1
        seen = np.flatnonzero(rng.uniform(size=targets) < detection)
        measured = place + rng.normal(0, noise, place.shape)
        rows += [(time[k], *measured[k], k) for k in seen.tolist()]
        for angle, radius in zip(
            rng.uniform(size=rng.poisson(clutter)), 3000 * np.sqrt(rng.uniform(size=999)),
            strict=False,
        ):  # fmt: skip
            around = 2 * np.pi * (angle if clockwise else 1 - angle)
            when = begin[turn] + angle * length[turn]
            rows.append((when, radius * np.sin(around), radius * np.cos(around), -1))
    rows.sort()
    t, x, y, who = np.array(rows).T
    return {"t": t, "x": x, "y": y}, who.astype(int), lambda time: start + velocity * time
