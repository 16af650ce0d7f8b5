"""ASTERIX of category 062 as it is written, against decoders that share no code with it."""

import io
import math
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.io.cat062 import SystemTracks, is_cat062, write_blocks

# -------------------------------------------------------------------- a decoder of bits

# Fixed items of the user application profile of edition 1.18 by their place: number and bytes.
FIXED = {1: ("010", 2), 3: ("015", 1), 4: ("070", 3), 5: ("105", 8), 6: ("100", 6), 7: ("185", 4),
         8: ("210", 2), 9: ("060", 2), 10: ("245", 7), 12: ("040", 2)}  # fmt: skip
# Parts of compound items by their place in the primary subfield: name and bytes.
AGES = {1: ("TRK", 1), 2: ("PSR", 1), 3: ("SSR", 1)}
ACCURACIES = {1: ("APC", 4), 2: ("COV", 2), 3: ("APWC", 4), 4: ("AGA", 1), 5: ("ABA", 1),
              6: ("ATV", 2)}  # fmt: skip
COMPOUND = {14: ("290", AGES), 27: ("500", ACCURACIES)}
EXTENDED = {13: "080"}


class Bits:
    def __init__(self, data):
        self.text, self.at = "".join(f"{byte:08b}" for byte in data), 0

    def take(self, count):
        part = self.text[self.at : self.at + count]
        assert len(part) == count
        self.at += count
        return part

    def places(self):
        """Places that are set, in bytes of seven bits and one that goes on."""
        found, number = [], 0
        while True:
            *bits, more = self.take(8)
            for bit in bits:
                number += 1
                if bit == "1":
                    found.append(number)
            if more == "0":
                return found


def decoded(data):
    """Records of all blocks, each a dictionary of texts of bits."""
    stream, records, blocks = Bits(data), [], 0
    while stream.at < len(stream.text):
        begin = stream.at
        assert int(stream.take(8), 2) == 62
        end = begin + 8 * int(stream.take(16), 2)
        blocks += 1
        while stream.at < end:
            records.append(record(stream))
        assert stream.at == end
    return records, blocks


def record(stream):
    found = {}
    for place in stream.places():
        if place in FIXED:
            name, size = FIXED[place]
            found[name] = stream.take(8 * size)
        elif place in EXTENDED:
            parts = [stream.take(8)]
            while parts[-1][-1] == "1":
                parts.append(stream.take(8))
            found[EXTENDED[place]] = parts
        else:
            name, parts = COMPOUND[place]
            found[name] = {parts[k][0]: stream.take(8 * parts[k][1]) for k in stream.places()}
    return found


def signed(bits):
    value = int(bits, 2)
    return value - (1 << len(bits)) if bits[0] == "1" else value


