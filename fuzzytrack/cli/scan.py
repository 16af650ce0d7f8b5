"""The command that makes tracks of plots without identities."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.complaints import printable
from fuzzytrack.cli.live_run import SavedState
from fuzzytrack.cli.noise_words import noise_json, noise_sentence
from fuzzytrack.cli.output import print_json, print_table, progress, say, say_notes
from fuzzytrack.cli.output_file import STANDARD_OUTPUT, output_file, told_aside
from fuzzytrack.cli.pictures import check_picture, save_picture
from fuzzytrack.cli.plot_options import number_or, reads_scans
from fuzzytrack.io.byte_stream import STANDARD_INPUT
from fuzzytrack.io.files import PathLike, check_output
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_run import ScanTotals
from fuzzytrack.recordings.scanning import (
    DEFAULT_SCANNER,
    ScanJob,
    ScannedRecording,
    scanner_with,
)
from fuzzytrack.scoring.clock_lag import Lag, by_clock_of, lag_of
from fuzzytrack.scoring.metrics import Settings
from fuzzytrack.scoring.positions import Positions

__all__ = ["scan"]

# Headings in the help.
_SCANS, _TRACKS = "Scans", "Tracks"
_HEADS = {
    "scans": "scans",
    "empty_scans": "empty",
    "plots": "plots",
    "tracks": "tracks",
    "moving": "moving",
    "static": "static",
    "undecided": "undecided",
}


@reads_scans
def scan(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE|DIR...", help="Files of plots, a folder of them, or -."),
    ],
    reading: Reading,
    config: Annotated[
        str,
        typer.Option(
            metavar="NAME|FILE.yaml",
            help="Configuration of the scan tracker; NAME:role.number=value changes it.",
            rich_help_panel=_TRACKS,
        ),
    ] = DEFAULT_SCANNER,
    tracker: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE.yaml",
            help="Tracker that updates the tracks, see `fuzzytrack trackers`. "
            "[default: the configuration's]",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    tentative: Annotated[
        bool,
        typer.Option("--tentative", help="Report tentative tracks, too.", rich_help_panel=_TRACKS),
    ] = False,
    scan: Annotated[
        str | None,
        typer.Option(
            metavar="COL",
            help="Column that says which scan a plot is of. [default: recognized]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    period: Annotated[
        str | None,
        typer.Option(
            metavar="S",
            help="Time of a turn of the antenna, s. [default: recognized]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    scans: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Table of all scans, those without a plot included: scan, time, own position.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    group: Annotated[
        str | None,
        typer.Option(
            metavar="COL",
            help="Column that says which of several recordings a row is of.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    own: Annotated[
        str | None,
        typer.Option(
            metavar="COL,COL|X,Y",
            help="Position of the radar in the frame of the plots: columns, or numbers, m.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    lateness: Annotated[
        str | None,
        typer.Option(
            metavar="S",
            help="Put plots up to S seconds late in order, and leave out later ones. "
            "[default: none may be late]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    sectors: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Track sector by sector behind a turning antenna, N a turn. "
            "[default: whole scans]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.csv|-",
            help="Write the tracks (or .parquet; .geojson, .kml, .czml, .gpx; .ast for ASTERIX "
            "CAT 062); - prints CSV.",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    output_columns: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,NEW=C",
            help="Columns of -o, in this order, maybe under new names. [default: all]",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    quote_formulas: Annotated[
        bool,
        typer.Option(
            "--quote-formulas",
            help="In CSV, quote text that a spreadsheet would run.",
            rich_help_panel=_TRACKS,
        ),
    ] = False,
    plot: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.png",
            help="Draw the tracks over the plots (or .pdf, .svg…).",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    animate: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.html",
            help="Write the tracks as a page with a slider of time.",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    show: Annotated[
        str | None,
        typer.Option(
            metavar="GROUP",
            help="Group that --plot and --animate show. [default: the first]",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    truth: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Table of true positions, for --plot and --animate.",
            rich_help_panel=_TRACKS,
        ),
    ] = None,
    lag: Annotated[
        str,
        typer.Option(
            metavar="S|GROUP=S,…|auto|none",
            help="How late the clock of the plots is against --truth, s; auto fits it.",
            rich_help_panel=_TRACKS,
        ),
    ] = "none",
    follow: Annotated[
        bool,
        typer.Option(
            "--follow",
            help="Read lines from standard input (-) or ASTERIX from udp://127.0.0.1:PORT, and "
            "answer each scan at once.",
            rich_help_panel=options.LIVE,
        ),
    ] = False,
    state: options.StateFile = None,
    feed: options.FeedWay = None,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Make tracks of plots without identities, scan by scan, as a radar gives them.

    Clutter, missed plots, births and deaths of tracks are the business of a configuration.
    """
    options.load_plugins(plugin)
    how = {
        "scan": scan,
        "period": None if period is None else number_or(period, "--period", {}),
        "group": group,
        "own": _names(own, "--own"),
        "scans": scans,
        "lateness": None if lateness is None else number_or(lateness, "--lateness", {"0": 0.0}),
        "sectors": sectors,
    }
    chosen = _names(output_columns, "--output-columns")
    saved = SavedState(state, feed)
    if follow:
        for option, given in (("--plot", plot), ("--animate", animate)):
            if given is not None:
                raise ValueError(f"{option}: needs the whole recording; not with --follow")
        from fuzzytrack.cli.follow_scans import follow_scans

        follow_scans(
            files,
            reading,
            scanner_with(config, tracker),
            how,
            output,
            saved,
            output_columns=chosen,
            tentative=tentative,
            json=json,
            quote_formulas=quote_formulas,
        )
        return
    saved.check_unused()
    if output == STANDARD_OUTPUT and json:
        raise ValueError("--json: -o - writes the tracks to standard output; name a file")
    if output_columns is not None and output is None:
        raise ValueError("--output-columns: are those of -o; give it")
    pictures = _Pictures(plot, animate, show, truth, options.lags(lag))
    pictures.check_given(grouped=group is not None)
    job = ScanJob.of(
        files if len(files) > 1 else files[0],
        config,
        reading,
        tracker=tracker,
        output_columns=chosen,
        **how,
    )
    totals = _run(job, output, pictures, tentative=tentative, quote_formulas=quote_formulas)
    if json:
        file = files[0] if len(files) == 1 else list(files)
        written = {"output": output, "plot": plot, "animate": animate}
        _print_json(job, totals, {"file": file}, written)
        return
    with told_aside(output):
        _print_table(job, totals)
        for each in (output, plot, animate):
            if each not in (None, STANDARD_OUTPUT):
                say(f"wrote {each}")


