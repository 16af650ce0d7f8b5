"""Plots without identities tracked in one call: what the command ``scan`` does, in Python."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.reading import Reading
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.scan_fit import ScanFit
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.recordings.scan_run import ScannedScan, ScanTotals, run_scans, run_sectors
from fuzzytrack.recordings.scan_table import ScanTable
from fuzzytrack.recordings.scan_writer import check_scan_tracks, scan_writer
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners import as_scanner, shipped_scanners
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.scan.update import updates
from fuzzytrack.tasks import Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["ScanJob", "ScannedRecording", "track_scans"]

DEFAULT_SCANNER = "default"
# Rows that are written together.
_WRITTEN = 20_000


def track_scans(
    plots: Any,
    config: ScanTracker | str | os.PathLike[str] = DEFAULT_SCANNER,
    *,
    scan: str | None = None,
    period: float | None = None,
    group: str | None = None,
    own: tuple[str, ...] | None = None,
    scans: PathLike | None = None,
    lateness: float | None = None,
    sectors: int | None = None,
    tracker: str | None = None,
    tentative: bool = False,
    output_columns: Sequence[str] | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> ScannedRecording:
    """Track the plots of a radar, which have no identities, as ``fuzzytrack scan`` does.

    Parameters
    ----------
    plots : path, data frame, mapping or tuple
        A file or folder, or several in a list; a data frame of pandas or polars, a table of Arrow;
        a mapping from names to columns; or (time, plots), arrays of shape (n,) and (n, 2).
    config : ScanTracker, str or path
        The scan tracker: a shipped configuration, maybe with numbers that are changed as in
        ``default:sensor.detection=0.8``, or a file.
    scan : str, optional
        Column in which plots of one scan have the same word or number.
    period : float, optional
        Time of a turn of the antenna (s). Without both, scans are recognized.
    group : str, optional
        Column that says which of several recordings a row belongs to; each is tracked by itself.
    own : (str, str), optional
        Columns of the position of a moving radar, in the fixed frame of the plots.
    scans : str or path, optional
        Table of all scans, those without a plot included: the columns of scan, group and time, and
        maybe `own`.
    lateness : float, optional
        Plots that come up to so many seconds late are put in order, later ones left out. Without
        it, times that fall are an error.
    sectors : int, optional
        The antenna turns, and plots are tracked sector by sector behind it, so many a turn; see
        `fuzzytrack.recordings.scan_sectors`. Otherwise a scan is tracked when it is whole.
    tracker : str, optional
        Tracker of this package that takes the place of the configuration's track update, see
        `fuzzytrack.trackers.catalog.make_tracker`.
    tentative : bool
        Whether tentative tracks are reported, too.
    output_columns : sequence of str, optional
        Columns of tables, see `fuzzytrack.recordings.scan_table.ScanTable.of`.
    progress : callable, optional
        Called with the share of the recording that has been read.
    **options
        How the plots are read, as for `fuzzytrack.track`; identities are not used. Without `sigma`
        the plots have the noise that the configuration says.

    Returns
    -------
    ScannedRecording

    Raises
    ------
    DataError
        If the plots cannot be used; names row, column and value.
    ScannerError
        If there is no such configuration, or the file is none.
    TypeError
        If there is no such option, or the plots are something else.
    ValueError
        If the value of an option is wrong.
    OSError
        If a file cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> import fuzzytrack as ft
    >>> t = np.repeat(np.arange(12) * 1.7, 2)
    >>> x = np.where(np.arange(24) % 2, 2 * t, 100.0)
    >>> plots = {"t": t, "x": x, "y": 50 + x}
    >>> tracked = ft.track_scans(plots)
    >>> tracked.totals.summary["tracks"]
    2
    """
    job = ScanJob.of(
        plots,
        config,
        Reading.of(**options),
        tracker=tracker,
        output_columns=output_columns,
        scan=scan,
        period=period,
        group=group,
        own=own,
        scans=scans,
        lateness=lateness,
        sectors=sectors,
    )
    return job.whole(tentative=tentative, progress=progress)


@dataclass(frozen=True, eq=False)
class ScanJob:
    """Plots and the scan tracker for them, before they are tracked.

    Attributes
    ----------
    plots : ScanPlots
        The plots, and how they are divided into scans.
    scanner : ScanTracker
        The scan tracker.
    spec : str
        What names it.
    table : ScanTable
        Columns of the tracks.
    """

    plots: ScanPlots
    scanner: ScanTracker
    spec: str
    table: ScanTable

    def __repr__(self) -> str:
        return summary(self, "spec", "plots")

    @classmethod
    def of(
        cls,
        plots: Any,
        config: ScanTracker | str | os.PathLike[str],
        reading: Reading,
        *,
        tracker: str | None = None,
        output_columns: Sequence[str] | None = None,
        **how: Any,
    ) -> ScanJob:
        """Look at plots before they are tracked.

        Parameters
        ----------
        plots, config, tracker, output_columns
            As for `track_scans`.
        reading : Reading
            How the plots are read.
        **how
            How they are divided into scans, see `ScanPlots.of`.

        Raises
        ------
        DataError, ScannerError, ValueError, OSError
            As `track_scans`.
        """
        # First, since a tracker that cannot be made needs no files.
        scanner = scanner_with(config, tracker)
        spec = scanner.name if isinstance(config, ScanTracker) else os.fspath(config)
        if tracker is not None:
            spec = f"{spec} with {tracker}"
        read = ScanPlots.of(plots, reading, **how)
        table = ScanTable.of(read.files.decoder, read.columns.group, output_columns)
        return cls(read, scanner, spec, table)

    def run(
        self, *, tentative: bool = False, progress: Progress | None = None
    ) -> Iterator[ScannedScan]:
        """Track scan by scan, or sector by sector; see `fuzzytrack.recordings.scan_run`.

        After the last one, what says that the plots do not suit the scan tracker is noted.
        """
        plots = self.plots
        if plots.sectors is None:
            found = run_scans(self.scanner, plots.scans(progress), tentative=tentative)
        else:
            found = run_sectors(
                self.scanner,
                plots.rows(progress),
                plots.sectors,
                plots.cut.period,
                tentative=tentative,
                radar=plots.radar_place,
            )
        turn = plots.cut.period if plots.cut.rule == "period" else None
        fit = ScanFit(self.scanner, whole=plots.sectors is None, turn=turn)
        for each in found:
            fit.add(each)
            yield each
        plots.findings.check(plots.files.names[0])
        # Scans that are none say nothing about the configuration.
        if not plots.findings.doubt:
            plots.findings.note(fit.notes())

    def whole(
        self, *, tentative: bool = False, progress: Progress | None = None
    ) -> ScannedRecording:
        """Track all scans, and keep them."""
        kept: dict[str, list[ScannedScan]] = {}
        totals: dict[str, ScanTotals] = {}
        for each in self.run(tentative=tentative, progress=progress):
            kept.setdefault(each.group, []).append(each)
            totals.setdefault(each.group, ScanTotals()).add(each)
        results = {
            name: ScanResult.of(
                TrackReports.joined([each.reports for each in found]),
                [each.scan.time for each in found],
                [each.scan.own for each in found],
                [len(each.scan) for each in found],
                self.spec,
            )
            for name, found in kept.items()
        }
        scans = {name: tuple(each.scan for each in found) for name, found in kept.items()}
        return ScannedRecording(self, results, scans, totals)

    def write(
        self,
        path: PathLike | None,
        *,
        tentative: bool = False,
        progress: Progress | None = None,
        quote_formulas: bool = False,
    ) -> dict[str, ScanTotals]:
        """Track scan by scan, and write the tracks as they come, without keeping them.

        Parameters
        ----------
        path : str, path or None
            File for the tracks, see `fuzzytrack.recordings.scan_writer.scan_writer`; None writes
            none.
        tentative : bool
            Whether tentative tracks are written, too.
        progress : callable, optional
            Called with the share of the recording that has been read.
        quote_formulas : bool
            As for `fuzzytrack.io.table_writer`.

        Returns
        -------
        dict of str to ScanTotals
            Counts of each group.

        Raises
        ------
        DataError, OSError
            As `track_scans`, and `fuzzytrack.recordings.scan_writer.scan_writer`.
        """
        found = self.run(tentative=tentative, progress=progress)
        totals: dict[str, ScanTotals] = {}
        if path is None:
            for each in found:
                totals.setdefault(each.group, ScanTotals()).add(each)
            return totals
        writer = scan_writer(path, self.table, self.inputs, quote_formulas=quote_formulas)
        with writer as write:
            for group, reports in _together(found, totals):
                write(group, reports)
        return totals

    @property
    def inputs(self) -> tuple[PathLike, ...]:
        """Files that are read, which must not be overwritten."""
        listed = self.plots.list
        return (*self.plots.files.paths, *([listed.file] if listed is not None else []))

    def check(self, path: PathLike) -> None:
        """Check that the tracks can be written to a file, before they are made."""
        check_scan_tracks(path, self.table, self.inputs)


def _together(
    found: Iterator[ScannedScan], totals: dict[str, ScanTotals]
) -> Iterator[tuple[str, TrackReports]]:
    """Reports of several scans of one group together, counted."""
    held: list[TrackReports] = []
    group, rows = "", 0
    for each in found:
        totals.setdefault(each.group, ScanTotals()).add(each)
        if held and (each.group != group or rows >= _WRITTEN):
            yield group, TrackReports.joined(held)
            held, rows = [], 0
        group = each.group
        if len(each.reports):
            held.append(each.reports)
            rows += len(each.reports)
    if held:
        yield group, TrackReports.joined(held)


def scanner_with(
    config: ScanTracker | str | os.PathLike[str], tracker: str | None = None
) -> ScanTracker:
    """A scan tracker, maybe with a tracker of this package as its track update.

    Parameters
    ----------
    config, tracker
        As for `track_scans`.

    Raises
    ------
    ScannerError, ValueError
        As `track_scans`.
    """
    scanner = as_scanner(config)
    if tracker is None:
        return scanner
    if tracker in shipped_scanners():
        raise ValueError(
            f"tracker: {tracker!r} is a configuration of a scan tracker, not a tracker of the "
            "package; give it as `config`"
        )
    make = updates.get("tracker")
    return replace(scanner, update=make(tracker))


@dataclass(frozen=True, eq=False)
class ScannedRecording:
    """The tracks that a scan tracker made of a recording, or of several in one file.

    Attributes
    ----------
    job : ScanJob
        The plots, the scan tracker, and the columns of tables.
    results : mapping of str to ScanResult
        Tracks of each group; the empty word is the group of a single recording.
    scans : mapping of str to tuple of Scan
        The scans of each group.
    totals_of : mapping of str to ScanTotals
        Counts of each group.
    """

    job: ScanJob
    results: Mapping[str, ScanResult]
    scans: Mapping[str, tuple[Scan, ...]]
    totals_of: Mapping[str, ScanTotals]

    def __repr__(self) -> str:
        total = self.totals.summary
        return summary(self, spec=self.job.spec, scans=total["scans"], tracks=total["tracks"])

    def __len__(self) -> int:
        """Number of tracks that were confirmed."""
        return self.totals.summary["tracks"]

    @property
    def result(self) -> ScanResult:
        """Tracks of the recording.

        Raises
        ------
        ValueError
            If there are several groups.
        """
        if len(self.results) != 1:
            raise ValueError(f"group: expected one of {', '.join(self.results)}; see `results`")
        return next(iter(self.results.values()))

    @property
    def totals(self) -> ScanTotals:
        """Counts of all groups together."""
        total = ScanTotals()
        for each in self.totals_of.values():
            total.merge(each)
        return total

    def to_pandas(self) -> Any:
        """Table of the tracks, as `write` writes it.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        DataError
            If pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise DataError("pandas is not installed; pip install 'fuzzytrack[pandas]'") from None
        table = self.job.table
        parts = [
            pandas.DataFrame(table.values(group, result.reports, typed=True))
            for group, result in self.results.items()
        ]
        return pandas.concat(parts, ignore_index=True)

    def write(self, path: PathLike, *, quote_formulas: bool = False) -> None:
        """Write the tracks to a file, whole or not at all.

        Parameters
        ----------
        path : str or path
            Its suffix says the format, see `fuzzytrack.recordings.scan_writer.scan_writer`.
        quote_formulas : bool
            Whether cells that a spreadsheet would run are quoted.

        Raises
        ------
        DataError, OSError
            As `fuzzytrack.recordings.scan_writer.scan_writer`.
        """
        job = self.job
        with scan_writer(path, job.table, job.inputs, quote_formulas=quote_formulas) as write:
            for group, result in self.results.items():
                write(group, result.reports)

    def plot(self, group: str | None = None, **options: Any) -> Figure:
        """Picture of the tracks over their plots, see `fuzzytrack.plotting.plot_scan`.

        Parameters
        ----------
        group : str, optional
            Which group is drawn; the first unless given.
        **options
            Passed on.

        Raises
        ------
        ValueError
            If there is no such group.
        """
        from fuzzytrack.plotting import plot_scan

        name = next(iter(self.results)) if group is None else group
        if name not in self.results:
            raise ValueError(f"group: no {name!r}; expected one of {', '.join(self.results)}")
        given = {"axes_names": self.job.table.axes, **options}
        figure, _ = plot_scan(self.results[name], self.scans[name], **given)
        return figure

    def _repr_html_(self) -> str:
        """Counts of each group, with a small picture, for notebooks."""
        from fuzzytrack.html_reprs import block, paragraph, picture, table

        heads = list(self.totals.summary)
        rows = [
            [name or "all", *map(str, totals.summary.values())]
            for name, totals in self.totals_of.items()
        ]
        findings = self.job.plots.findings
        told = paragraph("; ".join((*findings.notes, *findings.sentences())), note=True)
        title = f"{counted(len(self), 'track')} by {self.job.spec}"
        return block(title, table(["", *heads], rows), told, picture(self.plot(), "tracks"))
