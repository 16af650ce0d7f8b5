import math
import sys

import pytest
from data_files import written
from hypothesis import given, settings
from hypothesis import strategies as st
from source_rows import read

from fuzzytrack import DataError
from fuzzytrack.io.ais import Ais

pytest.importorskip("pyais", reason="pyais is not installed")

from pyais import encode_dict

# From the documentation of pyais, with the values that it gives.
DOCUMENTED = b"!AIVDM,1,1,,B,15NG6V0P01G?cFhE`R2IU?wn28R>,0*05"
TAGGED = rb"\s:2573135,c:1671620143*0B\!AIVDM,1,1,,A,16:=?;0P00`SstvFnFbeGH6L088h,0*44"
WRONG_TAG = rb"\s:2573238,c:1671620143*0B\!AIVDM,1,1,,A,16`l:v8P0W8Vw>fDVB0t8OvJ0H;9,0*0A"
NAME = (
    b"!AIVDM,2,1,4,A,55O0W7`00001L@gCWGA2uItLth@DqtL5@F22220j1h742t0Ht0000000,0*08",
    b"!AIVDM,2,2,4,A,000000000000000,2*20",
)


# What the standard says, bit by bit, without the library.


def sixbit(bits):
    bits += "0" * (-len(bits) % 6)
    numbers = (int(bits[k : k + 6], 2) for k in range(0, len(bits), 6))
    return "".join(chr(number + 48 if number < 40 else number + 56) for number in numbers)


def checked(text):
    """A sentence or tag block with its checksum."""
    total = 0
    for character in text:
        total ^= ord(character)
    return f"{text}*{total:02X}"


def signed(value, width):
    return format(value & (1 << width) - 1, f"0{width}b")


def sentence(payload, count=1, number=1, name=""):
    return "!" + checked(f"AIVDM,{count},{number},{name},A,{payload},0")


def position(kind, mmsi=244123456, lat=0, lon=0, sog=0, cog=0, heading=511, accuracy=0):
    """Payload of a report, all values as they are sent."""
    head = f"{kind:06b}00{mmsi:030b}"
    if kind == 27:
        return sixbit(
            head + f"{accuracy}0" + "0000" + signed(lon, 18) + signed(lat, 17)
            + f"{sog:06b}{cog:09b}00"
        )  # fmt: skip
    place = f"{sog:010b}{accuracy}" + signed(lon, 28) + signed(lat, 27) + f"{cog:012b}{heading:09b}"
    if kind in (18, 19):
        return sixbit((head + "0" * 8 + place).ljust(168 if kind == 18 else 312, "0"))
    return sixbit((head + "0" * 12 + place).ljust(168, "0"))


def line(payload, time=1_700_000_000):
    return "\\" + checked(f"c:{time}") + "\\" + sentence(payload) + "\r\n"


# -------------------------------------------------------------------- values


def test_documented_sentences(tmp_path):
    text = b"1671620144 " + DOCUMENTED + b"\n" + TAGGED + b"\n"
    columns, description, notes = read(written(tmp_path, text, "a.nmea"))
    assert columns["id"] == ["367380120", "413355820"]
    assert columns["lat"] == [37.806948, 39.932017]
    assert columns["lon"] == [-122.404333, 119.698612]
    assert columns["time"] == ["1671620144", "1671620143"]
    assert (columns["sog"], columns["cog"]) == ([0.1, 0.0], [245.2, 342.1])
    assert math.isnan(columns["heading"][0])
    assert columns["heading"][1] == 259.0
    assert columns["accuracy"] == [0.0, 1.0]
    assert (description.time, description.id) == ("time", "id")
    assert description.geodetic == ("lat", "lon")
    assert notes == []


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from([1, 2, 3, 18, 19]),
    st.integers(0, 999_999_999),
    st.integers(-90 * 600_000, 90 * 600_000),
    st.integers(-180 * 600_000, 180 * 600_000),
    st.integers(0, 1022),
    st.integers(0, 3599),
    st.integers(0, 359),
)
def test_a_position_is_what_its_bits_say(tmp_path_factory, kind, mmsi, lat, lon, sog, cog, heading):
    text = line(position(kind, mmsi, lat, lon, sog, cog, heading))
    columns, _, _ = read(written(tmp_path_factory.getbasetemp(), text, "property.nmea"))
    assert columns["id"] == [f"{mmsi:09d}"]
    # pyais rounds to 1e-6 degrees, which is less than the unit of the message.
    assert columns["lat"] == [pytest.approx(lat / 600_000, abs=6e-7)]
    assert columns["lon"] == [pytest.approx(lon / 600_000, abs=6e-7)]
    assert columns["sog"] == [pytest.approx(sog / 10)]
    assert columns["cog"] == [pytest.approx(cog / 10)]
    assert columns["heading"] == [heading]
    assert columns["type"] == [kind]


