"""How much is measured."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FULL", "QUICK", "TINY", "Scale"]


@dataclass(frozen=True)
class Scale:
    """Sizes of the jobs.

    Attributes
    ----------
    tracks, steps : int
        Of a batch.
    repeats : int
        Rounds in which the compared jobs take turns.
    growth : tuple of (tracks, steps)
        Batches from small to large.
    kalman_tracks, peer_tracks : int
        Tracks of a Kalman batch, and how many of them a peer without batches is given.
    stream_steps, scan_tracks : int
        Plots of a streamed track, and tracks of a streamed scan.
    evaluations : int
        Points of an array that a fuzzy engine evaluates.
    triad : int
        Numbers in an array of the triad.
    processes : int
        New processes for each cold start; none are started for 0.
    compiles : bool
        Whether trackers are compiled beforehand.
    """

    name: str
    tracks: int
    steps: int
    repeats: int
    growth: tuple[tuple[int, int], ...]
    kalman_tracks: int
    peer_tracks: int
    stream_steps: int
    scan_tracks: int
    evaluations: int
    triad: int
    processes: int
    compiles: bool = True


FULL = Scale(
    "full", 100_000, 100, 9,
    ((1, 100), (10, 100), (100, 100), (1_000, 100), (10_000, 100), (100_000, 100),
     (1_000_000, 100), (10_000_000, 25)),
    10_000, 10, 2_000, 1_000, 100_000, 10_000_000, 5,
)  # fmt: skip
QUICK = Scale(
    "quick", 50_000, 100, 5,
    ((1, 100), (10, 100), (100, 100), (1_000, 100), (10_000, 100), (100_000, 100)),
    2_000, 2, 400, 1_000, 10_000, 10_000_000, 1,
)  # fmt: skip
TINY = Scale("tiny", 20, 12, 2, ((1, 10), (5, 10)), 5, 1, 10, 5, 1, 1_000, 0, False)
