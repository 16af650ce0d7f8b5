"""Conformance kit: checks that a plug-in keeps its contract, each with a name.

`check_scheduler`, `check_tracker` and `check_part` run all checks in one call,
`parametrize_with_checks` makes each of them a test of its own, and `checks_for` lists them.
"""

from fuzzytrack.testing.checks import (
    Check,
    check_part,
    check_scheduler,
    check_tracker,
    checks_for,
)
from fuzzytrack.testing.pytest_tests import parametrize_with_checks

__all__ = [
    "Check",
    "check_part",
    "check_scheduler",
    "check_tracker",
    "checks_for",
    "parametrize_with_checks",
]