def halves(bits):
    return bits[: len(bits) // 2], bits[len(bits) // 2 :]


def tracks(**changes):
    usual = SystemTracks(
        time=np.array([3600.5]),
        number=np.array([17]),
        position=np.array([[-1234.5, 60000.0]]),
        velocity=np.array([[12.25, -3.5]]),
        deviation=np.array([[10.0, 20.5, 1.25, 2.0]]),
        tentative=np.array([False]),
        coasting=np.array([False]),
        first=np.array([False]),
        age=np.array([12.5]),
        since_last=np.array([0.0]),
    )
    return replace(usual, **{name: np.array(value) for name, value in changes.items()})


def written(some, **options):
    stream = io.BytesIO()
    write_blocks(stream, some, **options)
    return stream.getvalue()


def test_a_record_bit_by_bit():
    # By hand from the specification: 010, 070, 100, 185 | 040, 080, 290 | none | 500.
    assert written(tracks(), source=(25, 201)).hex(" ") == (
        "3e 00 26 "
        "97 0f 01 04 "
        "19 c9 "
        "07 08 40 "
        "ff f6 5b 01 d4 c0 "
        "00 31 ff f2 "
        "00 11 "
        "81 01 01 00 "
        "c0 32 00 "
        "84 00 14 00 29 05 08"
    )


def test_all_items():
    place = np.array([[63.4389, -10.399]])
    (found,), blocks = decoded(written(tracks(place=place), source=(1, 2)))
    assert blocks == 1
    assert list(found) == ["010", "070", "105", "100", "185", "040", "080", "290", "500"]
    assert found["010"] == f"{1:08b}{2:08b}"
    assert int(found["070"], 2) / 128 == 3600.5
    lat, lon = (signed(part) * 180 / 2**25 for part in halves(found["105"]))
    assert (lat, lon) == pytest.approx((63.4389, -10.399), abs=90 / 2**25)
    assert [signed(part) / 2 for part in halves(found["100"])] == [-1234.5, 60000]
    assert [signed(part) / 4 for part in halves(found["185"])] == [12.25, -3.5]
    assert int(found["040"], 2) == 17
    assert {name: int(bits, 2) / 4 for name, bits in found["290"].items()} == {
        "TRK": 12.5, "PSR": 0,
    }  # fmt: skip
    assert [int(part, 2) / 2 for part in halves(found["500"]["APC"])] == [10, 20.5]
    assert [int(part, 2) / 4 for part in halves(found["500"]["ATV"])] == [1.25, 2]


@pytest.mark.parametrize("tentative", [False, True])
@pytest.mark.parametrize("coasting", [False, True])
@pytest.mark.parametrize("first", [False, True])
def test_status(tentative, coasting, first):
    some = tracks(tentative=[tentative], coasting=[coasting], first=[first])
    (found,), _ = decoded(written(some))
    one, two, three, four = found["080"]
    assert one[0] == "1"  # one sensor
    assert one[6] == "01"[tentative]  # CNF
    assert two[2] == "01"[first]  # TSB
    assert three[:7] == "0" * 7
    assert four[:2] == ("11" if coasting else "00")  # CST, PSR
    assert four[2:] == "0" * 6


def test_values_beyond_their_range_and_unknown_ones():
    some = tracks(
        time=[86400 * 2 - 1e-9],
        position=[[np.nan, 1.0]],
        velocity=[[1e6, -1e6]],
        deviation=[[np.nan] * 4],
        age=[1e9],
        since_last=[np.inf],
        place=[[np.nan, 3.0]],
    )
    (found,), _ = decoded(written(some))
    assert "100" not in found
    assert "105" not in found
    assert "500" not in found
    assert int(found["070"], 2) == 0
    assert [signed(part) for part in halves(found["185"])] == [2**15 - 1, -(2**15)]
    assert {int(bits, 2) for bits in found["290"].values()} == {255}


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 70), st.integers(0, 2**32 - 1))
def test_many_tracks_come_back_as_they_were(count, seed):
    rng = np.random.default_rng(seed)
    some = SystemTracks(
        rng.uniform(-1e5, 1e6, count),
        rng.integers(1, 65536, count),
        rng.uniform(-4e6, 4e6, (count, 2)),
        rng.uniform(-8e3, 8e3, (count, 2)),
        np.column_stack([rng.uniform(0, 3e4, (count, 2)), rng.uniform(0, 60, (count, 2))]),
        *(rng.uniform(size=(3, count)) < 0.5),
        *rng.uniform(0, 60, (2, count)),
        np.column_stack([rng.uniform(-90, 90, count), rng.uniform(-180, 180, count)]),
    )
    found, blocks = decoded(written(some))
    assert len(found) == count
    assert blocks == math.ceil(count / 20)

    def column(of, unit):
        return np.array([[unit * v for v in of(each)] for each in found]).reshape(count, -1)

    for got, given_, unit in (
        (column(lambda f: [int(f["070"], 2)], 1 / 128), some.time[:, None] % 86400, 1 / 128),
        (column(lambda f: map(signed, halves(f["100"])), 0.5), some.position, 0.5),
        (column(lambda f: map(signed, halves(f["185"])), 0.25), some.velocity, 0.25),
        (column(lambda f: map(signed, halves(f["105"])), 180 / 2**25), some.place, 180 / 2**25),
        (column(lambda f: [int(f["290"]["PSR"], 2)], 0.25), some.since_last[:, None], 0.25),
    ):
        apart = np.abs(got - given_)
        if unit == 1 / 128:  # midnight is 0
            apart = np.minimum(apart, 86400 - apart)
        assert (apart <= unit / 2 + 1e-9).all()
    assert [int(each["040"], 2) for each in found] == some.number.tolist()


def test_no_tracks_are_no_block():
    none = {name: values[:0] for name, values in vars(tracks()).items() if values is not None}
    assert written(SystemTracks(**none)) == b""


def test_suffixes():
    assert is_cat062("tracks.AST")
    assert is_cat062("tracks.cat062")
    assert not is_cat062("tracks.csv")


# -------------------------------------------------------------------- another decoder


@pytest.mark.skipif(find_spec("asterix") is None, reason="libasterix is not installed")
def test_libasterix_reads_the_same(tmp_path):
    from fuzzytrack.io.formats import open_table

    path = tmp_path / "tracks.ast"
    path.write_bytes(written(tracks(), source=(25, 201)))
    kinds = {"time": "time", "id": "word", "source": "word"}
    kinds |= dict.fromkeys(("x", "y", "vx", "vy", "sigma_x", "sigma_y"), "gaps")
    with open_table(str(path)) as source:
        (table,) = source.tables(kinds, None)
    numbers = {name: values[0] for name, values in table.numbers.items()}
    assert numbers == {
        "x": -1234.5, "y": 60000, "vx": 12.25, "vy": -3.5, "sigma_x": 10, "sigma_y": 20.5,
    }  # fmt: skip
    assert table.words["id"][0] == "T17"
    assert table.words["source"][0] == "25/201"
    assert float(table.cells["time"][0]) == 3600.5


@pytest.mark.skipif(find_spec("asterix") is None, reason="libasterix is not installed")
def test_libasterix_reads_status_and_ages():
    from asterix import base, generated

    some = tracks(tentative=[True], coasting=[True], first=[True], since_last=[5.0])
    body = written(some)[3:]
    newest = generated.manifest["CATS"][62][-1]
    bits = base.Bits.from_bytes(body)
    record, rest = newest.cv_record.parse(base.ParsingMode.StrictParsing, bits)
    assert len(rest) == 0
    status = record.get_item("080").variation
    names = ("MON", "CNF", "TSB", "TSE", "CST", "PSR", "SSR")
    assert [int(status.get_item(name).as_uint()) for name in names] == [1, 1, 1, 0, 1, 1, 0]
    ages = record.get_item("290").variation
    assert float(ages.get_item("TRK").variation.content.as_quantity("s")) == 12.5
    assert float(ages.get_item("PSR").variation.content.as_quantity("s")) == 5.0
