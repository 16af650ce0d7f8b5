import numpy as np
import pytest

from fuzzytrack.gains import GAMMA_CONVENTIONS, convert_gamma, fading_memory, is_stable, poles


def predicted_noise_ratio(alpha, beta, gamma):
    """Sum of the squared impulse response of the prediction, by running the recursion."""
    state, total = np.zeros(3), 0.0
    gain = np.array([alpha, beta, gamma / 2])
    predict = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    for z in [1.0] + [0.0] * 400:
        prediction = predict @ state
        total += prediction[0] ** 2
        state = prediction + gain * (z - prediction[0])
    return total


@pytest.mark.parametrize(
    ("convention", "to_llinas", "largest"),
    [
        ("llinas", 1, 4),
        ("kalata", 1, 4),
        ("mahafza", 2, 2),
        ("brookner", 4, 1),
        ("filterpy", 4, 1),
        ("njonjo", 4, 1),
    ],
)
def test_every_convention(convention, to_llinas, largest):
    assert convert_gamma(0.1, convention, "llinas") == pytest.approx(0.1 * to_llinas, abs=1e-16)
    # The stability limit of γ, largest · αβ/(2 - α).
    limit = largest * 0.5 * 0.7 / 1.5
    gamma = convert_gamma(limit * np.array([0.999, 1.001]), convention, "llinas")
    np.testing.assert_array_equal(is_stable(0.5, 0.7, gamma), [True, False])
    # Critically damped at ξ = 0.64.
    expected = {1: 2.0, 2: 1.0, 4: 0.5}[to_llinas] * 0.36**3
    gamma = fading_memory(0.64, 3)[2]
    assert convert_gamma(gamma, "llinas", convention) == pytest.approx(expected, abs=1e-15)


def test_there_and_back_is_exact():
    gamma = np.random.default_rng(0).uniform(-1, 8, 100)
    for source in GAMMA_CONVENTIONS:
        for target in GAMMA_CONVENTIONS:
            there = convert_gamma(gamma, source, target)
            np.testing.assert_array_equal(convert_gamma(there, target, source), gamma)


def test_the_acceleration_gain_stays():
    """q in q/T² of the correction, as each author writes it."""
    written = {
        "llinas": lambda gamma: gamma / 2,
        "kalata": lambda gamma: gamma / 2,
        "mahafza": lambda gamma: gamma,
        "brookner": lambda gamma: 2 * gamma,
        "filterpy": lambda gamma: 2 * gamma,
        "njonjo": lambda gamma: 2 * gamma,
    }
    for source, of_source in written.items():
        for target, of_target in written.items():
            assert of_target(convert_gamma(0.3, source, target)) == of_source(0.3)


def test_which_reading_of_gamma_is_critically_damped():
    """At ξ = 0.64: (1 - ξ)³ as Mahafza's γ gives the triple pole, as Njonjo's it does not."""
    xi = 0.64
    alpha, beta, gamma = fading_memory(xi, 3)
    assert (alpha, beta) == pytest.approx((0.737856, 0.318816), abs=1e-12)
    printed = (1 - xi) ** 3
    assert printed == pytest.approx(0.046656, abs=1e-15)
    assert convert_gamma(printed, "mahafza", "llinas") == pytest.approx(gamma, abs=1e-15)
    np.testing.assert_allclose(np.poly(poles(alpha, beta, gamma)), np.poly([xi] * 3), atol=1e-14)
    assert predicted_noise_ratio(alpha, beta, gamma) == pytest.approx(1.294331, abs=5e-7)

    as_printed = convert_gamma(printed, "njonjo", "llinas")
    np.testing.assert_allclose(
        poles(alpha, beta, as_printed),
        [0.746545 + 0.303669j, 0.746545 - 0.303669j, 0.403581],
        atol=1e-6,
    )
    assert predicted_noise_ratio(alpha, beta, as_printed) == pytest.approx(1.412824, abs=5e-7)


def test_njonjo_as_printed_is_stable_for_every_pole():
    xi = np.linspace(0.001, 0.999, 999)
    alpha, beta, _ = fading_memory(xi, 3)
    assert is_stable(alpha, beta, convert_gamma((1 - xi) ** 3, "njonjo", "llinas")).all()


def test_shapes_and_errors():
    assert isinstance(convert_gamma(0.1, "llinas", "mahafza"), np.float64)
    assert convert_gamma(np.ones((2, 3)), "llinas", "mahafza").shape == (2, 3)
    allowed = "llinas, kalata, mahafza, brookner, filterpy, njonjo"
    with pytest.raises(ValueError, match=f"source must be one of {allowed}, got 'Llinas'"):
        convert_gamma(0.1, "Llinas", "kalata")
    with pytest.raises(ValueError, match=rf"target must be one of {allowed}, got \[\]"):
        convert_gamma(0.1, "llinas", [])
    with pytest.raises(ValueError, match="gamma must be finite, got nan at index 1"):
        convert_gamma([0.1, np.nan], "llinas", "kalata")
