"""Track-while-scan: from the plots of a radar, without identities, to tracks."""

from fuzzytrack.scan.part import Parameter, Part, Word, declared, parameter, parameters, word
from fuzzytrack.scan.scan import UNKNOWN_PLACE, Scan
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_reports import KINDS, STATUSES, TrackReports

__all__ = [
    "KINDS",
    "STATUSES",
    "UNKNOWN_PLACE",
    "Parameter",
    "Part",
    "Scan",
    "ScanResult",
    "ScanSession",
    "ScanTracker",
    "Sensor",
    "Setting",
    "TrackReports",
    "Word",
    "declared",
    "parameter",
    "parameters",
    "word",
]
