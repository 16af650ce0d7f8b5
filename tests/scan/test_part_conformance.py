"""Every part of a scan tracker keeps the contract of its role: each check is a test."""

import pytest

from fuzzytrack.scan.scanners import load_scanner, shipped_scanners
from fuzzytrack.scan.scanners.roles import ROLES, parts
from fuzzytrack.testing import parametrize_with_checks

pytestmark = pytest.mark.untraced


def subjects():
    """Every part with its defaults, and with the numbers of every shipped configuration."""
    found = {f"{each.role} {each.name}": each.kind() for each in parts()}
    for name in shipped_scanners():
        tracker = load_scanner(name)
        for role in ROLES:
            part = getattr(tracker, role)
            if part not in found.values():
                found[f"{role} of {name}"] = part
    return found


@parametrize_with_checks(subjects())
def test_contract(check):
    check()


def test_no_part_is_left_out():
    of_roles = {name for role in ROLES for name in ROLES[role].built_in()}
    assert of_roles == {each.name for each in parts()}
