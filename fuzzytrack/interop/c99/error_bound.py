"""Errors of a program in C, measured against the library when it is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.vectors import Vectors, library_values
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

__all__ = ["RANDOM_INPUTS", "ErrorBound", "error_bound"]

#: Random inputs unless another number is given.
RANDOM_INPUTS = 1_000_000
# Points at a time.
_CHUNK = 20_000
#: All numbers of 16 bits.
_ALL = 65_536

#: ``evaluate(rows) -> values``: outputs of the program, shape (n, n_outputs), at numbers of C.
Evaluate = Callable[[NDArray[Any]], NDArray[Any]]


@dataclass(frozen=True, eq=False)
class ErrorBound:
    """Differences from the library, in steps for integers.

    Attributes
    ----------
    largest : ndarray, shape (n_outputs,)
        The largest difference met.
    bounds : ndarray, shape (n_outputs,)
        Twice the largest one, and not less than the rounding of the largest value; the largest one
        itself where every input was tried.
    ulps : ndarray, shape (n_outputs,), or None
        The largest difference from the rounded value, in units in the last place; None for
        integers.
    random : int
        Random inputs that were tried; 0 where every input was.
    """

    largest: Array
    bounds: Array
    ulps: Array | None
    random: int

    def __repr__(self) -> str:
        return summary(self, "largest", "bounds", "random")


def error_bound(
    system: FuzzySystem,
    number: NumberType,
    evaluate: Evaluate,
    checked: Vectors,
    *,
    random: int = RANDOM_INPUTS,
    progress: Progress | None = None,
) -> ErrorBound:
    """Compare a program with the library.

    Parameters
    ----------
    system : FuzzySystem
    number : NumberType
    evaluate : callable
        What the program gives; see `Evaluate`.
    checked : Vectors
        Inputs that are tried as well.
    random : int
        Random inputs over the universes. A single input of 16 bits is tried at all its values.
    progress : callable, optional
        Called with the share of the work that is done.
    """
    inputs = system.rules.inputs
    every = number.whole and len(inputs) == 1
    total = _ALL if every else random
    generator = np.random.default_rng(1)
    n_outputs = checked.expected.shape[1]
    largest, ulps, size = np.zeros(n_outputs), np.zeros(n_outputs), np.zeros(n_outputs)

    def compare(rows: NDArray[Any], expected: Array) -> None:
        values = evaluate(rows)
        np.maximum(largest, _largest(_differences(values, expected)), out=largest)
        np.maximum(size, _largest(np.abs(np.nan_to_num(expected))), out=size)
        if not number.whole:
            np.maximum(ulps, _ulps(values, expected, number.dtype), out=ulps)

    compare(checked.inputs, checked.expected)
    for start in range(0, total, _CHUNK):
        count = min(_CHUNK, total - start)
        if every:
            rows = np.arange(start, start + count)[:, None] - 32_768
        else:
            columns = [number.random(v.universe, count, generator) for v in inputs]
            rows = np.stack(columns, axis=1)
        compare(rows, library_values(system, number, rows))
        if progress is not None:
            progress((start + count) / total)
    rounding = 0.0 if number.whole else np.finfo(number.dtype).eps * size
    bounds = largest if every else np.maximum(2 * largest, rounding)
    return ErrorBound(largest, bounds, None if number.whole else ulps, 0 if every else random)


def _differences(values: NDArray[Any], expected: Array) -> Array:
    """Absolute differences; infinite where only one of two values is NaN, 0 where both are."""
    apart = np.abs(values - expected)
    unknown, missing = np.isnan(values), np.isnan(expected)
    return np.where(unknown & missing, 0.0, np.where(unknown | missing, np.inf, apart))


def _largest(values: Array) -> Array:
    return np.asarray(values.max(axis=0, initial=0.0))


def _ulps(values: NDArray[Any], expected: Array, dtype: Any) -> Array:
    """Largest distance from the rounded values, counted in numbers of the type, of each column."""
    rounded = expected.astype(dtype)
    both = ~(np.isnan(values) | np.isnan(rounded))
    distance = np.abs(_ordinal(values) - _ordinal(rounded)) * both
    return np.asarray(distance.max(axis=0, initial=0).astype(np.float64))


def _ordinal(values: NDArray[Any]) -> NDArray[np.int64]:
    """Numbers as integers in their order, neighbors differing by one."""
    bits = values.view(np.int32 if values.dtype == np.float32 else np.int64).astype(np.int64)
    top = np.int64(np.iinfo(np.int32 if values.dtype == np.float32 else np.int64).max)
    return np.where(bits < 0, -(bits & top), bits)
