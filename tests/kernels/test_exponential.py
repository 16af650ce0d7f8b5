import numpy as np
import pytest

from fuzzytrack.kernels.exponential import exponential


def test_it_is_that_of_numpy():
    x = np.concatenate([np.linspace(-300, 300, 6001), np.logspace(-18, 0, 50), [0.0, -0.0]])
    ours = np.array([exponential(value) for value in x.tolist()])
    assert ours == pytest.approx(np.exp(x), rel=2e-13)
    small = np.abs(x) < 10
    assert ours[small] == pytest.approx(np.exp(x[small]), rel=1e-14)
