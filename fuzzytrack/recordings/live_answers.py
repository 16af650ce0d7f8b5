"""What is answered to plots of a live feed: columns of values, in the order of its lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.reprs import summary

__all__ = ["REVISION", "AnswerPart", "Answers", "digests", "joined_answers", "taken"]

#: Column of how often an answer has been written again.
REVISION = "revision"


@dataclass(frozen=True, eq=False)
class Answers:
    """What is answered to some plots.

    Attributes
    ----------
    columns : dict of (sequence of str or ndarray)
        Values by the names of `TrackTable`, and `REVISION`, all of one length.
    lines : ndarray of int
        Line of the feed that each answers. Answers that a late plot has changed follow its own.
    """

    columns: dict[str, Any]
    lines: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, rows=len(self.lines))

    def __len__(self) -> int:
        """Number of answers."""
        return len(self.lines)


@dataclass(frozen=True, eq=False)
class AnswerPart:
    """Answers to some of the lines that came together, and where they belong among the others.

    Attributes
    ----------
    columns : dict of (sequence of str or ndarray)
        As of `Answers`.
    lines : ndarray of int
        Line of the feed that each answers, or that has changed it.
    order : ndarray of int
        Place among the answers of that line.
    """

    columns: dict[str, Any]
    lines: NDArray[np.int64]
    order: NDArray[np.int64]


def digests(columns: dict[str, Any], names: Sequence[str]) -> list[bytes]:
    """Digest of each answer, by the bits of its numbers; its identity and time do not change."""
    numbers = [columns[name] for name in names if isinstance(columns.get(name), np.ndarray)]
    table = np.column_stack([np.asarray(each, dtype=np.float64) for each in numbers])
    # A NaN may have other bits from run to run.
    table[np.isnan(table)] = math.nan
    return [blake2b(row.tobytes(), digest_size=8).digest() for row in table]


def taken(values: Any, places: NDArray[np.intp]) -> Any:
    """Some values of a column, an array or a sequence."""
    if isinstance(values, np.ndarray):
        return values[places]
    return [values[place] for place in places.tolist()]


def joined_answers(parts: Sequence[AnswerPart], names: Sequence[str]) -> Answers:
    """Answers of all parts in the order of the lines, after each line those that it has changed."""
    if not parts:
        return Answers({name: np.empty(0) for name in names}, np.empty(0, dtype=np.int64))
    if len(parts) == 1 and not parts[0].order.any():
        return Answers({name: parts[0].columns[name] for name in names}, parts[0].lines)
    lines = np.concatenate([part.lines for part in parts])
    order = np.lexsort((np.concatenate([part.order for part in parts]), lines))
    columns: dict[str, Any] = {}
    for name in names:
        values = [part.columns[name] for part in parts]
        if all(isinstance(each, np.ndarray) for each in values):
            columns[name] = np.concatenate(values)[order]
        else:
            every = [cell for each in values for cell in each]
            columns[name] = [every[place] for place in order.tolist()]
    return Answers(columns, lines[order])
