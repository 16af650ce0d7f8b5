"""Parts of Zhang & Jiang's tracker, by what they do to a session."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.gains.design import quality
from fuzzytrack.papers.zhang_jiang.experiment import published, safe
from fuzzytrack.papers.zhang_jiang.theory import gate_factor
from fuzzytrack.scan import Scan
from fuzzytrack.scan.association import GreedyAssociation, NearestAssociation
from fuzzytrack.scan.candidates import AllPairs, SectorCandidates
from fuzzytrack.scan.gate.box import gate_factor as factor_of_the_gate
from fuzzytrack.scan.setting import Setting


def run(tracker, positions):
    session, live = tracker.start(), None
    for k, plot in enumerate(positions):
        plots = np.empty((0, 2)) if plot is None else np.array([plot], float)
        session.step(Scan(3.0 * k, plots))
        live = session.tracks()
    return live


def test_the_gains_are_those_of_the_paper_from_the_third_plot_on():
    along = [4000.0, 4030.0, 4055.0, 4090.0, 4118.0, 4150.0]
    live = run(safe(), [(x, 0.0) for x in along])
    x, v = along[1], (along[1] - along[0]) / 3.0
    for n, z in enumerate(along[2:], 1):
        alpha, beta = quality(n)
        ahead = x + 3.0 * v
        x, v = ahead + alpha * (z - ahead), v + beta / 3.0 * (z - ahead)
    np.testing.assert_allclose(live.position[0], [x, 0.0], atol=1e-9)
    np.testing.assert_allclose(live.velocity[0], [v, 0.0], atol=1e-9)


def test_the_gate_has_the_factor_of_the_paper():
    for n in (2.0, 3.5, 30.0):
        assert factor_of_the_gate(n) == pytest.approx(float(gate_factor(n)), rel=1e-12)


@pytest.mark.parametrize(
    ("tracker", "half"),
    [
        # After four plots N is 3; F(3) = 1.5275 on σ + L/2, or 4σ with F(4) and half a plot.
        (published(), math.sqrt(7 / 3) * (15 + 50)),
        (safe(), 4 * 15 * math.sqrt(1 + 1.5) + 50),
    ],
)
def test_a_plot_is_taken_up_to_the_end_of_the_gate(tracker, half):
    plots = [(4000.0 + 30.0 * k, 0.0) for k in range(4)]
    for away, taken in ((half - 0.01, True), (half + 0.01, False), (-half + 0.01, True)):
        live = run(tracker, [*plots, (4120.0 + away, 0.0)])
        assert (live.since_last[0] == 0.0) == taken


def test_a_miss_lowers_the_quality_by_three_and_the_first_plots_are_forgotten():
    plots = [(4000.0 + 30.0 * k, 0.0) for k in range(9)]
    widened = run(published(), [*plots, None, (4300.0 + 0.9 * (15 + 50), 0.0)])
    assert widened.since_last[0] == 0.0
    kept = run(published(), [*plots, (4270.0 + 0.9 * (15 + 50), 0.0)])
    assert kept.since_last[0] > 0.0


def test_a_track_ends_after_five_misses_and_a_tentative_one_after_two():
    plots = [(4000.0 + 30.0 * k, 0.0) for k in range(3)]
    assert len(run(safe(), [*plots, *[None] * 4])) == 1
    assert len(run(safe(), [*plots, *[None] * 5])) == 0
    assert len(run(safe(), [plots[0], None])) == 1
    assert len(run(safe(), [plots[0], None, None])) == 0


def pairs(part, cost):
    """Pairs that an association chooses, by a matrix of costs; NaN where there is no edge."""
    rows, count = cost.shape
    first = np.concatenate([[0], np.cumsum((~np.isnan(cost)).sum(axis=1))])
    plot, edges = np.nonzero(~np.isnan(cost))[1], int(first[-1])
    plot_of, track_of = np.full(rows, -1), np.full(count, -1)
    part.kernels(Setting(safe().sensor)).assign(
        rows, count, first, plot, cost[~np.isnan(cost)], plot_of, track_of,
        np.zeros(part.integers(rows, count, edges), np.int64),
        np.zeros(part.numbers(rows, count, edges)),
    )  # fmt: skip
    assert all(track_of[j] == i for i, j in enumerate(plot_of) if j >= 0)
    assert (plot_of >= 0).sum() == (track_of >= 0).sum()
    return {(i, int(j)) for i, j in enumerate(plot_of) if j >= 0}


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(0, 8), count=st.integers(0, 8))
def test_greedy_and_nearest_by_their_definitions(seed, rows, count):
    rng = np.random.default_rng(seed)
    cost = -rng.integers(1, 9, (rows, count)).astype(float)
    cost[rng.random((rows, count)) < 0.4] = np.nan
    greedy, left = set(), cost.copy()
    while not np.isnan(left).all():
        i, j = np.unravel_index(np.nanargmin(left), left.shape)
        greedy.add((int(i), int(j)))
        left[i], left[:, j] = np.nan, np.nan
    assert pairs(GreedyAssociation(), cost) == greedy
    asked = {}
    for i in range(rows):
        if not np.isnan(cost[i]).all():
            j = int(np.nanargmin(cost[i]))
            if j not in asked or cost[i, j] < cost[asked[j], j]:
                asked[j] = i
    assert pairs(NearestAssociation(), cost) == {(i, j) for j, i in asked.items()}


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    sectors=st.integers(2, 400),
    r=st.floats(0.0, 20e3),
    reach=st.floats(0.1, 30e3),
)
def test_no_plot_within_reach_is_missed(seed, sectors, r, reach):
    rng = np.random.default_rng(seed)
    n, own = 40, np.array([300.0, -200.0])
    part = SectorCandidates(sectors)
    kernels = part.kernels(Setting(safe().sensor))
    plots = np.zeros((n, 16))
    plots[:, :2] = rng.normal(0.0, 5e3, (n, 2))
    clock = np.zeros(8)
    clock[4:6] = own
    order, found = np.zeros(n, np.int64), np.zeros(n, np.int64)
    integers, numbers = np.zeros(part.integers(n), np.int64), np.zeros(part.numbers(n))
    kernels.arrange(plots, n, clock, order, integers, numbers)
    assert sorted(order) == list(range(n))
    plots = plots[order]
    bearing = rng.uniform(-np.pi, np.pi)
    x, y = own + r * np.array([np.cos(bearing), np.sin(bearing)])
    m = kernels.near(x, y, reach, plots, n, clock, integers, numbers, found)
    assert len(set(found[:m])) == m
    close = np.hypot(plots[:, 0] - x, plots[:, 1] - y) < reach
    assert set(np.flatnonzero(close)) <= set(found[:m])


def test_published_sectors_have_the_tracks_of_all_pairs_where_gates_are_narrow():
    rng = np.random.default_rng(1)
    place, velocity = rng.uniform(3e3, 9e3, (12, 2)), rng.normal(0, 5, (12, 2))
    scans = [
        Scan(3.0 * k, place + velocity * 3.0 * k + rng.normal(0, 10, (12, 2))) for k in range(12)
    ]
    tracker = replace(published(), candidates=SectorCandidates(16, "adjacent"))
    found = tracker.run(scans).reports
    every = replace(tracker, candidates=AllPairs()).run(scans).reports
    np.testing.assert_array_equal(found.track_id, every.track_id)
    np.testing.assert_array_equal(found.position, every.position)
