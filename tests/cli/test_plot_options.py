"""What the options that say how plots are read become."""

import math

import pytest

from fuzzytrack.cli.plot_options import number_or, plot_reading


@pytest.mark.parametrize(
    ("given", "name", "value"),
    [
        ({"time": "when"}, "time", "when"),
        ({"time": "day,clock"}, "time", ("day", "clock")),
        ({"time_unit": "ms"}, "time_unit", "ms"),
        ({"wrap": "none"}, "wrap", None),
        ({"wrap": "86400"}, "wrap", 86400.0),
        ({}, "wrap", "auto"),
        ({"id": "mmsi"}, "id", "mmsi"),
        ({"axes": "e, n"}, "axes", ("e", "n")),
        ({"polar": "r,az"}, "polar", ("r", "az")),
        ({"geodetic": "lat,lon"}, "geodetic", ("lat", "lon")),
        ({"angle": "b"}, "angle", "b"),
        ({"cartesian": True}, "cartesian", True),
        ({"azimuth_from": "east"}, "azimuth_from", "east"),
        ({"site": "60.5,-10"}, "site", (60.5, -10.0)),
        ({"own_ship": "ox,oy"}, "own_ship", ("ox", "oy")),
        ({"own_heading": "h"}, "own_heading", "h"),
        ({}, "sigma", None),
        ({"sigma": "auto"}, "sigma", "auto"),
        ({"sigma": "5"}, "sigma", 5.0),
        ({"sigma": "5,sy"}, "sigma", (5.0, "sy")),
        ({"sigma_range": "sr"}, "sigma_range", "sr"),
        ({"sigma_azimuth": ".5"}, "sigma_azimuth", 0.5),
        ({"sigma_elevation": "1"}, "sigma_elevation", 1.0),
        ({"valid": ["x=0:10,y=:5"]}, "valid", (("x", 0.0, 10.0), ("y", -math.inf, 5.0))),
        ({"valid": ["x=1:", "y=2:3"]}, "valid", (("x", 1.0, math.inf), ("y", 2.0, 3.0))),
    ],
)
def test_descriptions(given, name, value):
    assert getattr(plot_reading(**given).description, name) == value


@pytest.mark.parametrize(
    ("given", "name", "value"),
    [
        ({"duplicates": "mean"}, "duplicates", "mean"),
        ({"stale": True}, "stale", math.inf),
        ({}, "stale", None),
        ({"least_step": "0.5"}, "least_step", 0.5),
        ({"max_gap": "none"}, "max_gap", None),
        ({"max_gap": "30"}, "max_gap", 30.0),
        ({"max_coast": "5"}, "max_coast", 5.0),
    ],
)
def test_cleaning(given, name, value):
    assert getattr(plot_reading(**given).cleaning, name) == value


@pytest.mark.parametrize(
    ("given", "name", "value"),
    [
        ({"delimiter": "tab"}, "delimiter", "\t"),
        ({"delimiter": "\\t"}, "delimiter", "\t"),
        ({"delimiter": ";"}, "delimiter", ";"),
        ({}, "delimiter", None),
        ({"decimal": ","}, "decimal", ","),
        ({"na": "NULL, -999"}, "na", ("NULL", "-999")),
        ({"comment": "%"}, "comment", "%"),
        ({"columns": "t,x,y"}, "columns", ("t", "x", "y")),
    ],
)
def test_text(given, name, value):
    assert getattr(plot_reading(**given).form, name) == value


def test_format_and_order():
    reading = plot_reading(format="mot", sort=True)
    assert (reading.format, reading.sort) == ("mot", True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--time", "a,b,c"], "--time: expected COL, or DATE,TIME, got 'a,b,c'"),
        (["--axes", "a,,b"], "--axes: a name is missing in 'a,,b'"),
        (["--wrap", "-1"], "--wrap: expected a number > 0, or auto, or none, got '-1'"),
        (["--max-gap", "long"], "--max-gap: expected a number > 0, or auto, or none, got 'long'"),
        (["--max-coast", "0"], "--max-coast: expected a number > 0, got '0'"),
        (["--least-step", "nan"], "--least-step: expected a number > 0, got 'nan'"),
        (["--site", "60,east"], "--site: expected numbers with commas between them"),
        (["--site", "60,inf"], "--site: expected numbers with commas between them"),
        (["--sigma", "0"], "--sigma must be > 0, got 0"),
        (["--sigma", "inf"], "--sigma: no column 'inf'"),
        (["--valid", "x"], "--valid: expected NAME=VALUE"),
        (["--valid", "x=1"], "--valid: expected COL=LOW:HIGH, got 'x=1'"),
        (["--valid", "x=2:1"], "--valid: expected COL=LOW:HIGH, got 'x=2:1'"),
        (["--valid", "x=a:1"], "--valid: expected COL=LOW:HIGH, got 'x=a:1'"),
        (["--valid", "x=1:inf"], "got 'x=1:inf'; an end that is left out is no limit"),
        (["--time-unit", "hours"], "--time-unit: 'hours'; expected one of s, ms, us, ns"),
        (["--azimuth-from", "west"], "--azimuth-from: 'west'; expected one of north, east"),
        (["--polar", "r,az", "--angle", "b"], "--polar and --angle: a plot has one position"),
        (["--polar", "r"], "--polar: 1 given; expected 2 or 3"),
        (["--gate", "wide"], "--gate: expected a number > 0, or auto, or none, got 'wide'"),
    ],
)
def test_wrong_texts(fails, plots, options, message):
    assert message in fails("track", plots, *options)


def test_words_that_stand_for_numbers():
    assert number_or("many", "--rows", {"many": 9}) == 9
    assert number_or("2.5", "--rows", {}) == 2.5
