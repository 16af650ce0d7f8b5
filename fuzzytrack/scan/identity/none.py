"""Each track is a new one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.identity.base import Identity, IdentityKernels, identities
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import ID

__all__ = ["NoIdentity"]


@identities.register("none")
@dataclass(frozen=True, repr=False)
class NoIdentity(Identity):
    """Each track is a new one."""

    def kernels(self, setting: Setting, at: int) -> IdentityKernels:
        """Kernels of this part."""

        def end(tracks: Any, i: int, clock: Any, kept: Any) -> None:
            pass

        def confirm(tracks: Any, i: int, clock: Any, kept: Any) -> float:
            return tracks[i, ID]  # type: ignore[no-any-return]

        return IdentityKernels(end, confirm)
