"""Parts of scan trackers that the default one leaves out, each against a simpler way."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from fuzzytrack.scan import Scan, ScanSession, ScanTracker, Sensor, Setting
from fuzzytrack.scan.association import OptimalAssociation
from fuzzytrack.scan.candidates import AllPairs, GridCandidates, KdTree
from fuzzytrack.scan.extraction import Merging
from fuzzytrack.scan.identity import Dormant
from fuzzytrack.scan.plot_columns import PLOT_WIDTH, PLOT_X, PLOT_Y
from fuzzytrack.scan.quality import LogLikelihoodRatio, MOfN
from fuzzytrack.scan.track_columns import FIXED, SCORE

SETTING = Setting(Sensor())


def plots_at(positions):
    plots = np.zeros((len(positions), PLOT_WIDTH))
    plots[:, [PLOT_X, PLOT_Y]] = positions
    return plots


# ---------------------------------------------------------------- candidates


@settings(max_examples=30)
@given(
    seed=st.integers(0, 2**31),
    n=st.integers(0, 300),
    spread=st.sampled_from([0.0, 1.0, 100.0, 1e4]),
    part=st.sampled_from([GridCandidates(), KdTree(), AllPairs()]),
)
def test_no_plot_within_reach_is_missing(seed, n, spread, part):
    rng = np.random.default_rng(seed)
    given_plots = plots_at(rng.normal(0, 1, (n, 2)) * spread + rng.choice([0.0, -5e5]))
    order, found = np.zeros(n, np.int64), np.zeros(n + 1, np.int64)
    integers, numbers = np.zeros(part.integers(n), np.int64), np.zeros(part.numbers(n))
    arrange, near = part.kernels(SETTING)
    arrange(given_plots, n, None, order, integers, numbers)
    assert sorted(order) == list(range(n))
    plots = given_plots[order]
    for _ in range(5):
        x, y = rng.normal(0, 1, 2) * spread + (plots[0, :2] if n else 0.0)
        reach = rng.exponential(spread + 1.0)
        count = near(x, y, reach, plots, n, None, integers, numbers, found)
        rows = found[:count].tolist()
        assert len(set(rows)) == count
        away = np.hypot(plots[:, PLOT_X] - x, plots[:, PLOT_Y] - y)
        crowded = spread < 100.0 and isinstance(part, GridCandidates)
        if not crowded:
            assert set(np.flatnonzero(away <= reach)) <= set(rows)
    if n > 100 and spread == 1e4 and not isinstance(part, AllPairs):
        assert near(*plots[0, :2], 1.0, plots, n, None, integers, numbers, found) < n / 2


def test_a_track_in_a_crowd_looks_at_few_plots():
    n, part = 5000, GridCandidates()
    plots = plots_at(np.zeros((n, 2)))
    order, found = np.zeros(n, np.int64), np.zeros(n, np.int64)
    integers, numbers = np.zeros(part.integers(n), np.int64), np.zeros(1)
    arrange, near = part.kernels(SETTING)
    arrange(plots, n, None, order, integers, numbers)
    seen = set()
    for track in range(200):
        found[0] = track
        count = near(0.0, 0.0, 1.0, plots, n, None, integers, numbers, found)
        assert 0 < count <= 4 * 64
        seen |= set(found[:count].tolist())
    assert len(seen) > 2000


# ---------------------------------------------------------------- association


@settings(max_examples=200)
@given(
    seed=st.integers(0, 2**31),
    rows=st.integers(0, 8),
    count=st.integers(0, 8),
    density=st.sampled_from([0.2, 0.5, 1.0]),
    whole=st.booleans(),
)
def test_optimal_pairs_cost_as_little_as_those_of_scipy(seed, rows, count, density, whole):
    rng = np.random.default_rng(seed)
    cost = -rng.exponential(5.0, (rows, count)) - 0.01
    cost = np.floor(cost) if whole else cost
    cost[rng.random((rows, count)) > density] = 0.0
    first = np.concatenate([[0], np.cumsum((cost < 0).sum(axis=1))]).astype(np.int64)
    i, j = np.nonzero(cost)
    part = OptimalAssociation()
    plot_of, track_of = np.full(rows, -1), np.full(count, -1)
    integers = np.zeros(part.integers(rows, count, len(i)), np.int64)
    numbers = np.zeros(part.numbers(rows, count, len(i)))
    part.kernels(SETTING).assign(
        rows, count, first, j, cost[i, j], plot_of, track_of, integers, numbers
    )
    paired = plot_of >= 0
    assert all(track_of[plot_of[k]] == k for k in np.flatnonzero(paired))
    assert (track_of >= 0).sum() == paired.sum()
    found = cost[paired, plot_of[paired]]
    assert (found < 0).all()
    best = cost[linear_sum_assignment(cost)].sum() if cost.size else 0.0
    assert found.sum() == pytest.approx(best)


# ---------------------------------------------------------------- extraction


@given(seed=st.integers(0, 2**31), n=st.integers(0, 60))
def test_plots_are_merged_into_the_first_one_near(seed, n):
    rng = np.random.default_rng(seed)
    plots = np.zeros((n, PLOT_WIDTH))
    plots[:] = rng.uniform(-30, 30, (n, PLOT_WIDTH))
    groups = []
    for plot in plots:
        near = [g for g in groups if math.dist(g[0][:2], plot[:2]) <= 10.0]
        if near:
            near[0].append(plot.copy())
        else:
            groups.append([plot.copy()])
    integers = np.zeros(4 * n + 4, np.int64)
    kept = Merging(10.0).kernels(SETTING).extract(plots, n, integers)
    assert kept == len(groups)
    for k, group in enumerate(groups):
        np.testing.assert_allclose(plots[k, :6], np.mean(group, axis=0)[:6], atol=1e-9)


def test_many_plots_at_one_spot_become_one_in_proportional_time():
    plots = plots_at(np.zeros((20_000, 2)))
    integers = np.zeros(80_000, np.int64)
    assert Merging(5.0).kernels(SETTING).extract(plots, len(plots), integers) == 1


# ---------------------------------------------------------------- quality


@given(st.lists(st.booleans(), max_size=60), st.integers(1, 50))
def test_m_of_n_counts_the_last_scans(hits, n):
    track = np.zeros((1, FIXED + 1))
    quality = MOfN(n).kernels(SETTING, FIXED)
    quality.start(track, 0, None, 0, None)
    for is_hit in hits:
        if is_hit:
            quality.hit(track, 0, None, 0, None)
        else:
            quality.miss(track, 0, None)
    assert track[0, SCORE] == sum([True, *hits][-n:])
    assert math.isnan(quality.existence(track, 0))


def two_boats(n, gap=()):
    rng = np.random.default_rng(3)
    for k in range(n):
        z = np.array([[3.0 * k, 50.0], [-80.0, 4.0 * k]]) + rng.normal(0, 0.5, (2, 2))
        yield Scan(1.678 * k, z[1:] if k in gap else z)


def test_the_log_likelihood_ratio_falls_by_what_a_miss_says():
    session = ScanSession(ScanTracker(quality=LogLikelihoodRatio(most=15.0)), plain=True)
    reports = [session.step(scan) for scan in two_boats(14, gap=(12, 13))]
    first = [float(r.existence[r.track_id == 1][0]) for r in reports[10:]]
    odds = [math.log(p / (1 - p)) for p in first]
    assert odds[1] == pytest.approx(15.0, abs=1e-6)
    assert odds[3] - odds[2] == pytest.approx(math.log(1 - Sensor().detection), abs=1e-6)


# ---------------------------------------------------------------- identity


def test_a_track_that_was_lost_keeps_its_identity():
    gap = range(12, 29)
    without = ScanTracker().run(two_boats(40, gap)).track_ids
    assert len(without) == 3
    session = ScanSession(ScanTracker(identity=Dormant(scans=20, limit=30.0)), plain=True)
    found = [session.step(scan).track_id.tolist() for scan in two_boats(40, gap)]
    assert found[11] == [1, 2]
    assert found[28] == [2]
    assert found[39] == [1, 2]
