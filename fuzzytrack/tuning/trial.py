"""Trials: trackers run on all tracks."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError, RuleBaseError
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.compilation import code_form, learn_code, sharing_code
from fuzzytrack.tuning.candidates import Candidates
from fuzzytrack.tuning.criteria import Criterion
from fuzzytrack.tuning.data import TuningData
from fuzzytrack.tuning.folds import Folds
from fuzzytrack.tuning.parameters import Numbers

__all__ = ["REFUSED", "Trials"]

#: Loss of numbers that make no tracker, or one that does not predict all plots.
REFUSED = 1e3

# A rule table is compiled to sums whose form depends on the order of its levels, so a search may
# meet trackers of a hundred forms. To compile one takes as long as to run so many coordinates in
# plain Python, and memory: it is compiled when more than that has been run of it, and there are no
# more than so many of them.
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
        Whether to compile what runs often, all trackers of a form as the same code.
    """

    data: TuningData
    folds: Folds
    criterion: Criterion
    compiled: bool

    def __repr__(self) -> str:
        return summary(self, "data", "compiled")

    def sums(
        self,
        candidates: Candidates,
        trials: Sequence[Numbers],
        progress: Progress | None = None,
    ) -> list[Array]:
        """Sums of the criterion over the plots of each unit, of the trackers with some numbers.

        Parameters
        ----------
        candidates : Candidates
        trials : sequence of Numbers
        progress : callable, optional
            Called with the share of the trials that are done.

        Returns
        -------
        list of ndarray, shape (n_units,)
            One for each trial; infinite if its numbers make no tracker, or one that does not
            predict all scored plots.
        """
        made = [_tracker(candidates, numbers) for numbers in trials]
        forms, n_axes, found = _forms(candidates.title), self.data.n_axes, []
        for tracker in made:
            with contextlib.ExitStack() as stack:
                if self.compiled and forms.runs_compiled(
                    tracker, n_axes, self.data.coordinates, made
                ):
                    stack.enter_context(sharing_code(tracker, n_axes, forms.code))
                found.append(self._sums(tracker))
            if progress is not None:
                progress(len(found) / len(made))
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


@dataclass(eq=False)
class _Forms:
    """The forms of the trackers of a family, and the code of those that run often.

    Attributes
    ----------
    code : SharedCode
    """

    code: SharedCode = field(default_factory=SharedCode)
    _coordinates: Counter[str | None] = field(default_factory=Counter)
    _last: dict[str | None, Tracker] = field(default_factory=dict)
    _compiled: set[str | None] = field(default_factory=set)

    def runs_compiled(
        self,
        tracker: Tracker | None,
        n_axes: int,
        coordinates: int,
        others: Sequence[Tracker | None],
    ) -> bool:
        """Whether a tracker runs so many coordinates through `code`; they are counted.

        Parameters
        ----------
        tracker : Tracker or None
        n_axes, coordinates : int
            Of the data.
        others : sequence of Tracker or None
            Trackers that run next.
        """
        if tracker is None:
            return False
        form = code_form(tracker, n_axes)
        if form is None:
            # Its code would be of use to no other one.
            return coordinates > _COORDINATES
        self._coordinates[form] += coordinates
        before = self._last.get(form)
        self._last[form] = tracker
        if form in self._compiled:
            return True
        rare = self._coordinates[form] <= _COORDINATES
        if rare or (len(self._compiled) >= _FORMS and coordinates <= _COORDINATES):
            return False
        self._compiled.add(form)
        # One code for all that differs between these; a later surprise is compiled anew.
        for each in (before, *others):
            learn_code(each, n_axes, self.code)
        return True


@cache
def _forms(title: str) -> _Forms:
    """Those of this process, for all trackers of a family that are tried."""
    return _Forms()
