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


def test_a_line_without_end_is_cut(pipe):
    stream, end = pipe
    for _ in range(20):
        os.write(end, b"x" * 60_000)
        stream.look_ahead(10)
    (cut,) = stream.take(5.0)
    assert len(cut) > 1 << 20
    os.close(end)
