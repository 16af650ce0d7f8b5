"""What a user says of columns, and what a format says of them."""

import math

import numpy as np
import pytest

from fuzzytrack.io.description import PlotDescription, texts


def test_what_is_said_goes_before_what_a_format_knows():
    format_ = PlotDescription(time="tod", wrap=86400.0, id="track", polar=("rho", "theta"))
    user = PlotDescription(id="mode_a", sigma=5.0)
    both = user.over(format_)
    assert (both.time, both.wrap, both.id, both.polar) == (
        "tod",
        86400.0,
        "mode_a",
        ("rho", "theta"),
    )
    assert both.sigma == 5.0


def test_a_position_replaces_that_of_a_format():
    both = PlotDescription(axes=("x", "y")).over(PlotDescription(polar=("rho", "theta")))
    assert (both.axes, both.polar) == (("x", "y"), None)


def test_without_a_format_nothing_changes():
    user = PlotDescription(axes=["x", "y"])
    assert user.over(None) is user
    assert user.axes == ("x", "y")


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"axes": ("x",), "polar": ("r", "a")}, "axes and polar: a plot has one position"),
        ({"polar": ("r",)}, "polar: 1 given; expected 2 or 3"),
        ({"time_unit": "sec"}, "time_unit: 'sec'; expected one of s, ms, us, ns"),
        ({"azimuth_from": "nort"}, "azimuth_from: 'nort'; expected one of north, east"),
    ],
)
def test_mistakes_are_named(said, message):
    with pytest.raises(ValueError, match=message):
        PlotDescription(**said)


@pytest.mark.parametrize(
    ("sigma", "columns"),
    [(None, ()), (3.0, ()), ("sd", ("sd",)), (("sd_x", 2.0), ("sd_x",)), ((1.0, 2.0), ())],
)
def test_columns_of_noise(sigma, columns):
    assert texts(sigma) == columns


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"id": 0}, "id: must be the name of a column, got 0"),
        ({"angle": ("x",)}, "angle: must be the name of a column"),
        ({"axes": 3}, "axes: must be names of columns, got 3"),
        ({"polar": "xy"}, "polar: 1 given; expected 2 or 3"),
        ({"time": ("a", "b", "c")}, "time: 3 given"),
        ({"site": "1,2"}, "site: must be latitude, longitude"),
        ({"sigma": True}, "sigma: must be numbers or names of columns, got True"),
        ({"sigma_range": {"x": 1}}, "sigma_range: must be numbers or names"),
        ({"valid": 3}, "valid: must be columns, each with its least"),
        ({"valid": "x=0:1"}, "valid: must be columns"),
        ({"valid": [("x", 5, 1)]}, "valid: x from 5 to 1; expected low to high"),
        ({"valid": {"x": (math.nan, 1)}}, "valid: x from nan to 1"),
    ],
)
def test_values_of_another_kind_are_named(said, message):
    with pytest.raises(ValueError, match=message):
        PlotDescription(**said)


def test_arrays_and_mappings_are_taken():
    said = PlotDescription(
        sigma=np.array([1.0, 2.0]), sigma_range=np.float32(2), valid={"x": (0, 5)}, axes="xy"
    )
    assert (said.sigma, said.sigma_range) == ((1.0, 2.0), 2.0)
    assert (said.valid, said.axes) == ((("x", 0.0, 5.0),), ("xy",))
    assert PlotDescription(time=["t"]).time == "t"
    assert PlotDescription(time=["day", "hour"]).time == ("day", "hour")
