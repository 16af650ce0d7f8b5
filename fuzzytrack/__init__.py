"""fuzzytrack: fuzzy-logic gain scheduling for α-β(-γ) trackers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzytrack.errors import DataError, NoRuleFiresWarning, PluginWarning, RuleBaseError
from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.gains.wdomain import alpha_beta_from_w, w_from_alpha_beta
from fuzzytrack.schedulers import FixedGains, FuzzyScheduler, GainScheduler
from fuzzytrack.trackers import AlphaBetaTracker, Gains, Tracker, TrackResult, TrackState

if TYPE_CHECKING:
    from fuzzytrack.plotting import (
        plot_gain_plane,
        plot_gain_surfaces,
        plot_memberships,
        plot_surface,
        plot_track,
    )

__version__ = "0.1.0"

__all__ = [
    "AlphaBetaTracker",
    "DataError",
    "FixedGains",
    "Fuzzification",
    "FuzzyScheduler",
    "FuzzySystem",
    "GainScheduler",
    "Gains",
    "NoRuleFiresWarning",
    "PluginWarning",
    "RuleBase",
    "RuleBaseError",
    "TrackResult",
    "TrackState",
    "Tracker",
    "__version__",
    "alpha_beta_from_w",
    "load_rulebase",
    "loads_rulebase",
    "plot_gain_plane",
    "plot_gain_surfaces",
    "plot_memberships",
    "plot_surface",
    "plot_track",
    "shipped_rulebases",
    "w_from_alpha_beta",
]


def __getattr__(name: str) -> Any:
    # Pictures need matplotlib, which is slow to import and absent where trackers run.
    if name.startswith("plot_") and name in __all__:
        from fuzzytrack import plotting

        return getattr(plotting, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
