"""Trials: trackers run on all tracks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError, RuleBaseError
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.compilation import learn_code, sharing_code
from fuzzytrack.tuning.candidates import Candidates
from fuzzytrack.tuning.criteria import Criterion
from fuzzytrack.tuning.data import TuningData
from fuzzytrack.tuning.folds import Folds
from fuzzytrack.tuning.parameters import Numbers

__all__ = ["REFUSED", "Trials"]

#: Loss of numbers that make no tracker, or one that does not predict all plots.
REFUSED = 1e3

# A rule table is compiled to sums whose form depends on the order of its levels. If trackers of a
# family differ so in form, each is compiled by itself, which takes as long as running so many
# coordinates in plain Python, and memory; after so many of them the others run there.
_COORDINATES, _FORMS = 200_000, 24


@dataclass(frozen=True, eq=False)
class Trials:
    """Runs trackers on data; can be sent to another process.

    Parameters
    ----------
    data : TuningData
    folds : Folds
    criterion : Criterion
    compiled : bool
        Whether to run compiled, all trackers of a kind through the same code.
    """

    data: TuningData
    folds: Folds
    criterion: Criterion
    compiled: bool

    def __repr__(self) -> str:
        return summary(self, "data", "compiled")

    def sums(self, candidates: Candidates, trials: Sequence[Numbers]) -> list[Array]:
        """Sums of the criterion over the plots of each unit, of the trackers with some numbers.

        Parameters
        ----------
        candidates : Candidates
        trials : sequence of Numbers

        Returns
        -------
        list of ndarray, shape (n_units,)
            One for each trial; infinite if its numbers make no tracker, or one that does not
            predict all scored plots.
        """
        made = [_tracker(candidates, numbers) for numbers in trials]
        if not self.compiled:
            return [self._sums(tracker) for tracker in made]
        code, n_axes, found = _shared_code(candidates.title), self.data.n_axes, []
        if code.compilations > _FORMS and self.data.coordinates < _COORDINATES:
            return [self._sums(tracker) for tracker in made]
        if code.is_empty:
            # One code for all that differs between these; a later surprise is compiled anew.
            for tracker in made:
                learn_code(tracker, n_axes, code)
        for tracker in made:
            with sharing_code(tracker, n_axes, code):
                found.append(self._sums(tracker))
        return found

    def losses(self, candidates: Candidates, trials: Sequence[Numbers], held: int) -> list[float]:
        """Levels of trackers on all units but those of a fold; on all of them for -1."""
        trained = self.folds.fold != held
        found = (
            self.criterion.levels(sums, self.folds, trained)
            for sums in self.sums(candidates, trials)
        )
        return [loss if math.isfinite(loss) else REFUSED for loss in found]

    def _sums(self, tracker: Tracker | None) -> Array:
        if tracker is None:
            return np.full(len(self.folds.fold), math.inf)
        try:
            terms = [self.criterion.terms(tracker, batch) for batch in self.data.batches]
        except DataError:
            # A track that cannot be followed with numbers.
            return np.full(len(self.folds.fold), math.inf)
        return self.folds.by_unit(terms)


def _tracker(candidates: Candidates, numbers: Numbers) -> Tracker | None:
    try:
        return candidates.tracker(numbers)
    except (ValueError, RuleBaseError):
        return None


@cache
def _shared_code(title: str) -> SharedCode:
    """Compiled code of this process, for all trackers of a family that are tried."""
    return SharedCode()
