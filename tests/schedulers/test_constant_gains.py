import pickle

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.gains import resampled_gains
from fuzzytrack.schedulers import BenedictBordner, FadingMemory

SCHEDULERS = [
    ft.FixedGains(0.5, 0.7, period=4),
    ft.FixedGains(0.5, 0.4, 0.1, period=0.3),
    FadingMemory(0.6, period=4),
    FadingMemory(0.6, order=2, period=4),
    BenedictBordner(0.4, period=4),
]


def gains_at(scheduler, dt):
    return scheduler.kernel(1)(5.0, -2.0, dt, 1.0, ())[:3]


def own_gains(scheduler):
    return gains_at(type(scheduler)(**{**vars(scheduler), "period": None}), 1.0)


@pytest.mark.parametrize("scheduler", SCHEDULERS, ids=repr)
def test_gains_are_those_of_the_same_filter_at_the_time_step(scheduler):
    given = own_gains(scheduler)
    assert gains_at(scheduler, float(scheduler.period)) == given
    for dt in (0.01, 1.7, 60.0):
        expected = resampled_gains(*given, period=scheduler.period, dt=dt)
        assert gains_at(scheduler, dt) == pytest.approx(expected, rel=1e-11)
    # Just beside the period nothing jumps.
    beside = gains_at(scheduler, np.nextafter(float(scheduler.period), 9))
    assert beside == pytest.approx(given, rel=1e-13)


def test_a_track_uses_them():
    t, z = np.array([0.0, 4.0, 8.0, 9.0, 21.0]), np.array([0.0, 3.0, 11.0, 8.0, 31.0])
    used = ft.AlphaBetaTracker("fixed:alpha=.5:beta=.2:period=4").run(t, z).gains
    expected = resampled_gains(0.5, 0.2, period=4.0, dt=[4.0, 1.0, 12.0])
    np.testing.assert_allclose([used.alpha[2:], used.beta[2:]], expected[:2], rtol=1e-13)
    assert (used.alpha[2], used.beta[2]) == (0.5, 0.2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ft.FixedGains(0.5, 0.2, period=0), "period must be finite and > 0, got 0"),
        (lambda: ft.FixedGains(0.5, 0.2, period=np.inf), "period must be finite and > 0, got inf"),
        (lambda: ft.FixedGains(0.5, 0.2, period=[1, 2]), "period must be one number"),
        (lambda: ft.FixedGains(1.2, 0.2, period=4), "period: gains with a negative real pole"),
        (lambda: BenedictBordner(1.1, period=4), "period: gains with a negative real pole"),
        (lambda: FadingMemory(0.5, period=-1), "period must be finite and > 0, got -1"),
    ],
)
def test_a_period_that_cannot_be_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_period_is_part_of_the_value():
    scheduler = ft.FixedGains(0.5, 0.2, period=4)
    assert repr(scheduler) == "FixedGains(0.5, 0.2, period=4.0)"
    assert scheduler != ft.FixedGains(0.5, 0.2)
    assert pickle.loads(pickle.dumps(scheduler)) == scheduler
