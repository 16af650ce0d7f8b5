"""Words that a function for compilation may use beside plain Python.

In plain Python they do nothing, or what their name says; `fuzzytrack.kernels.compile` puts
instructions to the compiler in their place. A function finds them as globals or in its enclosing
scope.
"""

from __future__ import annotations

from typing import Any

__all__ = [
    "Memory", "own_numbers", "promise_independent_turns", "read_soon", "use_wide_vectors",
]  # fmt: skip

#: What a kernel remembers from step to step: numbers that it takes and returns.
Memory = tuple[float, ...]


def use_wide_vectors() -> None:
    """Let the loops of the calling function use the widest vector registers of the processor.

    By default LLVM avoids registers of 512 bits, because using them can slow down other code on the
    same processor. For a batch of tracks they are faster.
    """


def promise_independent_turns() -> None:
    """Promise that no iteration of the calling function's loops reads what another one writes.

    Then the compiler works on two vectors in each iteration: while one waits for a division, the
    other is computed. It cannot find this out by itself, since all rows lie in one buffer.

    Call it after the loops. The last statement of a loop must not be a call: a call ends with a
    check of its status, and the promise would be lost with the branch that the check adds.
    """


def own_numbers(count: int) -> Any:
    """Numbers for the calling function's own use, to be written before they are read.

    Parameters
    ----------
    count : int
        How many; fixed when the function is made, not computed in it.

    Returns
    -------
    list of float
        In compiled code, a pointer to numbers, which the compiler keeps in registers.
    """
    return [0.0] * count


def read_soon(table: Any, row: int, column: int) -> None:
    """Let the processor fetch the memory around a number that will be read soon.

    A loop over rows far apart waits for memory at each of them where a table is larger than the
    caches. The row may be one beyond the last.
    """
