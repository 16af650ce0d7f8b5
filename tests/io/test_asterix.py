import io
import math
import struct
import sys

import numpy as np
import pytest
from data_files import written
from hypothesis import given, settings
from hypothesis import strategies as st
from source_rows import read

from fuzzytrack import DataError
from fuzzytrack.io.asterix import Asterix
from fuzzytrack.io.asterix_blocks import records
from fuzzytrack.io.byte_stream import ByteStream
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.record_source import Losses

pytest.importorskip("asterix.generated", reason="libasterix is not installed")

from asterix import generated

CATS = {number: editions[-1] for number, editions in generated.manifest["CATS"].items()}


# What the standard says, bit by bit, without the library.


def block(category, *records):
    body = b"".join(records)
    return bytes([category]) + struct.pack(">H", len(body) + 3) + body


def three(value):
    return struct.pack(">I", value)[1:]


def plot_048(
    time=460800,
    rho=2560,
    theta=8192,
    kind=0b101,
    source=(1, 2),
    code=0o7777,
    level=400,
    address=0x4840D6,
    track=17,
):
    """010, 140, 020, 040, 070, 090, 220, 161 as raw numbers."""
    first, second = 0b11111101, 0b10010000
    return (
        bytes([first, second, *source])
        + three(time)
        + bytes([kind << 5])
        + struct.pack(">HHHh", rho, theta, code, level)
        + three(address)
        + struct.pack(">H", track)
    )


def primary_048(time=460800, rho=2560, theta=8192, source=(1, 2)):
    """010, 140, 020, 040: a plot of the primary radar, without any identity."""
    return bytes([0b11110000, *source]) + three(time) + b"\x20" + struct.pack(">HH", rho, theta)


GOOD = block(48, plot_048())


# -------------------------------------------------------------------- values


def test_category_048_as_the_library_encodes_it(tmp_path):
    record = CATS[48].cv_record.create(
        {
            "010": (("SAC", 1), ("SIC", 2)),
            "140": (3600.0, "s"),
            "020": ((0b101, 0, 0, 0, 0, None),),
            "040": (("RHO", (10.0, "NM")), ("THETA", (45.0, "°"))),
            "070": (0, 0, 0, 0, ("MODE3A", "7777")),
            "090": (0, 0, ("FL", (100.0, "FL"))),
            "220": 0x4840D6,
            "161": (0, 17),
        }
    )
    encoded = CATS[48].create([record]).unparse().to_bytes()
    assert encoded == GOOD
    columns, description, notes = read(written(tmp_path, encoded, "a.ast"))
    assert columns == {
        "time": [3600.0],
        "source": ["1/2"],
        "range": [18520.0],
        "azimuth": [45.0],
        "height": [3048.0],
        "mode_3a": ["7777"],
        "track": ["17"],
        "address": ["4840D6"],
        "callsign": [""],
        "id": ["4840D6"],
    }
    assert (description.time, description.wrap, description.id) == ("time", 86400.0, "id")
    assert (description.polar, description.azimuth_from) == (("range", "azimuth"), "north")
    assert notes == ["plots of category 048 from source 1/2"]


@settings(deadline=None, max_examples=30)
@given(
    st.integers(0, 86400 * 128 - 1),
    st.integers(0, 65535),
    st.integers(0, 65535),
    st.integers(0, 0o7777),
    st.integers(-8192, 8191),
    st.integers(0, 2**24 - 1),
)
def test_category_048_is_what_its_bits_say(
    tmp_path_factory, time, rho, theta, code, level, address
):
    # The two highest bits of the level mark it as doubtful and as garbled.
    raw = level & 0x3FFF
    signed = raw - 0x10000 if raw > 0x7FFF else raw
    data = block(48, plot_048(time, rho, theta, code=code, level=signed, address=address))
    columns, _, _ = read(written(tmp_path_factory.getbasetemp(), data, "property.ast"))
    assert columns["time"] == [time / 128]
    assert columns["range"] == [pytest.approx(rho / 256 * 1852, rel=1e-15)]
    assert columns["azimuth"] == [theta * 360 / 65536]
    assert columns["height"] == [pytest.approx(level / 4 * 100 * 0.3048, rel=1e-15)]
    assert columns["mode_3a"] == [f"{code:04o}"]
    assert columns["id"] == [f"{address:06X}"]


