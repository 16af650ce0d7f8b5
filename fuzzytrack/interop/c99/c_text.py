"""Numbers, arrays and comments as lines of C."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.identifiers import ascii_text

__all__ = ["WIDTH", "array_lines", "comment_lines", "literal"]

#: Columns of a line.
WIDTH = 100


def literal(value: Any) -> str:
    """A number as C writes it: ``f`` behind a float, ``U`` behind an unsigned integer."""
    if isinstance(value, np.integer):
        return f"{value}U" if isinstance(value, np.unsignedinteger) else f"{value}"
    if np.isnan(value):
        return "NAN"
    # The shortest text that reads as the same number.
    text = str(value) if isinstance(value, np.float32) else repr(float(value))
    return f"{text}f" if isinstance(value, np.float32) else text


def array_lines(c_type: str, name: str, values: Sequence[Any], row: int = 0) -> list[str]:
    """Definition of a constant array, its columns aligned.

    Parameters
    ----------
    c_type, name : str
    values : sequence of numbers
    row : int
        Values to a row of a table; 0 if they are one row, broken where the line is full.
    """
    words = [literal(v) for v in values]
    width = max(map(len, words))
    fit = max(1, (WIDTH - 8) // (width + 2))
    words = [word.rjust(width) for word in words]
    rows = [words[k : k + row] for k in range(0, len(words), row)] if row else [words]
    lines = [", ".join(part[k : k + fit]) for part in rows for k in range(0, len(part), fit)]
    head = f"static const {c_type} {name}[{len(words)}] = {{"
    whole = f"{head} {', '.join(w.strip() for w in words)} }};"
    if len(whole) <= WIDTH - 4 and (not row or row >= len(words)):
        return [whole]
    return [head, *(f"    {line}," for line in lines[:-1]), f"    {lines[-1]}", "};"]


def comment_lines(entries: Iterable[tuple[str, str]], column: int = 14) -> list[str]:
    """A block comment of names and texts in two columns; a text without a name has the width."""
    lines = ["/*"]
    for name, text in entries:
        # Neither the end of the comment nor a trigraph.
        clean = re.sub(r"\?(?=\?)", "? ", ascii_text(text))
        clean = clean.replace("*/", "* /").replace("/*", "/ *")
        first = f" * {name:<{column}}" if name else " * "
        rest = f" * {'':<{column}}" if name else " * "
        lines += textwrap.wrap(
            clean, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=True
        ) or [" *"]
    return [line.rstrip() for line in (*lines, " */")]
