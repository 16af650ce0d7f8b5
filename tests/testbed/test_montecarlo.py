import multiprocessing
import os
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.simulation import canonical_field, llinas_maneuver
from fuzzytrack.simulation.noise import Noise, streams
from fuzzytrack.simulation.scenario import FieldSensors, PlotNoise, Scenario
from fuzzytrack.testbed import montecarlo
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import make_tracker

NAMES = ("predicted", "filtered", "velocity", "measured", "nis", "nees")
SAMPLED = ("truth", "plots", "predicted", "filtered", "alpha", "beta", "gamma")

TRACKERS = {
    "fixed": AlphaBetaTracker(FixedGains(0.5, 0.2)),
    "with acceleration": AlphaBetaTracker(FixedGains(0.5, 0.2, 0.05)),
    "kalman": AlphaBetaTracker(KalmanCV(0.5)),
    "fuzzy": make_tracker("stiffness-damping"),
    "chan": make_tracker("chan-style"),
}


def straight(steps=12, **changes):
    t = np.arange(float(steps))
    moving = np.array([10.0, -3.0])
    sensors = PlotNoise((5.0, 8.0), Noise(correlation=0.3), detection=0.6)
    scenario = Scenario(
        "straight", t, t[:, None] * moving, sensors, velocity=np.tile(moving, (steps, 1))
    )
    return replace(scenario, **changes)


def in_the_field():
    """Tracks of their own, seen by different sensors, starting at different scans."""
    t, one = llinas_maneuver("M1")
    position = np.stack([one, one + 700.0, one[:, ::-1] - 2500.0], axis=1)
    sensors = FieldSensors(canonical_field(1500.0), sigma_from="plot", linear=True)
    return Scenario("field", t, position, sensors, prepare_start=True, process_sigma=0.05)


def assert_same(one, two, runs=None):
    """To the bit; the first runs of the one if asked."""
    for name in NAMES:
        a, b = getattr(one, name), getattr(two, name)
        assert (a is None) == (b is None)
        if a is not None:
            np.testing.assert_array_equal(a[:runs] if name == "measured" else a[:, :runs], b)
    for name in SAMPLED:
        np.testing.assert_array_equal(getattr(one.sample, name), getattr(two.sample, name))
    assert one.names == two.names


# -------------------------------------------------------------------- the numbers


def test_errors_run_by_run():
    scenario = straight(process_sigma=0.5)
    found = monte_carlo(scenario, TRACKERS, 9, 4)
    assert found.names == tuple(TRACKERS)
    assert found.predicted.shape == (5, 9, 12, 2)
    assert found.nis.shape == found.nees.shape == (5, 9, 12)
    for run, stream in enumerate(streams(4, 9)):
        plots = scenario.sensors.measure(scenario.position, [stream])
        z, sigma = plots.z[:, 0], plots.sigma[:, 0]
        np.testing.assert_array_equal(found.measured[run], z - scenario.position)
        for k, tracker in enumerate(TRACKERS.values()):
            result = tracker.run(scenario.time, z, sigma)
            known = ~np.isnan(result.filtered)
            for name, truth in (
                ("predicted", scenario.position),
                ("filtered", scenario.position),
                ("velocity", scenario.velocity),
            ):
                expected = np.where(known, getattr(result, name) - truth, np.nan)
                np.testing.assert_array_equal(getattr(found, name)[k, run], expected)
            if run == 0:
                for name in ("predicted", "filtered"):
                    array = getattr(found.sample, name)
                    np.testing.assert_array_equal(array[k], getattr(result, name))
                for name in ("alpha", "beta", "gamma"):
                    array = getattr(found.sample, name)
                    np.testing.assert_array_equal(array[k], getattr(result.gains, name))
                np.testing.assert_array_equal(found.sample.time, scenario.time)
                np.testing.assert_array_equal(found.sample.plots, z)
                np.testing.assert_array_equal(found.sample.truth, scenario.position)


