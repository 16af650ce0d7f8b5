"""The benchmark of axes that are tracked apart, at a size of little meaning."""

import json
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module", autouse=True)
def the_script_can_be_imported():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield


def test_its_kalman_filter_is_that_of_the_package_where_the_axes_are_independent():
    from benchmarks import polar

    rng = np.random.default_rng(3)
    truth = polar.targets(4, 30.0, rng)
    z = truth + rng.normal(0, 60.0, truth.shape)
    covariance = np.broadcast_to(np.diag([60.0**2] * 2), (*truth.shape, 2))
    full = polar.full_covariance(z, covariance)
    apart = polar.apart("kalman-cv:sigma_v=2", z, covariance, np.eye(2))
    # They start in different ways.
    assert full[20:] == pytest.approx(apart[20:], abs=0.5)


def test_what_the_covariance_between_the_axes_is_worth():
    from benchmarks import polar

    found = polar.measure(100, 45.0, 0.3)
    gain = found["kalman-cv, x and y"] / found["full covariance"]
    assert 1.04 < gain < 1.13
    assert found["kalman-cv, along sight"] / found["full covariance"] < 1.03
    assert 1 < found["maneuver, x and y"] / found["maneuver, along sight"] < 1.05


def test_the_command(monkeypatch, tmp_path, capsys):
    from benchmarks import polar

    monkeypatch.setattr(polar, "NOISES", (0.1,))
    monkeypatch.setattr(polar, "AZIMUTHS", (45.0,))
    file = tmp_path / "polar.json"
    assert polar.main(["--tracks", "3", "--json", str(file)]) == 0
    (row,) = json.loads(file.read_text())
    assert row["azimuth"] == 45.0
    assert "full covariance" in capsys.readouterr().out
