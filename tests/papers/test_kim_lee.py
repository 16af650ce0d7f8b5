"""Figures that an independent implementation found; tolerances are its own plus three of our
standard errors at the number of runs used here."""

import math

import pytest

from fuzzytrack.papers import reproduce

RUNS = 100

pytestmark = pytest.mark.untraced


@pytest.fixture(scope="module")
def found():
    return reproduce("kim-lee", RUNS)


FIXED, FITTED = "fixed, σ_v = 5", "fixed, σ_v = 5 g"
PUBLISHED, LITERAL = "published, σ_Q = 5", "published, unit Q"


@pytest.mark.parametrize(
    ("tracker", "quantity", "value", "within", "spread"),
    [
        # spread: standard deviation over runs of the quantity, generously
        (FIXED, "position, maneuver (m)", 428, 5, 30),
        (FIXED, "position, quiet (m)", 107, 3, 25),
        (FIXED, "position, peak (m)", 945, 12, 60),
        (FIXED, "position, time of the peak (s)", 77, 1, 0),
        (FIXED, "velocity, peak (m/s)", 335, 5, 10),
        (FIXED, "velocity, time of the peak (s)", 35, 0, 0),
        (PUBLISHED, "position, mean (m)", 110.5, 1.5, 14),
        (PUBLISHED, "position, maneuver (m)", 133.5, 3, 28),
        (PUBLISHED, "position, quiet (m)", 103.3, 2, 22),
        (PUBLISHED, "position, peak (m)", 167, 8, 120),
        (PUBLISHED, "velocity, quiet (m/s)", 46, 2, 20),
        ("self-consistent", "position, mean (m)", 114.8, 1.5, 15),
        ("self-consistent", "position, maneuver (m)", 140.5, 3, 28),
        ("self-consistent", "position, quiet (m)", 107.2, 2, 24),
        ("self-consistent", "position, peak (m)", 191, 9, 130),
        (LITERAL, "NPE, mean", 0.91, 0.015, 0.09),
        (LITERAL, "velocity, quiet (m/s)", 268, 8, 80),
        ("default", "position, mean (m)", 113.3, 1.5, 15),
        ("default", "position, maneuver (m)", 135.5, 2.5, 27),
        ("default", "position, quiet (m)", 101.8, 2, 24),
        ("default", "position, peak (m)", 163, 8, 120),
        (FITTED, "NPE, largest", 0.97, 0.03, 0.7),
    ],
)
def test_errors(found, tracker, quantity, value, within, spread):
    ours = found.ours(f"{tracker}: {quantity}")
    assert ours == pytest.approx(value, abs=within + 3 * spread / math.sqrt(RUNS))


def test_the_literal_text_latches_up_and_the_default_does_not(found):
    share = "{}: share of runs with α > 0.8 at 60 s".format
    assert found.ours(share(LITERAL)) == pytest.approx(0.93, abs=0.03 + 3 * 0.26 / math.sqrt(RUNS))
    assert found.ours(share("default")) < 0.2


def test_the_largest_speed_is_exact(found):
    assert found.ours("largest true speed (m/s)") == pytest.approx(610.5, abs=1e-9)


def test_the_adjusted_noise_follows_the_maneuver(found):
    for tracker in (PUBLISHED, "self-consistent", "default"):
        quiet = found.ours(f"{tracker}: median σ_v, 48-65 s (m/s²)")
        assert found.ours(f"{tracker}: median σ_v, 36-40 s (m/s²)") > 1.5 * quiet


def test_one_run_has_no_standard_errors():
    rows = reproduce("kim-lee", 1).rows
    assert all(r.se is None for r in rows)
