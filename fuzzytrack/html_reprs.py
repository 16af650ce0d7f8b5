"""Values as HTML, which notebooks show: tables, facts and pictures, with styles of their own.

Nothing in it runs or is loaded from elsewhere. Text has the color of the page, and tints let its
background through, so that both fit a light page and a dark one.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from fuzzytrack.arrays import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Cell",
    "as_text",
    "block",
    "curves",
    "facts",
    "paragraph",
    "picture",
    "table",
    "tint",
    "tinted",
]

# Rows that a table shows; of more the number is told.
_ROWS = 60
# Hues of the least and of the greatest value: blue and orange, which differ for every eye.
_HUES = (215.0, 30.0)

_STYLE = """\
.fuzzytrack{overflow-x:auto;font-variant-numeric:tabular-nums}
.fuzzytrack table{border-collapse:collapse;margin:.3em 0;color:inherit;width:auto}
.fuzzytrack th,.fuzzytrack td{padding:.2em .6em;text-align:right;color:inherit;white-space:nowrap;
border:0;border-bottom:1px solid rgba(128,128,128,.35);background:none}
.fuzzytrack thead th{border-bottom:1px solid rgba(128,128,128,.9)}
.fuzzytrack .word{text-align:left}
.fuzzytrack .best{font-weight:bold}
.fuzzytrack tr,.fuzzytrack tbody tr:hover{background:none}
.fuzzytrack p{margin:.3em 0;max-width:46em}
.fuzzytrack .note{opacity:.75}
.fuzzytrack i{font-style:normal;padding:.1em .4em;border-radius:.3em}
.fuzzytrack svg,.fuzzytrack img{max-width:100%;height:auto}"""


class Cell(str):
    """HTML of a cell of a table, which is not escaped again."""


def block(title: str, *parts: str) -> str:
    """Parts of HTML under a title, with their styles.

    Parameters
    ----------
    title : str
        Text.
    *parts : str
        HTML.
    """
    style = _STYLE.replace("\n", "")
    head = f"<p><strong>{escape(title)}</strong></p>"
    return f'<div class="fuzzytrack"><style>{style}</style>{head}{"".join(parts)}</div>'


def paragraph(text: str, *, note: bool = False) -> str:
    """A paragraph of text; nothing if there is none."""
    if not text:
        return ""
    return f"<p{_class('note', note)}>{escape(text)}</p>"


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    words: int = 1,
    best: int | None = None,
    what: str = "rows",
) -> str:
    """A table whose first column names the rows.

    Parameters
    ----------
    heads : sequence of str
        Texts, or `Cell`.
    rows : iterable of sequence of str
        Texts, or `Cell`; of many rows the first are shown.
    words : int
        How many columns, from the left, hold words; the others hold numbers.
    best : int, optional
        A row that is printed bold.
    what : str
        What the rows are, for the line that says how many more there are.
    """
    every = list(rows)
    head = "".join(_cell("th", text, k < words, "col") for k, text in enumerate(heads))
    lines = [_row(row, words, number == best) for number, row in enumerate(every[:_ROWS])]
    more = len(every) - _ROWS
    below = paragraph(f"and {more} more {what}", note=True) if more > 0 else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>{below}"


def facts(values: Mapping[str, str]) -> str:
    """Names with what they are, a line each; those without a value are left out."""
    lines = [[name, value] for name, value in values.items() if value]
    body = "".join(_row(line, len(line), False) for line in lines)
    return f"<table><tbody>{body}</tbody></table>"


def _row(cells: Sequence[str], words: int, best: bool) -> str:
    kinds = ("th", *("td",) * (len(cells) - 1))
    line = "".join(
        _cell(kind, text, k < words, "row")
        for k, (kind, text) in enumerate(zip(kinds, cells, strict=True))
    )
    return f"<tr{_class('best', best)}>{line}</tr>"


def _cell(kind: str, text: str, word: bool, scope: str) -> str:
    inside = text if isinstance(text, Cell) else escape(text)
    more = f' scope="{scope}"' if kind == "th" else ""
    return f"<{kind}{more}{_class('word', word)}>{inside}</{kind}>"


def _class(name: str, holds: bool) -> str:
    return f' class="{name}"' if holds else ""


def tint(share: float) -> str:
    """Color of a value between the least (0) and the greatest (1), as a CSS background."""
    hue, strength = _hue(share)
    return f"hsla({hue:.0f},{90 * strength:.0f}%,50%,{0.14 + 0.24 * strength:.2f})"


def _hue(share: float) -> tuple[float, float]:
    """Hue and saturation: gray in the middle."""
    low, high = _HUES
    return (low, 1 - 2 * share) if share < 0.5 else (high, 2 * share - 1)


def tinted(text: str, share: float) -> Cell:
    """A word on the color of its value; see `tint`."""
    return Cell(f'<i style="background:{tint(share)}">{escape(text)}</i>')


def as_text(value: float, error: float = math.nan) -> str:
    """A number to four digits, or with its standard error to two digits of that; a dash for NaN."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else str(value)
    if not 0 < error < math.inf:
        return f"{value:.0f}" if 1e4 <= abs(value) < 1e9 else f"{value:.4g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def curves(x: Array, values: Mapping[str, Array], shares: Sequence[float]) -> str:
    """Curves between 0 and 1 over an interval as a small drawing, each with its name at its peak.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Increasing.
    values : mapping of str to ndarray, shape (n,)
        The curves; what is beyond 1 is cut off.
    shares : sequence of float
        Color of each; see `tint`.
    """
    wide, high, top = 300.0, 60.0, 14.0
    across = (x - x[0]) / (x[-1] - x[0]) * wide
    parts = []
    for (name, curve), share in zip(values.items(), shares, strict=True):
        down = top + high * (1 - np.clip(curve, 0, 1))
        # Where it is 0 it would hide the others; between equal values the ends are enough.
        kept = curve > 0
        kept[1:] |= curve[:-1] > 0
        kept[:-1] |= curve[1:] > 0
        kept[1:-1] &= (np.diff(down)[:-1] != 0) | (np.diff(down)[1:] != 0)
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across[kept], down[kept], strict=True))
        peak = float(np.mean(across[curve >= curve.max()]))
        edge = "start" if peak < 20 else "end" if peak > wide - 20 else "middle"
        parts.append(
            f'<polyline points="{path}" fill="none" stroke="{_ink(share)}" stroke-width="1.5"/>'
            f'<text x="{peak:.0f}" y="10" text-anchor="{edge}">{escape(name)}</text>'
        )
    base = f'<line x1="0" x2="{wide:g}" y1="{top + high:g}" y2="{top + high:g}" stroke="#888"/>'
    ends = "".join(
        f'<text x="{place:g}" y="{top + high + 12:g}" text-anchor="{edge}">{end:g}</text>'
        for place, edge, end in ((0, "start", x[0]), (wide, "end", x[-1]))
    )
    size = f'width="{wide:g}" height="{top + high + 16:g}"'
    view = f'viewBox="-4 0 {wide + 8:g} {top + high + 16:g}"'
    return (
        f'<svg role="img" {size} {view} font-size="10" fill="currentColor">'
        f"{base}{''.join(parts)}{ends}</svg>"
    )


def _ink(share: float) -> str:
    """Color of a line; see `tint`."""
    hue, strength = _hue(share)
    return f"hsl({hue:.0f},{80 * strength:.0f}%,50%)"


def picture(figure: Figure, text: str) -> str:
    """A picture as PNG inside of the HTML; the figure is closed.

    Parameters
    ----------
    figure : Figure
    text : str
        What it shows, for those who do not see it.
    """
    import matplotlib.pyplot as plt

    # Of its own size: legends are placed for that.
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=80)
    plt.close(figure)
    code = base64.b64encode(data.getvalue()).decode("ascii")
    return f'<img alt="{escape(text)}" src="data:image/png;base64,{code}">'
