"""What is found out and chosen before recorded plots are tracked: files, tracker, gate, columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from fuzzytrack.io.data_frame import FrameSource
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.plot_files import Input, PlotFiles, Survey
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import recording_files
from fuzzytrack.recordings.judge import Judge
from fuzzytrack.recordings.judging import GateWidth, judge_of
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers import FuzzyScheduler
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_tracker, make_tracker

__all__ = [
    "DEFAULT_TRACKER",
    "DEFAULT_WITHOUT_NOISE",
    "PreparedPlots",
    "inputs_of",
    "noise_differs",
    "prepare",
    "prepare_surveyed",
    "shares_covariance",
    "suited",
]

#: The tracker of recorded plots unless another is named, and the one that takes its place where
#: the noise of the plots is not known.
DEFAULT_TRACKER, DEFAULT_WITHOUT_NOISE = "maneuver", "stiffness-damping"


@dataclass(frozen=True, eq=False)
class PreparedPlots:
    """Plots and the tracker for them, with all that was found out before the run.

    Attributes
    ----------
    files : PlotFiles
        The plots; noise and cleaning are settled.
    tracker : Tracker
        The tracker.
    spec : str
        What names it.
    table : TrackTable
        Columns of the tracks.
    judge : Judge or None
        What happens to plots before they are used.
    findings : Findings
        Notes so far.
    """

    files: PlotFiles
    tracker: Tracker
    spec: str
    table: TrackTable
    judge: Judge | None = None
    findings: Findings = field(default_factory=Findings)

    def __repr__(self) -> str:
        return summary(self, "tracker", files=len(self.files.inputs))


def inputs_of(plots: Any) -> tuple[Input, ...]:
    """Files and columns of what a user gives as plots; see `fuzzytrack.track`."""
    if isinstance(plots, str) or hasattr(plots, "__fspath__"):
        return recording_files(plots)
    if isinstance(plots, Sequence) and not isinstance(plots, tuple):
        return tuple(each for part in plots for each in inputs_of(part))
    return (FrameSource.of(plots),)


def prepare(
    plots: Any, tracker: Tracker | str | None, reading: Reading, gate: GateWidth = "auto"
) -> PreparedPlots:
    """Look at plots before they are tracked.

    Parameters
    ----------
    plots, tracker
        As for `fuzzytrack.track`.
    reading : Reading
        How they are read.
    gate : float, "auto" or None
        As for `fuzzytrack.track`.

    Raises
    ------
    DataError, ValueError, OSError
        As `fuzzytrack.track`.
    """
    # First, since a tracker that cannot be made needs no files.
    if tracker is not None:
        as_tracker(tracker)
    return prepare_surveyed(*PlotFiles.of(inputs_of(plots), reading).surveyed(), tracker, gate)


def prepare_surveyed(
    files: PlotFiles, survey: Survey, tracker: Tracker | str | None, gate: GateWidth = "auto"
) -> PreparedPlots:
    """Choose tracker, table and judge for plots that have been looked at.

    Parameters
    ----------
    files : PlotFiles
    survey : Survey
        What is known of them beside what the files say.
    tracker, gate
        As for `fuzzytrack.track`.

    Raises
    ------
    DataError, ValueError
        As `fuzzytrack.track`.
    """
    findings = Findings()
    chosen = DEFAULT_TRACKER if tracker is None else tracker
    if survey.missing and tracker is None:
        chosen = DEFAULT_WITHOUT_NOISE
        findings.note([f"{survey.missing}. Tracked with {chosen}: {DEFAULT_TRACKER} needs it"])
    elif survey.missing:
        findings.note([survey.missing])
    spec, made = suited(chosen, as_tracker(chosen), axes_differ=noise_differs(files.decoder))
    table, judge = TrackTable.of(files.decoder, made), judge_of(files.decoder, gate, survey.noise)
    return PreparedPlots(files, made, spec, table, judge, findings)


def noise_differs(decoder: PlotDecoder) -> bool:
    """Whether the noise of plots differs between their axes."""
    return isinstance(decoder.sigma, tuple) or decoder.noise_is_polar


def suited(tracker: Tracker | str, made: Tracker, *, axes_differ: bool) -> tuple[str, Tracker]:
    """A tracker and what names it; with a covariance for each axis where their noise differs.

    Parameters
    ----------
    tracker : Tracker or str
        The tracker, or what names it. Only a text is changed.
    made : Tracker
        The tracker itself.
    axes_differ : bool
        Whether the noise of the plots differs between axes.
    """
    if axes_differ and isinstance(tracker, str) and shares_covariance(tracker, made):
        spec = f"{tracker}:axes=own"
        return spec, make_tracker(spec)
    return tracker if isinstance(tracker, str) else repr(tracker), made


def shares_covariance(spec: str, made: Tracker) -> bool:
    """Whether a tracker keeps one covariance for all axes and its text does not say that it is to.

    Parameters
    ----------
    spec : str
        What names it; only its parameters matter.
    made : Tracker
        The tracker itself.
    """
    scheduler = made.scheduler if isinstance(made, AlphaBetaTracker) else None
    return (
        isinstance(scheduler, FuzzyScheduler)
        and "axes" in scheduler.outputs.parameters
        and ":axes=" not in spec
    )
