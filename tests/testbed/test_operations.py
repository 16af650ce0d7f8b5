import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.kernel import infer_function
from fuzzytrack.papers.llinas.columns import columns
from fuzzytrack.papers.llinas.programs import (
    alpha_beta,
    alpha_beta_gamma,
    chan,
    kalman_matrix,
    kalman_scalar,
    proposed,
)
from fuzzytrack.schedulers import (
    FixedGains,
    FuzzyScheduler,
    GainScheduler,
    GrowingMemory,
    InnovationScheduler,
    KalmanCV,
    QualityGains,
)
from fuzzytrack.testbed.operations import Tally, count_operations, count_program

PERIOD, SIGMA = 60.0, 115.0
TIMES = PERIOD * np.arange(20)


@cache
def fuzzy(name, method="exact"):
    return FuzzyScheduler(ft.load_rulebase(name), method)


@pytest.fixture(scope="module")
def track():
    truth = np.outer(np.arange(20.0), [300.0, -200.0])
    return truth + SIGMA * np.random.default_rng(3).normal(size=truth.shape), truth


# ---------------------------------------------------------------- numbers that count


def test_what_an_operation_is():
    tally = Tally()
    x = tally.number(3.0)
    results = [x + x, x - 1, x * 2.0, x / 2, x**2, 1 + x, 1 - x, 2 * x, 6 / x, 2**x]
    assert tally.total == 10
    assert [float(r) for r in results] == [6, 2, 6, 1.5, 9, 4, -2, 6, 2, 8]
    assert float(-x) == -3
    assert float(abs(-x)) == 3
    assert (x == 3, x != 3, x < 4, x <= 2, x > 2, x >= 4) == (True, False, True, False, True, False)
    assert round(tally.number(2.6)) == 3
    assert [10, 20, 30, 40][x] == 40
    assert tally.total == 10


def test_comparisons_and_signs_count_if_told():
    tally = Tally(comparisons=True, signs=True)
    x = tally.number(-3.0)
    assert float(abs(x)) == 3
    assert x < 0
    assert tally.total == 2


def test_an_index_must_be_whole():
    with pytest.raises(TypeError, match=r"an index must be whole, got 0\.5"):
        _ = [1, 2][Tally().number(0.5)]


# ---------------------------------------------------------------- kernels


def test_the_recursion_as_counted_by_hand():
    # 1/T and gap 2, prediction 2, innovation 1, change 1, x 2, v 3, plots 1
    found = count_operations(FixedGains(0.5, 0.2))
    assert found.recursion_per_update == 12
    # And with acceleration: prediction 4, velocity ahead 2, a 5.
    assert count_operations(FixedGains(0.5, 0.2, 0.1)).recursion_per_update == 23
    assert found.scheduler == found.scheduler_per_update == 0
    assert found.total == found.recursion
    assert found.per_update == 12


@dataclass(frozen=True)
class Known(GainScheduler):
    """One root, one product and the sum of two literals: three operations."""

    def kernel(self, n_axes):
        gain = 0.25

        def kernel(innovation, change, dt, sigma, memory):
            low = 0.5 if sigma > 0.0 else 0.0
            high = 0.25 if dt > 0.0 else 0.0
            return math.sqrt(gain), gain * (low + high), 0.0, 1.0, memory

        return kernel


def test_literals_constants_and_math_count():
    found = count_operations(Known())
    assert found.scheduler_per_update == 3
    # It runs at every scan of both axes, also where it is not asked.
    assert found.scheduler == 3 * 20 * 2


@pytest.mark.parametrize(
    ("scheduler", "operations"),
    [
        # d = n(n + 1): 2; α: 4; β: 1; count: 1
        (GrowingMemory(), 8),
        # span 1, T²/2 2, P⁻ 16, S 1, K 2, 1 - K₁ 1, P 16, β 1
        (KalmanCV(0.1, SIGMA), 40),
    ],
)
def test_schedulers_as_counted_by_hand(scheduler, operations):
    assert count_operations(scheduler).scheduler_per_update == operations


def test_operations_grow_with_scans_and_axes():
    one = count_operations(KalmanCV(0.1, SIGMA), n_axes=1)
    three = count_operations(KalmanCV(0.1, SIGMA), n_axes=3)
    assert three.total == 3 * one.total
    longer = count_operations(KalmanCV(0.1, SIGMA), scans=30, n_axes=1)
    assert longer.total - one.total == 10 * one.per_update


def test_a_track_that_is_never_corrected():
    found = count_operations(FixedGains(0.5, 0.2), scans=2)
    assert found.recursion > 0
    assert math.isnan(found.per_update)


def test_what_counts_gives_the_same_gains():
    """Counting does not change a kernel: gains of the ordinary tracker, number by number."""
    seen = []

    @dataclass(frozen=True)
    class Watched(GainScheduler):
        inner: GainScheduler

        def initial_memory(self, n_axes):
            return self.inner.initial_memory(n_axes)

        @property
        def sees_starts(self):
            return self.inner.sees_starts

        def kernel(self, n_axes):
            inner = self.inner.kernel(n_axes)

            def kernel(innovation, change, dt, sigma, memory):
                answer = inner(innovation, change, dt, sigma, memory)
                seen.append(([float(v) for v in answer[:3]], *map(float, (innovation, dt, sigma))))
                return answer

            return kernel

    for inner in (InnovationScheduler(), QualityGains(), KalmanCV(0.1)):
        seen.clear()
        count_operations(Watched(inner), scans=8, n_axes=1)
        kernel, memory = inner.kernel(1), inner.initial_memory(1)
        told = seen if inner.sees_starts else seen[2:]
        assert len(told) >= 6
        for gains, innovation, dt, sigma in told:
            *wanted, _, memory = kernel(innovation, 0.0, dt, sigma, memory)
            assert gains == wanted


