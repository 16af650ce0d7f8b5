"""How well tracks fit the truth: all metrics of one or more recordings, as table, picture, JSON."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.clock_lag import TrackLag
from fuzzytrack.scoring.metrics import METRICS, Settings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["GroupScores", "Scores"]


@dataclass(frozen=True, eq=False)
class GroupScores:
    """Metrics of one recording.

    Attributes
    ----------
    name : str
        Its group; empty if there is only one recording.
    metrics : dict of str to float
        By the names of `fuzzytrack.scoring.METRICS`.
    by_kind : dict of str to dict
        The same with the tracks of one kind only, against the whole truth; empty if tracks have
        no kind.
    time : ndarray, shape (n_instants,)
        The instants (s).
    curves : dict of str to ndarray, shape (n_instants,)
        OSPA, OSPA(2) and GOSPA with their parts, and the numbers of true objects, of tracks and of
        matched pairs (``n_true``, ``n_tracks``, ``n_matched``).
    objects, tracks : int
        True objects and tracks that are there at any of the instants.
    lag : float
        Time by which the clock of the tracks is late (s), which was taken off.
    fitted : TrackLag or None
        How that was found, if it was fitted.
    left_out : int
        Rows of tracks that were left out of all metrics but false-track times, since the truth does
        not list such objects.
    at_ends : int
        Instants before the first row of any track and after the last one, as far as the truth goes;
        0 if the instants were given.
    """

    name: str
    metrics: dict[str, float]
    by_kind: dict[str, dict[str, float]]
    time: Array
    curves: dict[str, Array]
    objects: int
    tracks: int
    lag: float = 0.0
    fitted: TrackLag | None = None
    left_out: int = 0
    at_ends: int = 0

    def __repr__(self) -> str:
        return summary(self, "name", "objects", "tracks", ospa=self.metrics["ospa"])

    def to_json_dict(self) -> dict[str, Any]:
        """The same in the types of JSON, without what is over time."""
        fitted = None if self.fitted is None else asdict(self.fitted)
        counts = {"objects": self.objects, "tracks": self.tracks, "instants": len(self.time)}
        more = {"by_kind": self.by_kind, "left_out": self.left_out, "at_ends": self.at_ends}
        lag = {"lag": self.lag, "fitted": fitted}
        return {"group": self.name, **counts, **lag, "metrics": self.metrics, **more}


@dataclass(frozen=True, eq=False)
class Scores:
    """How well tracks fit the truth.

    Attributes
    ----------
    groups : tuple of GroupScores
        One for each recording.
    settings : Settings
        Distances and lengths of the metrics.
    notes : tuple of str
        What was assumed, or left out, each in a sentence.
    """

    groups: tuple[GroupScores, ...]
    settings: Settings = field(default_factory=Settings)
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return summary(self, groups=len(self.groups), ospa=self["ospa"])

    def __getitem__(self, name: str) -> float:
        """A metric by its name: the mean over the recordings where it is a number."""
        if name not in METRICS:
            raise KeyError(f"{name!r}; expected one of {', '.join(METRICS)}")
        return self.means[name]

    @property
    def means(self) -> dict[str, float]:
        """Mean of each metric over the recordings where it is a number."""
        return _means([group.metrics for group in self.groups])

    @property
    def means_by_kind(self) -> dict[str, dict[str, float]]:
        """The same for the tracks of each kind."""
        kinds = dict.fromkeys(kind for group in self.groups for kind in group.by_kind)
        return {
            kind: _means([group.by_kind[kind] for group in self.groups if kind in group.by_kind])
            for kind in kinds
        }

    def to_json_dict(self) -> dict[str, Any]:
        """All metrics in the types of JSON."""
        units = {name: metric.unit for name, metric in METRICS.items() if metric.unit}
        return {
            "settings": asdict(self.settings),
            "mean": self.means,
            "mean_by_kind": self.means_by_kind,
            "groups": [group.to_json_dict() for group in self.groups],
            "units": units,
            "notes": list(self.notes),
        }

    def rows(self) -> list[tuple[str, str, str, list[float]]]:
        """Every metric as a row: its family, label and unit, and its value in each group."""
        return [
            (metric.family, metric.label, metric.unit, [g.metrics[name] for g in self.groups])
            for name, metric in METRICS.items()
        ]

    def plot(self, group: str | None = None) -> Figure:
        """Picture of a recording over time: OSPA with its parts, and the numbers of objects.

        Parameters
        ----------
        group : str, optional
            Name of the recording; the first one unless given.
        """
        from fuzzytrack.plotting import plot_scores

        return plot_scores(self, group)[0]

    def _repr_html_(self) -> str:
        """Table of all metrics, for notebooks."""
        several = len(self.groups) > 1
        names = [group.name for group in self.groups] if several else ["value"]
        rows = []
        for name, (family, label, unit, values) in zip(METRICS, self.rows(), strict=True):
            mean = [as_text(self.means[name])] if several else []
            rows.append(
                [family, f"{label} ({unit})" if unit else label, *map(as_text, values), *mean]
            )
        heads = ["", "metric", *names, *(["mean"] if several else [])]
        counts = ", ".join(
            f"{group.name + ': ' if several else ''}{counted(group.objects, 'object')} and "
            f"{counted(group.tracks, 'track')}"
            for group in self.groups
        )
        notes = "".join(paragraph(note, note=True) for note in self.notes)
        return block("Scores", paragraph(counts), table(heads, rows, words=2), notes)


def _means(values: list[dict[str, float]]) -> dict[str, float]:
    """Means over those that are numbers; NaN if none is."""
    found = {}
    for name in METRICS:
        each = np.array([value[name] for value in values], dtype=np.float64)
        known = each[~np.isnan(each)]
        found[name] = float(known.mean()) if len(known) else float("nan")
    return found
