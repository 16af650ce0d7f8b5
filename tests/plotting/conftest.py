import matplotlib
import numpy as np
import pytest
from lopsided import lopsided

import fuzzytrack as ft

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def tidy(monkeypatch):
    """No window before, none after, and nobody calls show."""
    from matplotlib import pyplot as plt

    monkeypatch.setattr(plt, "show", lambda *_, **__: pytest.fail("show was called"))
    plt.close("all")
    before = dict(matplotlib.rcParams)
    yield
    assert dict(matplotlib.rcParams) == before
    plt.close("all")


@pytest.fixture
def rules():
    return lopsided()


@pytest.fixture(scope="session")
def shipped():
    return ft.load_rulebase("stiffness-damping")


@pytest.fixture(scope="session")
def valve():
    return ft.load_rulebase("valve")


@pytest.fixture(scope="session")
def flight():
    """Times, truth and plots of one track with two axes; a gap at steps 8 and 9."""
    t = 2.0 * np.arange(20)
    truth = np.stack([30 * t, 5 * t + 0.4 * t**2], axis=-1)
    z = truth + np.random.default_rng(0).normal(0, 10, truth.shape)
    z[8:10] = np.nan
    return t, truth, z


@pytest.fixture(scope="session")
def tracker(shipped):
    return ft.AlphaBetaTracker(ft.FuzzyScheduler(shipped))


@pytest.fixture(scope="session")
def result(tracker, flight):
    t, _, z = flight
    return tracker.run(t, z)


@pytest.fixture(scope="session")
def batch(tracker, flight):
    """Six tracks of one target, of shape (2, 3)."""
    t, truth, _ = flight
    z = truth[:, None, None, :] + np.random.default_rng(3).normal(0, 9, (len(t), 2, 3, 2))
    z[5, 1, 2] = np.nan
    return tracker.run(t, z)
