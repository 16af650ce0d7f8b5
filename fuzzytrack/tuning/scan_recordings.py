"""Scans with their truth, on which scan trackers are tuned."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scoring import GroupScores, Positions, score

__all__ = ["ScanRecording"]


@dataclass(frozen=True, eq=False)
class ScanRecording:
    """Scans of one recording, or of one run of a simulation, with what is true.

    Parameters
    ----------
    name : str
        Name of the recording.
    scans : sequence of Scan
        At least two.
    truth : tuple (time, id, position)
        True positions: times (s), identities, and positions (m), shape (n, 2).
    group : str
        Recordings of one group count together, as runs of one scene do, and are held out together;
        the name unless given.
    lag : float, "auto" or None
        Time by which the clock of the plots is late against that of the truth (s); "auto" fits it
        once, with the tracks of the configuration where a search begins.
    moving_above : float, optional
        If the truth lists moving objects only: speed (m/s), from the first to the last row of a
        track, above which it is moving. Tracks that are not, and are far from all true objects, do
        not count. The kind that a tracker gives does not decide, so that a search cannot change
        what is judged.
    """

    name: str
    scans: Sequence[Scan]
    truth: tuple[Array, NDArray[Any], Array]
    group: str = ""
    lag: float | Literal["auto"] | None = None
    moving_above: float | None = None
    times: Array = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "scans", tuple(self.scans))
        object.__setattr__(self, "group", self.group or self.name)
        object.__setattr__(self, "times", np.array([scan.time for scan in self.scans]))
        if len(self.scans) < 2:
            raise DataError(f"{self.name}: {len(self.scans)} scans; tuning needs two at least")
        if not len(self.truth[0]):
            raise DataError(f"{self.name}: no true position; tuning needs the truth")

    def __repr__(self) -> str:
        return summary(self, "name", "group", scans=len(self.scans))

    def metrics(self, result: ScanResult, lag: float | None = None) -> dict[str, float]:
        """All metrics of tracks; see `fuzzytrack.scoring.score`.

        Parameters
        ----------
        result : ScanResult
            What a tracker made of the scans.
        lag : float, optional
            Lag of the plots, where it was fitted.
        """
        return self.scores(result, self.lag if lag is None else lag).metrics

    def scores(self, result: ScanResult, lag: float | Literal["auto"] | None) -> GroupScores:
        """Scores of tracks, with a lag that is given or fitted."""
        tracks = replace(Positions.of(result, "tracks"), kind=None)
        lists: Literal["all", "moving"] = "all" if self.moving_above is None else "moving"
        found = score(
            tracks,
            self.truth,
            lag=lag,
            scans=self.times,
            truth_lists=lists,
            moving_above=self.moving_above,
        )
        return found.groups[0]

    @property
    def digest(self) -> str:
        """Digest of plots and truth."""
        found = hashlib.sha256()
        for scan in self.scans:
            found.update(np.array([scan.time, *scan.own]).tobytes())
            for values in (scan.positions, scan.covariances, scan.times):
                found.update(b"-" if values is None else np.ascontiguousarray(values).tobytes())
        for values in (self.truth[0], self.truth[2]):
            found.update(np.ascontiguousarray(values).tobytes())
        found.update(f"{self.group} {self.lag} {self.moving_above}".encode())
        return found.hexdigest()[:16]
