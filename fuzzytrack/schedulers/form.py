"""Form of a scheduler's kernel, of what it returns, and of its memory."""

from __future__ import annotations

import inspect
from typing import Any

from fuzzytrack.errors import Location, PluginError
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory

__all__ = ["answer_mistake", "check_answer", "checked_kernel", "checked_memory"]

_ARGUMENTS = ("innovation", "change", "dt", "sigma", "memory")


def checked_kernel(scheduler: GainScheduler, n_axes: int) -> Kernel:
    """Kernel of a scheduler, which can be called with the five arguments.

    Parameters
    ----------
    scheduler : GainScheduler
    n_axes : int
        As for `GainScheduler.kernel`.

    Raises
    ------
    PluginError
        If it is no function, or takes other arguments.
    """
    name, kernel = type(scheduler).__name__, scheduler.kernel(n_axes)
    if not callable(kernel):
        raise PluginError(
            f"{name}.kernel must return a function, got {kernel!r}",
            Location.of_function(scheduler.kernel),
        )
    signature = inspect.signature(kernel)
    if not _takes_five(signature):
        raise PluginError(
            f"the kernel of {name} must take the five arguments ({', '.join(_ARGUMENTS)}), takes "
            f"{signature}",
            Location.of_function(kernel),
        )
    return kernel


def _takes_five(signature: inspect.Signature) -> bool:
    try:
        signature.bind(*_ARGUMENTS)
    except TypeError:
        return False
    # None by name, not even with a default: a function that has one cannot be compiled.
    return all(p.kind is not p.KEYWORD_ONLY for p in signature.parameters.values())


def checked_memory(scheduler: GainScheduler, n_axes: int) -> Memory:
    """Memory of a new track, as a tuple of floats.

    Parameters
    ----------
    scheduler : GainScheduler
    n_axes : int
        As for `GainScheduler.initial_memory`.

    Raises
    ------
    PluginError
        If the scheduler gives anything else.
    """
    memory: Any = scheduler.initial_memory(n_axes)
    try:
        return tuple(float(number) for number in memory)
    except (TypeError, ValueError):
        raise PluginError(
            f"{type(scheduler).__name__}.initial_memory must return a tuple of numbers, got "
            f"{memory!r}",
            Location.of_function(scheduler.initial_memory),
        ) from None


def answer_mistake(answer: Any, n_memory: int, n_own: int | None = None) -> str | None:
    """What is wrong with the form of what a kernel returned; None if nothing is.

    Parameters
    ----------
    answer : object
    n_memory : int
        Numbers in the memory that the kernel was given.
    n_own : int, optional
        Axes that each have their own gains; unless given, there is one set of gains.
    """
    if not isinstance(answer, tuple) or len(answer) != 5:
        return f"must return (alpha, beta, gamma, retention, memory), got {answer!r}"
    memory = answer[4]
    if not isinstance(memory, tuple):
        return f"must return its memory as a tuple, got {memory!r}"
    if len(memory) != n_memory:
        return f"must return a memory of length {n_memory} as it gets, got length {len(memory)}"
    for gains in answer[:3]:
        if n_own is not None and (not isinstance(gains, tuple) or len(gains) != n_own):
            return (
                "must return alpha, beta and gamma as tuples with a number for each axis, since "
                f"own_gains is set, got {gains!r} for {n_own}"
            )
    return None


def check_answer(scheduler: GainScheduler, n_axes: int) -> None:
    """Check the form of what a scheduler's kernel returns for a plot like the prediction.

    Parameters
    ----------
    scheduler : GainScheduler
    n_axes : int
        As for `GainScheduler.kernel`.

    Raises
    ------
    PluginError
        If it lacks the form. What the kernel itself raises is no matter of form, and is dropped.
    """
    kernel, memory = checked_kernel(scheduler, n_axes), checked_memory(scheduler, n_axes)
    zeros: Any = (0.0,) * n_axes if scheduler.coupled else 0.0
    ones: Any = (1.0,) * n_axes if scheduler.coupled else 1.0
    try:
        answer = kernel(zeros, zeros, 1.0, ones, memory)
    except Exception:
        return
    mistake = answer_mistake(answer, len(memory), n_axes if scheduler.own_gains else None)
    if mistake is not None:
        raise PluginError(
            f"the kernel of {type(scheduler).__name__} {mistake}", Location.of_function(kernel)
        )
