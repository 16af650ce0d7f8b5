import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.simulation.scenario_files import load_scenario, loads_scenario
from fuzzytrack.tuning.data import TuningData, TuningTrack, recorded, simulated
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


def test_recorded_plots_with_and_without_truth(tmp_path):
    rows = ["t,id,x,y"]
    rows += [f"{k},{id},{k * 2},{k % 7}" for id in "ab" for k in range(250)]
    plots = tmp_path / "plots.csv"
    plots.write_text("\n".join(rows))
    data = recorded(plots, id="id", sigma=2.0)
    assert not data.has_truth
    assert data.tracks[1].sigma.tolist() == [[2.0, 2.0]] * 250
    truth = tmp_path / "truth.csv"
    truth.write_text("t,id,x,y\n10,a,21,1\n12,a,25,2\n0,b,0,0\n500,b,1000,0\n")
    data = recorded(plots, id="id", truth=truth)
    np.testing.assert_array_equal(data.tracks[0].truth[9:13, 0], [np.nan, 21, 23, 25])
    assert data.tracks[0].scored.sum() == 3
    assert data.tracks[1].truth[7, 0] == 14
    truth.write_text("t,id,x,y\n10,a,21,1\n")
    with pytest.raises(DataError, match=r"truth\.csv: has no track 'b', for which there are plots"):
        recorded(plots, id="id", truth=truth)
    # The truth can be in columns of the same file.
    columns = recorded(plots, id="id", truth="y, x")
    np.testing.assert_array_equal(columns.tracks[1].truth, columns.tracks[1].plots[:, ::-1])
    with pytest.raises(DataError, match=r"truth: there is no file yy,x, and .* no column 'yy'"):
        recorded(plots, id="id", truth="yy,x")
    truth.write_text("t,id,x,y,z\n10,a,21,1,0\n10,b,21,1,0\n")
    with pytest.raises(DataError, match=r"truth\.csv: has 3 axes, the plots have 2"):
        recorded(plots, id="id", truth=truth)
    with pytest.raises(ValueError, match="sigma must be > 0, got -1"):
        recorded(plots, id="id", sigma=-1)