def test_long_range_messages(tmp_path):
    text = line(position(27, lat=-30 * 600, lon=150 * 600 + 1, sog=62, cog=359))
    text += line(position(27, lat=91 * 600, lon=181 * 600, sog=63, cog=511))
    columns, _, _ = read(written(tmp_path, text, "a.nmea"))
    assert columns["lat"][0] == -30.0
    assert columns["lon"][0] == pytest.approx(150 + 1 / 600, abs=6e-7)
    assert (columns["sog"][0], columns["cog"][0]) == (62.0, 359.0)
    assert all(math.isnan(columns[name][1]) for name in ("lat", "lon", "sog", "cog"))


def test_what_is_not_available_is_missing(tmp_path):
    kinds = (1, 18)
    text = "".join(
        line(position(k, lat=91 * 600_000, lon=181 * 600_000, sog=1023, cog=3600)) for k in kinds
    )
    # Either of them is enough, and so is a place that is none. 63 knots are slow for a hydrofoil.
    text += line(position(1, lat=91 * 600_000, lon=600_000, sog=630))
    text += line(position(1, lat=600_000, lon=200 * 600_000, sog=1022, cog=4000))
    columns, _, _ = read(written(tmp_path, text, "a.nmea"))
    assert all(map(math.isnan, columns["lat"] + columns["lon"]))
    assert all(map(math.isnan, columns["sog"][:2] + columns["heading"]))
    assert columns["sog"][2:] == [63.0, 102.2]
    assert math.isnan(columns["cog"][3])


def test_identities_keep_their_zeros(tmp_path):
    columns, _, _ = read(written(tmp_path, line(position(1, mmsi=2_320_000)), "a.nmea"))
    assert columns["id"] == ["002320000"]


def test_what_pyais_encodes(tmp_path):
    fields = {"type": 1, "mmsi": "366053209", "lat": 37.802, "lon": -122.341, "course": 219.3}
    (encoded,) = encode_dict(fields)
    columns, _, _ = read(written(tmp_path, f"1700000000,{encoded}\n", "a.nmea"))
    assert columns["lat"] == [37.802]
    assert columns["lon"] == [-122.341]
    assert columns["cog"] == [219.3]


# -------------------------------------------------------------------- times


@pytest.mark.parametrize(
    ("before", "after", "time"),
    [
        ("1700000000 ", "", "1700000000"),
        ("1700000000.25,", "", "1700000000.25"),
        ("1700000000123\t", "", "1700000000123"),
        ("2023-11-14T22:13:20Z ", "", "2023-11-14T22:13:20Z"),
        ("2023-11-14 22:13:20.5;", "", "2023-11-14 22:13:20.5"),
        ("2023-11-14T22:13:20+01:00 ", "", "2023-11-14T22:13:20+01:00"),
        ("", ",r003669945,1700000000", "1700000000"),
        (f"\\{checked('s:x,c:1700000000,t:y')}\\", "", "1700000000"),
        (f"\\{checked('g:1-1-7,c:1700000000')}\\ ", "", "1700000000"),
        (f"2001-01-01T00:00Z \\{checked('c:1700000000')}\\", "", "1700000000"),
    ],
)
def test_where_the_time_of_reception_may_stand(tmp_path, before, after, time):
    text = f"{before}{sentence(position(1))}{after}\n"
    assert read(written(tmp_path, text, "a.nmea"))[0]["time"] == [time]


@pytest.mark.parametrize(
    "before", ["", "12 ", "x1700000000x ", "\\" + checked("s:x") + "\\", "2023-11-14 "]
)
def test_without_a_time_of_reception_the_file_is_refused_with_the_remedy(tmp_path, before):
    text = before + sentence(position(1)) + "\n"
    message = r"a\.nmea: row 1: no time of reception, and the second .* record sentences with a tag"
    with pytest.raises(DataError, match=message):
        read(written(tmp_path, text, "a.nmea"))