def test_category_001_as_published(tmp_path):
    # The example of CroatiaControl's asterix, and the values that are published with it.
    data = bytes.fromhex("01001AF7C619C9A00EB2767F189408AA42D8033405C8800D400E")
    columns, description, _ = read(written(tmp_path, data, "a.ast"))
    assert columns["source"] == ["25/201"]
    assert columns["track"] == ["3762"]
    assert columns["id"] == ["T3762"]
    assert columns["range"] == [236.9921875 * 1852]
    assert columns["azimuth"] == pytest.approx([34.5629883], abs=1e-7)
    assert columns["mode_3a"] == ["1464"]
    assert columns["height"] == pytest.approx([370 * 30.48])
    assert columns["time"] == [256.1015625]
    assert description.wrap == 512.0


def test_plots_and_tracks_of_category_001_in_one_block(tmp_path):
    plots = CATS[1].cv_uap.spec("plot"), CATS[1].cv_uap.spec("track")
    head = {"010": (("SAC", 1), ("SIC", 2)), "040": (("RHO", (2.0, "NM")), ("THETA", (90.0, "°")))}
    plot = {**head, "020": ((0, 0, 2, 0, 0, 0, None),), "070": 0o1234, "141": (3.0, "s")}
    track = {**head, "020": ((1, 0, 2, 0, 0, 0, None),), "161": 9, "141": (4.0, "s")}
    body = plots[0].create(plot), plots[1].create(track), plots[0].create(plot)
    encoded = CATS[1].create(list(body)).unparse().to_bytes()
    columns, _, _ = read(written(tmp_path, encoded, "a.ast"))
    assert columns["id"] == ["A1234", "T9", "A1234"]
    assert columns["time"] == [3.0, 4.0, 3.0]
    assert columns["range"] == [3704.0] * 3


def test_category_021(tmp_path):
    record = CATS[21].cv_record.create(
        {
            "010": (("SAC", 1), ("SIC", 2)),
            "040": ((0, 0, 0, 0, None),),
            "131": (("LAT", (45.5, "°")), ("LON", (-7.25, "°"))),
            "080": 0xABCDEF,
            "073": (86399.5, "s"),
            "077": (86399.75, "s"),
            "140": (10000.0, "ft"),
            "090": ((0, 0, 1), (0, 0, 10, None)),
        }
    )
    encoded = CATS[21].create([record]).unparse().to_bytes()
    # Longitude: 32 bits of 180/2**30 degrees.
    assert struct.pack(">i", round(-7.25 * 2**30 / 180)) in encoded
    columns, description, _ = read(written(tmp_path, encoded, "a.ast"))
    assert columns["lat"] == pytest.approx([45.5], abs=2e-7)
    assert columns["lon"] == pytest.approx([-7.25], abs=2e-7)
    assert columns["time"] == [86399.5]
    assert columns["id"] == ["ABCDEF"]
    assert columns["height"] == [3048.0]
    # Accuracy category 10: 95 % within 10 m, which is 2.4477 standard deviations.
    assert columns["sigma"] == pytest.approx([10 / 2.4477], rel=1e-4)
    assert (description.geodetic, description.wrap) == (("lat", "lon"), 86400.0)


