"""Rows of large CSV files by pyarrow's parser, block by block; what is unusual is read by lines.

A block is parsed by pyarrow only if all readers agree on it: every line is a row, and every cell
that is wanted is a number or a word. Anything else in a block is left to the reader of the standard
library, whose tables and messages are so those of every file.
"""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.byte_stream import ByteStream
from fuzzytrack.io.csv_lines import Part, line_parts, text_lines
from fuzzytrack.io.recognition import HEAD, Layout
from fuzzytrack.io.table import Column, Kind
from fuzzytrack.io.text_form import TextForm

__all__ = ["block_parts", "is_large", "parser"]

#: Bytes from which on a file is large; to import pyarrow takes as long as to read a tenth of it.
LARGE = 10_000_000
# Bytes that are parsed at a time, by one thread each of these.
BLOCK, SHARE = 1 << 22, 1 << 20
# Bytes of a line, on average at least; what has shorter ones is nearly empty.
_SHORTEST = 4

_LINE_END, _RETURN, _BLANK, _QUOTE = b'\n\r "'


def is_large(stream: ByteStream) -> bool:
    """Whether a file is so large that pyarrow is faster."""
    if stream.size and not stream.compressed:
        return stream.size > LARGE
    start = stream.take(LARGE + 1)
    stream.put_back(start)
    return len(start) > LARGE


def parser() -> Any:
    """Pyarrow's module for CSV; None if it is not installed."""
    try:
        import pyarrow.csv
    except ImportError:
        return None
    return pyarrow.csv


def block_parts(
    stream: ByteStream, layout: Layout, kinds: Mapping[str, Kind], counts: dict[str, int]
) -> Iterator[Part]:
    """Parts of rows of a file in UTF-8; see `line_parts`.

    Parameters
    ----------
    stream : ByteStream
        The file, from its beginning.
    layout : Layout
        How it is written.
    kinds : mapping of str to Kind
        The columns that are wanted.
    counts : dict of str to int
        What is left out is added to it.
    """
    parse = _Parser(layout, kinds)
    if not _pass_names(stream, layout.lines):
        yield from _by_lines(stream, layout, 0, counts)
        return
    before, rest = layout.lines, b""
    while block := rest + (new := stream.take(BLOCK)):
        end = block.rfind(b"\n") + 1 if len(new) == BLOCK else len(block)
        text, rest = _Text(block[:end]), block[end:]
        part = parse(text, before + 1) if end else None
        if part is not None:
            yield part
        elif end and text.rows_end_with_lines(parse.delimiter):
            yield from _by_lines(BytesIO(text.data), layout, before, counts)
        else:
            stream.put_back(block)
            yield from _by_lines(stream, layout, before, counts)
            return
        before += text.line_count


def _pass_names(stream: ByteStream, lines: int) -> bool:
    """Pass over the first lines; False if their ends are not plain, and nothing is passed over."""
    head = stream.take(HEAD)
    end = 0
    for _ in range(lines):
        end = head.find(b"\n", end) + 1
        if not end:
            break
    passed = head[:end]
    plain = (end > 0 or not lines) and passed.count(b"\r") == passed.count(b"\r\n")
    stream.put_back(head[end:].removeprefix(BOM_UTF8 if not lines else b"") if plain else head)
    return plain


def _by_lines(stream: Any, layout: Layout, before: int, counts: dict[str, int]) -> Iterator[Part]:
    lines = text_lines(stream, "utf-8" if before else "utf-8-sig")
    return line_parts(lines, layout, before, counts)


class _Text:
    """Some lines of a file, as bytes."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.bytes = np.frombuffer(data, dtype=np.uint8)
        self.feeds = data.count(b"\n")
        self.returns = data.count(b"\r") if b"\r" in data else 0
        self.has_quotes = b'"' in data
        self._quotes_are_plain: bool | None = None

    @cached_property
    def ends(self) -> NDArray[np.int64]:
        """Where lines end."""
        return np.flatnonzero(self.bytes == _LINE_END)

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where lines begin."""
        starts = np.concatenate([[0], self.ends + 1])
        return starts[:-1] if starts[-1] == len(self.data) else starts

    @property
    def ends_are_plain(self) -> bool:
        """Whether all lines end with a line feed, maybe after a carriage return."""
        return not self.returns or self.returns == self.data.count(b"\r\n")

    @property
    def line_count(self) -> int:
        """Lines as Python counts them."""
        ends = self.feeds
        if not self.ends_are_plain:
            ends += self.returns - self.data.count(b"\r\n")
        return ends + (self.data[-1:] not in (b"\n", b"\r"))

    def rows_end_with_lines(self, delimiter: int) -> bool:
        """Whether no quoted cell goes beyond its line, and quotes are around whole cells only."""
        if not self.has_quotes:
            return True
        if self._quotes_are_plain is None:
            self._quotes_are_plain = self._has_plain_quotes(delimiter)
        return self._quotes_are_plain

    def _has_plain_quotes(self, delimiter: int) -> bool:
        quotes = np.flatnonzero(self.bytes == _QUOTE)
        if len(quotes) % 2:
            return False
        first, last = quotes[::2], quotes[1::2]
        # A line feed stands for the beginning and the end of the text.
        around = np.concatenate([[_LINE_END], self.bytes, [_LINE_END]])
        before, after = around[first], around[last + 2]
        return bool(
            np.isin(before, (delimiter, _LINE_END)).all()
            and np.isin(after, (delimiter, _LINE_END, _RETURN)).all()
            and (np.searchsorted(self.ends, first) == np.searchsorted(self.ends, last)).all()
        )


