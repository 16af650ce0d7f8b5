"""What a reader gives of a file of plots: its columns, and tables of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

from fuzzytrack.io.table import Kind, Table, silent
from fuzzytrack.tasks import Progress

__all__ = ["Source"]


class Source(Protocol):
    """An open file of plots.

    A source may also have ``description``, a `PlotDescription` of what its format says of the
    columns; ``units``, a mapping of names of columns to units that the file gives apart from the
    names, as in a row of units; ``origin``, a text that says where the plots come from, if files of
    other origins have positions or times that do not fit to them; and ``notes``, a list of texts
    that grows while the file is read: what was left out of it, and why.
    """

    @property
    def file(self) -> str:
        """Name of the file, for messages."""

    @property
    def types(self) -> Mapping[str, str]:
        """Names of the columns, and the format's names for their types."""

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns.

        Parameters
        ----------
        kinds : mapping of str to Kind
            The columns, and what each must hold.
        rows : int or None
            Rows of a table, at most; without it the whole file is one table.
        progress : callable
            Called with the share of the file that has been read.

        Yields
        ------
        Table
            At least one row; no table of a file without rows.

        Raises
        ------
        DataError
            If a cell does not hold what it must; names row, column and value.
        """