def test_the_remedy_is_right(tmp_path):
    with pytest.raises(DataError) as caught:
        read(written(tmp_path, DOCUMENTED, "a.nmea"))
    block = str(caught.value).partition("tag block (")[2].partition("!AIVDM)")[0]
    columns, _, _ = read(written(tmp_path, block.encode() + DOCUMENTED, "a.nmea"))
    assert columns["time"] == ["1700000000"]


# -------------------------------------------------------------------- parts, broken lines


def test_the_parts_of_a_message_may_come_between_others(tmp_path):
    payload = position(19, lat=600_000)
    one = sentence(payload[:30], 2, 1, "3")
    two = sentence(payload[30:], 2, 2, "3")
    other = sentence(position(1)[:14], 2, 1, "4")
    text = f"\\{checked('c:1700000000')}\\{one}\n{other}\n" + line(position(1)) + f"{two}\n"
    columns, _, notes = read(written(tmp_path, text, "a.nmea"))
    assert columns["type"] == [1.0, 19.0]
    assert columns["lat"] == [0.0, 1.0]
    assert columns["time"] == ["1700000000"] * 2
    assert notes == ["messages that are incomplete: 1 left out, first at line 2"]


def test_a_part_that_comes_twice_begins_a_new_message(tmp_path):
    payload = position(19, lat=600_000)
    one, two = sentence(payload[:30], 2, 1, "3"), sentence(payload[30:], 2, 2, "3")
    text = "".join(f"1700000000 {part}\n" for part in (one, one, two))
    columns, _, notes = read(written(tmp_path, text, "a.nmea"))
    assert columns["lat"] == [1.0]
    assert notes == ["messages that are incomplete: 1 left out, first at line 1"]


def test_few_messages_wait_for_their_parts(tmp_path):
    waiting = "".join(f"{sentence(position(19)[:30], 9, 1, str(k))}\n" for k in range(200))
    columns, _, notes = read(written(tmp_path, waiting + line(position(1)), "a.nmea"))
    assert len(columns["lat"]) == 1
    assert notes == ["messages that are incomplete: 200 left out, first at line 1"]


def test_broken_lines_and_other_messages_are_counted(tmp_path):
    good = TAGGED + b"\n"
    lines = [
        good,
        b"# a comment\n",
        b"\n",
        b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\n",
        good.replace(b"*44", b"*45"),
        WRONG_TAG + b"\n",
        good.replace(b"c:", b"c;"),
        NAME[0] + b"\n",
        NAME[1] + b"\n",
        f"1700000000 {sentence(position(1)[:14])}\n".encode(),
        b"\xff" * 10_000 + b"\n",
        good,
    ]
    columns, _, notes = read(written(tmp_path, b"".join(lines), "a.nmea"))
    assert len(columns["lat"]) == 2
    assert notes == [
        "lines without a sentence of AIS: 2 left out, first at line 4",
        "sentences that are broken or have a wrong checksum: 1 left out, first at line 5",
        "tag blocks with a wrong checksum: 2 not used, first at line 6",
        "positions without a time of reception: 2 left out, first at line 6",
        "messages of other types: 1 left out, first at line 8",
        "messages that cannot be decoded: 1 left out, first at line 10",
    ]


@pytest.mark.parametrize("text", [b"", b"t,x\n0,1\n", b"\n".join(NAME), bytes(10_000)])
def test_a_file_without_positions_is_refused(tmp_path, text):
    with pytest.raises(DataError, match=r"a\.nmea: holds no plots"):
        read(written(tmp_path, text, "a.nmea"))


def test_pieces_are_parts_of_the_whole(tmp_path):
    text = "".join(line(position(1, lat=k, heading=k), 1_700_000_000 + k) for k in range(20))
    file = written(tmp_path, text, "a.nmea")
    assert read(file, rows=7)[0] == read(file)[0]


def test_without_the_library_the_command_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyais", None)
    message = r"a\.ais: AIS needs pyais.*pip install 'fuzzytrack\[ais\]'"
    with pytest.raises(DataError, match=message):
        Ais().check("a.ais")
