import pytest
from data_files import written

from fuzzytrack import DataError
from fuzzytrack.io import read_tracks
from fuzzytrack.io.columns import choose_columns
from fuzzytrack.io.description import PlotDescription


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"time": "tt"}, "`time`: no column 'tt'; did you mean 't'"),
        ({"axes": ["x", "q"]}, "`axes`: no column 'q'; allowed: t, id, x, none"),
        ({"axes": []}, "`axes`: needs at least one"),
        ({"id": "idd"}, "`id`: no column 'idd'; did you mean 'id'"),
        ({"axes": ["x", "x"]}, "column 'x' cannot serve twice"),
        ({"id": "none"}, "column none: no row has an identity"),
    ],
)
def test_bad_columns(tmp_path, columns, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, "t,id,x,none\n0,a,0,\n1,,0, \n"), **columns)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sigma": "t"}, "column 't' cannot serve twice"),
        ({"sigma": "x"}, "column 'x' cannot serve twice"),
        ({"sigma_range": 1.0}, "`sigma_range`: is of polar plots"),
        ({"sigma_elevation": 1.0, "polar": ("r", "az")}, "there is no elevation"),
        ({"sigma_range": (1.0, 2.0), "polar": ("r", "az")}, "2 given; expected one"),
        ({"sigma_range": 1.0, "sigma": 2.0, "polar": ("r", "az")}, "`sigma` is given as well"),
        ({"azimuth_from": "east"}, "`azimuth_from`: is of polar plots"),
        ({"geodetic": ("lon", "lat")}, "`geodetic`: 'lon' is a longitude by its name"),
        ({"polar": ("az", "r")}, "`polar`: 'az' is an angle by its name; range comes first"),
        ({"own_ship": ("lon", "lat"), "polar": ("r", "az")}, "'lon' is a longitude by its name"),
        ({"own_ship": ("lon",), "polar": ("r", "az")}, "`own_ship`: 1 given"),
        ({"own_ship": ("x", "y"), "geodetic": ("lat", "lon")}, "cannot carry geodetic"),
        ({"own_ship": ("x", "y"), "angle": "az"}, "cannot carry angle"),
        ({"own_heading": "az", "geodetic": ("lat", "lon")}, "cannot turn geodetic"),
        ({"own_heading": ""}, "`own_heading`: no column ''"),
        ({"valid": (("X", 0.0, 1.0),)}, "`valid`: 'X' is no column of position; did you mean 'x'"),
    ],
)
def test_what_would_have_no_effect_is_refused(options, message):
    names = ("t", "x", "y", "r", "az", "lat", "lon")
    with pytest.raises(DataError, match=message):
        choose_columns(names, "f.csv", PlotDescription(**options))
