"""Marks of trackers in a table: which is best, and which are worse than the plots themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["BEST", "WORSE", "best_of", "marks_of"]

BEST, WORSE = "best", "worse"


def best_of(errors: ArrayLike) -> int | None:
    """Place of the least error, the first of several; None where there is no choice of two.

    Parameters
    ----------
    errors : array_like, shape (n_trackers,)
        NaN and infinite ones are never best.
    """
    each = np.asarray(errors, dtype=np.float64)
    if len(each) < 2 or not np.isfinite(each).any():
        return None
    return int(np.where(np.isfinite(each), each, np.inf).argmin())


def marks_of(errors: ArrayLike, own: ArrayLike, limit: float) -> list[str]:
    """Marks of trackers, one for each; empty for most.

    Parameters
    ----------
    errors : array_like, shape (n_trackers,)
        By which the best is found.
    own : array_like, shape (n_trackers,)
        What is compared with the limit.
    limit : float
        Error of the plots themselves; a tracker above it is worse than no tracker.
    """
    best = best_of(errors)
    each = np.asarray(own, dtype=np.float64)
    # NaN and infinity: the tracker has lost the target.
    worse = (each > limit) | ~np.isfinite(each)
    return [
        ", ".join(([BEST] if place == best else []) + ([WORSE] if bad else []))
        for place, bad in enumerate(worse.tolist())
    ]
