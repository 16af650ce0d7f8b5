"""All tracks are taken for moving ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.kind.base import MOVING, Kind, KindKernels, kinds
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import KIND, MOTION

__all__ = ["NoKind"]


@kinds.register("none")
@dataclass(frozen=True, repr=False)
class NoKind(Kind):
    """All tracks are taken for moving ones."""

    def kernels(self, setting: Setting, at: int) -> KindKernels:
        """Kernels of this part."""

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, KIND], tracks[i, MOTION] = MOVING, 0.0

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            pass

        def miss(tracks: Any, i: int, clock: Any) -> None:
            pass

        return KindKernels(start, hit, miss)
