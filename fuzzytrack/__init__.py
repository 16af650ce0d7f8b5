"""fuzzytrack: fuzzy-logic gain scheduling for α-β(-γ) trackers."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fuzzytrack.version import __version__

# For type checkers and editors; at run time a name is imported when it is first used, so that
# `import fuzzytrack` is fast, and only what a program uses is loaded.
if TYPE_CHECKING:
    from fuzzytrack.errors import (
        CacheWarning,
        DataError,
        NoRuleFiresWarning,
        PluginWarning,
        PrecisionWarning,
        RuleBaseError,
        ScannerError,
        TrackWarning,
    )
    from fuzzytrack.fuzzy.fuzzification import Fuzzification
    from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, shipped_rulebases
    from fuzzytrack.fuzzy.rulebase import RuleBase
    from fuzzytrack.fuzzy.system import FuzzySystem
    from fuzzytrack.gains.wdomain import alpha_beta_from_w, w_from_alpha_beta
    from fuzzytrack.plotting import (
        plot_gain_plane,
        plot_gain_surfaces,
        plot_memberships,
        plot_surface,
        plot_track,
    )
    from fuzzytrack.recordings.scanning import ScannedRecording, track_scans
    from fuzzytrack.recordings.tracking import TrackedRecording, track
    from fuzzytrack.scan.scanners import load_scanner, shipped_scanners
    from fuzzytrack.schedulers import FixedGains, FuzzyScheduler, GainScheduler
    from fuzzytrack.schedulers.reachable_gains import certify
    from fuzzytrack.scoring.score_tracks import score
    from fuzzytrack.scoring.scores import Scores
    from fuzzytrack.trackers import AlphaBetaTracker, Gains, Tracker, TrackResult, TrackState
    from fuzzytrack.tuning.tuner import tune

__all__ = [
    "AlphaBetaTracker",
    "CacheWarning",
    "DataError",
    "FixedGains",
    "Fuzzification",
    "FuzzyScheduler",
    "FuzzySystem",
    "GainScheduler",
    "Gains",
    "NoRuleFiresWarning",
    "PluginWarning",
    "PrecisionWarning",
    "RuleBase",
    "RuleBaseError",
    "ScannedRecording",
    "ScannerError",
    "Scores",
    "TrackResult",
    "TrackState",
    "TrackWarning",
    "TrackedRecording",
    "Tracker",
    "__version__",
    "alpha_beta_from_w",
    "certify",
    "load_rulebase",
    "load_scanner",
    "loads_rulebase",
    "plot_gain_plane",
    "plot_gain_surfaces",
    "plot_memberships",
    "plot_surface",
    "plot_track",
    "score",
    "shipped_rulebases",
    "shipped_scanners",
    "track",
    "track_scans",
    "tune",
    "w_from_alpha_beta",
]

_HOMES = {
    "errors": (
        "CacheWarning",
        "DataError",
        "NoRuleFiresWarning",
        "PluginWarning",
        "PrecisionWarning",
        "RuleBaseError",
        "ScannerError",
        "TrackWarning",
    ),
    "fuzzy.fuzzification": ("Fuzzification",),
    "fuzzy.loading": ("load_rulebase", "loads_rulebase", "shipped_rulebases"),
    "fuzzy.rulebase": ("RuleBase",),
    "fuzzy.system": ("FuzzySystem",),
    "gains.wdomain": ("alpha_beta_from_w", "w_from_alpha_beta"),
    "plotting": (
        "plot_gain_plane",
        "plot_gain_surfaces",
        "plot_memberships",
        "plot_surface",
        "plot_track",
    ),
    "recordings.scanning": ("ScannedRecording", "track_scans"),
    "recordings.tracking": ("TrackedRecording", "track"),
    "scan.scanners": ("load_scanner", "shipped_scanners"),
    "schedulers": ("FixedGains", "FuzzyScheduler", "GainScheduler"),
    "schedulers.reachable_gains": ("certify",),
    "scoring.score_tracks": ("score",),
    "scoring.scores": ("Scores",),
    "trackers": ("AlphaBetaTracker", "Gains", "TrackResult", "TrackState", "Tracker"),
    "tuning.tuner": ("tune",),
}
_HOME = {name: f"fuzzytrack.{home}" for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(importlib.import_module(_HOME[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
