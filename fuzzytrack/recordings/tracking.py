"""Recorded plots tracked in one call: what the command ``track`` does, in Python."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Recording, Track, read_recording
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.notebook import html_of
from fuzzytrack.recordings.picture import picture_of
from fuzzytrack.recordings.preparation import PreparedPlots, prepare
from fuzzytrack.recordings.ragged import run_judged_tracks, run_tracks, sigmas_of
from fuzzytrack.recordings.restarts import divided
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.recordings.track_writer import check_tracks, table_of_tracks, write_tracks
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.result import KEPT, ON_REQUEST, TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["TrackedRecording", "track", "track_recording"]


def track(
    plots: Any,
    tracker: Tracker | str | None = None,
    *,
    gate: GateWidth = "auto",
    progress: Progress | None = None,
    **options: Any,
) -> TrackedRecording:
    """Track recorded plots, as the command ``fuzzytrack track`` does.

    Parameters
    ----------
    plots : path, data frame, mapping or tuple
        A file or folder, or several in a list; a data frame of pandas or polars, a table of Arrow;
        a mapping from names to columns; or (time, plots), arrays of shape (n,) and (n, n_axes).
    tracker : Tracker or str, optional
        The tracker, or what names it, see `fuzzytrack.trackers.catalog.make_tracker`. Unless given,
        ``maneuver``, or ``stiffness-damping`` if the noise of the plots can neither be estimated
        nor is given.
    gate : float, "auto" or None
        Plots whose innovation is larger are not used; in standard deviations of a plot, and wider
        after gaps and in maneuvers, see `fuzzytrack.recordings.judge.Gate`. Unless given, 20 where
        the noise of the plots is known; None is no gate.
    progress : callable, optional
        Called with the share of the work that is done.
    **options
        How the plots are read: attributes of `fuzzytrack.io.PlotDescription` (time, id, axes,
        polar, geodetic, sigma…), of `fuzzytrack.io.Cleaning` (duplicates, max_gap…) and of
        `fuzzytrack.io.TextForm` (delimiter, na…), ``format``, and ``sort``. Without `sigma` the
        standard deviation of the plots is estimated from them.

    Returns
    -------
    TrackedRecording

    Raises
    ------
    DataError
        If the plots cannot be used; names row, column and value.
    TypeError
        If there is no such option, or the plots are something else.
    ValueError
        If the value of an option is wrong, or the tracker needs a standard deviation that is not
        known.
    OSError
        If a file cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> import fuzzytrack as ft
    >>> t = np.arange(8.0)
    >>> tracked = ft.track((t, np.stack([10 * t, 5 * t], axis=1)), sigma=2.0)
    >>> tracked.results[0].velocity[-1].round(3)
    array([10.,  5.])
    """
    return track_recording(plots, tracker, Reading.of(**options), progress, gate=gate)


def track_recording(
    plots: Any,
    tracker: Tracker | str | None,
    reading: Reading,
    progress: Progress | None = None,
    output: PathLike | None = None,
    *,
    gate: GateWidth = "auto",
) -> TrackedRecording:
    """Track recorded plots that are read in a given way; see `track`.

    If the tracks could not be written to `output`, they are not made.
    """
    prepared = prepare(plots, tracker, reading, gate)
    if output is not None:
        check_tracks(output, prepared.table, prepared.files.paths)
    recording = read_recording(prepared.files, progress)
    prepared.findings.merge(recording.findings)
    tracks, results = _run(prepared, recording.tracks, progress)
    recording = replace(recording, tracks=tracks)
    return TrackedRecording(
        recording, results, prepared.tracker, prepared.spec, prepared.table, prepared.findings
    )


def _run(
    prepared: PreparedPlots, tracks: Sequence[Track], progress: Progress | None
) -> tuple[tuple[Track, ...], tuple[TrackResult, ...]]:
    """Tracks with their results; those that a gate starts again are divided there."""
    given = [(track.time, track.plots) for track in tracks]
    common: dict[str, Any] = {
        "sigmas": sigmas_of(tracks),
        "keep": (*KEPT, *ON_REQUEST) if prepared.table.deviation else None,
    }
    tracker, sigma, judge = prepared.tracker, prepared.files.decoder.sigma, prepared.judge
    if judge is None:
        return tuple(tracks), tuple(run_tracks(tracker, given, sigma, progress, **common))
    judged = run_judged_tracks(tracker, given, sigma, judge, progress, **common)
    return divided(tracks, judged, prepared.findings)


@dataclass(frozen=True, eq=False)
class TrackedRecording:
    """The tracks of a recording.

    Attributes
    ----------
    recording : Recording
        The plots, track by track.
    results : tuple of TrackResult
        What the tracker made of each.
    tracker : Tracker
        The tracker.
    spec : str
        What names it.
    table : TrackTable
        Columns of the table of tracks.
    findings : Findings
        Faults that were put right, and notes.
    """

    recording: Recording
    results: tuple[TrackResult, ...]
    tracker: Tracker
    spec: str
    table: TrackTable
    findings: Findings

    def __repr__(self) -> str:
        return summary(self, "tracker", tracks=len(self.results), plots=self.totals.plots)

    def __len__(self) -> int:
        """Number of tracks."""
        return len(self.results)

    @property
    def totals(self) -> Totals:
        """Sums over all tracks."""
        return Totals.of(self.results)

    def to_pandas(self) -> Any:
        """Table of all tracks, one row for each plot, as `write` writes it.

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
        return pandas.DataFrame(table_of_tracks(self.recording, self.results, self.table))

    def write(
        self,
        path: PathLike,
        progress: Progress | None = None,
        *,
        quote_formulas: bool = False,
    ) -> None:
        """Write the tracks to a file, whole or not at all.

        Parameters
        ----------
        path : str or path
            Its suffix says the format: ``.csv`` or ``.parquet``, or for tracks on the earth
            ``.geojson``, ``.kml``, ``.czml`` or ``.gpx``; see `fuzzytrack.recordings.write_tracks`.
        progress : callable, optional
            Called with the share that has been written.
        quote_formulas : bool
            Whether cells that a spreadsheet would run are quoted.

        Raises
        ------
        DataError, OSError
            As `fuzzytrack.recordings.write_tracks`.
        """
        write_tracks(
            path,
            self.recording,
            self.results,
            progress,
            table=self.table,
            quote_formulas=quote_formulas,
        )

    def plot(self, gains: bool | None = None) -> Figure:
        """Picture of the tracks, see `fuzzytrack.plotting.plot_tracks`.

        Parameters
        ----------
        gains : bool, optional
            Whether the gains are drawn below. Unless given, for up to three tracks.
        """
        return picture_of(self.recording, self.results, gains)

    def _repr_html_(self) -> str:
        """Table of the first tracks, with a small picture, for notebooks."""
        ids = [track.id for track in self.recording.tracks]
        tracks = list(zip(ids, self.results, strict=True))
        title = f"{counted(len(self), 'track')} by {self.spec}"
        told = (*self.findings.notes, *self.findings.sentences())
        return html_of(title, tracks, told, self.plot(gains=False))
