"""Track-while-scan: from the plots of a radar, without identities, to tracks."""

from fuzzytrack.scan.part import Parameter, Part, Word, declared, parameter, parameters, word
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS, STATUSES, TrackReports

__all__ = [
    "KINDS",
    "STATUSES",
    "Parameter",
    "Part",
    "Scan",
    "TrackReports",
    "Word",
    "declared",
    "parameter",
    "parameters",
    "word",
]