@pytest.mark.parametrize("edition", generated.manifest["CATS"][21][:4])
def test_old_editions_of_category_021_are_counted_and_not_read(tmp_path, edition):
    assert edition.cv_edition < (1, 0)
    assert CATS[21].cv_edition > (1, 0)
    # Items that each of them had, the time (030) among them.
    values = {
        "010": (("SAC", 1), ("SIC", 2)),
        "040": 0x2000,
        "030": (43200.0, "s"),
        "130": (("LAT", (45.5, "°")), ("LON", (7.25, "°"))),
        "080": 0xABCDEF,
        "145": (330.0, "FL"),
    }
    old = edition.create([edition.cv_record.create(values)] * 3).unparse().to_bytes()
    with pytest.raises(DataError, match=r"before 1\.0, which are not read: 2 left"):
        read(written(tmp_path, old + old, "old.ast"))
    columns, _, notes = read(written(tmp_path, GOOD + old + GOOD, "a.ast"))
    assert columns["id"] == ["4840D6"] * 2
    assert notes[1:] == [
        "blocks of category 021 in an edition before 1.0, which are not read: 1 left out, first at "
        f"byte {len(GOOD)}"
    ]


def test_a_circle_of_category_021_holds_95_percent():
    rng = np.random.default_rng(1)
    radius = np.hypot(*rng.normal(scale=10 / math.sqrt(-2 * math.log(0.05)), size=(2, 10**6)))
    assert (radius < 10).mean() == pytest.approx(0.95, abs=1e-3)


def system_track(**more):
    items = {"010": (("SAC", 1), ("SIC", 2)), "070": (12.5, "s"), "040": 4711, **more}
    record = CATS[62].cv_record.create({name.strip("_"): item for name, item in items.items()})
    return CATS[62].create([record]).unparse().to_bytes()


ON_EARTH = {"_105": (("LAT", (-33.5, "°")), ("LON", (151.25, "°")))}
FLAT = {"_100": (("X", (-1000.5, "m")), ("Y", (2000.0, "m")))}


def test_category_062_on_earth(tmp_path):
    data = system_track(**ON_EARTH, **FLAT, _380={"ADR": 0x4840D6})
    columns, description, _ = read(written(tmp_path, data, "a.ast"))
    assert columns["lat"] == pytest.approx([-33.5], abs=6e-6)
    assert columns["lon"] == pytest.approx([151.25], abs=6e-6)
    # In an address some records of a track have, and others not.
    assert (columns["id"], columns["address"]) == (["T4711"], ["4840D6"])
    assert description.geodetic == ("lat", "lon")


def test_category_062_in_the_plane(tmp_path):
    accuracy = {"APC": (("X", (20.0, "m")), ("Y", (30.5, "m")))}
    data = system_track(**FLAT, _500=accuracy)
    columns, description, _ = read(written(tmp_path, data, "a.ast"))
    assert (columns["x"], columns["y"], columns["time"]) == ([-1000.5], [2000.0], [12.5])
    assert (columns["sigma_x"], columns["sigma_y"]) == ([20.0], [30.5])
    assert description.axes == ("x", "y")


def test_a_doubtful_level_and_code_are_none(tmp_path):
    garbled, doubtful = 0x4000, -0x8000
    for mark in (garbled, doubtful):
        data = block(48, plot_048(level=mark | 400, code=0o1234 | mark & 0xF000))
        columns, _, _ = read(written(tmp_path, data, "a.ast"))
        assert math.isnan(columns["height"][0])
        assert columns["mode_3a"] == [""]


# -------------------------------------------------------------------- which records


def test_the_first_source_and_category_are_read_and_others_counted(tmp_path):
    other = block(48, plot_048(source=(1, 3)))
    data = GOOD + other + system_track(**FLAT) + block(34, b"\x80\x01\x02") + GOOD
    file = written(tmp_path, data, "a.ast")
    columns, _, notes = read(file)
    assert columns["source"] == ["1/2", "1/2"]
    assert notes[1:] == [
        "records of category 048 from source 1/3: 1 left out, first at byte 24",
        "records of category 062 from source 1/2: 1 left out, first at byte 48",
        f"blocks of category 034: 1 left out, first at byte {48 + len(system_track(**FLAT))}",
    ]
    assert read(file, "asterix:source=1/3")[0]["source"] == ["1/3"]
    assert read(file, "asterix:category=62")[1].axes == ("x", "y")


