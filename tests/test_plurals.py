import pytest

from fuzzytrack.plurals import counted


@pytest.mark.parametrize(
    ("count", "text"),
    [(0, "0 runs"), (1, "1 run"), (2, "2 runs"), (1.2, "1 run"), (0.6, "1 run"), (17.5, "18 runs")],
)
def test_a_noun_goes_with_its_number(count, text):
    assert counted(count, "run") == text


def test_another_form():
    assert [counted(n, "axis", "axes") for n in (1, 3)] == ["1 axis", "3 axes"]
