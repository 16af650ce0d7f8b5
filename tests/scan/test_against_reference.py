"""The default scan tracker does what the reference machine does, track by track."""

import dataclasses

import numpy as np
import pytest
from autoferry import LAGS, scans_of, score
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_machine import Numbers, ReferenceMachine
from scenes import scene

from fuzzytrack.scan import KINDS, STATUSES, UNKNOWN_PLACE, ScanTracker
from fuzzytrack.scan.association import OptimalAssociation
from fuzzytrack.scan.clutter import AdaptiveMap
from fuzzytrack.scan.confirmation import Evidence
from fuzzytrack.scan.gate import CovarianceGate
from fuzzytrack.scan.initiation import OnePoint
from fuzzytrack.scan.kind import HypothesisBank
from fuzzytrack.scan.quality import Existence
from fuzzytrack.scan.report import Recent
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.update import Transient

# The engine has no hypothesis of merged plots.
NUMBERS = Numbers(ks=0)


def compare(scans, numbers=NUMBERS, session=None):
    """Compare all live tracks after each scan; how many were reported."""
    session = session or ScanTracker().start()
    machine, reported = ReferenceMachine(numbers), 0
    for scan in scans:
        shown = machine.step(scan)
        reports, live = session.step(scan), session.tracks()
        reported += len(shown)
        assert reports.track_id.tolist() == [track.id for track in shown]
        assert reports.kind.tolist() == [machine.kind_reported(track) for track in shown]
        assert live.track_id.tolist() == [track.id for track in machine.tracks]
        for row, track in enumerate(machine.tracks):
            time = scan.time if track.plot < 0 else track.last.t
            position, variances = track.at(time, numbers)
            np.testing.assert_allclose(live.position[row], position, rtol=0, atol=1e-6)
            np.testing.assert_allclose(live.velocity[row], track.v, rtol=0, atol=1e-6)
            deviations = np.sqrt(np.take(variances, [0, 0, 2, 2]))
            np.testing.assert_allclose(live.deviation[row], deviations, rtol=1e-6)
            existence = 1.0 / (1.0 + np.exp(-track.existence))
            np.testing.assert_allclose(live.existence[row], existence, rtol=1e-6)
            assert live.time[row] == time
            assert live.plot[row] == track.plot
            assert live.kind[row] == machine.kind_reported(track)
            status = "tentative"
            if track.confirmed:
                status = "confirmed" if track.misses == 0 else "coasting"
            assert STATUSES[live.status[row]] == status
    x, y = scans[-1].positions.mean(axis=0) if len(scans[-1]) else (0.0, 0.0)
    density = session.clutter_density([x, x + 40], [y, y - 70])
    expected = [machine.density_at(np.array(place)) for place in ((x, y), (x + 40, y - 70))]
    np.testing.assert_allclose(density, expected, rtol=1e-6)
    return reported


def test_words_of_kinds_are_those_of_the_reference():
    assert KINDS == ("undecided", "moving", "static")


@pytest.mark.parametrize("seed", range(12))
def test_scenes(seed):
    assert compare(scene(seed)) > 0


@pytest.mark.parametrize("seed", range(6))
def test_plots_with_times_and_covariances_of_their_own(seed):
    assert compare(scene(100 + seed, own_times=True)) > 0
    assert compare(scene(200 + seed, covariances=True)) > 0
    assert compare(scene(300 + seed, own_times=True, covariances=True)) > 0


@pytest.mark.parametrize("seed", range(3))
def test_a_radar_whose_place_is_not_known(seed):
    scans = [dataclasses.replace(each, own=UNKNOWN_PLACE) for each in scene(400 + seed)]
    assert compare(scans) > 0


@pytest.mark.untraced
@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    ships=st.integers(2, 12),
    clutter=st.floats(0, 12),
    side=st.floats(150, 600),
)
def test_any_scene(seed, ships, clutter, side):
    compare(scene(seed, scans=15, ships=ships, clutter=clutter, side=side))


@settings(max_examples=5, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), factors=st.lists(st.floats(0.5, 2.0), min_size=12, max_size=12)
)
def test_other_parameters(seed, factors):
    """Each number of the study is the parameter of a part that it is said to be."""
    names = ("sr", "saz", "sext", "qa", "sv0", "tau", "wc", "h", "w0", "sst", "srw", "kr")
    changed = {name: getattr(Numbers, name) * f for name, f in zip(names, factors, strict=True)}
    changed["w0"] = min(changed["w0"], 1.0)
    changed["wc"] = min(changed["wc"], 1.0)
    numbers = dataclasses.replace(NUMBERS, kap=0.8, wl=2.0, tst=0.0, lcs=3.0, hstat=5, **changed)
    session = ScanSession(with_numbers(numbers), plain=True)
    compare(scene(seed, scans=8, ships=3), numbers, session)


def with_numbers(n):
    """Scan tracker with the numbers of the reference."""
    return ScanTracker(
        sensor=Sensor(n.sr, n.saz, n.sext, n.pd, n.period),
        clutter=AdaptiveMap(n.lam0, n.n0, n.tau, n.wc, n.h, n.wl, n.w0, n.wsh),
        gate=CovarianceGate(n.gate),
        association=OptimalAssociation(n.bonus),
        update=Transient(n.qa),
        quality=Existence(n.ps, n.lb, n.lmax),
        kind=HypothesisBank(
            n.sst, n.slo, n.srw, n.sar, n.sac, n.ff2, n.kap, n.tm, n.chilo, n.kr, n.lhr, n.tst,
            n.lcs, n.hstat, n.rest,
        ),
        initiation=OnePoint(n.sv0, n.vmax),
        confirmation=Evidence(n.lc, n.minhit, n.lc2, n.wb, n.le, n.ld, n.kt, n.k),
        report=Recent(n.kc, n.lrep),
    )  # fmt: skip


def test_default_values_are_those_of_the_study():
    assert with_numbers(Numbers()) == ScanTracker()


@pytest.mark.parametrize("scenario", LAGS)
def test_recorded_plots(scenario):
    assert compare(scans_of(scenario)) > 50


def test_figures_on_recorded_plots():
    means = []
    for scenario in LAGS:
        scans = scans_of(scenario)
        result = ScanTracker().run(scans)
        tracked = [{} for _ in scans]
        for row in range(len(result.reports)):
            report = result.reports
            tracked[report.scan[row]][int(report.track_id[row])] = report.position[row]
        ospa, near, switches, false = score(scenario, tracked)
        means.append(ospa)
        assert near > 0.79
        assert switches == 0
        assert false == 0
    assert np.mean(means) < 5.5
