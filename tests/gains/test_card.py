import numpy as np
import pytest

from fuzzytrack.gains import gain_card, kalata
from fuzzytrack.gains.card import kalata_gains_at


def test_what_does_not_exist_is_none_or_left_out():
    unstable = gain_card(1.9, 3.0)
    assert (unstable["stable"], unstable["region"]) == (False, "unstable")
    assert unstable["reason"] == "2 alpha + beta must be below 4, and is 6.8"
    assert "noise_ratio" not in unstable
    assert gain_card(0.5, 0.7)["lag_per_jerk"] is None
    assert "covariance" not in gain_card(0.5, 0.7)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"dt": 0.0}, "dt: must be > 0, got 0"),
        ({"dt": np.inf}, "dt: must be > 0, got inf"),
        ({"sigma": -1.0}, "sigma: must be > 0, got -1"),
        ({"alpha": np.nan}, "alpha must be finite"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises(ValueError, match=message):
        gain_card(**{"alpha": 0.5, "beta": 0.7, **arguments})


@pytest.mark.parametrize("index", [0.01, 0.7, 9.0])
def test_kalatas_other_gains(index):
    alpha, beta = kalata(index, 2)
    assert kalata_gains_at(alpha)[0] == pytest.approx(beta, rel=1e-9)
    assert kalata_gains_at(kalata(index, 3)[0]) == pytest.approx(kalata(index, 3)[1:], rel=1e-9)
