"""Configurations of scan trackers tuned on scans with truth."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzytrack.errors import DataError
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners import loads_scanner
from fuzzytrack.scan.scanners.loading import load_configuration
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.tuning import scanner_tuner
from fuzzytrack.tuning.scan_criteria import STUDY, scan_criterion
from fuzzytrack.tuning.scan_recordings import ScanRecording
from fuzzytrack.tuning.scan_sources import recorded_scans, scan_sources, simulated_recordings
from fuzzytrack.tuning.scanner_numbers import scanner_numbers
from fuzzytrack.tuning.scanner_tuner import tune_scanner
from fuzzytrack.tuning.tuned_scanner import GroupRow, TunedScanner

TIMES = np.arange(12) * 1.7
TRUTH = np.stack([3.0 * TIMES, 50.0 + 0.0 * TIMES], axis=1)


def recording(name, group="", **more):
    """One target that is always seen."""
    random = np.random.default_rng(len(name))
    scans = [
        Scan(t, place + random.normal(0.0, 0.7, (1, 2)))
        for t, place in zip(TIMES, TRUTH, strict=True)
    ]
    return ScanRecording(name, scans, (TIMES, np.ones(12), TRUTH), group, **more)


RECORDINGS = [recording("a"), recording("bc"), recording("b", "bc"), recording("d")]


@pytest.fixture
def judged(monkeypatch):
    """What is minimized without a run: how far two numbers are from those that are best.

    The best cell differs from group to group.
    """
    best = {"a": 20.0, "bc": 24.0, "d": 28.0}

    def values(self, tracker):
        if tracker is None:
            return np.full(len(self.groups), math.inf)
        far = math.log(tracker.confirmation.hits / 6) ** 2
        return np.array([math.log(tracker.clutter.cell / best[g]) ** 2 + far for g in self.groups])

    monkeypatch.setattr(scanner_tuner._Trials, "_values", values)


def plain(tracker, scans):
    """Tracks in plain Python, without compiling anything."""
    session = ScanSession(tracker, plain=True)
    found = TrackReports.joined([session.step(scan) for scan in scans])
    times = [scan.time for scan in scans]
    return ScanResult.of(found, times, [(0.0, 0.0)] * len(scans), [1] * len(scans), "plain")


FREE = ("clutter.cell", "confirmation.hits")


@pytest.mark.untraced
@pytest.mark.usefixtures("judged")
def test_it_finds_the_best_numbers():
    found = tune_scanner(RECORDINGS, "default", free=FREE, trials=150, name="mine")
    assert found.numbers["confirmation.hits"] == 6
    assert isinstance(found.numbers["confirmation.hits"], int)
    # The geometric mean of the best cells.
    assert found.numbers["clutter.cell"] == pytest.approx((20 * 24 * 28) ** (1 / 3), rel=0.02)
    assert found.start == {"clutter.cell": 31.0, "confirmation.hits": 3}
    assert found.means.tuned < found.means.start
    assert "not judged on anything else" in found.verdict
    assert [row.group for row in found.rows] == ["a", "bc", "d"]
    assert loads_scanner(found.text) == found.tracker
    assert found.tracker.name == "mine"
    assert "based_on: default" in found.text
    assert found.tracker.clutter.cell == found.numbers["clutter.cell"]


@pytest.mark.usefixtures("judged")
def test_groups_are_left_out():
    found = tune_scanner(RECORDINGS, "default", free=["clutter.cell"], trials=60,
                         leave_one_out=True)  # fmt: skip
    for row, others in zip(found.rows, ((24, 28), (20, 28), (20, 24)), strict=True):
        own = {"a": 20.0, "bc": 24.0, "d": 28.0}[row.group]
        cell = math.sqrt(others[0] * others[1])
        expected = math.log(cell / own) ** 2 + math.log(0.5) ** 2
        assert row.held_out == pytest.approx(expected, abs=5e-3)
        assert row.held_out >= row.tuned - 0.05
    middle, low, high = found.change
    assert low < middle < high
    assert "on groups that were left out" in found.verdict


@pytest.mark.untraced
@pytest.mark.usefixtures("judged")
def test_the_same_seed_gives_the_same_and_a_search_is_resumed(tmp_path):
    options = {"free": FREE, "trials": 40, "seed": 3}
    whole = tune_scanner(RECORDINGS, "default", **options)
    assert tune_scanner(RECORDINGS, "default", **options).numbers == whole.numbers
    state = tmp_path / "state.json"
    shares = []
    tune_scanner(RECORDINGS, "default", state=state, progress=shares.append, **options)
    assert shares[-1] == 1.0
    kept = json.loads(state.read_text())
    kept["losses"] = [losses[:13] for losses in kept["losses"]]
    state.write_text(json.dumps(kept))
    resumed = tune_scanner(RECORDINGS, "default", state=state, resume=True, **options)
    assert resumed.numbers == whole.numbers
    with pytest.raises(ValueError, match="resume: metric is"):
        tune_scanner(RECORDINGS, "default", metric="gospa", state=state, resume=True, **options)


@pytest.mark.usefixtures("judged")
def test_what_cannot_be_tuned_is_refused():
    with pytest.raises(ValueError, match="recordings: at least one"):
        tune_scanner([], "default")
    with pytest.raises(ValueError, match=r"no number 'clutter\.cel'"):
        tune_scanner(RECORDINGS, "default", free=["clutter.cel"])
    with pytest.raises(ValueError, match="metric: unknown 'osp'; did you mean 'ospa'"):
        tune_scanner(RECORDINGS, "default", metric="osp")
    with pytest.raises(ValueError, match="needs two groups of recordings, got 'a' only"):
        tune_scanner(RECORDINGS[:1], "default", leave_one_out=True)
    with pytest.raises(ValueError, match="unknown configuration 'defalt'"):
        tune_scanner(RECORDINGS, "defalt")


@pytest.mark.untraced
def test_on_scans():
    """Compiled once for all trials; the losses are those of the trackers run by themselves."""
    recordings = [recording("a", moving_above=0.5), recording("bc")]
    found = tune_scanner(recordings, "default", free=["confirmation.hits", "gate.limit"], trials=9)
    assert found.rows[0].start > 0.0
    metrics = recordings[1].metrics(plain(found.tracker, recordings[1].scans))
    assert metrics["ospa"] == pytest.approx(found.rows[1].tuned, rel=1e-9)
    assert found.means.tuned <= found.means.start


# -------------------------------------------------------------------- what is free


def test_numbers_are_free_within_their_limits():
    found = scanner_numbers(load_configuration("default"), None)
    by_name = {p.name: p for p in found.space.parameters}
    assert by_name["sensor.detection"].scale == "probability"
    assert by_name["clutter.cell"].scale == "log"
    assert by_name["confirmation.ended"].scale == "linear"
    assert by_name["confirmation.ended"].low < -7.6 < by_name["confirmation.ended"].high
    assert by_name["clutter.memory_scans"].low >= 1.0
    # Every end of every range makes a configuration.
    for end in ("low", "high"):
        for k, parameter in enumerate(found.space.parameters):
            if parameter.name == "clutter.side":  # a power of 2
                continue
            numbers = list(found.space.start)
            numbers[k] = getattr(parameter, end)
            configuration = found.configuration(tuple(numbers))
            assert configuration.part("sensor") is not None


def test_a_role_names_all_numbers_of_its_part():
    found = scanner_numbers(load_configuration("default"), ["gate", "sensor.detection"])
    assert [p.name for p in found.space.parameters] == ["sensor.detection", "gate.limit"]


# -------------------------------------------------------------------- what is minimized


def test_criteria():
    metrics = {"ospa": 5.0, "idf1": 0.8, "switches": 2.0, "moving_false_per_minute": 10.0,
               "false_per_minute": 20.0, "breaks": 1.0}  # fmt: skip
    assert scan_criterion("ospa").value(metrics) == 5.0
    assert scan_criterion("idf1").value(metrics) == -0.8
    assert "the most is best" in scan_criterion("idf1").text
    assert scan_criterion(STUDY).value(metrics) == pytest.approx(5 + 1 + 0.5 + 0.2 + 0.2)
    assert scan_criterion("ospa").value({"ospa": math.nan}) == math.inf
    with pytest.raises(ValueError, match="unknown 'ambiguity'"):
        scan_criterion("ambiguity")


def test_recordings_need_scans_and_truth():
    with pytest.raises(DataError, match="1 scans; tuning needs two"):
        ScanRecording("x", [Scan(0.0, np.zeros((0, 2)))], (TIMES, np.ones(12), TRUTH))
    with pytest.raises(DataError, match="no true position"):
        ScanRecording("x", recording("a").scans, (TIMES[:0], np.ones(0), TRUTH[:0]))


def test_digests_tell_recordings_apart():
    digests = {each.digest for each in (*RECORDINGS, recording("a", lag=1.0))}
    assert len(digests) == 5
    assert recording("a").digest == RECORDINGS[0].digest


def test_a_track_with_two_rows_at_a_time_is_scored():
    result = plain(ScanTracker(), RECORDINGS[0].scans)
    reports = result.reports
    last = replace(reports.where(np.array([-1])), plot=np.array([-1]))
    twice = type(reports).joined([last, reports])
    object.__setattr__(result, "reports", twice)
    assert RECORDINGS[0].metrics(result)["ospa"] >= 0.0


# -------------------------------------------------------------------- where recordings come from


def test_runs_of_a_scene_are_one_group():
    found = simulated_recordings("crossing:scans.count=5", 2, seed=4)
    assert {each.group for each in found} == {"crossing:scans.count=5"}
    assert len({each.digest for each in found}) == 2
    assert len(found[0].scans) == 5
    with pytest.raises(ValueError, match="runs must be at least 1"):
        simulated_recordings("crossing", 0)


@pytest.fixture
def files(tmp_path):
    """Plots of two groups, with their truth."""
    plots, truth = ["run,t,x,y"], ["run,t,target,x,y"]
    for run in ("one", "two"):
        for t, (x, y) in zip(TIMES, TRUTH, strict=True):
            plots += [f"{run},{t},{x},{y}", f"{run},{t},{x + 70},{-y}"]
            truth.append(f"{run},{t},7,{x},{y}")
    (tmp_path / "plots.csv").write_text("\n".join(plots))
    (tmp_path / "truth.csv").write_text("\n".join(truth))
    return tmp_path


def test_groups_of_a_file_are_recordings(files):
    found = recorded_scans(files / "plots.csv", files / "truth.csv", group="run")
    assert [each.group for each in found] == ["run one", "run two"]
    assert [len(each.scans) for each in found] == [12, 12]
    assert [len(each.truth[0]) for each in found] == [12, 12]
    late = {"one": 1.5, "two": 2.5}
    found = recorded_scans(files / "plots.csv", files / "truth.csv", group="run", lag=late)
    assert [each.lag for each in found] == [1.5, 2.5]
    with pytest.raises(ValueError, match="lag: has no group 'two'"):
        recorded_scans(files / "plots.csv", files / "truth.csv", group="run", lag={"one": 1.5})
    text = (files / "truth.csv").read_text().replace("two", "three")
    (files / "truth.csv").write_text(text)
    with pytest.raises(DataError, match="no true position of run two"):
        recorded_scans(files / "plots.csv", files / "truth.csv", group="run")


def test_files_need_a_truth(files):
    with pytest.raises(ValueError, match=r"truth: .*is no scene"):
        scan_sources([str(files / "plots.csv")], runs=1, seed=0, truth=None)
    given = [str(files / "plots.csv"), "crossing:scans.count=5"]
    found = scan_sources(given, runs=2, seed=0, truth=str(files / "truth.csv"), group="run")
    assert [each.group for each in found] == ["run one", "run two", given[1], given[1]]


# -------------------------------------------------------------------- the result


def tuned(*rows):
    return TunedScanner(
        ScanTracker(), "name: x\n", "default", {"a": 1.0}, {"a": 2.0},
        tuple(GroupRow(*row) for row in rows), "ospa", "OSPA: OSPA", 3, 50, 0,
    )  # fmt: skip


def test_verdicts(tmp_path):
    better = tuned(("a", 5.0, 4.0, 4.1), ("b", 6.0, 5.0, 5.0), ("c", 7.0, 6.0, 6.2))
    assert "better" in better.verdict
    assert better.means == GroupRow("mean", 6.0, 5.0, pytest.approx(5.1))
    assert "worse" in tuned(("a", 5.0, 4.0, 6.1), ("b", 6.0, 5.0, 7.0), ("c", 7.0, 6, 8.1)).verdict
    unsure = tuned(("a", 5.0, 4.0, 6.1), ("b", 6.0, 5.0, 5.0), ("c", 7.0, 6.0, 6.9))
    assert "no sure change" in unsure.verdict
    assert "too few groups" in tuned(("a", 5.0, 4.0, 4.1), ("b", 6.0, 5.0, 5.0)).verdict
    assert "4.1" in better._repr_html_()
    assert json.loads(json.dumps(better.to_json_dict()))["mean"]["group"] == "mean"
    assert repr(better).startswith("<TunedScanner")
    better.save(tmp_path / "x.yaml")
    assert (tmp_path / "x.yaml").read_text() == "name: x\n"