def _names(text: str | None, option: str) -> tuple[str, ...] | None:
    return None if text is None else tuple(options.names(text, option))


@dataclass(frozen=True)
class _Pictures:
    """Files of pictures that are asked for; the group and the truth that they show."""

    plot: str | None
    animate: str | None
    show: str | None
    truth: str | None
    lag: Lag

    def check_given(self, *, grouped: bool) -> None:
        """Raise ValueError if something is given without what it is for."""
        for option, given in (("--show", self.show), ("--truth", self.truth)):
            if given is not None and not self.any:
                raise ValueError(f"{option}: is for --plot and --animate; give one of them")
        if self.lag is not None and self.truth is None:
            raise ValueError("--lag: is that of the plots behind --truth; give it")
        if self.show is not None and not grouped:
            raise ValueError("--show: is one of the groups of --group; give it")

    @property
    def any(self) -> bool:
        """Whether there is one."""
        return self.plot is not None or self.animate is not None

    def check(self, inputs: tuple[PathLike, ...]) -> None:
        """Check that they can be written, before the tracks are made."""
        if self.plot is not None:
            check_picture(self.plot, inputs)
        if self.animate is not None:
            if Path(self.animate).suffix.lower() not in (".html", ".htm"):
                raise ValueError(f"--animate: {self.animate}: is a page; give it the suffix .html")
            check_output(self.animate, inputs)

    def read_truth(self, job: ScanJob) -> Positions | None:
        """True positions of all groups, before the tracks are made."""
        if self.truth is None:
            return None
        from fuzzytrack.scoring.position_files import TableOptions, read_truth

        return read_truth(
            self.truth, job.plots.files, TableOptions(group=job.plots.columns.group or None)
        )

    def group(self, found: ScannedRecording) -> str:
        """The group that is shown."""
        if self.show is None:
            return next(iter(found.results))
        if self.show not in found.results:
            there = ", ".join(found.results)
            raise ValueError(f"--show: no group {self.show!r}; expected one of {there}")
        return self.show

    def by_clock(
        self, found: ScannedRecording, group: str, truth: Positions | None
    ) -> Positions | None:
        """True positions of the group that is shown, by the clock of its plots."""
        if truth is None:
            return None
        truth = truth if truth.group is None else truth.of_group(group)
        tracks = Positions.of(found.results[group], "tracks")
        truth, fitted = by_clock_of(tracks, truth, lag_of(self.lag, group), Settings().cutoff)
        found.job.plots.findings.note([fitted] if fitted else [])
        return truth

    def write(self, found: ScannedRecording, group: str, truth: Positions | None) -> None:
        """Write them."""
        if self.plot is not None:
            save_picture(self.plot, lambda: found.plot(group, truth=truth), found.job.inputs)
        if self.animate is not None:
            from fuzzytrack.reports.scan_page import write_scan_page

            read = str(found.job.inputs[0])
            name = "standard input" if read == STANDARD_INPUT else Path(read).name
            title = f"Tracks of {name}" + (f", {group}" if group else "")
            axes, result = found.job.table.axes, found.results[group]
            write_scan_page(self.animate, result, found.scans[group], truth, axes, title=title)


