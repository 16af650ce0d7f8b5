"""Datagrams of ASTERIX, on a port of this computer."""

import socket
import struct

import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io.datagrams import AsterixDatagrams, DatagramStream, is_address


def test_addresses():
    assert is_address("udp://127.0.0.1:5000")
    assert not is_address("plots.csv")
    for text in ("udp://10.0.0.1:5000", "udp://127.0.0.1", "udp://127.0.0.1:70000", "udp://::1:5"):
        with pytest.raises(ValueError, match=r"expected udp://127.0.0.1:PORT"):
            DatagramStream(text)


def test_datagrams_as_they_come_until_an_empty_one():
    stream = DatagramStream("udp://127.0.0.1:0")
    try:
        assert stream.address == f"udp://127.0.0.1:{stream.port}"
        assert stream.take(0.0) == []
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for part in (b"one", b"two", b"", b"after the end"):
                sender.sendto(part, ("127.0.0.1", stream.port))
            found = []
            while (parts := stream.take(5.0)) is not None:
                assert parts
                found += parts
        assert found == [b"one", b"two"]
        assert stream.take(0.0) is None
        with pytest.raises(OSError, match="in use"):
            DatagramStream(stream.address)
    finally:
        stream.close()


def plots_048(*plots, source=(1, 2)):
    """A block of category 048: 010, 140, 020, 040 of (time, range in m, azimuth in deg)."""
    body = b""
    for time, distance, azimuth in plots:
        body += bytes([0b11110000, *source]) + struct.pack(">I", round(time * 128))[1:]
        body += bytes([0b00100000])
        body += struct.pack(
            ">HH", round(distance / 1852 * 256), round(azimuth / 360 * 65536) % 65536
        )
    return bytes([48]) + struct.pack(">H", len(body) + 3) + body


@pytest.fixture
def asterix():
    pytest.importorskip("asterix.generated", reason="libasterix is not installed")


@pytest.mark.usefixtures("asterix")
def test_tables_of_datagrams():
    first = [plots_048((10.0, 18520, 90), (10.5, 1852, 180))]
    tables = AsterixDatagrams("the feed", first)
    assert tables.description.polar == ("range", "azimuth")
    kinds = {"time": "time", "range": "gaps", "azimuth": "gaps"}
    (table,) = tables.tables(kinds, None)
    np.testing.assert_allclose(table.numbers["range"], [18520, 1852])
    later = tables.table([plots_048((11.0, 9260, 45)), plots_048((11.5, 926, 0))], 3, kinds)
    assert later.rows.tolist() == [3, 4]
    np.testing.assert_allclose(later.numbers["azimuth"], [45, 0])
    # Those of another radar are left out.
    with pytest.raises(DataError, match="holds no plots"):
        tables.table([plots_048((12.0, 9260, 45), source=(1, 3))], 5, kinds)
    assert any("from source 1/3" in note for note in tables.notes)


@pytest.mark.usefixtures("asterix")
@pytest.mark.parametrize(
    "broken",
    [b"0\xff\xff" + b"\xff" * 40, b"0\0\0", b"0", plots_048((12.0, 926, 0))[:-4]],
    ids=["long", "no-length", "one-byte", "cut"],
)
def test_a_broken_datagram_leaves_the_next_one_whole(broken):
    whole = [plots_048((10.0 + k, 18520, 90)) for k in range(2)]
    kinds = {"time": "time", "range": "gaps"}
    given = [broken, whole[0], broken, whole[1]]
    table = (tables := AsterixDatagrams("the feed", given)).table(given, 1, kinds)
    assert table.rows.tolist() == [1, 2]
    assert any("no whole block: 2 left out, first at datagram 1" in n for n in tables.notes)


@pytest.mark.usefixtures("asterix")
def test_bytes_that_are_no_block():
    with pytest.raises(DataError, match="holds no plots"):
        AsterixDatagrams("the feed", [b"what?"])
