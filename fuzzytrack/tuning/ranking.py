"""Tuned trackers ranked on random tracks, tuned for each set of them and for all sets at once."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.published import TRACK_SETS, track_set
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.tuning.families import FAMILIES, Numbers
from fuzzytrack.tuning.objective import prediction_mse

__all__ = ["Ranked", "rank"]


@dataclass(frozen=True, eq=False)
class Ranked:
    """One family, measured.

    Attributes
    ----------
    name : str
        Of the family.
    own : dict of str to float
        RMSE in each set, tuned for it, in standard deviations of the noise.
    single : dict of str to float
        RMSE in each set, tuned once for all of them.
    own_change, single_change : float
        Relative change of the geometric mean over the sets against the reference family.
    single_error : float
        Standard error of `single_change`, from the spread over tracks.
    """

    name: str
    own: dict[str, float]
    single: dict[str, float]
    own_change: float
    single_change: float
    single_error: float

    def __repr__(self) -> str:
        return summary(self, "name", "own_change", "single_change", "own")


def rank(
    tuned: Mapping[str, Mapping[str, Numbers]],
    tracks: int,
    seed: int,
    reference: str = "fixed α-β",
    progress: Progress | None = None,
) -> list[Ranked]:
    """Measure families of trackers on fresh tracks.

    Parameters
    ----------
    tuned : mapping of str to mapping of str to numbers
        For each family, by name, its parameters for ``report``, ``mixed``, ``strong`` and ``all``;
        an empty mapping for one without parameters.
    tracks : int
        Number of tracks in each set.
    seed : int
        Seed of tracks and noise; different from that of the tuning.
    reference : str
        Family whose error the others are compared with.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    list of Ranked
        The best with a single tuning first.

    Raises
    ------
    ValueError
        If a family is unknown, or the reference is none of them.
    """
    for name in (reference, *tuned):
        if name not in FAMILIES or name not in tuned:
            raise ValueError(f"tuned: needs families out of {', '.join(FAMILIES)}; got {name!r}")
    sets = [track_set(name, tracks, seed) for name in TRACK_SETS]
    errors: dict[tuple[str, str], list[Array]] = {}
    for number, (name, numbers) in enumerate(tuned.items(), 1):
        for kind in ("own", "single"):
            errors[name, kind] = [
                prediction_mse(_made(name, numbers, kind, s.name), s, seed) for s in sets
            ]
        if progress is not None:
            progress(number / len(tuned))
    found = [_ranked(name, errors, reference) for name in tuned]
    return sorted(found, key=lambda each: each.single_change)


def _made(name: str, numbers: Mapping[str, Numbers], kind: str, set_name: str) -> Tracker:
    family = FAMILIES[name]
    return family.make(numbers[set_name if kind == "own" else "all"] if family.start else ())


def _ranked(name: str, errors: dict[tuple[str, str], list[Array]], reference: str) -> Ranked:
    def change(kind: str) -> tuple[float, float]:
        logs, variance = 0.0, 0.0
        for mine, theirs in zip(errors[name, kind], errors[reference, kind], strict=True):
            logs += math.log(mine.mean() / theirs.mean()) / 2
            # Delta method; both saw the same tracks, so the spread is that of the differences.
            spread = mine / mine.mean() - theirs / theirs.mean()
            variance += spread.var() / (4 * len(spread))
        sets = len(errors[name, kind])
        return math.exp(logs / sets) - 1, math.sqrt(variance) / sets

    def roots(kind: str) -> dict[str, float]:
        means = (math.sqrt(each.mean()) for each in errors[name, kind])
        return dict(zip(TRACK_SETS, means, strict=True))

    return Ranked(name, roots("own"), roots("single"), change("own")[0], *change("single"))
