"""Rows of a table as text, CSV or lines of JSON, for answers that are written one by one."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Collection, Sequence
from io import StringIO
from typing import Any

import numpy as np

from fuzzytrack.io.csv import csv_rows
from fuzzytrack.io.table import Values

__all__ = ["csv_text", "json_text"]

# A number as JSON writes it.
_NUMBER = re.compile(r"-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?", re.ASCII)


def csv_text(values: Values, names: Sequence[str], quote_formulas: bool = False) -> str:
    """Rows of CSV, each with its end.

    Parameters
    ----------
    values : mapping of str to (sequence of str or ndarray)
        Columns of one length.
    names : sequence of str
        Which of them, in order.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.
    """
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows(csv_rows([values[name][:] for name in names], quote_formulas))
    return text.getvalue()


def json_text(values: Values, names: Sequence[str], numbers: Collection[str] = ()) -> str:
    """Lines of JSON, each an object with null for NaN.

    Parameters
    ----------
    values, names
        As for `csv_text`.
    numbers : collection of str
        Columns of text that are written as numbers where they are such.
    """
    columns = [_json_cells(values[name][:], name in numbers) for name in names]
    # The names stand between the cells, and a percent sign in one of them is doubled.
    keys = [json.dumps(name, ensure_ascii=False).replace("%", "%%") for name in names]
    form = "{" + ", ".join(f"{key}: %s" for key in keys) + "}\n"
    return "".join([form % row for row in zip(*columns, strict=True)])


def _json_cells(values: Any, number: bool) -> list[str]:
    if not isinstance(values, np.ndarray):
        return [
            text if number and _NUMBER.fullmatch(text) else json.dumps(text, ensure_ascii=False)
            for text in map(str, values)
        ]
    if values.dtype.kind == "b":
        return ["true" if value else "false" for value in values.tolist()]
    show: Callable[[Any], str] = repr if values.dtype.kind in "iuf" else _text
    cells = list(map(show, values.tolist()))
    for index in np.flatnonzero(np.isnan(values)).tolist():
        cells[index] = "null"
    return cells


def _text(value: Any) -> str:
    return json.dumps(str(value))
