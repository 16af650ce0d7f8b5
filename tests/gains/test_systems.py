import numpy as np
import pytest
from scipy import signal

from fuzzytrack.gains import frequency_response, noise_ratio, transfer_function

GAINS = [(0.5, 0.7, 0.0), (1.2, 0.5, 0.0), (0.5, 0.4, 0.1), (1.05, 1.225, 1.5)]


@pytest.mark.parametrize("gains", GAINS)
@pytest.mark.parametrize("of", ["predicted", "filtered"])
def test_impulse_and_frequency_responses_agree_with_the_closed_forms(gains, of):
    system = transfer_function(*gains, dt=2, of=of)
    assert isinstance(system, signal.dlti)
    assert system.dt == 2
    _, (response,) = system.impulse(n=600)
    assert (response**2).sum() == pytest.approx(noise_ratio(*gains, of=of), rel=1e-9)
    rate = np.linspace(0.01, np.pi / 2, 50)
    _, expected = signal.dfreqresp(system, rate * 2)
    np.testing.assert_allclose(
        frequency_response(*gains, rate, 2, of=of), expected, rtol=1e-9, atol=1e-12
    )


@pytest.mark.parametrize("gains", GAINS)
@pytest.mark.parametrize("of", ["predicted", "filtered"])
def test_the_system_answers_as_the_recursion_does(gains, of):
    alpha, beta, gamma = gains
    z = np.random.default_rng(1).normal(size=60)
    x = v = a = 0.0
    outputs = {"predicted": [], "filtered": []}
    for plot in z:
        ahead, v = x + v + a / 2, v + a
        e = plot - ahead
        x, v, a = ahead + alpha * e, v + beta * e, a + gamma / 2 * e
        outputs["predicted"].append(ahead)
        outputs["filtered"].append(x)
    _, got = signal.dlsim(transfer_function(*gains, of=of), z)
    np.testing.assert_allclose(got[:, 0], outputs[of], atol=1e-11)


def test_the_poles_are_those_of_the_filter():
    assert sorted(transfer_function(0.5, 0.7).poles, key=np.imag) == pytest.approx(
        [0.4 - 0.583095j, 0.4 + 0.583095j], abs=1e-6
    )
    assert (np.abs(transfer_function(0.5, 0.7, 0.94).poles) > 1).any()  # need not be stable


@pytest.mark.parametrize("of", ["predicted", "filtered"])
@pytest.mark.parametrize("gains", [(0, 0.5, 0), (0, 0, 0.5), (0.5, -0.5, 0)])
def test_gains_that_vanish_give_a_system_too(gains, of):
    _, (response,) = transfer_function(*gains, of=of).impulse(n=3)
    assert response[0] == (gains[0] if of == "filtered" else 0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: transfer_function(np.nan, 0.4), "alpha must be finite"),
        (lambda: transfer_function(0.5, np.inf), "beta must be finite"),
        (lambda: transfer_function(0.5, 0.4, np.nan), "gamma must be finite"),
        (lambda: transfer_function(0.5, [0.4, 0.5]), "beta must be one number"),
        (lambda: transfer_function(0, 0, 0), "gamma must not all be 0"),
        (lambda: transfer_function(0.5, 0.4, dt=-1), "dt must be finite and > 0"),
        (lambda: transfer_function(0.5, 0.4, of="velocity"), "of must be one of"),
    ],
)
def test_arguments_out_of_range_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
