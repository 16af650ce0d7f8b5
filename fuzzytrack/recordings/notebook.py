"""Tracked recordings in notebooks: a table of tracks with a small picture, as HTML."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fuzzytrack.recordings.totals import Totals
from fuzzytrack.trackers.result import TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["html_of"]

# Tracks in the table.
_LISTED = 10
_HEADS = ("plots", "missed", "duration (s)", "innovation RMS")


def html_of(
    title: str,
    tracks: Sequence[tuple[str, TrackResult]],
    faults: Sequence[str],
    figure: Figure,
) -> str:
    """HTML of tracks, with nothing in it from elsewhere.

    Parameters
    ----------
    title : str
        Line above the table.
    tracks : sequence of (str, TrackResult)
        Identity and result of each track.
    faults : sequence of str
        What was left out or put right.
    figure : Figure
        Picture of the tracks; it is closed.
    """
    from html import escape

    rows = [_row(escape(id or "track"), result) for id, result in tracks[:_LISTED]]
    more = len(tracks) - len(rows)
    if more > 0:
        rows.append(f"<tr><td colspan='{1 + len(_HEADS)}'>and {more} more</td></tr>")
    head = "".join(f"<th>{name}</th>" for name in ("", *_HEADS))
    below = f"<p>{escape('; '.join(faults))}</p>" if faults else ""
    return (
        f"<div><p>{escape(title)}</p><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{''.join(rows)}</tbody></table>{below}{_picture(figure)}</div>"
    )


def _row(name: str, result: TrackResult) -> str:
    totals = Totals.of([result]).summary
    numbers = (
        f"{totals['plots']}",
        f"{totals['missed']}",
        f"{totals['duration']:.6g}",
        f"{totals['innovation_rms']:.4g}",
    )
    cells = "".join(f"<td>{number}</td>" for number in numbers)
    return f"<tr><th>{name}</th>{cells}</tr>"


def _picture(figure: Figure) -> str:
    import matplotlib.pyplot as plt

    figure.set_size_inches(5, 3.5)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=80)
    plt.close(figure)
    code = base64.b64encode(data.getvalue()).decode()
    return f"<img alt='tracks' src='data:image/png;base64,{code}'>"