def test_one_kind_of_position(tmp_path):
    data = system_track(**FLAT) + system_track(**ON_EARTH) + system_track()
    columns, _, notes = read(written(tmp_path, data, "a.ast"))
    assert columns["x"] == [-1000.5]
    assert [note.partition(":")[0] for note in notes[1:]] == [
        "records with another kind of position",
        "records without a position",
    ]


def test_a_record_without_source_has_that_of_the_one_before(tmp_path):
    bare = bytes([0b01111000]) + three(460800) + b"\x20" + struct.pack(">HHH", 256, 0, 0o1234)
    columns, _, _ = read(written(tmp_path, block(48, plot_048(), bare), "a.ast"))
    assert columns["source"] == ["1/2", "1/2"]
    assert columns["id"] == ["4840D6", "A1234"]


@pytest.mark.parametrize(
    ("identity", "id"),
    [("auto", "4840D6"), ("address", "4840D6"), ("track", "T17"), ("mode_3a", "A7777")],
)
def test_what_the_identity_is(tmp_path, identity, id):
    file = written(tmp_path, GOOD, "a.ast")
    assert read(file, f"asterix:identity={identity}")[0]["id"] == [id]


def test_plots_without_identity(tmp_path):
    file = written(tmp_path, block(48, primary_048(), primary_048(time=460900)), "a.ast")
    with pytest.raises(DataError, match=r"holds no plots: .*identity.* asterix:identity=none.*: 2"):
        read(file)
    columns, description, _ = read(file, "asterix:identity=none")
    assert "id" not in columns
    assert description.id is None
    assert len(columns["time"]) == 2


def test_a_track_that_was_not_detected_is_a_missed_plot(tmp_path):
    data = GOOD + block(48, plot_048(time=460900, kind=0))
    columns, _, notes = read(written(tmp_path, data, "a.ast"))
    assert math.isnan(columns["range"][1])
    assert math.isnan(columns["azimuth"][1])
    assert notes[1:] == ["records without a detection: 1 taken as missed, first at byte 24"]


def test_no_time_and_impossible_times_are_counted(tmp_path):
    timeless = bytes([0b10111000, 1, 2]) + b"\x20" + struct.pack(">HHH", 256, 0, 0o1234)
    data = GOOD + block(48, timeless) + block(48, plot_048(time=86400 * 128))
    columns, _, notes = read(written(tmp_path, data, "a.ast"))
    assert columns["time"] == [3600.0]
    assert [note.partition(":")[0] for note in notes[1:]] == [
        "records without a time",
        "records later than midnight",
    ]


def test_a_latitude_beyond_the_pole_is_counted(tmp_path):
    wrong = {"_105": (("LAT", (100.0, "°")), ("LON", (0.0, "°")))}
    data = system_track(**ON_EARTH) + system_track(**wrong)
    columns, _, notes = read(written(tmp_path, data, "a.ast"))
    assert len(columns["lat"]) == 1
    assert "records with a latitude beyond 90°: 1 left out" in notes[1]


def test_files_of_two_radars_are_not_read_as_one(tmp_path):
    files = [
        str(written(tmp_path, block(48, plot_048(source=source)), name))
        for source, name in (((1, 2), "a.ast"), ((1, 2), "b.ast"), ((1, 3), "c.ast"))
    ]
    assert PlotFiles.of(files[:2]).columns.read == ("range", "azimuth")
    message = r"c\.ast: holds plots .* source 1/3; expected .* 1/2, as in .*a\.ast"
    with pytest.raises(DataError, match=message):
        PlotFiles.of(files)


# -------------------------------------------------------------------- broken bytes


