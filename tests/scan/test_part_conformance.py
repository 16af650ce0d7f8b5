"""Every part of a scan tracker keeps the contract of its role: each check is a test."""

from dataclasses import fields, replace

import numpy as np
import pytest

from fuzzytrack.scan import ScanSession, ScanTracker, TrackReports
from fuzzytrack.scan.scan_pass import compiling_by_stage
from fuzzytrack.scan.scanners import load_scanner, shipped_scanners
from fuzzytrack.scan.scanners.roles import ROLES, parts
from fuzzytrack.testing import checks_for
from fuzzytrack.testing.part_samples import sample_scans

pytestmark = pytest.mark.untraced

# Compiled for each part by itself, it would take minutes: trackers of many parts are compared.
COMPILED = "compiled-equals-plain"


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


@pytest.mark.parametrize(
    "check",
    [
        pytest.param(check, id=f"{name}-{check.name}")
        for name, part in subjects().items()
        for check in checks_for(part)
        if check.name != COMPILED
    ],
)
def test_contract(check):
    check()


def of_roles():
    """Parts with their defaults, by role."""
    return {role: [each.kind() for each in parts() if each.role == role] for role in ROLES}


def combined():
    """Few trackers in which every part occurs: the first one of each role, the second one, ..."""
    found = of_roles()
    for k in range(max(map(len, found.values()))):
        chosen = {role: alike[k % len(alike)] for role, alike in found.items()}
        yield replace(ScanTracker(), **chosen)


def test_every_part_is_combined():
    trackers = list(combined())
    for role, alike in of_roles().items():
        assert {getattr(tracker, role) for tracker in trackers} == set(alike)
        assert any(check.name == COMPILED for part in alike for check in checks_for(part))


@pytest.mark.parametrize("tracker", list(combined()), ids=lambda each: type(each.quality).__name__)
def test_compiled_equals_plain(tracker):
    """To the last bit, of tracks that begin, are confirmed and end."""
    with compiling_by_stage():
        compiled = tracker.start()
    found, expected = (
        TrackReports.joined([session.step(scan, tentative=True) for scan in sample_scans(0)])
        for session in (compiled, ScanSession(tracker, plain=True))
    )
    assert np.ptp(found.status) > 0
    for each in fields(TrackReports):
        one, other = getattr(found, each.name), getattr(expected, each.name)
        np.testing.assert_array_equal(one, other, err_msg=each.name)


def test_no_part_is_left_out():
    built_in = {name for role in ROLES for name in ROLES[role].built_in()}
    assert built_in == {each.name for each in parts()}
