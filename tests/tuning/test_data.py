import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io import Reading
from fuzzytrack.simulation.scenario_files import load_scenario, loads_scenario
from fuzzytrack.tuning.data import TuningData, TuningTrack, joined, recorded, simulated
from fuzzytrack.tuning.folds import make_folds

RNG = np.random.default_rng(8)


def track(id, steps, sigma=None):
    time = np.cumsum(RNG.uniform(0.5, 1.5, steps))
    plots = 5 * time[:, None] + RNG.normal(0, 2, (steps, 2))
    return TuningTrack(id, time, plots, sigma=sigma)


def test_plots_from_the_third_on_are_scored_if_they_are_there():
    plots = np.arange(14.0).reshape(7, 2)
    plots[0, 1] = plots[4] = np.nan
    one = TuningTrack("a", np.arange(7.0), plots)
    np.testing.assert_array_equal(one.scored, [0, 0, 0, 1, 0, 1, 1])
    truth = np.zeros((7, 2))
    truth[5] = np.nan
    one = TuningTrack("a", np.arange(7.0), plots, truth)
    np.testing.assert_array_equal(one.scored, [0, 0, 0, 1, 0, 0, 1])


def test_units_are_tracks_or_blocks_of_time():
    tracks = tuple(track(name, steps) for name, steps in zip("abcd", (60, 80, 75, 30), strict=True))
    data = TuningData("four", tracks)
    folds = make_folds(data, 5, seed=1)
    assert (folds.kind, folds.number) == ("tracks", 4)
    assert sorted(folds.fold) == [0, 1, 2, 3]
    np.testing.assert_array_equal(folds.plots, [58, 78, 73, 28])
    assert all(batch.time.ndim == 2 or len(batch.members) == 1 for batch in data.batches)
    # Sums over the plots of each track, whatever the batches.
    values = [np.where(b.scored, b.members + 1.0, np.nan) for b in data.batches]
    np.testing.assert_array_equal(folds.by_unit(values), folds.plots * [1, 2, 3, 4])
    other = make_folds(data, 2, seed=1)
    np.testing.assert_array_equal(np.bincount(other.fold), [2, 2])

    data = TuningData("two", (track("a", 122), track("b", 102)))
    folds = make_folds(data, 5, seed=1)
    assert (folds.kind, folds.number) == ("blocks of time", 5)
    np.testing.assert_array_equal(folds.plots, [6] * 20 + [5] * 20)
    np.testing.assert_array_equal(folds.fold[:6], [0, 1, 2, 3, 4, 0])
    # Blocks follow each other in time.
    (batch,) = (b for b in data.batches if 0 in b.members)
    column = int(np.flatnonzero(batch.members == 0)[0])
    units = folds.units[0][:, column]
    assert (np.diff(units[units >= 0]) >= 0).all()
    with pytest.raises(ValueError, match="folds must be at least 2, got 1"):
        make_folds(data, 1, seed=0)


def test_the_noise_is_the_known_one_or_estimated():
    time = np.arange(3000.0)
    plots = 4 * time[:, None] + RNG.normal(0, 7, (3000, 2))
    assert TuningData("a", (TuningTrack("", time, plots),)).noise == pytest.approx(7, rel=0.05)
    sigma = np.full((3000, 2), 3.0)
    sigma[::2] = 4.0
    data = TuningData("a", (TuningTrack("", time, plots, sigma=sigma),))
    assert data.noise == pytest.approx(np.sqrt(12.5))
    assert data.interval == 1.0
    # Plots that are rounded to few values have no median.
    few = np.zeros((300, 1))
    few[150] = 5.0
    assert TuningData("a", (TuningTrack("", np.arange(300.0), few),)).noise > 0


def test_too_little_and_constant_data_are_refused():
    with pytest.raises(DataError, match="few: 98 plots can be scored; tuning needs 200 at least"):
        TuningData("few", (track("a", 100),))
    still = TuningTrack("a", np.arange(400.0), np.full((400, 2), 7.0))
    with pytest.raises(DataError, match="still: all plots are at one place"):
        TuningData("still", (still,))


def test_runs_of_a_scenario_have_their_truth_and_sigma():
    data = simulated(load_scenario("llinas-m2"), 20, seed=3)
    assert len(data.tracks) == 20
    assert data.has_truth
    assert data.has_sigma
    scaled = np.concatenate([(t.plots - t.truth) / t.sigma for t in data.tracks])
    assert np.nanmean(scaled**2) == pytest.approx(1, rel=0.2)
    # Times that all have in common are not repeated.
    assert [batch.time.shape for batch in data.batches] == [data.tracks[0].time.shape]
    assert "TuningData" in repr(data)


