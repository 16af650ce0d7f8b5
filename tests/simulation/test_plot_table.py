import numpy as np

from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.plot_table import plot_columns, truth_columns
from fuzzytrack.simulation.scenario import PlotNoise, Scenario

T = np.array([0.0, 1.0, 4.0])
# Two tracks in three axes, each flown by every second run.
POSITION = np.arange(18.0).reshape(3, 2, 3)
SCENARIO = Scenario("two tracks", T, POSITION, PlotNoise((1.0, 2.0, 3.0), detection=0.5))


def test_plots_of_each_run_stand_beside_its_own_truth():
    found = plot_columns(SCENARIO, 3, 8)
    assert list(found) == [
        *("run", "t_s", "x_m", "y_m", "z_m", "true_x_m", "true_y_m", "true_z_m"),
        *("sigma_x_m", "sigma_y_m", "sigma_z_m"),
    ]
    assert found["run"] == ["0"] * 3 + ["1"] * 3 + ["2"] * 3
    assert found["t_s"].tolist() == [*T, *T, *T]
    assert found["true_y_m"].tolist() == [1, 7, 13, 4, 10, 16, 1, 7, 13]
    plots = SCENARIO.sensors.measure(POSITION[:, [0, 1, 0]], streams(8, 3))
    assert 0 < np.isnan(plots.z[..., 0]).sum() < 9
    for k, axis in enumerate("xyz"):
        for run in range(3):
            rows = slice(3 * run, 3 * run + 3)
            np.testing.assert_array_equal(found[f"{axis}_m"][rows], plots.z[:, run, k])
            np.testing.assert_array_equal(found[f"sigma_{axis}_m"][rows], plots.sigma[:, run, k])


def test_a_truth_that_all_runs_share_is_written_once():
    alone = Scenario("one track", T, POSITION[:, 1], PlotNoise(1.0))
    assert truth_columns(alone, 5)["x_m"].tolist() == [3, 9, 15]
    found = truth_columns(SCENARIO, 3)
    assert found["run"] == ["0"] * 3 + ["1"] * 3 + ["2"] * 3
    assert found["x_m"].tolist() == [0, 6, 12, 3, 9, 15, 0, 6, 12]
