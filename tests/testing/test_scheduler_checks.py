"""The checks of schedulers fail what breaks the contract."""

import math
from dataclasses import dataclass

import pytest
from subjects import (
    bare_memory,
    divides,
    fixed,
    forgets_one,
    four_answers,
    gambles,
    grows_to_infinity,
    no_answer,
    run_check,
    scheduler_of,
)

import fuzzytrack as ft
from fuzzytrack.schedulers import GainScheduler
from fuzzytrack.testing import check_scheduler


@dataclass
class Unhashable(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@dataclass(frozen=True, eq=False)
class Unequal(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@pytest.mark.parametrize(
    ("scheduler", "promise"),
    [
        (0.5, "must be a GainScheduler, got float"),
        (ft.FixedGains, r"got the class FixedGains; give an object, as FixedGains\(\) makes it"),
        (Unhashable(), "^hashable: Unhashable must be hashable: make it a frozen dataclass"),
        (Unequal(), "^equals-pickled-copy: Unequal must equal its pickled copy"),
        (scheduler_of(fixed), "Made must pickle .*: define the class at the top of a module"),
    ],
)
def test_a_scheduler_is_a_value(scheduler, promise):
    with pytest.raises(AssertionError, match=promise):
        check_scheduler(scheduler)


@pytest.mark.parametrize(
    ("kernel", "memory", "promise"),
    [
        (forgets_one, (0.0,), "must return a memory of length 1 as it gets, got length 0"),
        (bare_memory, (0.0,), "must return its memory as a tuple, got 1.0"),
        (four_answers, (), r"must return \(alpha, .*, retention, memory\), got \(0.5, 0.2, 0.0"),
        (no_answer, (), r"must return \(alpha, beta, gamma, retention, memory\), got None"),
        (lambda *words: [0.5, 0.2, 0.0, 1.0, ()], (), r"must return \(alpha, .*\), got \[0.5, 0"),
        (lambda *words: (0.5, 0.2, 0.0, 1.0, []), (), r"its memory as a tuple, got \[\]"),
        (grows_to_infinity, (), "gains and memory must be finite floats"),
        (gambles, (), "must depend on nothing else"),
        (divides, (), r"innovation 0, change 0: raises ZeroDivisionError .* guard its own divis"),
    ],
)
def test_what_a_kernel_returns(kernel, memory, promise):
    with pytest.raises(AssertionError, match=f"^kernel-answers-in-form: kernel at .*{promise}"):
        run_check("kernel-answers-in-form", scheduler_of(kernel, memory))


@pytest.mark.parametrize("alpha", [0.5, (0.5,), [0.5, 0.5]])
def test_own_gains_are_one_of_each_axis(alpha):
    made = scheduler_of(
        lambda e, d, dt, s, m: (alpha, (0.2, 0.2), (0.0, 0.0), 1.0, m), coupled=True, own_gains=True
    )
    with pytest.raises(AssertionError, match="as tuples with a number for each axis, since own_"):
        run_check("kernel-answers-in-form", made)


def test_the_gains_of_every_axis_are_looked_at():
    def one_grows(e, d, dt, s, m):
        return (0.5, 1.9), (0.2, 0.5), (0.0, 0.0), 1.0, m

    made = scheduler_of(one_grows, coupled=True, own_gains=True)
    run_check("kernel-answers-in-form", made)
    with pytest.raises(AssertionError, match=r"alpha = 1.9, beta = 0.5, .* make a filter unstable"):
        run_check("gains-are-stable", made)


def test_gamma_needs_a_declaration():
    made = scheduler_of(lambda e, d, dt, s, m: (0.5, 0.2, 0.01, 1.0, m), uses_acceleration=False)
    with pytest.raises(AssertionError, match="gamma must be 0 unless uses_acceleration is set"):
        run_check("kernel-answers-in-form", made)


def gains(alpha, beta, gamma=0.0, retention=None, memory=()):
    said, uses = (1.0, False) if retention is None else (retention, True)
    return scheduler_of(
        lambda e, d, dt, s, m: (alpha, beta, gamma, said, m), memory, uses_retention=uses
    )


@pytest.mark.parametrize("retention", [0.0, -1.0, math.nan, 2])
def test_a_retention_is_a_time(retention):
    with pytest.raises(AssertionError, match=r"^kernel-answers-in-form: .* retention must be"):
        run_check("kernel-answers-in-form", gains(0.5, 0.2, 0.01, retention))


@pytest.mark.parametrize("retention", [1e-3, 7.0, math.inf])
def test_a_retention_may_be_for_ever(retention):
    run_check("kernel-answers-in-form", gains(0.5, 0.2, 0.01, retention))


@pytest.mark.parametrize(
    "values",
    [(1.9, 3.0), (0.5, -0.1), (2.1, 0.1), (-0.1, 0.2), (0.5, 0.2, 0.3), (0.5, 0.2, -0.1),
     (0.5, 0.2, 0.3, math.inf)],
)  # fmt: skip
def test_gains_outside_of_the_stability_region(values):
    with pytest.raises(
        AssertionError, match=r"^gains-are-stable: kernel at .*2 alpha \+ beta <= 4"
    ):
        run_check("gains-are-stable", gains(*values))
    allowed = gains(*values)
    type(allowed).may_be_unstable = True
    run_check("gains-are-stable", allowed)


@pytest.mark.parametrize(
    # Deadbeat gains, a plot that is left out, the corners and edges, and acceleration that fades:
    # of a retention time of 0.25 s, φ = 0.2 is left after half a second.
    "values",
    [(1.0, 1.0), (1.0, 1.5, 1.0), (0.0, 0.0), (0.0, 4.0), (2.0, 0.0), (1.0, 2.0),
     (0.5, 0.2, 0.5, 0.25)],
)  # fmt: skip
def test_the_edge_of_the_region_is_inside(values):
    run_check("gains-are-stable", gains(*values))


def test_gains_that_become_unstable_later():
    def wanders(innovation, change, dt, sigma, memory):
        return 0.5, 0.2 + memory[0], 0.0, 1.0, (memory[0] + 0.2,)

    with pytest.raises(AssertionError, match="make a filter unstable"):
        run_check("gains-are-stable", scheduler_of(wanders, (0.0,)))


@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_gains_are_stable_for_large_innovations_in_both_directions(direction):
    def jumps(innovation, change, dt, sigma, memory):
        return 1.9 if direction * innovation > 1e6 else 0.5, 0.3, 0.0, 1.0, memory

    with pytest.raises(AssertionError, match=r"innovation -?1e[+]09, .* make a filter unstable"):
        run_check("gains-are-stable", scheduler_of(jumps))


def test_steps_of_a_start_need_no_gains():
    def counts(innovation, change, dt, sigma, memory):
        return (0.5 if memory[0] > 1.0 else 9.0), 0.2, 0.0, 1.0, (memory[0] + 1.0,)

    run_check("gains-are-stable", scheduler_of(counts, (0.0,), sees_starts=True))
    with pytest.raises(AssertionError, match="alpha = 9"):
        run_check("gains-are-stable", scheduler_of(counts, (0.0,)))
