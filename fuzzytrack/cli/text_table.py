"""A table as lines of text that fit a terminal of any width."""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["table_lines", "wrapped"]

# Spaces between columns, and before what belongs to a name that has a line of its own.
_GAP, _INDENT = 2, 2
# Where text may be broken: at spaces, and behind the colons in the names of trackers.
_PIECE = re.compile(r"[^\s:]*:+(?=\S)|\S+")

_Cells = Sequence[str]


def table_lines(columns: _Cells, rows: Sequence[_Cells], width: int, words: int = 1) -> list[str]:
    """Lines of a table, no wider than a terminal.

    Numbers are never broken, and words only at spaces and behind ``:``. Where the columns
    have no room even so, the table is turned: each row becomes a few lines, one for each cell.

    Parameters
    ----------
    columns : sequence of str
        Heads.
    rows : sequence of sequence of str
        Cells, as many as heads; an empty row is an empty line.
    width : int
        Of the terminal, in characters. One that is narrower than a number, or than a piece of a
        name, is exceeded by it.
    words : int
        How many columns, from the left, hold words; the others hold numbers.
    """
    widths = _widths([columns, *filter(None, rows)], words, width)
    if sum(widths) + _GAP * (len(widths) - 1) > width:
        return _turned(columns, rows, width)
    lines = [*_row(columns, widths, words), "─" * (sum(widths) + _GAP * (len(widths) - 1))]
    for number, row in enumerate(rows):
        if row:
            lines += _row(row, widths, words)
        elif number:
            lines.append("")
    return lines


def wrapped(text: str, width: int, indent: int = 0) -> list[str]:
    """Text in lines that are broken at spaces, and behind ``:``; at least one line.

    Parameters
    ----------
    text : str
    width : int
        Of a line, in characters; a longer piece has a line of its own.
    indent : int
        Spaces before every line but the first.
    """
    lines, line = [], ""
    for piece, space in _pieces(text):
        longer = f"{line}{space}{piece}" if line.strip() else line + piece
        if line.strip() and _length(longer) > width:
            lines.append(line)
            longer = " " * indent + piece
        line = longer
    return [*lines, line]


def _pieces(text: str) -> list[tuple[str, str]]:
    """Pieces that are never broken, each with the space before it."""
    found = [match.span() for match in _PIECE.finditer(text)]
    ends = [0, *(end for _, end in found)]
    return [
        (text[start:end], " " if start > before else "")
        for (start, end), before in zip(found, ends, strict=False)
    ]


def _length(text: str) -> int:
    from rich.cells import cell_len

    return cell_len(text)


def _widths(lines: Sequence[_Cells], words: int, room: int) -> list[int]:
    """Widths of columns; where there is too little room, the widest ones of words are narrowed."""
    widths, least = [], []
    for number, cells in enumerate(zip(*lines, strict=True)):
        parts = cells
        if number < words:
            parts = tuple(piece for cell in cells for piece, _ in _pieces(cell))
        widths.append(max(map(_length, cells)))
        least.append(max(map(_length, parts), default=0))
    while sum(widths) + _GAP * (len(widths) - 1) > room:
        wide = [width if width > low else 0 for width, low in zip(widths, least, strict=True)]
        if not any(wide):
            break
        widths[wide.index(max(wide))] -= 1
    return widths


def _row(cells: _Cells, widths: Sequence[int], words: int) -> list[str]:
    """Lines of a row: words at the left of their column, numbers at the right of theirs."""
    parts = [
        wrapped(cell, width) if k < words else [cell]
        for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
    ]
    lines = []
    for number in range(max(map(len, parts))):
        texts = [each[number] if number < len(each) else "" for each in parts]
        spaces = [" " * (width - _length(text)) for text, width in zip(texts, widths, strict=True)]
        placed = [
            text + space if k < words else space + text
            for k, (text, space) in enumerate(zip(texts, spaces, strict=True))
        ]
        lines.append((" " * _GAP).join(placed).rstrip())
    return lines


def _turned(columns: _Cells, rows: Sequence[_Cells], width: int) -> list[str]:
    """Lines of a table whose columns have no room side by side."""
    lead = 1
    while lead < len(columns) and not columns[lead]:
        lead += 1
    heads = columns[lead:]
    longest = max(map(_length, heads), default=0)
    lines = [*wrapped(columns[0], width), "─" * width] if columns[0] else ["─" * width]
    for number, row in enumerate(rows):
        if not row:
            lines += [""] if number else []
            continue
        name = " ".join(filter(None, row[:lead]))
        lines += wrapped(name, width, _INDENT) if name else []
        for head, cell in zip(heads, row[lead:], strict=True):
            if cell.strip():
                lines += _entry(head, cell.strip(), longest, width)
    return lines


def _entry(head: str, cell: str, longest: int, width: int) -> list[str]:
    """Lines of one cell of a turned table."""
    if not head:
        return [" " * _INDENT + each for each in wrapped(cell, width - _INDENT)]
    text = " " * _INDENT + head + " " * (longest - _length(head) + _GAP)
    if _length(text) + _length(cell) <= width:
        return [text + cell]
    # Below its head, where a whole line has room for it.
    lines = []
    for words, spaces in ((head, _INDENT), (cell, 2 * _INDENT)):
        lines += [" " * spaces + each for each in wrapped(words, width - spaces)]
    return lines
