import numpy as np
import pytest

from fuzzytrack.gains import alpha_beta_from_w, kalata
from fuzzytrack.schedulers.gain_outputs import GAIN_SETTINGS, choices, find_gain_outputs, gains_of

# In an order other than that of the names.
RULE_BASES = [
    ("damping", "stiffness"),
    ("stiffness",),
    ("beta", "alpha"),
    ("gamma", "beta", "alpha"),
]


@pytest.mark.parametrize("names", RULE_BASES)
def test_arrays_and_the_scalar_function_agree(names):
    found = find_gain_outputs(names)
    values = np.random.default_rng(3).uniform(0.1, 0.9, (len(names), 5, 2))
    gains = found.gains(dict(zip(names, values, strict=True)))
    convert = found.conversion(names)
    for place in np.ndindex(5, 2):
        alpha, beta, gamma, retention = convert(tuple(values[(slice(None), *place)].tolist()))
        assert (alpha, beta) == pytest.approx((gains["alpha"][place], gains["beta"][place]))
        assert gamma == (gains["gamma"][place] if "gamma" in names else 0.0)
        assert retention == 1.0


def test_stiffness_is_a_frequency_of_the_w_domain():
    stiffness, damping = np.array([0.2, 0.5]), np.array([0.7, 1.3])
    gains = find_gain_outputs(["stiffness", "damping"]).gains(
        {"stiffness": stiffness, "damping": damping}
    )
    np.testing.assert_array_equal([*gains.values()], alpha_beta_from_w(stiffness, damping))
    # Alone, it belongs to the tracking index λ = 4ω₀².
    gains = find_gain_outputs(["stiffness"]).gains({"stiffness": stiffness})
    np.testing.assert_allclose([*gains.values()], kalata(4 * stiffness**2), rtol=1e-12)


def test_gains_are_unknown_where_an_output_is():
    outputs = {"stiffness": np.array([0.3, np.nan, 0.3]), "damping": np.array([np.nan, 0.7, 0.7])}
    gains = gains_of(outputs)
    assert np.isnan(gains["alpha"]).tolist() == np.isnan(gains["beta"]).tolist()
    assert np.isnan(gains["alpha"]).tolist() == [True, True, False]
    with pytest.raises(ValueError, match="omega0 must be finite and >= 0"):
        gains_of({"stiffness": np.array([-0.1])})


def test_outputs_that_are_no_gains():
    assert find_gain_outputs(["opening"]) is None
    assert find_gain_outputs(["stiffness", "damping", "opening"]) is None
    assert find_gain_outputs([]) is None
    assert gains_of({"opening": np.zeros(2)}) == {}
    assert gains_of({"beta": np.zeros(2), "alpha": np.zeros(2)}) == {}


def test_words_for_messages():
    assert GAIN_SETTINGS == ("w-domain", "kalata", "direct", "covariance")
    assert choices("direct") == "alpha, beta or alpha, beta, gamma"
    assert choices().startswith("stiffness, damping or stiffness or alpha")
