"""A new track takes the identity of one that was lost nearby."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.clock import SCAN
from fuzzytrack.scan.identity.base import Identity, IdentityKernels, identities
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.process_noise import process_noise
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import ID, P11, P12, P22, TIME, VX, VY, X, Y

__all__ = ["Dormant"]

#: Tracks that are kept, numbers of each, and where the first one begins: after the number of
#: tracks that have ended.
_KEPT, _NUMBERS, _FIRST = 256, 10, 1
#: Columns of a track that are kept, after the scan in which it ended; 0 there says nobody.
_COLUMNS = (ID, TIME, X, Y, VX, VY, P11, P12, P22)


@identities.register("dormant")
@dataclass(frozen=True, repr=False)
class Dormant(Identity):
    """A track that is confirmed takes the identity of one that ended lately and fits.

    With the difference e of its position to the prediction of the old track, its variance S, and
    the difference w of velocities, it fits if ``|e|²/S + |w|²/(1 + (acceleration dt)²)`` is below
    the limit; the best one is taken. The last 256 tracks that have ended are kept.
    """

    source: ClassVar[str] = "first study, step 13: no effect on harbor radar"

    scans: int = parameter(12, "scans for which a track is kept", "scans", least=1, whole=True)
    limit: float = parameter(9.0, "largest squared distance", "", least=0, above=True)
    acceleration: float = parameter(0.117, "standard deviation of the acceleration of a target",
                                    "m/s²", least=0, above=True)  # fmt: skip

    @property
    def numbers(self) -> int:
        """Tracks that have ended."""
        return _FIRST + _KEPT * _NUMBERS

    def kernels(self, setting: Setting, at: int) -> IdentityKernels:
        """Kernels of this part."""
        scans, limit = float(self.scans), self.limit
        turn = self.acceleration * self.acceleration
        noise = process_noise(self.acceleration, setting.sensor.period)

        def end(tracks: Any, i: int, clock: Any, kept: Any) -> None:
            place = _FIRST + int(kept[0]) % _KEPT * _NUMBERS
            kept[0] += 1.0
            kept[place] = clock[SCAN] + 1.0
            for k in range(_NUMBERS - 1):
                kept[place + 1 + k] = tracks[i, _COLUMNS[k]]

        def apart(tracks: Any, i: int, kept: Any, at: int) -> float:
            """Squared distance of a track from the one whose columns are kept from a place on."""
            dt = tracks[i, TIME] - kept[at + 1]
            q11, _, _ = noise(dt)
            variance = kept[at + 6] + dt * (2.0 * kept[at + 7] + dt * kept[at + 8]) + q11
            variance += tracks[i, P11]
            dx = tracks[i, X] - kept[at + 2] - dt * kept[at + 4]
            dy = tracks[i, Y] - kept[at + 3] - dt * kept[at + 5]
            wx, wy = tracks[i, VX] - kept[at + 4], tracks[i, VY] - kept[at + 5]
            change = (wx * wx + wy * wy) / (1.0 + turn * dt * dt)
            square: float = (dx * dx + dy * dy) / variance + change
            return square

        def confirm(tracks: Any, i: int, clock: Any, kept: Any) -> float:
            best, least = -1, limit
            for k in range(_KEPT):
                place = _FIRST + k * _NUMBERS
                ended = kept[place]
                recent = ended > 0.0 and clock[SCAN] + 1.0 - ended <= scans
                if recent and kept[place + 2] < tracks[i, TIME]:
                    away = apart(tracks, i, kept, place + 1)
                    if away < least:
                        best, least = place, away
            if best < 0:
                return tracks[i, ID]  # type: ignore[no-any-return]
            kept[best] = 0.0
            return kept[best + 1]  # type: ignore[no-any-return]

        return IdentityKernels(end, confirm)
