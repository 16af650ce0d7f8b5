"""Scans with truth on which scan trackers are tuned: simulated, or recorded."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scoring.clock_lag import Lag, lag_of
from fuzzytrack.scoring.position_files import TableOptions, read_truth
from fuzzytrack.simulation.scene.files import as_scene, names_scene, shipped_scenes
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.simulation.scene.simulate import simulate_scans
from fuzzytrack.tuning.scan_recordings import ScanRecording

__all__ = ["recorded_scans", "scan_sources", "simulated_recordings"]


def simulated_recordings(
    scene: Scene | str | os.PathLike[str], runs: int, seed: int = 0
) -> tuple[ScanRecording, ...]:
    """Runs of a scene of many targets, each with its truth; together they are one group.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, or its name or file, maybe with settings: ``harbor:radar.detection=0.6``.
    runs : int
        Number of runs, at least 1.
    seed : int
        Seed of the first run; each of the others has the next one.

    Raises
    ------
    ScenarioError
        If there is no such scene.
    ValueError
        If there are no runs.
    """
    if runs < 1:
        raise ValueError(f"runs must be at least 1, got {runs}")
    made, found = as_scene(scene), []
    group = made.name if isinstance(scene, Scene) else str(scene)
    for run in range(runs):
        simulated = simulate_scans(made, seed + run)
        truth = simulated.truth
        found.append(
            ScanRecording(
                f"{group}, run {run + 1}",
                simulated.scans,
                (truth.time, truth.target_id, truth.position),
                group,
            )
        )
    return tuple(found)


def recorded_scans(
    plots: Any,
    truth: str | os.PathLike[str],
    reading: Reading | None = None,
    *,
    lag: Lag = None,
    moving_above: float | None = None,
    group: str | None = None,
    **division: Any,
) -> tuple[ScanRecording, ...]:
    """Recorded plots without identities, with true positions; each group is a recording.

    Parameters
    ----------
    plots : path, data frame, mapping or tuple
        As for `fuzzytrack.track`.
    truth : str or path
        Table of true positions: time, identity, position, and the column of groups.
    reading : Reading, optional
        How the plots are read.
    lag, moving_above
        See `ScanRecording`; a lag may be that of each group.
    group : str, optional
        Column that says which of several recordings a row belongs to, in both tables.
    **division
        How plots are divided into scans; see `fuzzytrack.recordings.scan_plots.ScanPlots.of`.

    Raises
    ------
    ValueError
        If a group has no lag, where lags are given by group.
    DataError
        If a table does not hold what it must, or the truth has nothing of a group.
    OSError
        If a file cannot be read.
    """
    made = ScanPlots.of(plots, reading, group=group, **division)
    known = read_truth(truth, made.files, TableOptions(group=group))
    scans: dict[str, list[Scan]] = {}
    for word, scan in made.scans():
        scans.setdefault(word, []).append(scan)
    found = []
    for word, mine in scans.items():
        true = known
        if known.group is not None:
            if word not in known.group:
                raise DataError(f"{truth}: no true position of {group} {word}")
            true = known.of_group(word)
        name = f"{group} {word}" if word else made.files.names[0]
        found.append(
            ScanRecording(
                name,
                mine,
                (true.time, true.id, true.position),
                lag=lag_of(lag, word),
                moving_above=moving_above,
            )
        )
    return tuple(found)


def scan_sources(
    data: Sequence[str], *, runs: int, seed: int, truth: str | None, **recording: Any
) -> tuple[ScanRecording, ...]:
    """Recordings of scenes that are named, and of files.

    Parameters
    ----------
    data : sequence of str
        Names or files of scenes, or files of plots.
    runs, seed : int
        See `simulated_recordings`.
    truth : str or None
        True positions of files of plots; they need them.
    **recording
        See `recorded_scans`.

    Raises
    ------
    ValueError
        If there is no truth.
    DataError, ScenarioError, OSError
        As of the others.
    """
    found: list[ScanRecording] = []
    for each in data:
        if names_scene(each):
            found += simulated_recordings(each, runs, seed)
        elif truth is None:
            raise ValueError(
                f"truth: {each} is no scene, so it needs a table of true positions to be tuned on; "
                f"scenes: {', '.join(shipped_scenes())}"
            )
        else:
            found += recorded_scans(each, truth, **recording)
    return tuple(found)
