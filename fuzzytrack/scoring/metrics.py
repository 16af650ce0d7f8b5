"""All metrics of a scene, by name, and what each of them means."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.scoring.clear_mot import clear_mot
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.gospa import gospa
from fuzzytrack.scoring.hota import hota
from fuzzytrack.scoring.idf1 import idf1
from fuzzytrack.scoring.ospa import SetAssignment, ospa
from fuzzytrack.scoring.ospa2 import ospa2
from fuzzytrack.scoring.scored_scene import ScoredScene
from fuzzytrack.scoring.siap import nearest_objects, siap
from fuzzytrack.scoring.track_life import track_life

__all__ = ["METRICS", "Metric", "Settings", "evaluate", "of_kind"]


@dataclass(frozen=True)
class Metric:
    """A number that says how well tracks fit the truth.

    Attributes
    ----------
    family : str
        To which metrics it belongs.
    label : str
        What a table calls it.
    unit : str
        Its unit; empty if it has none.
    best : {"least", "most", "one"}
        Which values are good; of ambiguity it is 1.
    """

    family: str
    label: str
    unit: str = ""
    best: str = "least"


#: Every metric by its name, in the order of tables.
METRICS = {
    "ospa": Metric("OSPA", "OSPA", "m"),
    "ospa_localization": Metric("OSPA", "localization", "m"),
    "ospa_cardinality": Metric("OSPA", "cardinality", "m"),
    "ospa2": Metric("OSPA(2)", "OSPA(2)", "m"),
    "ospa2_localization": Metric("OSPA(2)", "localization", "m"),
    "ospa2_cardinality": Metric("OSPA(2)", "cardinality", "m"),
    "gospa": Metric("GOSPA", "GOSPA", "m"),
    "gospa_localization": Metric("GOSPA", "localization", "m"),
    "gospa_missed": Metric("GOSPA", "missed objects"),
    "gospa_false": Metric("GOSPA", "false tracks"),
    "share_tracked": Metric("tracks", "share tracked", best="most"),
    "first_match": Metric("tracks", "time to first match", "s"),
    "never_matched": Metric("tracks", "objects never matched"),
    "breaks": Metric("tracks", "breaks an object"),
    "switches": Metric("tracks", "switches an object"),
    "rmse": Metric("tracks", "RMSE of matched", "m"),
    "false_time": Metric("tracks", "false-track time", "s"),
    "false_per_minute": Metric("tracks", "false", "s/min"),
    "moving_false_per_minute": Metric("tracks", "moving false", "s/min"),
    "static_false_per_minute": Metric("tracks", "static false", "s/min"),
    "redundant_per_minute": Metric("tracks", "redundant", "s/min"),
    "completeness": Metric("SIAP", "completeness", best="most"),
    "ambiguity": Metric("SIAP", "ambiguity", best="one"),
    "spuriousness": Metric("SIAP", "spuriousness"),
    "position_accuracy": Metric("SIAP", "position accuracy", "m"),
    "velocity_accuracy": Metric("SIAP", "velocity accuracy", "m/s"),
    "rate_of_number_changes": Metric("SIAP", "number changes", "1/s"),
    "longest_segment": Metric("SIAP", "longest segment", best="most"),
    "mota": Metric("CLEAR MOT", "MOTA", best="most"),
    "motp": Metric("CLEAR MOT", "MOTP", "m"),
    "misses": Metric("CLEAR MOT", "misses"),
    "false_positives": Metric("CLEAR MOT", "false positives"),
    "identity_switches": Metric("CLEAR MOT", "switches"),
    "fragmentations": Metric("CLEAR MOT", "fragmentations"),
    "idf1": Metric("identity", "IDF1", best="most"),
    "idp": Metric("identity", "IDP", best="most"),
    "idr": Metric("identity", "IDR", best="most"),
    "hota": Metric("HOTA", "HOTA", best="most"),
    "det_a": Metric("HOTA", "DetA", best="most"),
    "ass_a": Metric("HOTA", "AssA", best="most"),
    "loc_a": Metric("HOTA", "LocA", best="most"),
}


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Distances and lengths of the metrics.

    Attributes
    ----------
    cutoff : float
        Cut-off c of OSPA, OSPA(2) and GOSPA, and distance at which the similarity of HOTA is 0 (m).
        Tracks that are farther than this from every true object are false.
    order : float
        Order p of OSPA, OSPA(2) and GOSPA; at least 1.
    within : float
        Largest distance of a track from its true object (m), for the share tracked, the time to the
        first match, breaks and switches.
    match : float, optional
        The same for CLEAR MOT, IDF1 and SIAP; as `within` unless given.
    window : int
        Instants of a window of OSPA(2).
    """

    cutoff: float = 20.0
    order: float = 2.0
    within: float = 15.0
    match: float | None = None
    window: int = 10

    def __post_init__(self) -> None:
        for name in ("cutoff", "within", "match"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ValueError(f"{name}: must be a finite distance > 0 m, got {value:g}")
        if not 1 <= self.order < math.inf:
            raise ValueError(f"order: must be at least 1 and finite, got {self.order:g}")
        if self.window < 1 or self.window != int(self.window):
            raise ValueError(f"window: must be a whole number of instants >= 1, got {self.window}")
        if self.match is None:
            object.__setattr__(self, "match", self.within)

    @property
    def reach(self) -> float:
        """Largest distance that any metric looks at (m)."""
        assert self.match is not None
        return max(self.cutoff, self.within, self.match)


def evaluate(scene: ScoredScene, settings: Settings) -> tuple[dict[str, float], dict[str, Array]]:
    """Every metric of a scene, and what is shown of it over time.

    Parameters
    ----------
    scene : ScoredScene
    settings : Settings

    Returns
    -------
    metrics : dict of str to float
        By the names of `METRICS`; those that are over time are means over the instants.
    curves : dict of str to ndarray, shape (n_instants,)
        Those of OSPA, OSPA(2) and GOSPA by the same names; ``n_true``, ``n_tracks`` and
        ``n_matched``, the pairs nearer than `Settings.within`.
    """
    pairs = ClosePairs.of(scene, settings.reach)
    curves = _sets(scene, pairs, settings)
    values = {name: float(curve.mean()) for name, curve in curves.items()}
    held = Correspondences.of(scene, pairs, settings.within)
    assert settings.match is not None
    matched = held
    if settings.match != settings.within:
        matched = Correspondences.of(scene, pairs, settings.match)
    clear = clear_mot(scene, matched)
    near = np.zeros(len(scene.tracks), dtype=np.bool_)
    near[pairs.within(settings.cutoff).track_row] = True
    values |= vars(track_life(scene, held, near))
    values |= vars(siap(scene, nearest_objects(pairs, settings.match)))
    values |= {**vars(clear), "switches": values["switches"], "identity_switches": clear.switches}
    values |= vars(idf1(scene, pairs, settings.match))
    values |= {k: v for k, v in vars(hota(scene, pairs, settings.cutoff)).items() if k in METRICS}
    curves["n_true"] = scene.n_true.astype(float)
    curves["n_tracks"] = scene.n_tracks.astype(float)
    numbers = np.bincount(held.pairs.instant, minlength=len(scene.time))
    curves["n_matched"] = numbers.astype(float)
    return {name: float(values[name]) for name in METRICS}, curves


def _sets(scene: ScoredScene, pairs: ClosePairs, settings: Settings) -> dict[str, Array]:
    """Distances between sets, and their parts, over time."""
    found: dict[str, Array] = {}
    assigned = SetAssignment.of(scene, pairs, settings.cutoff, settings.order)
    whole = ospa2(scene, pairs, settings.cutoff, settings.order, settings.window)
    for name, value in (("ospa", ospa(assigned)), ("ospa2", whole), ("gospa", gospa(assigned))):
        parts = dict(vars(value))
        found[name] = parts.pop("distance")
        found |= {f"{name}_{part}": curve for part, curve in parts.items()}
    return found


def of_kind(scene: ScoredScene, kind: int) -> ScoredScene:
    """The scene with the tracks of one kind only, by its number."""
    assert scene.tracks.kind is not None
    return replace(scene, tracks=scene.tracks.where(scene.tracks.kind == kind))
