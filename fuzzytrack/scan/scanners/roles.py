"""The roles of a scan tracker: what each does, and where its parts are registered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.association.base import associations
from fuzzytrack.scan.candidates.base import candidates
from fuzzytrack.scan.clutter.base import clutters
from fuzzytrack.scan.confirmation.base import confirmations
from fuzzytrack.scan.extraction.base import extractions
from fuzzytrack.scan.gate.base import gates
from fuzzytrack.scan.identity.base import identities
from fuzzytrack.scan.initiation.base import initiations
from fuzzytrack.scan.kind.base import kinds
from fuzzytrack.scan.part import Part, declared
from fuzzytrack.scan.quality.base import qualities
from fuzzytrack.scan.report.base import reports
from fuzzytrack.scan.scanners.reader import SENSOR, Roles
from fuzzytrack.scan.update.base import updates

__all__ = ["MEANINGS", "ROLES", "CatalogPart", "parts"]

#: For each role the registry of its parts, in the order of a scan.
ROLES: Roles = {
    "extraction": extractions,
    "clutter": clutters,
    "candidates": candidates,
    "gate": gates,
    "association": associations,
    "update": updates,
    "quality": qualities,
    "kind": kinds,
    "initiation": initiations,
    "confirmation": confirmations,
    "identity": identities,
    "report": reports,
}

#: What the sensor and each role do.
MEANINGS = {
    SENSOR: "How exact plots are, how often a target is seen, how long a scan takes.",
    "extraction": "Which plots of a scan are used, and which are one.",
    "clutter": "How dense clutter is at a plot.",
    "candidates": "How the plots near a track are found.",
    "gate": "Whether a plot may be that of a track.",
    "association": "Which plot is that of which track.",
    "update": "How a track moves, and how a plot corrects it.",
    "quality": "A number that says how good a track is.",
    "kind": "Whether a track moves, is static, or neither is sure.",
    "initiation": "How tracks begin.",
    "confirmation": "When a tentative track is confirmed, and when a track ends.",
    "identity": "Whether a new track is one that was lost.",
    "report": "Which confirmed tracks are reported.",
}


@dataclass(frozen=True)
class CatalogPart:
    """A part that has a name.

    Attributes
    ----------
    role : str
    name : str
    kind : type of Part
    source : str
        Where it comes from: a paper, or what was measured.
    package : str
        Package that it comes from; for a script, its file.
    """

    role: str
    name: str
    kind: type[Part]
    source: str
    package: str

    def numbers(self) -> dict[str, dict[str, Any]]:
        """Declared numbers and words: meaning, unit, what is allowed, and the default."""
        default = self.kind()
        return {
            key: {
                "meaning": meant.meaning,
                "unit": getattr(meant, "unit", ""),
                "allowed": meant.allowed,
                "default": getattr(default, key),
            }
            for key, meant in declared(self.kind).items()
        }


def parts() -> tuple[CatalogPart, ...]:
    """All parts that have a name, those of plug-ins included, by role."""
    return tuple(
        CatalogPart(role, plugin.name, plugin.factory, plugin.source, plugin.package)
        for role, registry in ROLES.items()
        for plugin in registry
        if isinstance(plugin.factory, type)
    )
