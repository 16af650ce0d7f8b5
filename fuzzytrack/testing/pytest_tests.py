"""Checks as tests of pytest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from fuzzytrack.scan.part import Part
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.testing.checks import checks_for
from fuzzytrack.trackers.base import Tracker

__all__ = ["parametrize_with_checks"]

Subject = GainScheduler | Tracker | Part


def parametrize_with_checks(subjects: Iterable[Subject] | Mapping[str, Subject]) -> Any:
    """Decorator of a test function: makes each check of each object a test of its own.

    Parameters
    ----------
    subjects : iterable of GainScheduler, Tracker or Part, or mapping
        The objects. The test of a check is called ``OBJECT-CHECK``, for example
        ``FixedGains-batch-equals-single``; the keys of a mapping stand in the place of the names of
        classes.

    Returns
    -------
    pytest.MarkDecorator
        The test function takes the argument ``check``, and calls it.

    Examples
    --------
    >>> from fuzzytrack import FixedGains
    >>> from fuzzytrack.testing import parametrize_with_checks
    >>> @parametrize_with_checks([FixedGains(0.5, 0.2)])
    ... def test_contract(check):
    ...     check()
    """
    import pytest

    named = subjects.items() if isinstance(subjects, Mapping) else _numbered(subjects)
    return pytest.mark.parametrize(
        "check",
        [
            pytest.param(check, id=f"{name}-{check.name}")
            for name, subject in named
            for check in checks_for(subject)
        ],
    )


def _numbered(subjects: Iterable[Subject]) -> Iterable[tuple[str, Subject]]:
    """Objects with the names of their classes, numbered from the second of a class on."""
    seen: Counter[str] = Counter()
    for subject in subjects:
        name = type(subject).__name__
        seen[name] += 1
        yield name if seen[name] == 1 else f"{name}-{seen[name]}", subject
