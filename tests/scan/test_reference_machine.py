"""The reference machine has the figures of the study, so that it can judge the engine."""

import math

import numpy as np
import pytest
from autoferry import LAGS, ospa, scans_of, score
from reference_machine import ReferenceMachine

from fuzzytrack.scan import Scan


@pytest.mark.parametrize(
    ("truth", "tracks", "value"),
    [
        ([[0, 0]], [[3, 4]], 5.0),
        ([[0, 0]], [[300, 4]], 20.0),
        ([[0, 0], [100, 0]], [[0, 0]], math.sqrt(200.0)),
        ([[0, 0], [100, 0]], [[100, 6], [0, 8]], math.sqrt(50.0)),
        ([[0, 0]], [], 20.0),
        ([], [], math.nan),
    ],
)
def test_ospa_by_hand(truth, tracks, value):
    assert ospa(truth, tracks) == pytest.approx(value, nan_ok=True)


def tracked(machine, scans):
    return [
        {track.id: track.at(scan.time, machine.n)[0] for track in machine.step(scan)}
        for scan in scans
    ]


def test_two_boats_in_each_of_three_recordings():
    figures = {}
    for scenario in LAGS:
        scans = scans_of(scenario)
        figures[scenario] = score(scenario, tracked(ReferenceMachine(), scans))
    means = [figures[scenario][0] for scenario in LAGS]
    np.testing.assert_allclose(means, [3.84, 8.09, 3.96], atol=0.01)
    assert np.mean(means) < 5.5
    for _, near, switches, false in figures.values():
        assert near > 0.79
        assert switches == 0
        assert false == 0


def test_a_ship_alone_is_confirmed_and_a_shore_echo_is_not():
    rng = np.random.default_rng(0)
    machine, found = ReferenceMachine(), []
    for k in range(20):
        ship = [100.0 + 5.0 * k, 50.0]
        jumping = [-80.0 + rng.normal(0, 12), 60.0 + rng.normal(0, 12)]
        found = machine.step(Scan(1.678 * k, np.array([ship, jumping])))
    assert [track.id for track in found] == [1]
    np.testing.assert_allclose(found[0].p, [195.0, 50.0], atol=0.5)
    np.testing.assert_allclose(found[0].v, [5.0 / 1.678, 0.0], atol=0.1)
