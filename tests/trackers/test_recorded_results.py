"""Every tracker gives the numbers that it gave when `recorded_results.npz` was recorded."""

from functools import cache

import numpy as np
import pytest
from recorded_cases import CASES, INPUTS, LANES, OUTPUTS, tracker_of
from recorded_file import load, save
from recorded_results import (
    Replay,
    complaints,
    first_difference,
    recorded,
    replays,
    track,
    whole,
)

from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.schedulers.catalog import scheduling_rulebases
from fuzzytrack.trackers.catalog import catalog

pytestmark = pytest.mark.untraced

#: Parameters that all trackers are made with, as ``:name=value``. When the file was recorded, time
#: counted from step to step.
OPTIONS = ":missed=step"

recording = cache(load)


def ways_proved(case):
    """Precisions, and whether compiled, in which a case has to have run."""
    ways = {("float64", False)}
    ways |= {("float32", True)} if case.single else set()
    return ways | ({("float64", True)} if case.compiled else set())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_it_gives_the_recorded_numbers(case):
    proved = set()
    for replay in replays(case, OPTIONS):
        outputs = recording()[case.name][replay.inputs, replay.dtype]
        assert not complaints(case, replay, outputs)
        if replay.calls is not None:
            # Plain Python calls a function at least once for each step of a track.
            assert (replay.calls < replay.lane_steps) == replay.compiled, (replay.way, replay.calls)
            proved.add((replay.inputs, replay.dtype, replay.compiled))
    assert proved == {(name, *way) for name in INPUTS for way in ways_proved(case)}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_without_missed_plots_time_may_count_from_plot_to_plot(case):
    found = whole(track(case, tracker_of(case), INPUTS["plain"], "float64"))
    outputs = recording()[case.name]["plain", "float64"]
    assert not complaints(case, Replay("plain", "float64", "plot to plot", found), outputs)


def test_the_file_has_the_cases_of_the_list():
    assert list(recording()) == [case.name for case in CASES]
    for case in CASES:
        kinds = ("float64", "float32") if case.single else ("float64",)
        runs = recording()[case.name]
        assert list(runs) == [(name, kind) for name in INPUTS for kind in kinds]
        for outputs in runs.values():
            assert set(outputs) == {*OUTPUTS, LANES}


def test_nothing_is_left_out():
    ours = [entry for entry in catalog() if entry.package == "fuzzytrack"]
    names = {case.spec.partition(":")[0] for case in CASES}
    rules = " ".join(case.rules for case in CASES)
    used = {
        dict(load_rulebase(name).scheduler)["normalization"] for name in scheduling_rulebases()
    }  # fmt: skip
    for entry in ours:
        if entry.kind == "normalization":
            assert f"normalization: {entry.name}," in rules or entry.name in used, entry
        else:
            assert entry.name in names, entry
    for kind in ("scheduler", "tracker", "rule base", "normalization"):
        assert [entry for entry in ours if entry.kind == kind], kind
    # What is compiled in single precision only has a sibling that is compiled in both.
    assert sum(case.compiled for case in CASES) > len(CASES) / 3


@pytest.mark.parametrize(
    "case",
    [case for case in CASES if not (case.single and case.streams)],
    ids=lambda case: case.name,
)
def test_what_a_case_leaves_out_is_refused(case):
    tracker, given = tracker_of(case, OPTIONS), INPUTS["plain"]
    if not case.single:
        with pytest.raises(ValueError, match="which float32 lacks"):
            tracker.run(given.times, given.plots, given.sigma, dtype=np.float32)
    if not case.streams:
        with pytest.raises(ValueError, match="cannot track plot by plot"):
            tracker.start(given.plots[0], given.times[0], given.sigma)


def test_inputs_have_what_they_are_named_for():
    missed = np.isnan(INPUTS["gaps"].plots)
    assert not np.isnan(INPUTS["plain"].plots).any()
    assert np.unique(np.diff(INPUTS["plain"].times)).size == 1
    assert np.unique(np.diff(INPUTS["gaps"].times)).size > 10
    assert np.ptp(INPUTS["own times"].times, axis=1).all()
    # At the start, at the end, several in a row, one coordinate alone, never seen.
    assert missed[0].all(axis=-1).any()
    assert missed[-1].all(axis=-1).any()
    assert (missed[9:13].all(axis=(0, -1)) & ~missed[13].any(axis=-1)).any()
    assert (missed.sum(axis=-1) == 1).any()
    assert missed.all(axis=(0, -1)).sum() == 1
    for given in INPUTS.values():
        for values in (given.times, given.plots, given.sigma):
            single = np.asarray(values, dtype=np.float32)
            np.testing.assert_array_equal(single.astype(np.float64), values)


def test_a_difference_of_one_bit_is_found_and_told():
    numbers = np.array([[1.0, np.nan], [0.0, -3.0]])
    assert first_difference(numbers, numbers.copy()) is None
    assert first_difference(numbers, np.where(np.isnan(numbers), -np.nan, numbers)) is None
    for place, value in (((0, 0), np.nextafter(1.0, 2.0)), ((0, 1), 0.0), ((1, 0), -0.0)):
        changed = numbers.copy()
        changed[place] = value
        assert first_difference(numbers, changed) == place
        assert first_difference(changed, numbers) == place
        allowed = first_difference(numbers, changed, 1e-12)
        assert allowed == (place if np.isnan(numbers[place]) else None)
    assert first_difference(numbers, numbers + 1e-11, 1e-12) == (0, 0)
    assert "shape (2, 2) is now float64 of (2,)" in first_difference(numbers, numbers[0])

    case = next(case for case in CASES if not case.tolerant)
    replay = next(replays(case, OPTIONS))
    outputs = {name: np.array(values) for name, values in replay.outputs.items()}
    before = outputs["velocity"][4, 1, 0]
    outputs["velocity"][4, 1, 0] = np.nextafter(before, np.inf)
    outputs[LANES][3, 2] = 7.0
    told, of_lanes = complaints(case, replay, outputs)
    assert told.startswith(
        f"{case.name}: velocity of the inputs 'plain' in float64, plain: at [4, 1"
    )
    assert told.endswith(f"is now {float(before)!r} ({float(before).hex()})")
    assert "lanes of" in of_lanes
    assert "at [3, 2] 7.0" in of_lanes


def test_a_file_holds_every_bit(tmp_path):
    cases = [case for case in CASES if case.name in ("kalman-ca", "imm", "chan-magnitude, gamma")]
    results = {case.name: recorded(case, OPTIONS) for case in cases}
    odd = results["imm"]["gaps", "float64"]
    odd["velocity"] = odd["velocity"].copy()
    odd["velocity"][3, :2, 0] = -0.0, np.inf
    path = tmp_path / "results.npz"
    save(path, results)
    again = load(path)
    assert list(again) == list(results)
    for name, runs in results.items():
        for key, outputs in runs.items():
            for output, values in outputs.items():
                assert first_difference(np.asarray(values), again[name][key][output]) is None
    assert [file.name for file in tmp_path.iterdir()] == ["results.npz"]


def test_a_file_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "results.npz"
    path.write_bytes(b"as it was")
    case = CASES[0]

    def full(stream, **arrays):
        stream.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OSError, match="No space left"):
        save(path, {case.name: recorded(case, OPTIONS)})
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [
        (path.name, b"as it was")
    ]
