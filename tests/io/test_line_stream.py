"""Lines of a pipe as they come."""

from __future__ import annotations

import os

import pytest

from fuzzytrack.io.line_stream import LineStream


@pytest.fixture
def pipe():
    """A stream of lines, and what writes to it."""
    reads, writes = os.pipe()
    yield LineStream(reads), writes
    os.close(reads)


def test_lines_come_whole_and_at_once(pipe):
    stream, end = pipe
    os.write(end, b"one\ntw")
    assert stream.take(5.0) == [b"one\n"]
    assert stream.take(0.01) == []
    os.write(end, b"o\nthree")
    assert stream.take(5.0) == [b"two\n"]
    os.close(end)
    assert stream.take(5.0) == [b"three\n"]
    assert stream.take(5.0) is None
    assert stream.take() is None


def test_many_lines_come_in_parts(pipe):
    stream, end = pipe
    os.write(end, b"a\n" * 1200)
    os.close(end)
    assert [len(stream.take(5.0)) for _ in range(3)] == [500, 500, 200]
    assert stream.take(5.0) is None


def test_to_look_ahead_takes_nothing(pipe):
    stream, end = pipe
    os.write(end, b"a\nb\n")
    assert not stream.look_ahead(10)
    os.close(end)
    assert stream.look_ahead(10)
    assert stream.take(5.0) == [b"a\n", b"b\n"]


@pytest.mark.parametrize("ends", ["\n0,a\n", "\n0,a"])
def test_of_a_line_that_is_too_long_nothing_but_its_beginning_is_kept(pipe, ends):
    stream, end = pipe
    for _ in range(40):
        os.write(end, b"x" * 60_000)
        assert not stream.look_ahead(10)
    # The end of it would be a plot.
    os.write(end, f",7,b{ends}".encode())
    os.close(end)
    stream.look_ahead(10)
    cut, after = stream.take(5.0)
    assert (1 << 20) < len(cut) < (1 << 20) + 10
    assert set(cut) == set(b"x\n")
    assert after == b"0,a\n"
    assert stream.take() is None
