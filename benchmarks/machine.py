"""The machine: what it is, how fast its memory is, and what a second thread adds."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib import metadata
from pathlib import Path
from typing import Any

import numba
import numpy as np

__all__ = ["Arithmetic", "Copy", "Triad", "available_memory", "bandwidth", "cores", "describe"]

PACKAGES = (
    "fuzzytrack", "numpy", "scipy", "numba", "llvmlite", "filterpy", "stonesoup", "simdkalman",
    "scikit-fuzzy", "pyfuzzylite", "simpful",
)  # fmt: skip


def cores() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def describe() -> dict[str, Any]:
    """Processor, caches, memory and versions."""
    return {
        "processor": _processor(),
        "cores": cores(),
        "caches": _caches(),
        "memory_gb": None if (total := _meminfo("MemTotal")) is None else round(total / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: version for name in PACKAGES if (version := _version(name))},
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def available_memory() -> float:
    """Bytes that may be used without driving anybody out; a careful guess where it is not told."""
    found = _meminfo("MemAvailable")
    return 4e9 if found is None else found


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _caches() -> dict[str, str]:
    found = {}
    for folder in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = (
            (folder / name).read_text().strip() for name in ("level", "type", "size")
        )
        if kind != "Instruction":
            found[f"L{level}"] = size
    return found


def _meminfo(key: str) -> float | None:
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith(f"{key}:"):
                return 1024.0 * float(line.split()[1])
    except OSError:
        pass
    return None


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


@numba.njit(nogil=True, cache=True)
def _triad(a, b, c, factor):
    for i in range(a.size):
        a[i] = b[i] + factor * c[i]


@numba.njit(nogil=True, cache=True)
def _arithmetic(numbers, rounds):
    for _ in range(rounds):
        for i in range(numbers.size):
            x = numbers[i]
            numbers[i] = ((0.25 * x + 0.5) * x + 0.125) * (1.0 - 0.5 * x)


class _Shared:
    """A job in one part for each thread."""

    def __init__(self, work: Callable[..., Any], parts: Sequence[tuple[Any, ...]]) -> None:
        self.work, self.parts = work, parts
        self.pool = ThreadPoolExecutor(len(parts)) if len(parts) > 1 else None

    def __call__(self) -> None:
        if self.pool is None:
            self.work(*self.parts[0])
            return
        done = [self.pool.submit(self.work, *part) for part in self.parts]
        for each in done:
            each.result()


class Triad(_Shared):
    """a = b + s·c over arrays larger than the caches."""

    def __init__(self, size: int, threads: int = 1) -> None:
        self.bytes = 24 * size
        split = (np.array_split(np.full(size, 1.0), threads) for _ in range(3))
        super().__init__(_triad, [(*part, 0.5) for part in zip(*split, strict=True)])


class Copy(_Shared):
    """One array into another, larger than the caches."""

    def __init__(self, size: int, threads: int = 1) -> None:
        split = (np.array_split(np.full(size, 1.0), threads) for _ in range(2))
        super().__init__(np.copyto, list(zip(*split, strict=True)))


class Arithmetic(_Shared):
    """Additions and multiplications within the first cache; `size` of each number of a block."""

    BLOCK = 240

    def __init__(self, size: int, threads: int = 1) -> None:
        rounds = max(1, size // threads)
        super().__init__(_arithmetic, [(np.full(self.BLOCK, 0.5), rounds) for _ in range(threads)])


def bandwidth(size: int, threads: int, repeats: int) -> dict[str, float]:
    """Triad bandwidth (GB/s), best and median; 24 bytes a number, write-allocation not counted."""
    triad = Triad(size, threads)
    triad()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        triad()
        times.append(time.perf_counter() - start)
    return {
        "best": triad.bytes / min(times) / 1e9,
        "median": triad.bytes / statistics.median(times) / 1e9,
    }
