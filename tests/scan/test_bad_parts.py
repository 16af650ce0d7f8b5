"""Parts that break a promise: the check says which, and a session loses no track by them."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fuzzytrack.errors import PluginError
from fuzzytrack.scan.association import Association, AssociationKernels
from fuzzytrack.scan.gate import Gate, GateKernels
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.quality import Quality, QualityKernels
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.track_columns import SCORE
from fuzzytrack.testing import check_part, checks_for
from fuzzytrack.testing.part_samples import sample_scans


@dataclass(frozen=True, repr=False)
class Faulty(Association):
    """An association with a fault that can be chosen."""

    plain = True
    fault: float = parameter(0.0, "which fault", "", least=0, most=9)

    def kernels(self, setting):
        """One kernel pair, with the fault."""
        fault = int(self.fault)

        def cost(tracks, i, plots, j, distance, log_likelihood):
            return 1.0 if fault == 1 else -1.0

        def assign(rows, count, first, plot, cost, plot_of, track_of, integers, numbers):
            for i in range(rows):
                for e in range(first[i], first[i + 1]):
                    if plot_of[i] < 0 and (track_of[plot[e]] < 0 or fault == 2):
                        plot_of[i], track_of[plot[e]] = plot[e], i
            if fault == 3 and rows and count:
                plot_of[:], track_of[:] = -1, -1
                plot_of[0], track_of[count - 1] = count - 1, 0
            if fault == 4:
                raise KeyError("nothing")

        return AssociationKernels(cost, assign)


@dataclass(frozen=True, repr=False)
class Narrow(Gate):
    """A gate that refuses the plot at the predicted position."""

    def kernels(self, setting, at):
        """Kernels that accept nothing."""

        def reach(tracks, i, x, y, clock, variance):
            return 10.0

        def distance(tracks, i, plots, j, clock, dx, dy, s11, s12, s22):
            return -1.0 if dx == 0.0 else 1.0

        return GateKernels(reach, distance)


@dataclass(frozen=True, repr=False)
class Backwards(Quality):
    """A quality that falls with every plot."""

    size: float = 1.0

    def kernels(self, setting, at):
        """Kernels of the wrong sign."""

        def start(tracks, i, plots, j, clock):
            tracks[i, SCORE] = 0.0

        def hit(tracks, i, plots, j, clock):
            tracks[i, SCORE] -= 1.0

        def miss(tracks, i, clock):
            tracks[i, SCORE] += 1.0

        def existence(tracks, i):
            return 0.5

        return QualityKernels(start, hit, miss, existence)


def fails(part, name):
    """Message of the check of that name, which must fail."""
    (check,) = (check for check in checks_for(part) if check.name == name)
    with pytest.raises(AssertionError) as caught:
        check()
    return str(caught.value)


def test_a_good_one_passes_where_the_bad_ones_fail():
    for check in checks_for(Faulty()):
        check()


@pytest.mark.parametrize(
    ("part", "check", "message"),
    [
        (Faulty(1.0), "association-costs-are-gains", "cost must be finite and below 0"),
        (Faulty(2.0), "association-is-one-to-one", "must hold the same pairs"),
        (Faulty(3.0), "association-is-one-to-one", "pairs must be edges"),
        (Faulty(4.0), "association-is-one-to-one", "Faulty raises KeyError"),
        (Narrow(), "gate-accepts-own-plot", "at the predicted position must be accepted"),
        (Backwards(), "quality-goes-with-plots", "by a likely plot"),
        (Backwards(), "numbers-are-declared", "the field size must be declared"),
    ],
)
def test_a_broken_promise_is_named(part, check, message):
    text = fails(part, check)
    assert text.startswith(f"{check}: ")
    assert message in text


def test_what_is_no_part_is_refused():
    with pytest.raises(AssertionError, match="must be a part of a role"):
        check_part(ScanTracker().sensor)


def test_a_part_that_raises_is_named_and_loses_no_track():
    scans = sample_scans(0)
    good, bad = (replace(ScanTracker(), association=Faulty(fault)) for fault in (0.0, 4.0))
    session = ScanSession(good, plain=True)
    for scan in scans[:8]:
        session.step(scan)
    before, other = session.tracks(), pickle.loads(pickle.dumps(session))
    broken = ScanSession(bad, plain=True)
    broken._work = session._work
    with pytest.raises(PluginError, match=r"association Faulty: assign raised KeyError: 'nothing'"):
        broken.step(scans[8])
    session._work = broken._work
    assert broken.scans == 8
    for name in ("track_id", "position", "existence"):
        np.testing.assert_array_equal(getattr(session.tracks(), name), getattr(before, name))
    # It goes on as if nothing had been.
    for scan in scans[8:]:
        one, two = session.step(scan), other.step(scan)
        np.testing.assert_array_equal(one.position, two.position)
