"""One run of a tracker, plot by plot: what it saw, what its rules said, what it made of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.studio.rule_inputs import rule_inputs, scheduler_of
from fuzzytrack.trackers.base import Tracker

__all__ = ["MOST_STEPS", "walk"]

#: Scans of a run that can be walked, which takes long and makes a long answer.
MOST_STEPS = 5_000
# Rules of a plot, the strongest.
_RULES = 4


def walk(
    tracker: Tracker, times: Array, z: Array, sigma: Array, truth: Array | None
) -> Mapping[str, Any]:
    """Walk one track.

    Parameters
    ----------
    tracker : Tracker
    times : ndarray, shape (n_steps,)
        s.
    z, sigma : ndarray, shape (n_steps, n_axes)
        Plots and their standard deviations (m); NaN where missed.
    truth : ndarray, shape (n_steps, n_axes), or None
        m.

    Returns
    -------
    dict
        Arrays of scans by axes (``t`` and ``seen`` of scans): ``t``, ``seen``, ``coasted``,
        ``truth``, ``plots``, ``predicted``, ``estimates``, ``innovations``, ``gains`` (``alpha``,
        ``beta``, ``gamma``); and ``inputs``: for each scan a list of lanes, one for each axis or a
        single one where all axes share their gains, each None or with ``values`` by name and the
        strongest ``rules`` (``index`` from 0, ``text``, ``strength``).
    """
    result = tracker.run(times, z, sigma)
    gains = result.gains
    return {
        "t": times,
        "seen": ~np.isnan(z).any(axis=1),
        "coasted": result.coasted.any(axis=1),
        "truth": truth,
        "plots": z,
        "predicted": result.predicted,
        "estimates": result.filtered,
        "innovations": result.innovation,
        "gains": {"alpha": gains.alpha, "beta": gains.beta, "gamma": gains.gamma},
        "inputs": _inputs(tracker, times, z, sigma, result.innovation),
    }


def _inputs(
    tracker: Tracker, times: Array, z: Array, sigma: Array, innovation: Array
) -> list[list[dict[str, Any] | None]]:
    scheduler = scheduler_of(tracker)
    found = rule_inputs(tracker, times, z, sigma)
    if scheduler is None or found is None:
        return [[] for _ in times]
    known = ~np.isnan(found).any(axis=-1) & np.any(~np.isnan(innovation), axis=1)[:, None]
    lanes: list[list[dict[str, Any] | None]] = [[None] * found.shape[1] for _ in times]
    # All at once: one by one they would take longer than a page waits.
    points = found[known]
    strengths = scheduler.system.strengths(points)
    for (scan, lane), point, strength in zip(
        np.argwhere(known).tolist(), points, strengths, strict=True
    ):
        lanes[scan][lane] = _lane(scheduler.rules, point, strength)
    return lanes


def _lane(rules: RuleBase, point: Array, strength: Array) -> dict[str, Any]:
    """Inputs of one lane at one scan, and the rules that fire there, the strongest first."""
    order = np.argsort(-strength, kind="stable")[:_RULES].tolist()
    return {
        "values": dict(zip(rules.input_names, point.tolist(), strict=True)),
        "rules": [
            {"index": k, "text": str(rules.rules[k]), "strength": float(strength[k])}
            for k in order
            if strength[k] > 0
        ],
    }