class _Parser:
    """pyarrow's parser for the columns that are wanted."""

    def __init__(self, layout: Layout, kinds: Mapping[str, Kind]) -> None:
        form = layout.form
        self.delimiter = ord(form.delimiter or ",")
        self._kinds, self._layout = kinds, layout
        self._csv = parser()
        # Lines that begin so may be blank or comments, or no lines of their own.
        self._unusual = np.zeros(256, dtype=bool)
        self._unusual[[_LINE_END, _RETURN, _BLANK, self.delimiter]] = True
        self._unusual[list((form.comment[:1] + "\ufeff").encode()[:2])] = True
        places = {name: f"{place}" for place, name in enumerate(layout.names) if name}
        self._places = {name: places[name] for name in kinds}
        self._names = [f"{place}" for place in range(len(layout.names))]
        self._convert = self._csv.ConvertOptions(
            include_columns=list(self._places.values()),
            column_types={
                place: "double" if kinds[name] in ("number", "gaps") else "string"
                for name, place in self._places.items()
            },
            null_values=_spellings(form),
            decimal_point=form.decimal or ".",
        )

    def __call__(self, text: _Text, row: int) -> _Arrays | None:
        """Rows of some lines, the first of which is `row`; None if anything is unusual."""
        if not self._is_usual(text):
            return None
        parsed = self._parsed(text)
        if parsed is None:
            return None
        values: dict[str, Any] = {}
        for name, kind in self._kinds.items():
            column = parsed.column(self._places[name])
            if kind not in ("number", "gaps"):
                values[name] = column if kind != "word" else _words(column)
            elif (numbers := _numbers(column, kind)) is not None:
                values[name] = numbers
            else:
                return None
        return _Arrays(np.arange(row, row + parsed.num_rows), values)

    def _is_usual(self, text: _Text) -> bool:
        """Whether every line is a row."""
        if text.feeds * _SHORTEST > len(text.data):
            return False
        starts = text.starts
        if self._unusual[text.bytes[starts]].any() or not text.ends_are_plain:
            return False
        if text.has_quotes:
            if not text.rows_end_with_lines(self.delimiter):
                return False
            quoted = starts[text.bytes[starts] == _QUOTE] + 1
            # Maybe a row of blank cells.
            if np.isin(text.bytes[quoted], (_QUOTE, _BLANK)).any():
                return False
        return b"\0" not in text.data and self._can_tell_names and _is_utf8(text.data)

    @property
    def _can_tell_names(self) -> bool:
        """Whether names among the rows are an error of some column."""
        missing = self._layout.form.missing
        return any(
            kind in ("number", "gaps") and name.lower() not in missing
            for name, kind in self._kinds.items()
        )

    def _parsed(self, text: _Text) -> Any:
        import pyarrow

        try:
            return self._csv.read_csv(
                pyarrow.BufferReader(text.data),
                read_options=self._csv.ReadOptions(column_names=self._names, block_size=SHARE),
                parse_options=self._csv.ParseOptions(
                    delimiter=chr(self.delimiter),
                    quote_char='"' if text.has_quotes else False,
                    ignore_empty_lines=False,
                ),
                convert_options=self._convert,
            )
        except pyarrow.ArrowException:
            return None


class _Arrays:
    """Rows as arrays of numbers, words and text."""

    def __init__(self, rows: NDArray[np.int64], values: Mapping[str, Any]) -> None:
        self.rows, self._values = rows, values

    def take(self, columns: Sequence[Column], start: int, stop: int) -> None:
        """Add the cells of some of the rows to the columns."""
        for column in columns:
            values = self._values[column.name]
            rows = self.rows[start:stop]
            if column.kind in ("number", "gaps"):
                column.take_numbers(values[start:stop], rows)
            elif column.kind == "word":
                names, codes = values
                column.take_words(*_used(names, codes, start, stop))
            else:
                part = values.slice(start, stop - start).to_numpy().tolist()
                column.take_cells(part, rows.tolist())


def _numbers(column: Any, kind: Kind) -> Array | None:
    """Numbers, NaN where there is none; None if that or another number is not allowed."""
    values: Array = column.to_numpy()
    strange = len(values) - int(np.isfinite(values).sum())
    allowed = column.null_count if kind == "gaps" else 0
    return values if strange == allowed else None


def _words(column: Any) -> tuple[list[str], NDArray[np.int64]]:
    """Different words, and for each row which."""
    encoded = column.combine_chunks().dictionary_encode()
    return encoded.dictionary.to_pylist(), encoded.indices.to_numpy()


def _used(
    names: list[str], codes: NDArray[np.int64], start: int, stop: int
) -> tuple[list[str], NDArray[np.int64]]:
    """Words of some rows, in order of first appearance, and for each row which."""
    import pyarrow

    if stop - start == len(codes):
        return names, codes
    encoded = pyarrow.array(codes[start:stop]).dictionary_encode()
    return [names[code] for code in encoded.dictionary.to_pylist()], encoded.indices.to_numpy()


def _spellings(form: TextForm) -> list[str]:
    """What stands for a missing number, in the cases that it usually has."""
    found = {form.title() for form in form.missing} | form.missing | set(form.na)
    return sorted(found | {word.upper() for word in found} | {word.lower() for word in found})


def _is_utf8(data: bytes) -> bool:
    if data.isascii():
        return True
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
