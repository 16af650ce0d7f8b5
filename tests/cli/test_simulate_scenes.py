"""`simulate` with scenes of many targets."""

import csv as csv_module

import numpy as np
import pytest

from fuzzytrack.simulation.scene import load_scene, simulate_scans
from fuzzytrack.simulation.scene.schema import dumps_scene_schema


def rows(path):
    with open(path, newline="") as file:
        return list(csv_module.DictReader(file))


def column(table, name):
    return np.array([row[name] for row in table], float)


def test_the_schema_is_printed_alone(run):
    result = run("simulate", "--schema")
    assert (result.exit_code, result.stdout) == (0, dumps_scene_schema())


def test_plots_truth_and_scans_are_those_of_the_simulation(run, tmp_path):
    plots, truth, scans = (tmp_path / f"{name}.csv" for name in ("plots", "truth", "scans"))
    name = "harbor:scans.count=30:scans.lost=0.2"
    result = run(
        *("simulate", name, "-o", plots, "--truth", truth, "--scans", scans, "--seed", 4),
        *("--polar", "--own", "--truth-id"),
    )
    assert (result.exit_code, result.stderr) == (0, "")
    made = simulate_scans(load_scene(name), 4)
    clutter = (made.target_id == 0).sum()
    assert result.stdout.splitlines() == [
        *(f"wrote {file}" for file in (plots, truth, scans)),
        f"30 scans, {len(made.target_id)} plots, {clutter} of them clutter, "
        f"{made.truth.n_targets} targets",
    ]
    table = rows(plots)
    assert list(table[0]) == [
        "scan",
        "t",
        "x",
        "y",
        "range",
        "azimuth",
        "own_x",
        "own_y",
        "truth_id",
    ]
    places = np.concatenate([each.positions for each in made.scans])
    np.testing.assert_array_equal(np.stack([column(table, "x"), column(table, "y")], 1), places)
    np.testing.assert_array_equal(column(table, "t"), np.concatenate([s.times for s in made.scans]))
    np.testing.assert_array_equal(column(table, "truth_id"), made.target_id)
    # Range and azimuth lead back from the place of the radar.
    azimuth = np.radians(column(table, "azimuth"))
    assert ((azimuth >= 0) & (azimuth < 2 * np.pi)).all()
    back = column(table, "own_x") + column(table, "range") * np.sin(azimuth)
    np.testing.assert_allclose(back, places[:, 0], atol=1e-9)
    table = rows(scans)
    assert list(table[0]) == ["scan", "t", "own_x", "own_y", "plots"]
    assert column(table, "plots").tolist() == [len(each) for each in made.scans]
    assert (column(table, "plots") == 0).sum() > 1
    assert column(table, "own_y").tolist() == [each.own[1] for each in made.scans]
    table = rows(truth)
    assert list(table[0]) == ["t", "id", "x", "y", "vx", "vy", "group", "visible"]
    np.testing.assert_array_equal(column(table, "vy"), made.truth.velocity[:, 1])
    assert {row["group"] for row in table} <= set(load_scene("harbor").traffic)


def test_plots_without_truth_do_not_tell_it(run, tmp_path):
    plots = tmp_path / "plots.parquet"
    assert run("simulate", "crossing", "-o", plots).exit_code == 0
    import pyarrow.parquet

    assert pyarrow.parquet.read_table(plots).column_names == ["scan", "t", "x", "y"]


def test_a_file_after_truth_may_stand_anywhere(run, tmp_path):
    one, two, plots = (tmp_path / f"{name}.csv" for name in ("one", "two", "plots"))
    assert run("simulate", "--truth", one, "crossing", "-o", plots).exit_code == 0
    assert run("simulate", "crossing", "-o", plots, "--truth", two).exit_code == 0
    assert one.read_bytes() == two.read_bytes()


def test_the_truth_of_a_single_target_beside_its_plots(run, tmp_path):
    alone, beside, plots = (tmp_path / f"{name}.csv" for name in ("alone", "beside", "plots"))
    assert run("simulate", "warship", "--truth", "-o", alone).exit_code == 0
    result = run("simulate", "warship", "--truth", beside, "-o", plots)
    assert result.stdout == f"wrote {plots}\nwrote {beside}\n"
    assert alone.read_bytes() == beside.read_bytes()
    assert "sigma_x_m" in rows(plots)[0]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("harbur",), "error: unknown scenario 'harbur'; did you mean 'harbor'? allowed: air-su"),
        (("harbor", "--truth"), "error: --truth: name its file, as in --truth truth.csv; harbor"),
        (("harbor", "--runs", 2), "error: --runs: a scene is simulated once for a seed; leave it"),
        (("harbor", "more"), "error: unexpected argument 'more'; a file of the truth follows --t"),
        (("warship", "--polar"), "error: --polar: is for scenes of many targets; warship has one"),
        (("warship", "--scans", "s.csv"), "error: --scans: is for scenes of many targets; warsh"),
        (("harbor", "--scans", "out.csv"), "error: --scans: out.csv is written already; name an"),
        (("harbor", "--truth", "no/t.csv"), "error: no/t.csv: there is no folder "),
        (("harbor:radar.detection=2",), "error: radar.detection=2: detection must be a number >="),
        (("harbor:scans.count=0",), "error: scans.count=0: count must be a whole number >= 1 and"),
        (
            ("dense-traffic:traffic.ships.count=1000000",),
            "error: the scene has 25 scans of some 1000000 targets, more than 20000000 states; si",
        ),
    ],
)
def test_what_cannot_be_simulated(fails, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    assert fails("simulate", *words, "-o", "out.csv").startswith(message)
    assert not list(tmp_path.iterdir())


def test_a_mistake_in_a_file_is_told_with_its_place(fails, csv, tmp_path):
    path = csv(
        "scenario: 1\nname: bay\nscans: {count: 5, period: 1}\n"
        "radar: {reach: 100, detection: 1.3}\ntraffic: {boats: {count: 2}}\n",
        "bay.yaml",
    )
    told = fails("simulate", path, "-o", tmp_path / "x.csv")
    assert told == f"{path}:4:32: detection must be a number >= 0 and <= 1, got 1.3"
    assert "is a scene of many targets" in fails("testbed", "harbor")