def test_nis_and_nees_of_a_kalman_filter_from_its_own_covariance():
    scenario = straight(process_sigma=0.5)
    found = monte_carlo(scenario, {"kalman": TRACKERS["kalman"]}, 3, 8)
    for run, stream in enumerate(streams(8, 3)):
        plots = scenario.sensors.measure(scenario.position, [stream])
        state, before = None, None
        for k, (z, sigma) in enumerate(zip(plots.z[:, 0], plots.sigma[:, 0], strict=True)):
            tracker, at = TRACKERS["kalman"], scenario.time[k]
            state = tracker.step(state, z, at, sigma) if state else tracker.start(z, at, sigma)
            phase, p11, p12, p22, _ = state.lanes[state.rows.memory : state.rows.state]
            if before is not None:
                q, (b11, b12, b22, since) = 0.25, before
                dt = at - since
                predicted = b11 + dt * (2 * b12 + dt * b22) + q * dt**4 / 4
                if not np.isnan(state.innovation).all():
                    expected = np.nansum(state.innovation**2 / (predicted + sigma**2))
                    np.testing.assert_allclose(found.nis[0, run, k], expected, rtol=1e-9)
            last = state.lanes[state.rows.last_time]
            if (phase == 2).all() and (before is not None or (last == at).all()):
                variance = np.where(last == at, p11, predicted if before is not None else np.nan)
                off = (state.position - scenario.position[k]) ** 2 / variance
                np.testing.assert_allclose(found.nees[0, run, k], off.sum(), rtol=1e-9)
            before = (p11, p12, p22, last) if (phase == 2).all() else None
    assert np.isfinite(found.nis).sum() > 9


def test_without_covariance_there_is_no_nis():
    found = monte_carlo(straight(process_sigma=0.5), TRACKERS, 3, 4)
    assert np.isnan(found.nis[1]).all()
    assert np.isnan(found.nees[1]).all()
    assert np.isfinite(found.nis[[0, 2, 3, 4]]).any(axis=(1, 2)).all()
    assert monte_carlo(straight(), TRACKERS, 3, 4).nis is None


def test_trackers_of_the_scenario():
    names = ("chan-style", "fixed:alpha=0.5:beta=0.2")
    found = monte_carlo(straight(trackers=names), None, 3, 4)
    assert found.names == names
    asked = monte_carlo(straight(), {name: make_tracker(name) for name in names}, 3, 4)
    assert_same(found, asked)


def test_prepared_plots_and_what_comes_before_them():
    scenario = straight(prepare_start=True)
    found = monte_carlo(scenario, TRACKERS, 20, 4)
    plain = monte_carlo(straight(), TRACKERS, 20, 4)
    late = 0
    for run, stream in enumerate(streams(4, 20)):
        seen = ~np.isnan(plain.measured[run, :, 0])
        first = int(seen.argmax())
        late += first > 0
        # Nothing before the first plot, two then, and the tracker predicts the third.
        assert np.isnan(found.measured[run, :first]).all()
        assert np.isfinite(found.measured[run, first : first + 2]).all()
        trimmed = montecarlo.prepare_start(
            scenario.time,
            *(
                getattr(scenario.sensors.measure(scenario.position, [stream]), name)[:, 0]
                for name in ("z", "sigma")
            ),
        )
        for k, tracker in enumerate(TRACKERS.values()):
            result = tracker.run(trimmed[0], trimmed[1].z, trimmed[1].sigma)
            np.testing.assert_array_equal(
                found.predicted[k, run, first:], result.predicted - scenario.position[first:]
            )
    assert late > 2