def _run(
    job: ScanJob, output: str | None, pictures: _Pictures, *, tentative: bool, quote_formulas: bool
) -> dict[str, ScanTotals]:
    """Track, and write what is to be written; scans are kept for pictures only."""
    with output_file(output) as place:
        if place is not None:
            job.check(place)
        pictures.check(job.inputs)
        if not pictures.any:
            with progress("tracking") as watch:
                return job.write(
                    place, tentative=tentative, progress=watch, quote_formulas=quote_formulas
                )
        truth = pictures.read_truth(job)
        with progress("tracking") as watch:
            found = job.whole(tentative=tentative, progress=watch)
        group = pictures.group(found)
        truth = pictures.by_clock(found, group, truth)
        if place is not None:
            found.write(place, quote_formulas=quote_formulas)
        pictures.write(found, group, truth)
        return dict(found.totals_of)


# -------------------------------------------------------------------- summary


def _print_json(
    job: ScanJob, totals: dict[str, ScanTotals], read: dict[str, Any], written: dict[str, Any]
) -> None:
    plots = job.plots
    decoder = plots.files.decoder
    groups = {name: each.summary for name, each in totals.items()} if plots.columns.group else None
    found = {
        "config": job.spec,
        "time": decoder.columns.time,
        "axes": job.table.axes,
        "columns": asdict(decoder.columns),
        **noise_json(decoder),
        "scans_by": {"said": plots.said, **asdict(plots.cut), "column": plots.columns.scan or None},
        **plots.findings.to_json_dict(),
        "groups": groups,
        "total": _total(totals).summary,
    }
    print_json({**read, **found, **written})


def _total(totals: dict[str, ScanTotals]) -> ScanTotals:
    total = ScanTotals()
    for each in totals.values():
        total.merge(each)
    return total


def _print_table(job: ScanJob, totals: dict[str, ScanTotals]) -> None:
    plots = job.plots
    decoder = plots.files.decoder
    say(f"columns: {decoder.columns.sentence.replace('; no id: one track', '')}")
    say(f"scans: {plots.said}")
    say(f"configuration: {job.spec}")
    say(f"sigma: {noise_sentence(decoder) or 'that of the configuration'}")
    say_notes(plots.findings.notes)
    rows = [[printable(name), *_row(each)] for name, each in totals.items()]
    if len(rows) != 1:
        rows += [[], [f"all {len(rows)}", *_row(_total(totals))]]
    elif not plots.columns.group:
        rows[0][0] = "all"
    print_table([plots.columns.group, *_HEADS.values()], rows)
    for fault in plots.findings.sentences():
        say(fault)


def _row(totals: ScanTotals) -> list[str]:
    found = totals.summary
    return [str(found[key]) for key in _HEADS]