@pytest.mark.parametrize(
    ("data", "plots", "note"),
    [
        (b"\x00noise" + GOOD, 1, "bytes that are no block: 6 left out, first at byte 0"),
        (GOOD + b"\x00noise", 1, "bytes that are no block: 6 left out, first at byte 24"),
        (GOOD + GOOD[:-1], 1, "bytes that are no block: 23 left out, first at byte 24"),
        (GOOD + b"\x00\x00" + GOOD, 2, "bytes that are no block: 2 left out, first at byte 24"),
        # Its length is wrong: the record is lost, and the next one found.
        (GOOD + b"\x30\x00\x28" + GOOD[3:] + GOOD * 2, 3, "bytes that are no block: 24 left out"),
        # A record that ends too early, in a block of the right length.
        (
            block(48, plot_048(), b"\xff\xff") + GOOD,
            2,
            "bytes that are no record: 2 left out, first at byte 24",
        ),
        (block(48, b"\x00") + GOOD, 1, "bytes that are no record: 1 left out, first at byte 3"),
    ],
)
def test_broken_bytes_are_counted_and_the_rest_is_read(tmp_path, data, plots, note):
    columns, _, notes = read(written(tmp_path, data, "a.ast"))
    assert columns["range"] == [18520.0] * plots
    assert len(notes) == 2
    assert note in notes[1]


@settings(deadline=None, max_examples=30)
@given(st.lists(st.one_of(st.just(GOOD), st.binary(min_size=1, max_size=40)), max_size=12))
def test_good_blocks_between_any_bytes_are_found(parts):
    # A byte that is no category keeps what precedes a block from being taken for its head.
    data = b"".join(
        part if part == GOOD else part.replace(b"\x30", b"") + bytes(4) for part in parts
    )
    found = list(records(ByteStream("f", io.BytesIO(data)), Losses()))
    assert len([record for record in found if record.items.get_item("161")]) >= parts.count(GOOD)


@pytest.mark.parametrize("data", [b"", b"t,x\n0,1\n", b"\xff" * 5000, block(34, b"\x80\x01\x02")])
def test_a_file_without_plots_is_refused(tmp_path, data):
    with pytest.raises(DataError, match=r"a\.ast: holds no plots"):
        read(written(tmp_path, data, "a.ast"))


def test_a_capture_of_packets_is_refused_with_the_remedy(tmp_path):
    data = b"\xd4\xc3\xb2\xa1" + bytes(20)
    with pytest.raises(DataError, match=r"capture of network packets \(pcap\); write the payload"):
        read(written(tmp_path, data, "a.ast"))


# -------------------------------------------------------------------- large files, pieces


def test_blocks_are_found_wherever_parts_of_the_file_end(tmp_path):
    # Three megabytes, of which few are plots, and some are broken.
    filler = block(34, bytes(65_000))
    data = b"".join(filler + GOOD + bytes(5_000) + GOOD for _ in range(45))
    columns, _, notes = read(written(tmp_path, data, "a.ast"), rows=7)
    assert len(columns["time"]) == 90
    assert notes[1:] == [
        "blocks of category 034: 45 left out, first at byte 0",
        f"bytes that are no block: {45 * 5000} left out, first at byte {65_003 + 24}",
    ]


def test_pieces_are_parts_of_the_whole(tmp_path):
    plots = [plot_048(time=128 * k, rho=k) for k in range(20)]
    file = written(tmp_path, block(48, *plots), "a.ast")
    assert read(file, rows=7)[0] == read(file)[0]
    shares = []
    with open_table(str(file)) as source:
        rows = [t.rows.tolist() for t in source.tables({"time": "time"}, 8, shares.append)]
    assert rows == [list(range(1, 9)), list(range(9, 17)), list(range(17, 21))]
    assert shares[-1] == 1.0


# -------------------------------------------------------------------- options, installation


@pytest.mark.parametrize(
    ("format", "message"),
    [
        ("asterix:category=34", "category: 34 cannot be read; allowed: 1, 21, 48, 62"),
        ("asterix:identity=adress", "identity: unknown 'adress'; did you mean 'address'"),
    ],
)
def test_options_that_do_not_fit(format, message):
    with pytest.raises(ValueError, match=message):
        open_table("a.ast", format=format)


def test_without_the_library_the_command_is_told(monkeypatch):
    for name in ("asterix", "asterix.base", "asterix.generated"):
        monkeypatch.setitem(sys.modules, name, None)
    message = r"a\.ast: ASTERIX needs libasterix.*pip install 'fuzzytrack\[asterix\]'"
    with pytest.raises(DataError, match=message):
        Asterix().check("a.ast")
