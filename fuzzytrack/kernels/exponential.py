"""An exponential function that is the same to the last bit wherever it runs."""

from __future__ import annotations

__all__ = ["exponential"]


def exponential(x: float) -> float:
    """Exponential for -300 <= x <= 300, to a relative 1e-13.

    Compilers use different libraries for it, which differ in the last bit; this one is the same
    everywhere, and is computed for neighboring lanes at once. It is the series of exp(x/1024) - 1,
    squared ten times without loss of small terms.
    """
    r = (x if x > 0.0 else -x) / 1024.0
    y = 1 / 362880 + r * (1 / 3628800 + r * (1 / 39916800 + r / 479001600))
    y = 1 / 120 + r * (1 / 720 + r * (1 / 5040 + r * (1 / 40320 + r * y)))
    y = r * (1.0 + r * (1 / 2 + r * (1 / 6 + r * (1 / 24 + r * y))))
    for _ in range(10):
        y = y * (2.0 + y)
    return 1.0 / (1.0 + y) if x < 0.0 else 1.0 + y
