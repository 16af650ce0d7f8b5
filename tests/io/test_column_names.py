import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io.column_names import plain_name, unit_of


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("X [m]", ("x", "m")),
        ("Time (s)", ("time", "s")),
        ("time [ms]", ("time", "ms")),
        ("TIME (Seconds)", ("time", "s")),
        ("t/µs", ("t", "us")),
        ("Time, s", ("time", "s")),
        ("t_s", ("t", "s")),
        ("x_m", ("x", "m")),
        ("vx_m_s", ("vx", "m/s")),
        ("speed (m/s)", ("speed", "m/s")),
        ("Azimuth [°]", ("azimuth", "deg")),
        ("Slant Range (NM)", ("slant_range", "nmi")),
        ("track-id", ("track_id", "")),
        ("pos_x", ("pos_x", "")),
        ("x()", ("x", "")),
        ("[m]", ("[m]", "")),
        ("lat/lon", ("lat/lon", "")),
        ("x [furlong]", ("x", "furlong")),
        ("", ("", "")),
    ],
)
def test_names_and_units(name, expected):
    assert plain_name(name) == expected


def test_units_in_any_spelling():
    assert list(map(unit_of, ["[sec]", "Degrees", "m s-1", "?"])) == ["s", "deg", "m/s", "?"]


@given(
    st.from_regex(r"[a-z]{2,8}", fullmatch=True).filter(lambda name: name != "m"),
    st.sampled_from(["s", "ms", "us", "ns", "m", "km", "deg", "rad", "m/s"]),
    st.sampled_from(["{} [{}]", "{}({})", " {} <{}> ", "{} {{{}}}", "{}, {}", "{}[{}]"]),
    st.booleans(),
)
def test_the_unit_is_found_however_it_is_written(name, unit, written, upper):
    text = written.format(name.upper() if upper else name, unit)
    assert plain_name(text) == (name, unit)


@given(st.text())
def test_any_name_has_a_plain_one(name):
    plain, unit = plain_name(name)
    assert isinstance(plain, str)
    assert isinstance(unit, str)
