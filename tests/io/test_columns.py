import pytest
from data_files import written

from fuzzytrack import DataError
from fuzzytrack.io import read_tracks
from fuzzytrack.io.columns import choose_columns, looks_like_identity
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


@pytest.mark.parametrize(
    ("names", "options", "message"),
    [
        (("t", "time", "x"), {}, "columns 't' and 'time' could all be the time; name one of them"),
        (("when", "x"), {}, "no column t, time or timestamp; .*; there are when, x"),
        (("t", "x", "x_m"), {}, "columns 'x' and 'x_m' could all be x; name those of position"),
        (("t", "x_km", "y_km"), {}, "column 'x_km' is in km; expected meters"),
        (("t", "a", "b"), {}, "no columns x, y or x_m, y_m; .*; there are t, a, b"),
        (("t", "lat", "lon"), {}, "no columns x, y; `geodetic`=lat,lon takes latitude"),
        (("t", "range", "azimuth"), {}, "no columns x, y; `polar`=range,azimuth takes range"),
        (("t", "bearing"), {}, "no columns x, y; `angle`=bearing takes a bare angle"),
        (("t", "bearing"), {"axes": ("bearing",)}, "is an angle by its name; `angle`=bearing"),
        (("t", "cog", "x"), {"axes": ("x", "cog")}, "'cog' is an angle.*`angle`=cog"),
        (("t", "lat", "lon"), {"axes": ("lon", "lat")}, "angle by its name; `geodetic`=lat,lon"),
        (("t", "lat"), {"axes": ("lat", "t")}, "`angle`=lat takes it as an angle"),
    ],
)
def test_what_could_be_meant_is_told(names, options, message):
    with pytest.raises(DataError, match=message):
        choose_columns(names, "f.csv", PlotDescription(**options))


def test_units_of_the_file_go_before_those_of_the_names():
    names = ("t", "x", "y")
    assert choose_columns(names, "f.csv").axes == ("x", "y")
    with pytest.raises(DataError, match="column 'y' is in km"):
        choose_columns(names, "f.csv", units={"y": "km"})


def test_lengths_are_converted_from_the_unit_of_their_name_or_of_the_file():
    said = PlotDescription(polar=("Rng[NM]", "Brg"), own_ship=("ox", "oy"), sigma_range="sr")
    names = ("Time", "Rng[NM]", "Brg", "ox", "oy", "sr")
    columns = choose_columns(names, "f.csv", said, {"Time": "s", "oy": "km", "Brg": "rad"})
    assert [columns.meters(name) for name in names] == [1, 1852, 1, 1, 1000, 1]
    assert (columns.unit("Brg"), columns.unit("ox")) == ("rad", "")
    assert columns.sentence.endswith("; Rng[NM] from nmi to m; oy from km to m")
    # Cartesian positions are taken as they are, and all that is added to them.
    plain = PlotDescription(axes=("x_km", "y_km"), own_ship=("ox_km", "oy_km"))
    columns = choose_columns(("t", "x_km", "y_km", "ox_km", "oy_km"), "f.csv", plain)
    assert columns.meters("x_km") == columns.meters("ox_km") == 1


def test_angles_are_axes_for_those_who_say_so():
    said = PlotDescription(axes=("lat", "lon"), cartesian=True)
    columns = choose_columns(("t", "lat", "lon"), "f.csv", said)
    assert (columns.position, columns.axes) == ("cartesian", ("lat", "lon"))


def test_names_in_other_letters_are_found():
    said = PlotDescription(time="TIME", id="Id", axes=("X",))
    columns = choose_columns(("time", "ID", "x"), "f.csv", said)
    assert (columns.time, columns.id, columns.axes) == ("time", "ID", ("x",))


def test_columns_in_words():
    said = PlotDescription(
        time=("day", "clock"), polar=("r", "az"), own_ship=("ox", "oy"), own_heading="h",
        sigma_range="sr", sigma_azimuth=1.0,
    )  # fmt: skip
    names = ("day", "clock", "r", "az", "ox", "oy", "h", "sr")
    columns = choose_columns(names, "f.csv", said)
    assert columns.sentence == (
        "time day and clock; no id: one track; position r, az (polar); own ship ox, oy; "
        "own heading h; sigma sr"
    )
    assert set(columns.kinds) == set(names)


def test_a_column_that_looks_like_an_identity():
    columns = choose_columns(("t", "x", "MMSI"), "f.csv")
    assert looks_like_identity(("t", "x", "MMSI"), columns) == "MMSI"
    assert looks_like_identity(("t", "x"), columns) == ""
    with_id = choose_columns(("t", "x", "MMSI"), "f.csv", PlotDescription(id="MMSI"))
    assert looks_like_identity(("t", "x", "MMSI"), with_id) == ""