def test_runs_of_a_scenario_have_their_own_times():
    scenario = loads_scenario(
        "scenario: 1\nname: own\ntarget: {set: mixed, tracks: 3}\nsensors: {sigma: 1}\n"
        "sampling: {jitter: 0.3}\n"
    )
    data = simulated(scenario, 5, seed=3)
    for k, one in enumerate(data.tracks):
        np.testing.assert_array_equal(one.time, scenario.time[:, k % 3])
        np.testing.assert_array_equal(one.truth, scenario.position[:, k % 3])


def reading(**options):
    return Reading.of(**{"id": "id", **options})


def test_recorded_plots_have_their_noise_given_or_estimated(tmp_path):
    rng = np.random.default_rng(4)
    rows = ["t,id,x,y"]
    for id in "ab":
        noise = rng.normal(0, (2, 8), (250, 2))
        rows += [f"{k},{id},{k * 2 + dx:.4f},{k + dy:.4f}" for k, (dx, dy) in enumerate(noise)]
    plots = tmp_path / "plots.csv"
    plots.write_text("\n".join(rows))
    data = recorded(plots, reading(sigma=2.0))
    assert (data.has_truth, data.axes_differ, data.name) == (False, False, str(plots))
    assert data.tracks[1].sigma.tolist() == [[2.0, 2.0]] * 250
    data = recorded(plots, reading())
    assert data.axes_differ
    np.testing.assert_allclose(data.tracks[0].sigma[7], [2, 8], rtol=0.15)
    with pytest.raises(ValueError, match="sigma: must be > 0, got -1"):
        recorded(plots, reading(sigma=-1))


def test_plots_beyond_the_gate_are_missed(tmp_path):
    rng = np.random.default_rng(4)
    x = 3.0 * np.arange(300) + rng.normal(0, 1, 300)
    x[100] += 500
    x[200:] += 1e5
    data = recorded({"t": np.arange(300), "x": x}, Reading.of())
    assert [len(track.time) for track in data.tracks] == [203, 97]
    assert np.isnan(data.tracks[0].plots).nonzero()[0].tolist() == [100, 200, 201, 202]
    assert data.notes == (
        "4 plots beyond the gate, not used",
        "1 track started again after several of these",
    )
    (whole,) = recorded({"t": np.arange(300), "x": x}, Reading.of(), gate=None).tracks
    np.testing.assert_array_equal(whole.plots[:, 0], x)


def test_bare_angles_have_no_jumps(tmp_path):
    k = np.arange(300)
    rng = np.random.default_rng(4)
    course = 350 + 0.1 * k
    columns = {"t": k, "heading": (course + rng.normal(0, 0.5, 300)) % 360, "true": course % 360}
    data = recorded(columns, Reading.of(angle="heading"), truth="true")
    (one,) = data.tracks
    np.testing.assert_allclose(one.plots[:, 0], course, atol=3)
    np.testing.assert_allclose(one.truth[:, 0], course, atol=1e-9)
    assert data.noise == pytest.approx(0.5, rel=0.15)


def test_notes_and_noise_of_several_recordings_are_joined():
    rng = np.random.default_rng(4)
    columns = {"t": np.arange(300), "x": 3.0 * np.arange(300) + rng.normal(0, 1, 300)}
    spiked = {**columns, "x": np.where(np.arange(300) == 100, 1e4, columns["x"])}
    data = joined([recorded(columns), recorded(spiked)])
    assert data.notes == ("plots: 1 plot beyond the gate, not used",)
    assert [track.group for track in data.tracks] == [0, 1]
    assert not data.axes_differ


def test_a_lag_between_plots_and_their_truth_is_taken_off(tmp_path):
    t = np.arange(0.0, 600.0, 2.0)
    x, y = 1000 * np.sin(t / 30), 800 * np.cos(t / 40)
    rng = np.random.default_rng(5)
    plots = {"t": t + 2.5, "x": x + rng.normal(size=len(t)), "y": y + rng.normal(size=len(t))}
    truth = tmp_path / "truth.csv"
    rows = [f"{a},{b},{c}" for a, b, c in zip(t, x, y, strict=True)]
    truth.write_text("\n".join(["t,x,y", *rows]))
    data = recorded(plots, Reading.of(sigma=1.0), truth=truth)
    (one,) = data.tracks
    error = one.plots - one.truth
    assert np.nanstd(error) < 1.3
    assert "s behind the truth (fitted), which was taken off" in data.notes[-1]
