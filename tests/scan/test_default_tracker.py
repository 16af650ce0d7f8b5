"""The default scan tracker has the tracks of the reference machine, on real and random plots."""

import numpy as np
import pytest
from autoferry import LAGS, scans_of
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_machine import Numbers, ReferenceMachine

from fuzzytrack.scan import Scan, ScanTracker

#: Without the rule for merged plots, which the tracker leaves out: it changes no figure.
NUMBERS = Numbers(ks=0)


def assert_same_tracks(scans):
    session, machine = ScanTracker().start(), ReferenceMachine(NUMBERS)
    for scan in scans:
        reports, expected = session.step(scan), machine.step(scan)
        assert reports.track_id.tolist() == [track.id for track in expected]
        for row, track in enumerate(expected):
            time = track.last.t if track.misses == 0 else scan.time
            place, (p11, _, p22) = track.at(time, NUMBERS)
            np.testing.assert_allclose(reports.position[row], place, atol=1e-7)
            np.testing.assert_allclose(reports.velocity[row], track.v, atol=1e-7)
            deviation = np.sqrt([p11, p11, p22, p22])
            np.testing.assert_allclose(reports.deviation[row], deviation, rtol=1e-7)
            assert reports.plot[row] == track.plot
            assert reports.kind[row] == machine.kind_reported(track)
        assert session.n_tracks == len(machine.tracks)
    return session


@pytest.mark.parametrize("scenario", LAGS)
def test_recordings_of_a_harbor(scenario):
    assert_same_tracks(scans_of(scenario))


@settings(max_examples=10)
@given(
    seed=st.integers(0, 2**31),
    targets=st.integers(0, 4),
    clutter=st.integers(0, 6),
    own_times=st.booleans(),
    own_noise=st.booleans(),
)
def test_random_scans(seed, targets, clutter, own_times, own_noise):
    rng = np.random.default_rng(seed)
    start, velocity = rng.uniform(-200, 200, (targets, 2)), rng.normal(0, 3, (targets, 2))
    scans, time = [], 100.0
    for _ in range(20):
        before, time = time, time + rng.choice([0.4, 1.678, 1.7, 5.0])
        seen = rng.random(targets) < 0.85
        n = seen.sum() + rng.integers(clutter + 1)
        times = np.sort(rng.uniform(0.5 * (before + time), time, n))
        z = rng.uniform(-250, 250, (n, 2))
        moved = start + velocity * (time - 100.0)
        z[: seen.sum()] = moved[seen] + rng.normal(0, 0.7, (seen.sum(), 2))
        covariances = np.column_stack([np.full(n, 1.5), rng.normal(0, 0.2, n), np.full(n, 0.9)])
        scans.append(
            Scan(
                time,
                z,
                covariances=covariances if own_noise else None,
                times=times if own_times else None,
                own=(10.0, -20.0),
            )
        )
    assert_same_tracks(scans)
