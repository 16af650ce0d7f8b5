"""Monte Carlo experiments: runs in chunks, on one core, on many, or on a cluster; resumable."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.noise import Plots, check_runs, truth_of_runs
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_files import as_scenario
from fuzzytrack.simulation.starting import prepare_start
from fuzzytrack.tasks import Progress, run_tasks
from fuzzytrack.testbed.chunk_store import ChunkStore
from fuzzytrack.testbed.results import Results, Sample
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import Trackers, as_trackers
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains

__all__ = ["Preview", "monte_carlo", "simulated_runs"]

#: Called with the results of the runs that are done.
Preview = Callable[[Results], None]

# Coordinates a chunk may hold: a tracker makes about ten arrays of this many floats.
_COORDINATES = 200_000
# Runs a chunk may hold: few enough that a job of a few hundred runs keeps several cores busy.
# With two axes they nearly fill one block of lanes of compiled code.
_RUNS = 124


def monte_carlo(
    scenario: Scenario | str | os.PathLike[str],
    trackers: Trackers | None,
    runs: int,
    seed: int,
    *,
    progress: Progress | None = None,
    preview: Preview | None = None,
    executor: Executor | None = None,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> Results:
    """Run trackers on many random draws of a scenario.

    Parameters
    ----------
    scenario : Scenario, str or path
        Target and sensors; or the name of a shipped scenario or the path of a file, as for
        `fuzzytrack.simulation.scenario_files.load_scenario`.
    trackers : mapping of str to Tracker or str, sequence of str, or None
        The trackers by name; or what names them, see `fuzzytrack.trackers.catalog.as_trackers`;
        those of the scenario if None.
    runs : int
        Number of Monte Carlo runs, at least 1.
    seed : int
        Seed, not negative; the same seed gives the same numbers.
    progress : callable, optional
        Called with the share of the runs that are done, after every chunk of them.
    preview : callable, optional
        Called with the results of the runs that are done, the first ones without a gap, whenever
        there are more of them. They are what a job of that many runs gives.
    executor : concurrent.futures.Executor, optional
        Runs the chunks; in this process unless given. A process pool, or a Dask cluster through
        ``client.get_executor()``. Scenario and trackers are pickled to it.
    folder : str or path, optional
        Where finished chunks are kept, in its subfolder ``chunks``, so that an interrupted job can
        be continued; made if it does not exist.
    resume : bool
        Whether to continue the job whose chunks `folder` holds, if any. More runs, or fewer, may
        be asked for than before.

    Returns
    -------
    Results

    Raises
    ------
    TypeError
        If `scenario` or a tracker is something else.
    ValueError
        If there is no tracker or no such tracker, `runs` or `seed` is out of range, `folder` holds
        chunks and `resume` is False, or they are of another job; names the difference.
    OSError
        If `folder` cannot be written to.

    Notes
    -----
    Every tracker sees the same plots. Every run has a random stream of its own, spawned from the
    seed, so its numbers depend to the last bit neither on how many runs there are nor on how they
    are cut into chunks, where those are run or in which order they finish. A run without a plot has
    NaN for errors.

    All errors are kept: 8·n_steps·(n_axes·(1 + 3·n_trackers) + 2·n_trackers) bytes a run, with 2
    for 3 where the scenario has no velocity, and without the last term where it has no
    ``process_sigma``. 100 scans of two axes and 5 trackers take up to 34 kB a run.

    An error in a chunk, a broken process pool or an interrupt ends the job; chunks that are
    finished stay in `folder`. A Dask cluster may lose workers: their chunks are run again. A chunk
    that fails on an executor is tried three times, except with a ValueError.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.testbed.montecarlo import monte_carlo
    >>> from fuzzytrack.simulation.scenario import PlotNoise, Scenario
    >>> t = np.arange(20.0)
    >>> scenario = Scenario("straight", t, 100 * t[:, None], PlotNoise(10.0))
    >>> trackers = {"fixed": "fixed:alpha=0.5:beta=0.2"}
    >>> results = monte_carlo(scenario, trackers, runs=50, seed=1)
    >>> results.rmse().round(1), results.rmse_se().round(1)
    (array([11.]), array([0.5]))
    """
    check_runs(runs, seed)
    scenario = as_scenario(scenario)
    made = as_trackers(scenario.trackers if trackers is None else trackers)
    size = _chunk_runs(scenario)
    chunks = [range(first, min(first + size, runs)) for first in range(0, runs, size)]
    store = None
    if folder is not None:
        store = ChunkStore.open(folder, scenario, made, seed, size, resume=resume)
    elif resume:
        raise ValueError("resume: needs the folder of the job to continue")

    whole: dict[str, Array] = {}
    done, ready = 0, _Ready()
    for chunk, part in _parts(scenario, made, seed, chunks, executor, store):
        _put(whole, part, chunk.start, runs)
        done += len(chunk)
        if progress is not None:
            progress(done / runs)
        if ready.grows(chunk) and preview is not None:
            preview(_results(scenario, made, seed, whole, ready.count))
    return _results(scenario, made, seed, whole, runs)


def _results(
    scenario: Scenario, made: dict[str, Tracker], seed: int, whole: dict[str, Array], runs: int
) -> Results:
    """Results of the first runs, which are views of the arrays."""
    sample = {name: whole[name] for name in whole if name.startswith("sample_")}
    first = {name: array[_at(name, 0, runs)] for name, array in whole.items() if name not in sample}
    return Results(
        scenario=scenario.name,
        names=tuple(made),
        seed=seed,
        first_scored=scenario.first_scored,
        time=scenario.scan_time,
        predicted=first["predicted"],
        filtered=first["filtered"],
        velocity=first.get("velocity"),
        measured=first["measured"],
        nis=first.get("nis"),
        nees=first.get("nees"),
        sample=Sample(**{name.removeprefix("sample_"): array for name, array in sample.items()}),
    )


class _Ready:
    """How many of the first runs are done, without a gap; chunks finish in any order."""

    def __init__(self) -> None:
        self.count = 0
        self._later: dict[int, int] = {}

    def grows(self, chunk: range) -> bool:
        """Whether there are more of them with this chunk."""
        self._later[chunk.start] = chunk.stop
        before = self.count
        while self.count in self._later:
            self.count = self._later.pop(self.count)
        return self.count > before


def _chunk_runs(scenario: Scenario) -> int:
    """Runs in a chunk; of the scenario only, so that jobs of any length share their chunks."""
    return max(1, min(_RUNS, _COORDINATES // (len(scenario.time) * scenario.n_axes)))


def _put(whole: dict[str, Array], part: dict[str, Array], first: int, runs: int) -> None:
    """Put a chunk into its place among all runs."""
    for name, array in part.items():
        if name.startswith("sample_"):
            whole[name] = array
            continue
        axis = _axis_of_runs(name)
        if name not in whole:
            whole[name] = np.empty((*array.shape[:axis], runs, *array.shape[axis + 1 :]))
        whole[name][_at(name, first, array.shape[axis])] = array


def _axis_of_runs(name: str) -> int:
    return 0 if name == "measured" else 1


def _at(name: str, first: int, count: int) -> tuple[slice, ...]:
    """Where some runs are in an array."""
    return (*[slice(None)] * _axis_of_runs(name), slice(first, first + count))


# -------------------------------------------------------------------- where chunks are run


def _parts(
    scenario: Scenario,
    trackers: dict[str, Tracker],
    seed: int,
    chunks: list[range],
    executor: Executor | None,
    store: ChunkStore | None,
) -> Iterator[tuple[range, dict[str, Array]]]:
    """All chunks: first the stored ones, then the others as they finish."""
    missing = []
    for chunk in chunks:
        stored = None if store is None else store.load(chunk)
        if stored is None:
            missing.append(chunk)
        else:
            yield chunk, stored
    if executor is None:
        coordinates = sum(map(len, missing)) * len(scenario.time) * scenario.n_axes
        for tracker in trackers.values():
            announce(tracker, scenario.n_axes, coordinates)
    for chunk, part in run_tasks(partial(run_chunk, scenario, trackers, seed), missing, executor):
        if store is not None:
            store.save(chunk, part)
        yield chunk, part


# -------------------------------------------------------------------- one chunk


def simulated_runs(
    scenario: Scenario, seed: int, runs: range
) -> tuple[Array, Array, Array | None, Plots]:
    """Times, true positions, true velocities and plots of some of the runs.

    Parameters
    ----------
    scenario, seed
        As for `monte_carlo`.
    runs : range
        Numbers of the runs, from 0.

    Returns
    -------
    times : ndarray, shape (n_steps,) or (n_steps, runs)
        s.
    position, velocity : ndarray, shape (n_steps, 1 or runs, n_axes)
        m, m/s; None where the velocity is not known.
    plots : Plots
        Those that trackers get, shape (n_steps, runs, n_axes).
    """
    # What SeedSequence(seed).spawn gives for these runs.
    streams = [np.random.SeedSequence(seed, spawn_key=(k,)) for k in runs]
    position, velocity = scenario.truth(runs.start, len(runs))
    plots = scenario.sensors.measure(position, streams)
    if scenario.prepare_start:
        plots = _prepared(scenario.time, plots)
    true = truth_of_runs(position, len(runs))
    moving = None if velocity is None else truth_of_runs(velocity, len(runs))
    return scenario.times(runs.start, len(runs)), true, moving, plots


def run_chunk(
    scenario: Scenario, trackers: Mapping[str, Tracker], seed: int, runs: range
) -> dict[str, Array]:
    """Errors of some of the runs.

    Parameters
    ----------
    scenario, trackers, seed
        As for `monte_carlo`.
    runs : range
        Numbers of the runs, from 0.

    Returns
    -------
    dict of ndarray
        Attributes of `Results` by name, for these runs; with run 0 those of `Sample` too, named
        ``sample_...``.
    """
    times, true, moving, plots = simulated_runs(scenario, seed, runs)
    part = _blank(len(trackers), plots.z.shape, moving is not None, scenario.process_sigma)
    part["measured"] = _turned(plots.z - true)
    for k, tracker in enumerate(trackers.values()):
        result = tracker.run(times, plots.z, plots.sigma)
        part["predicted"][k] = _turned(result.predicted - true)
        part["filtered"][k] = _turned(result.filtered - true)
        if moving is not None:
            speeds = np.where(np.isnan(result.filtered), np.nan, result.velocity)
            part["velocity"][k] = _turned(speeds - moving)
        if scenario.process_sigma is not None:
            nis, nees = _normalized(result, plots.sigma, true, scenario.process_sigma)
            part["nis"][k], part["nees"][k] = nis.T, nees.T
        if runs.start == 0:
            _keep(part, k, result)
    if runs.start == 0:
        part["sample_time"] = times.reshape(len(times), -1)[:, 0].copy()
        part["sample_truth"] = np.array(true[:, 0])
        part["sample_plots"] = plots.z[:, 0].copy()
    else:
        part = {name: array for name, array in part.items() if not name.startswith("sample_")}
    return part


_SAMPLED = ("predicted", "filtered", "alpha", "beta", "gamma")


def _blank(
    number: int, shape: tuple[int, ...], moving: bool, process_sigma: float | None
) -> dict[str, Array]:
    n_steps, count, n_axes = shape
    names = ("predicted", "filtered", "velocity") if moving else ("predicted", "filtered")
    part = {name: np.empty((number, count, n_steps, n_axes)) for name in names}
    if process_sigma is not None:
        part |= {name: np.empty((number, count, n_steps)) for name in ("nis", "nees")}
    return part | {f"sample_{name}": np.empty((number, n_steps, n_axes)) for name in _SAMPLED}


def _keep(part: dict[str, Array], k: int, result: TrackResult) -> None:
    """Keep run 0 of tracker k."""
    gains = result.gains
    of_it = (result.predicted, result.filtered, gains.alpha, gains.beta, gains.gamma)
    for name, array in zip(_SAMPLED, of_it, strict=True):
        part[f"sample_{name}"][k] = array[:, 0]


def _turned(values: Array) -> Array:
    """Values with the axis of runs before that of scans."""
    return values.swapaxes(0, 1)


def _prepared(time: Array, plots: Plots) -> Plots:
    """Plots as `prepare_start` makes them, with NaN for the scans that it drops."""
    if np.isnan(plots.z).all():
        return plots
    left, begun = prepare_start(time, plots.z, plots.sigma)
    before = np.full((len(time) - len(left), *plots.z.shape[1:]), np.nan)
    return Plots(np.concatenate([before, begun.z]), np.concatenate([before, begun.sigma]))


def _normalized(
    result: TrackResult, sigma: Array, true: Array, process_sigma: float
) -> tuple[Array, Array]:
    """NIS and NEES of position, shape (n_steps, runs); NaN for runs whose covariance is not known.

    A batch is refused as a whole if the covariance of one of its runs is not known. Each run is
    then taken by itself, so that its numbers do not depend on the others.
    """
    from fuzzytrack.trackers.covariance import track_covariance

    try:
        found = track_covariance(result, sigma, process_sigma)
    except ValueError:
        count = result.measured.shape[1]
        if count == 1:
            nothing = np.full(result.measured.shape[:2], np.nan)
            return nothing, nothing
        everyone = np.broadcast_to(true, result.measured.shape)
        runs = [slice(k, k + 1) for k in range(count)]
        each = [
            _normalized(_some(result, k), sigma[:, k], everyone[:, k], process_sigma) for k in runs
        ]
        nis, nees = (np.concatenate(part, axis=1) for part in zip(*each, strict=True))
        return nis, nees
    off = np.square(result.filtered - true) / found.filtered[..., 0, 0]
    total = off[..., 0].copy()
    for k in range(1, off.shape[-1]):
        total += off[..., k]
    return found.nis, total


def _some(result: TrackResult, runs: slice) -> TrackResult:
    arrays = ("measured", "predicted", "filtered", "velocity", "acceleration", "innovation")
    gains = (getattr(result.gains, name)[:, runs] for name in ("alpha", "beta", "gamma"))
    return replace(
        result,
        time=result.time if result.time.ndim == 1 else result.time[:, runs],
        **{name: getattr(result, name)[:, runs] for name in arrays},
        gains=Gains(*gains),
    )
