"""What the scalar functions called kernels are written with, besides plain Python."""

from __future__ import annotations

__all__ = ["Memory"]

#: What a kernel remembers from step to step: numbers that it takes and returns.
Memory = tuple[float, ...]
