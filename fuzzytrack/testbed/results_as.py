"""Statistics of trackers as rows, as plain types for JSON, and as a data frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.json_types import plain
from fuzzytrack.version import __version__

if TYPE_CHECKING:
    import pandas

__all__ = ["data_frame", "json_dict", "rows"]


def rows(columns: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Columns of equal length as rows, a dict each."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def json_dict(
    facts: Mapping[str, Any],
    trackers: Sequence[Mapping[str, Any]],
    time: Array,
    curves: Mapping[str, Array],
) -> dict[str, Any]:
    """Summary and curves in plain types, with None for every number that is not finite.

    Parameters
    ----------
    facts : mapping of str to value
        What is known of the experiment as a whole, in plain types.
    trackers : sequence of mapping
        A row of each tracker, with its ``name``.
    time : ndarray, shape (n_steps,)
        Times of the scans (s).
    curves : mapping of str to ndarray, shape (n_trackers, n_steps)
        Curves over the scans, by name.

    Returns
    -------
    dict
        ``fuzzytrack`` (version), the facts, ``trackers``, ``time``, and ``curves``: those of each
        tracker by its name.
    """
    content: dict[str, Any] = plain(
        {
            "fuzzytrack": __version__,
            **facts,
            "trackers": list(trackers),
            "time": time.tolist(),
            "curves": {
                row["name"]: {column: curve[k].tolist() for column, curve in curves.items()}
                for k, row in enumerate(trackers)
            },
        }
    )
    return content


def data_frame(names: Sequence[str], time: Array, curves: Mapping[str, Array]) -> pandas.DataFrame:
    """Curves as a table, a row for each tracker and scan.

    Parameters
    ----------
    names : sequence of str
        The trackers.
    time, curves
        As for `json_dict`.

    Raises
    ------
    ImportError
        If pandas is not installed.
    """
    try:
        import pandas
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install pandas") from error
    n_trackers, n_steps = len(names), len(time)
    return pandas.DataFrame(
        {
            "tracker": np.repeat(np.array(names, dtype=object), n_steps),
            "scan": np.tile(np.arange(n_steps), n_trackers),
            "time": np.tile(time, n_trackers),
            **{name: curve.ravel() for name, curve in curves.items()},
        }
    )