def test_a_coupled_tracker():
    scheduler = fuzzy("chan-style")
    found = count_operations(scheduler)
    assert found.scheduler_per_update > 20
    # 1/T, the gap and the plots of a track are counted once for both axes.
    assert found.recursion_per_update == 10.5


def test_a_cell_of_a_table_is_cheaper_than_its_rules():
    exact = count_operations(fuzzy("stiffness-damping"), scans=6)
    table = count_operations(fuzzy("stiffness-damping", "relation"), scans=6)
    # E and ΔE 3, their cells 6, Eq. 3.26 for both gains with one division 8
    assert table.scheduler_per_update == 17
    assert exact.scheduler_per_update > 4 * 17


def test_what_cannot_be_counted():
    with pytest.raises(
        TypeError, match="tracker must be a LaneTracker or a GainScheduler, got int"
    ):
        count_operations(3)
    for name in ("scans", "n_axes"):
        with pytest.raises(ValueError, match=f"{name} must be at least 1, got 0"):
            count_operations(FixedGains(0.5, 0.2), **{name: 0})


# ---------------------------------------------------------------- the report's programs


def check(program, scheduler, track, *arguments, **options):
    """Count a program, once it has been held against the tracker of ours that it is."""
    plots, truth = track
    total, counted = count_program(program, plots, truth, PERIOD, *arguments, **options)
    plain = program(plots, truth, PERIOD, *arguments, **options)
    ours = ft.AlphaBetaTracker(scheduler).run(TIMES, plots, SIGMA).predicted[2:]
    assert counted.predicted == pytest.approx(ours, rel=1e-12, abs=1e-9)
    np.testing.assert_array_equal(plain.predicted, counted.predicted)
    assert counted.distance == pytest.approx(np.hypot(*(ours - truth[2:]).T), rel=1e-12)
    return total


def test_fixed_gains_cost_what_table_5_7_says(track):
    assert check(alpha_beta, FixedGains(0.5377, 0.2018), track, 0.5377, 0.2018) == 472
    gains = (0.75, 0.24, 0.005)
    assert check(alpha_beta_gamma, FixedGains(*gains), track, *gains) == 976


def test_the_totals_are_36_updates_and_a_start(track):
    plots, truth = track
    for program, gains, update in (
        (alpha_beta, (0.5, 0.2), 13),
        (alpha_beta_gamma, (0.5, 0.2, 0.05), 27),
    ):
        for scans in (2, 3, 11):
            given = (plots[:scans], truth[:scans], PERIOD, *gains)
            total, run = count_program(program, *given)
            assert total == 2 * update * (scans - 2) + 4
            assert run.predicted.shape == (scans - 2, 2)


def test_the_proposed_tracker(track):
    scheduler = fuzzy("stiffness-damping-cog", "relation")
    total = check(proposed, scheduler, track, columns(scheduler.rules))
    # 13 as without rules; E and ΔE 5; cells 4; two centroids over four sets 22; Eq. 3.26 twice 16
    assert total == 36 * (13 + 5 + 4 + 22 + 16) + 4
    assert 2063 <= total <= 2250


def test_the_proposed_tracker_with_singletons(track):
    scheduler = fuzzy("stiffness-damping", "relation")
    table = columns(scheduler.rules)
    assert check(proposed, scheduler, track, table) == 2164
    # Sums of four products without a division by the sum of the levels, which is 1
    assert check(proposed, scheduler, track, table, weighted_sum=True) == 2164 - 36 * 8


def test_chans_tracker(track):
    scheduler = fuzzy("chan-style")
    total = check(chan, scheduler, track, infer_function(scheduler.system))
    assert total == 36 * (13 + 5) + 18 * 10 + 4


def test_three_forms_of_the_kalman_filter(track):
    scheduler = KalmanCV(0.045, SIGMA)
    matrix = check(kalman_matrix, scheduler, track, SIGMA, 0.045)
    joseph = check(kalman_matrix, scheduler, track, SIGMA, 0.045, joseph=True)
    scalar = check(kalman_scalar, scheduler, track, SIGMA, 0.045)
    assert (matrix, joseph, scalar) == (3852, 5364, 972)
    assert joseph / scalar >= 4
    assert scalar / 472 == pytest.approx(2.06, abs=0.01)


def test_programs_refuse_other_plots():
    with pytest.raises(ValueError, match=r"one shape \(n_scans, 2\); got \(3, 1\) and \(3, 1\)"):
        alpha_beta(np.zeros((3, 1)), np.zeros((3, 1)), 1.0, 0.5, 0.2)
    with pytest.raises(ValueError, match="plots must have at least 2 scans, got 1"):
        alpha_beta(np.zeros((1, 2)), np.zeros((1, 2)), 1.0, 0.5, 0.2)


def test_columns_are_of_product_and_sum_with_two_inputs():
    with pytest.raises(ValueError, match="omega-schedule must have 2 inputs, it has 1"):
        columns(ft.load_rulebase("omega-schedule"))
    with pytest.raises(ValueError, match="operators product and sum; it has min and max"):
        columns(ft.load_rulebase("tipper"))
