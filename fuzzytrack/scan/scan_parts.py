"""The parts of a scan tracker as one value."""

# Parts are frozen, so one can be the default of all trackers.
# ruff: noqa: RUF009

from __future__ import annotations

from dataclasses import dataclass, fields

from fuzzytrack.reprs import constructor_code
from fuzzytrack.scan.association import Association, OptimalAssociation
from fuzzytrack.scan.candidates import Candidates, GridCandidates
from fuzzytrack.scan.clutter import AdaptiveMap, Clutter
from fuzzytrack.scan.confirmation import Confirmation, Evidence
from fuzzytrack.scan.extraction import Extraction, NoExtraction
from fuzzytrack.scan.gate import CovarianceGate, Gate
from fuzzytrack.scan.identity import Identity, NoIdentity
from fuzzytrack.scan.initiation import Initiation, OnePoint
from fuzzytrack.scan.kind import HypothesisBank, Kind
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.quality import Existence, Quality
from fuzzytrack.scan.report import Recent, Report
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.track_columns import FIXED
from fuzzytrack.scan.update import Companion, Transient, Update

__all__ = ["ScanParts"]

#: Roles with a memory of each track, in the order of their columns.
_WITH_MEMORY = (
    "confirmation", "kind", "quality", "update", "gate", "initiation", "report", "identity",
    "clutter",
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class ScanParts:
    """The sensor, and one part of each role.

    Attributes
    ----------
    sensor : Sensor
        Noise, detection probability and period of the radar.
    extraction, clutter, candidates, gate, association, update : Part
        How plots are taken, how dense clutter is, which plots may be those of a track, and are,
        and what they do to it.
    quality, kind, initiation, confirmation, identity, report : Part
        How good a track is, whether it moves, how it begins, is confirmed and ends, which identity
        it has, and when it is reported.
    name : str
        Name of the configuration, for tables and messages.

    Raises
    ------
    TypeError
        If a part is not one of its role.
    """

    sensor: Sensor = Sensor()
    extraction: Extraction = NoExtraction()
    clutter: Clutter = AdaptiveMap()
    candidates: Candidates = GridCandidates()
    gate: Gate = CovarianceGate()
    association: Association = OptimalAssociation()
    update: Update = Transient()
    quality: Quality = Existence()
    kind: Kind = HypothesisBank()
    initiation: Initiation = OnePoint()
    confirmation: Confirmation = Evidence()
    identity: Identity = NoIdentity()
    report: Report = Recent()
    name: str = "default"

    def __post_init__(self) -> None:
        for role, base in _BASES.items():
            if not isinstance(getattr(self, role), base):
                raise TypeError(
                    f"{role}: needs a part that is a {base.__name__}, got {getattr(self, role)!r}"
                )

    def __repr__(self) -> str:
        return constructor_code(self)

    @classmethod
    def roles(cls) -> tuple[str, ...]:
        """Names of the roles of parts, in the order of the fields; the sensor is none."""
        return tuple(each.name for each in fields(cls) if each.name not in ("sensor", "name"))

    def places(self) -> dict[str, int]:
        """Column of the array of tracks at which the memory of each part begins."""
        found, at = {}, FIXED
        for role in _WITH_MEMORY:
            found[role] = at
            at += getattr(self, role).memory
        return found

    def companion(self) -> Companion | None:
        """What a session keeps for the update beside the array of tracks, if anything."""
        return self.update.companion(self.places()["update"])

    @property
    def merges_plots(self) -> bool:
        """Whether it makes one plot of several."""
        return self.extraction.merges

    def needing_own(self) -> tuple[str, ...]:
        """Roles whose part needs the position of the radar."""
        return tuple(role for role in self.roles() if getattr(self, role).needs_own)

    @property
    def width(self) -> int:
        """Columns of the array of tracks."""
        memory: int = sum(getattr(self, role).memory for role in _WITH_MEMORY)
        return FIXED + memory


_BASES: dict[str, type[Part]] = {
    "sensor": Sensor, "extraction": Extraction, "clutter": Clutter, "candidates": Candidates,
    "gate": Gate, "association": Association, "update": Update, "quality": Quality, "kind": Kind,
    "initiation": Initiation, "confirmation": Confirmation, "identity": Identity, "report": Report,
}  # fmt: skip
