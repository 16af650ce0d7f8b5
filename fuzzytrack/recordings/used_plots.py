"""Recorded plots as all trackers of a comparison or of a search are to see them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.angles import unwrapped
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Recording, Track, read_recording
from fuzzytrack.recordings.clock_lag import ClockLag, fitted_lag
from fuzzytrack.recordings.judge import Judge
from fuzzytrack.recordings.judging import GateWidth, judge_of
from fuzzytrack.recordings.preparation import DEFAULT_TRACKER, inputs_of, noise_differs, suited
from fuzzytrack.recordings.ragged import run_judged_tracks, sigmas_of
from fuzzytrack.recordings.restarts import divided
from fuzzytrack.recordings.truth import read_truth, true_positions
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.catalog import as_tracker

__all__ = ["UsedPlots", "read_used_plots"]


@dataclass(frozen=True, eq=False)
class UsedPlots:
    """Recorded plots that are used, the same ones by all trackers.

    Attributes
    ----------
    name : str
        Of the first file.
    tracks : tuple of Track
        Plots that the gate rejects are missed; where it begins a track again, the track is divided.
        Each has the standard deviation of every plot, if the noise is known. Bare angles have no
        jumps.
    decoder : PlotDecoder
        How rows became plots.
    true : Recording or None
        The truth, for `fuzzytrack.recordings.truth.true_positions`.
    true_has_own_clock : bool
        Whether the clocks of plots and truth may differ: those of two files may, and columns beside
        the plots have the time of these.
    findings : Findings
        Faults that were put right, and notes.
    """

    name: str
    tracks: tuple[Track, ...]
    decoder: PlotDecoder
    true: Recording | None
    true_has_own_clock: bool
    findings: Findings

    def __repr__(self) -> str:
        return summary(self, "name", tracks=len(self.tracks))

    @property
    def axes_differ(self) -> bool:
        """Whether the noise differs between axes."""
        return noise_differs(self.decoder)

    @property
    def has_sigma(self) -> bool:
        """Whether the noise is known."""
        return all(track.sigma is not None for track in self.tracks)

    @cached_property
    def lag(self) -> ClockLag | None:
        """Fitted lag of the plots; None without a truth, or if it has the clock of the plots."""
        if self.true is None or not self.true_has_own_clock:
            return None
        return fitted_lag(self.tracks, self.true)

    def truth_of(self, track: Track) -> Array | None:
        """True positions at the plots of a track, the lag taken off; None without a truth."""
        if self.true is None:
            return None
        return true_positions(track, self.true, 0.0 if self.lag is None else self.lag.taken_off)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was guessed, left out or put right, each in a sentence."""
        return (*self.findings.notes, *self.findings.sentences())


def read_used_plots(
    plots: Any,
    reading: Reading | None = None,
    *,
    truth: str | os.PathLike[str] | None = None,
    gate: GateWidth = "auto",
    progress: Progress | None = None,
) -> UsedPlots:
    """Read recorded plots, and leave out what the default tracker would not use.

    Parameters
    ----------
    plots : path, data frame, mapping or tuple
        As for `fuzzytrack.track`.
    reading : Reading, optional
        How they are read. Without a standard deviation of the plots it is estimated from them.
    truth : str or path, optional
        True positions, see `fuzzytrack.recordings.truth.read_truth`.
    gate : float, "auto" or None
        As for `fuzzytrack.track`, with its default tracker.
    progress : callable, optional
        Called with the share that has been read.

    Raises
    ------
    DataError, ValueError, OSError
        As `fuzzytrack.track`; see also `read_truth`.
    """
    files, survey = PlotFiles.of(inputs_of(plots), reading).surveyed()
    judge = judge_of(files.decoder, gate, survey.noise)
    recording = read_recording(files, progress)
    findings, decoder = recording.findings, files.decoder
    findings.note([survey.missing] if survey.missing else [])
    tracks: Sequence[Track] = recording.tracks
    if judge is not None and judge.gate is not None:
        tracks = _gated(tracks, decoder, judge, findings)
    true = None if truth is None else read_truth(truth, files)
    used = tuple(_with_noise(track, decoder) for track in tracks)
    own_clock = truth is not None and os.path.exists(truth)
    return UsedPlots(files.names[0], used, decoder, true, own_clock, findings)


def _gated(
    tracks: Sequence[Track], decoder: PlotDecoder, judge: Judge, findings: Findings
) -> tuple[Track, ...]:
    """Tracks without the plots that a gate rejects, divided where it begins them again."""
    differ = noise_differs(decoder)
    _, tracker = suited(DEFAULT_TRACKER, as_tracker(DEFAULT_TRACKER), axes_differ=differ)
    judged = run_judged_tracks(
        tracker,
        [(track.time, track.plots) for track in tracks],
        decoder.sigma,
        judge,
        sigmas=sigmas_of(tracks),
        keep=("predicted",),
    )
    used = [
        replace(track, plots=np.where(one.rejected[:, None], np.nan, track.plots))
        for track, one in zip(tracks, judged, strict=True)
    ]
    return divided(used, judged, findings)[0]


def _with_noise(track: Track, decoder: PlotDecoder) -> Track:
    """A track with the noise of each plot where it is known, and without jumps of an angle."""
    plots, sigma = track.plots, track.sigma
    if decoder.period is not None:
        plots = unwrapped(plots[:, 0], period=decoder.period)[:, None]
    if sigma is None and decoder.sigma is not None:
        sigma = np.broadcast_to(np.asarray(decoder.sigma, dtype=np.float64), plots.shape)
    return replace(track, plots=plots, sigma=sigma)
