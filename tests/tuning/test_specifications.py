import pytest

from fuzzytrack.gains import kalata
from fuzzytrack.trackers import Tracker
from fuzzytrack.tuning.specifications import specification, specification_families

UNIT = 3.0


@pytest.mark.parametrize("family", specification_families())
def test_every_family_makes_trackers_at_its_start_and_its_limits(family):
    candidates = specification(family, None, UNIT)
    space = candidates.space
    for numbers in (
        space.start,
        tuple(p.low for p in space.parameters),
        tuple(p.high for p in space.parameters),
    ):
        try:
            assert isinstance(candidates.tracker(numbers), Tracker)
        except ValueError:
            # Limits are those of each number by itself: fixed gains need not be stable together.
            assert numbers != space.start


def test_numbers_that_are_given_are_where_the_search_begins():
    candidates = specification("kalman-cv:sigma_w=10:sigma_v=2:start=one-point", None, UNIT)
    (parameter,) = candidates.space.parameters
    assert (parameter.name, parameter.start) == ("sigma_v", 2.0)
    assert candidates.text((0.25,)) == "kalman-cv:sigma_w=10:start=one-point:sigma_v=0.25"
    # Without one, accelerations begin at a part of σ/T².
    (parameter,) = specification("kalman-cv", None, UNIT).space.parameters
    assert parameter.start == pytest.approx(0.5 * UNIT)
    assert parameter.low < parameter.start < parameter.high


def test_any_number_can_be_free():
    candidates = specification("kalman-cv:sigma_w=10", ["sigma_w", "sigma_v"], UNIT)
    assert candidates.text((1.0, 8.0)) == "kalman-cv:sigma_v=1.0:sigma_w=8.0"
    candidates = specification("innovation:sigma_d=4", ["sigma_d"], UNIT)
    assert candidates.space.start == (4.0,)
    kept = specification("fixed:alpha=0.5:beta=0.2", None, UNIT).restricted([1])
    assert kept.text((0.3,)) == "fixed:alpha=0.5:beta=0.3"


def test_the_level_of_a_maneuver_begins_at_that_of_the_plots():
    (parameter,) = specification("imm-two", ["level"], UNIT).space.parameters
    assert parameter.start == pytest.approx(3 * UNIT)
    assert specification("imm-two:level=2", ["level"], UNIT).text((4.0,)) == "imm-two:level=4.0"


def test_kalata_is_a_fixed_pair_by_its_index():
    candidates = specification("kalata:tracking_index=0.2", None, UNIT)
    alpha, beta = kalata(0.7)
    assert candidates.text((0.7,)) == f"fixed:alpha={float(alpha)!r}:beta={float(beta)!r}"


@pytest.mark.parametrize(
    ("text", "free", "message"),
    [
        ("kalman", None, r"tracker 'kalman': no such tracker; did you mean 'kal.*or a rule base"),
        ("fixed:alfa=1", None, "unknown parameter 'alfa'; did you mean 'alpha'"),
        ("fixed", ["gama"], "free: tracker 'fixed' has no number 'gama'"),
        ("fixed", [], "tracker 'fixed' has no number that is free; name some out of alpha, beta"),
        ("growing-memory", None, "tracker 'growing-memory' has no number that is free$"),
    ],
)
def test_what_is_allowed_is_listed(text, free, message):
    with pytest.raises(ValueError, match=message):
        specification(text, free, UNIT)
