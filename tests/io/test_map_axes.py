"""How two axes lie on a map."""

import pytest

from fuzzytrack.io.map_axes import map_axes


@pytest.mark.parametrize(
    ("names", "shown", "order"),
    [
        (("x", "y"), ("x", "y"), (0, 1)),
        (("east", "north"), ("east", "north"), (0, 1)),
        (("north", "east"), ("east", "north"), (1, 0)),
        (("north_m", "east_m"), ("east", "north"), (1, 0)),
        (("Northing [m]", "Easting [m]"), ("easting", "northing"), (1, 0)),
        (("x_km", "y_km"), ("x_km", "y_km"), (0, 1)),
    ],
)
def test_north_is_upwards_and_meters_are_not_named(names, shown, order):
    assert map_axes(names) == (shown, order)


def test_two_names_are_needed():
    with pytest.raises(ValueError, match="axes_names: needs 2 names, got 3: x, y, z"):
        map_axes(("x", "y", "z"))