def test_runs_without_a_plot():
    sensors = PlotNoise(1.0, detection=1e-9)
    for prepare in (False, True):
        found = monte_carlo(
            straight(sensors=sensors, prepare_start=prepare, process_sigma=0.1), TRACKERS, 3, 0
        )
        for name in NAMES:
            assert np.isnan(getattr(found, name)).all()
        assert found.empty_runs == 3
        assert found.unstarted_runs.tolist() == [3] * 5
    # Some have plots, some have not.
    sensors = PlotNoise(1.0, detection=0.1)
    found = monte_carlo(straight(sensors=sensors), {"f": TRACKERS["fixed"]}, 60, 0)
    assert 0 < found.empty_runs < 60
    assert found.empty_runs == np.isnan(found.predicted[0, :, :, 0]).all(axis=1).sum()
    assert np.isfinite(found.rmse()).all()


# -------------------------------------------------------------------- chunks and where they run


@pytest.mark.parametrize("scenario", [straight(process_sigma=0.5), in_the_field()], ids=["a", "f"])
@pytest.mark.parametrize("size", [1, 3, 7])
def test_chunks_leave_no_trace(scenario, size, monkeypatch):
    one = monte_carlo(scenario, TRACKERS, 17, 3)
    assert np.isfinite(one.predicted).any(axis=(1, 2, 3)).all()
    monkeypatch.setattr(montecarlo, "_RUNS", size)
    shares = []
    assert_same(one, monte_carlo(scenario, TRACKERS, 17, 3, progress=shares.append))
    assert len(shares) == -(-17 // size)
    assert shares == sorted(shares)
    assert shares[-1] == 1
    # A run has the noise that it has in any longer job.
    assert_same(one, monte_carlo(scenario, TRACKERS, 5, 3), runs=5)
    assert (monte_carlo(scenario, TRACKERS, 5, 4).measured != one.measured[:5]).any()


def test_a_preview_has_the_first_runs_without_a_gap(monkeypatch):
    monkeypatch.setattr(montecarlo, "_RUNS", 4)
    scenario, seen = straight(), []

    def in_another_order(function, tasks, executor):
        for task in sorted(tasks, key=lambda chunk: [4, 0, 8, 12, 16].index(chunk.start)):
            yield task, function(task)

    monkeypatch.setattr(montecarlo, "run_tasks", in_another_order)
    montecarlo.monte_carlo(scenario, TRACKERS, 17, 3, preview=seen.append)
    assert [found.runs for found in seen] == [8, 12, 16, 17]
    assert_same(seen[0], monte_carlo(scenario, TRACKERS, 8, 3))


def test_size_of_chunks():
    assert montecarlo._chunk_runs(straight()) == 124
    long = np.arange(300_000.0)
    assert montecarlo._chunk_runs(Scenario("l", long, long[:, None], PlotNoise(1.0))) == 1
    long = long[:5000]
    assert montecarlo._chunk_runs(Scenario("l", long, long[:, None], PlotNoise(1.0))) == 40


def test_processes(monkeypatch, tmp_path):
    one = monte_carlo(straight(process_sigma=0.5), TRACKERS, 12, 3)
    monkeypatch.setattr(montecarlo, "_RUNS", 3)
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        two = monte_carlo(straight(process_sigma=0.5), TRACKERS, 12, 3, executor=pool)
        assert_same(one, two)
        # A worker that dies breaks the pool; what is finished is kept.
        deadly = {"fixed": DiesOnce(TRACKERS["fixed"], tmp_path / "died")}
        with pytest.raises(BrokenProcessPool):
            monte_carlo(straight(), deadly, 12, 3, executor=pool, folder=tmp_path)
    resumed = monte_carlo(straight(), deadly, 12, 3, folder=tmp_path, resume=True)
    assert_same(resumed, monte_carlo(straight(), {"fixed": TRACKERS["fixed"]}, 12, 3))


class DiesOnce:
    """Kills the process that it runs in, the first time."""

    def __init__(self, tracker, trace):
        self.tracker, self.trace = tracker, trace

    def start(self, *args):
        return self.tracker.start(*args)

    def step(self, *args):
        return self.tracker.step(*args)

    def predict(self, *args):
        return self.tracker.predict(*args)

    def run(self, *args):
        if not self.trace.exists():
            self.trace.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return self.tracker.run(*args)


# -------------------------------------------------------------------- what is kept


def chunk_files(folder):
    return sorted((folder / "chunks").glob("[!.]*.npz"))


class Interrupt:
    def __init__(self, after):
        self.left = after

    def __call__(self, share):
        self.left -= 1
        if not self.left:
            raise KeyboardInterrupt


def test_interrupted_and_resumed(tmp_path, monkeypatch):
    monkeypatch.setattr(montecarlo, "_RUNS", 2)
    scenario = straight(process_sigma=0.5)
    one = monte_carlo(scenario, TRACKERS, 9, 3)
    with pytest.raises(KeyboardInterrupt):
        monte_carlo(scenario, TRACKERS, 9, 3, progress=Interrupt(3), folder=tmp_path)
    kept = chunk_files(tmp_path)
    assert len(kept) == 3
    before = [path.stat().st_mtime_ns for path in kept]
    shares = []
    again = monte_carlo(
        scenario, TRACKERS, 9, 3, progress=shares.append, folder=tmp_path, resume=True
    )
    assert_same(one, again)
    assert [path.stat().st_mtime_ns for path in kept] == before
    np.testing.assert_allclose(shares, [2 / 9, 4 / 9, 6 / 9, 8 / 9, 1])
    # More runs than before, and fewer; the last chunk of the nine was a short one.
    longer = monte_carlo(scenario, TRACKERS, 12, 3, folder=tmp_path, resume=True)
    assert_same(longer, one, runs=9)
    assert [path.stat().st_mtime_ns for path in kept] == before
    assert_same(one, monte_carlo(scenario, TRACKERS, 3, 3, folder=tmp_path, resume=True), runs=3)


def test_half_a_chunk_is_none(tmp_path, monkeypatch):
    monkeypatch.setattr(montecarlo, "_RUNS", 2)
    one = monte_carlo(straight(), TRACKERS, 8, 3, folder=tmp_path)
    half, empty, foreign, wrong = chunk_files(tmp_path)
    half.write_bytes(half.read_bytes()[:-300])
    empty.write_bytes(b"")
    foreign.write_bytes(b"no archive at all")
    with np.load(wrong) as file:
        arrays = {**file, "mark": np.array("another job")}
    arrays["predicted"] += 1
    np.savez(wrong, **arrays)
    draft = half.with_name(".runs-000000000-2.abcd.part.npz")
    draft.write_bytes(b"left by a process that was killed")
    assert_same(one, monte_carlo(straight(), TRACKERS, 8, 3, folder=tmp_path, resume=True))
    assert not draft.exists()
    with np.load(half) as file:
        assert file["measured"].shape == (2, 12, 2)


def test_a_folder_holds_one_job(tmp_path):
    monte_carlo(straight(), TRACKERS, 2, 3, folder=tmp_path / "new" / "folder")
    folder = tmp_path / "new" / "folder"
    with pytest.raises(ValueError, match=r"folder holds results of an earlier run; resume it or"):
        monte_carlo(straight(), TRACKERS, 2, 3, folder=folder)
    others = {
        r"seed is 4, .* was 3": (straight(), TRACKERS, 4),
        r"scenario\.sensors is": (straight(sensors=PlotNoise(5.0)), TRACKERS, 3),
        r"scenario\.position is": (straight(position=straight().position + 1e-9), TRACKERS, 3),
        r"scenario\.process_sigma is 0\.1, .* was None": (straight(process_sigma=0.1), TRACKERS, 3),
        r"scenario\.prepare_start is True": (straight(prepare_start=True), TRACKERS, 3),
        r"tracker fixed is": (
            straight(),
            TRACKERS | {"fixed": AlphaBetaTracker(FixedGains(0.5, 0.21))},
            3,
        ),
        r"trackers is fixed, ": (straight(), {"fixed": TRACKERS["fixed"]}, 3),
        r"runs a chunk is 50": (straight(2000), TRACKERS, 3),
    }
    for complaint, (scenario, trackers, seed) in others.items():
        with pytest.raises(ValueError, match=f"^resume: {complaint}"):
            monte_carlo(scenario, trackers, 2, seed, folder=folder, resume=True)
    # What is made anew is the same, and what is scored touches no number.
    fresh = {name: tracker for name, tracker in TRACKERS.items() if name != "fuzzy"}
    fresh["fuzzy"] = make_tracker("stiffness-damping")
    same = {name: fresh[name] for name in TRACKERS}
    scenario = straight(first_scored=4, name="other")
    again = monte_carlo(scenario, same, 2, 3, folder=folder, resume=True)
    assert again.first_scored == 4

    job = folder / "chunks" / "job.json"
    for text in ("{", "[]"):
        job.write_text(text)
        with pytest.raises(ValueError, match=r"job\.json"):
            monte_carlo(straight(), TRACKERS, 2, 3, folder=folder, resume=True)


def test_resume_may_begin(tmp_path):
    monte_carlo(straight(), TRACKERS, 2, 3, folder=tmp_path, resume=True)
    assert len(chunk_files(tmp_path)) == 1
    with pytest.raises(ValueError, match="resume: needs the folder"):
        monte_carlo(straight(), TRACKERS, 2, 3, resume=True)


KILLED = """
import os, signal, sys
sys.path.insert(0, {tests!r})
from test_montecarlo import TRACKERS, straight
from fuzzytrack.testbed import montecarlo
montecarlo._RUNS = 2
def killed(share):
    if share >= 6 / 400:
        os.kill(os.getpid(), signal.SIGKILL)
montecarlo.monte_carlo(straight(), TRACKERS, 400, 3, folder=sys.argv[1], progress=killed)
"""


def test_killed_and_resumed(tmp_path, monkeypatch):
    monkeypatch.setattr(montecarlo, "_RUNS", 2)
    script = KILLED.format(tests=str(Path(__file__).parent))
    # In another process with another order of sets and other identities.
    done = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)],
        env={**os.environ, "PYTHONHASHSEED": "7"},
        check=False,
    )
    assert done.returncode == -signal.SIGKILL
    kept = {path: path.stat().st_mtime_ns for path in chunk_files(tmp_path)}
    assert len(kept) == 3
    runs = 2 * len(kept) + 5
    resumed = monte_carlo(straight(), TRACKERS, runs, 3, folder=tmp_path, resume=True)
    assert_same(monte_carlo(straight(), TRACKERS, runs, 3), resumed)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept


# -------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"runs": 0}, "runs must be at least 1, got 0"),
        ({"seed": -1}, "seed must not be negative, got -1"),
        ({"trackers": {}}, "trackers: at least one is needed"),
        ({"trackers": None}, "trackers: at least one is needed"),
    ],
)
def test_mistakes(changes, complaint):
    given = {"scenario": straight(), "trackers": TRACKERS, "runs": 1, "seed": 0, **changes}
    with pytest.raises(ValueError, match=complaint):
        monte_carlo(**given)


def test_unknown_tracker():
    with pytest.raises(ValueError, match="tracker 'chan-stile': no such tracker"):
        monte_carlo(straight(trackers=("chan-stile",)), None, 1, 0)


def test_an_error_in_a_chunk_ends_the_job(monkeypatch):
    monkeypatch.setattr(montecarlo, "_RUNS", 2)

    class Broken(DiesOnce):
        def run(self, *args):
            raise RuntimeError("no good")

    assert isinstance(Broken(None, None), Tracker)
    with pytest.raises(RuntimeError, match="no good"):
        monte_carlo(straight(), {"b": Broken(None, None)}, 8, 0)
