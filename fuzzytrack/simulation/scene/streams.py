"""Random streams of a scene: each part and each of its purposes has one of its own."""

from __future__ import annotations

import zlib

import numpy as np

__all__ = ["Streams"]


class Streams:
    """Random streams of one part of a scene, by what they are for.

    The name of the part chooses them, not its place, so that a part that is added leaves the
    numbers of the others as they are. Arrays are drawn with a row for each target: those of a
    target do not change when others come after it.

    Parameters
    ----------
    seed : int
        Seed of the simulation, not negative.
    role, name : str
        Kind of part, and its name.
    """

    def __init__(self, seed: int, role: str, name: str = "") -> None:
        self._seed = seed
        self._key = (zlib.crc32(role.encode()), zlib.crc32(name.encode()))

    def stream(self, purpose: str, number: int = 0) -> np.random.Generator:
        """Random numbers for a purpose; always the same ones, from the first on."""
        key = (*self._key, zlib.crc32(purpose.encode()), number)
        return np.random.default_rng(np.random.SeedSequence(self._seed, spawn_key=key))
