"""What every gain scheduler promises, a function for each promise."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Iterator
from types import FunctionType
from typing import Any

from fuzzytrack.gains.singer import fade
from fuzzytrack.gains.stability import in_closed_region
from fuzzytrack.schedulers.base import GainScheduler, Memory
from fuzzytrack.schedulers.form import answer_mistake, checked_kernel, checked_memory
from fuzzytrack.testing.kernel_words import foreign_word
from fuzzytrack.testing.samples import AXES, SIGMA, arrays, expect, expect_same, sample_plots
from fuzzytrack.testing.tracker_checks import (
    TRACKER_CHECKS,
    compiled_equals_plain,
    equals_pickled_copy,
    hashable,
    rows_left_out,
)
from fuzzytrack.trackers.alpha_beta import STARTS, AlphaBetaTracker

__all__ = ["SCHEDULER_CHECKS"]

#: Innovations and changes of observation (m): none, tiny, ordinary and, in both directions, absurd.
_MAGNITUDES = (0.0, 1e-12, 1.0, -3.0, 50.0, -1e9, 1e9)
_DT = 0.5


def kernel_takes_five_arguments(scheduler: GainScheduler, seed: int) -> None:
    """The kernel is a plain function that can be called with the five arguments."""
    kernel = checked_kernel(scheduler, _axes(scheduler))
    expect(
        isinstance(kernel, FunctionType),
        f"kernel(n_axes) must return a plain function, got {type(kernel).__name__}: define it "
        "inside, and take what it needs of self into variables before",
    )


def kernel_uses_numbers_only(scheduler: GainScheduler, seed: int) -> None:
    """The kernel, and what it calls, refers to nothing that cannot be compiled."""
    found = foreign_word(_kernel(scheduler))
    expect(found is None, str(found))


def kernel_answers_in_form(scheduler: GainScheduler, seed: int) -> None:
    """The kernel returns finite gains and a memory of the same length, and nothing else counts.

    A retention time that is used may be infinite.
    """
    kernel, memory = _kernel(scheduler), checked_memory(scheduler, _axes(scheduler))
    for where, arguments in _sample_arguments(scheduler):
        answer = _answer(kernel, where, arguments, memory)
        own = _axes(scheduler) if scheduler.own_gains else None
        mistake = answer_mistake(answer, len(memory), own)
        expect(mistake is None, f"{where}: {mistake}")
        sets = _gain_sets(scheduler, answer)
        numbers = (*(gain for gains in sets for gain in gains), *answer[4])
        expect(
            all(isinstance(n, float) and math.isfinite(n) for n in numbers),
            f"{where}: gains and memory must be finite floats, got {answer}",
        )
        retention = answer[3]
        expect(
            isinstance(retention, float) and (retention > 0.0 or not scheduler.uses_retention),
            f"{where}: retention must be a float, and a time > 0 if uses_retention is set, got "
            f"{retention!r}",
        )
        expect(
            scheduler.uses_acceleration or all(gamma == 0.0 for _, _, gamma in sets),
            f"{where}: gamma must be 0 unless uses_acceleration is set, got {answer[2]}",
        )
        expect(
            _answer(kernel, where, arguments, memory) == answer,
            f"{where}: must depend on nothing else",
        )


def gains_are_stable(scheduler: GainScheduler, seed: int) -> None:
    """With the gains of no plot does the error of a filter grow by itself.

    The edge of the stability region counts as inside: with gains of 0 a plot is ignored. Checked
    are the gains for the memory of a track that has just started and, one plot after another, for
    the memories that follow.
    """
    if scheduler.may_be_unstable:
        return
    kernel = _kernel(scheduler)
    started = _started(scheduler)
    later = started
    for where, arguments in _sample_arguments(scheduler):
        for memory in (started, later):
            answer = _answer(kernel, where, arguments, memory)
            phi = fade(_DT / answer[3]) if scheduler.uses_retention else 1.0
            for gains in _gain_sets(scheduler, answer):
                _expect_stable(where, *gains, phi)
        later = answer[4]


def _expect_stable(where: str, alpha: float, beta: float, gamma: float, phi: float) -> None:
    expect(
        bool(in_closed_region(alpha, beta, gamma, phi)),
        f"{where}: alpha = {alpha:g}, beta = {beta:g}, gamma = {gamma:g}, phi = {phi:g} make a "
        "filter unstable; stable are 0 <= alpha <= 2, beta >= 0, 2 alpha + beta <= 4 and, with "
        "phi = 1, 0 <= gamma <= 4 alpha beta/(2 - alpha). Or declare may_be_unstable = True",
    )


def pickled_copy_gives_the_same_gains(scheduler: GainScheduler, seed: int) -> None:
    """Another process gives the same track."""
    both = scheduler, pickle.loads(pickle.dumps(scheduler))
    times, plots = sample_plots(seed)
    for start in STARTS:
        one, other = (AlphaBetaTracker(each, start).run(times, plots, SIGMA) for each in both)
        expect_same(arrays(one), arrays(other), "a pickled scheduler must give the same gains")


def compiled(scheduler: GainScheduler, seed: int) -> None:
    """See `compiled_equals_plain`."""
    compiled_equals_plain(AlphaBetaTracker(scheduler), seed)


def left_out(scheduler: GainScheduler, seed: int) -> None:
    """See `rows_left_out`."""
    rows_left_out(AlphaBetaTracker(scheduler), seed)


def _with_either_start(promise: Callable[[Any, int], None]) -> Callable[[Any, int], None]:
    """Promise of a tracker, of the one that a scheduler makes with either start."""

    def kept(scheduler: GainScheduler, seed: int) -> None:
        for start in STARTS:
            promise(AlphaBetaTracker(scheduler, start), seed)

    return kept


def _axes(scheduler: GainScheduler) -> int:
    return AXES if scheduler.coupled else 1


def _kernel(scheduler: GainScheduler) -> Callable[..., Any]:
    return scheduler.kernel(_axes(scheduler))


def _gain_sets(scheduler: GainScheduler, answer: Any) -> list[tuple[float, float, float]]:
    """The gains that a kernel returned, α, β and γ together; one set, or one for each axis."""
    return list(zip(*answer[:3], strict=True)) if scheduler.own_gains else [answer[:3]]


def _answer(kernel: Callable[..., Any], where: str, arguments: Any, memory: Memory) -> Any:
    try:
        return kernel(*arguments, memory)
    except ArithmeticError as error:
        raise AssertionError(
            f"{where}: raises {type(error).__name__} ({error}); it must guard its own divisions"
        ) from error


def _arguments(scheduler: GainScheduler, innovation: float, change: float) -> tuple[Any, ...]:
    """What a kernel is called with, but for its memory; the same on all axes."""
    if not scheduler.coupled:
        return innovation, change, _DT, SIGMA
    return (innovation,) * AXES, (change,) * AXES, _DT, (SIGMA,) * AXES


def _sample_arguments(scheduler: GainScheduler) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Arguments that a kernel may be called with, and a text that describes them."""
    for innovation in _MAGNITUDES:
        for change in _MAGNITUDES:
            where = f"kernel at innovation {innovation:g}, change {change:g}"
            yield where, _arguments(scheduler, innovation, change)


def _started(scheduler: GainScheduler) -> Memory:
    """Memory of a track that has been started from two plots."""
    memory = checked_memory(scheduler, _axes(scheduler))
    if scheduler.sees_starts or scheduler.sees_misses:
        for _ in range(2):
            memory = _kernel(scheduler)(*_arguments(scheduler, 0.0, 0.0), memory)[4]
    return memory


#: Checks of every scheduler, by name.
SCHEDULER_CHECKS: dict[str, Callable[[Any, int], None]] = {
    "hashable": hashable,
    "equals-pickled-copy": equals_pickled_copy,
    "kernel-takes-five-arguments": kernel_takes_five_arguments,
    "kernel-uses-numbers-only": kernel_uses_numbers_only,
    "kernel-answers-in-form": kernel_answers_in_form,
    "gains-are-stable": gains_are_stable,
    **{name: _with_either_start(promise) for name, promise in TRACKER_CHECKS.items()},
    "pickled-copy-gives-same-gains": pickled_copy_gives_the_same_gains,
    "compiled-equals-plain": compiled,
    "rows-left-out": left_out,
}
