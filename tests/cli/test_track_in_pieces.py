import json
import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from fuzzytrack.cli import track as tracking


@pytest.fixture
def folder(tmp_path):
    """Four files of 400 rows in order of time, ten tracks mixed."""
    place = tmp_path / "plots"
    place.mkdir()
    rng = np.random.default_rng(4)
    for k in range(4):
        x = rng.normal(size=(400, 2)) * 10
        x[rng.random(400) < 0.1] = math.nan
        table = pa.table(
            {
                "id": rng.integers(0, 10, 400),
                "t": 400.0 * k + np.arange(400),
                "x": pa.array(x[:, 0], from_pandas=True),
                "y": pa.array(x[:, 1], from_pandas=True),
            }
        )
        pq.write_table(table, place / f"part-{k}.parquet", row_group_size=150)
    pq.write_table(pq.read_table(place), tmp_path / "whole.parquet")
    return place


def sorted_rows(path):
    """Rows track by track, in the order of time."""
    return pq.read_table(path).sort_by([("id", "ascending"), ("t", "ascending")])


def test_the_table_is_that_of_a_run_at_once(run, folder, tmp_path):
    at_once, in_pieces, of_folder = (tmp_path / f"{k}.parquet" for k in "abc")
    whole = tmp_path / "whole.parquet"
    # No plot is too soon after the first one.
    words = ("--id", "id", "--tracker", "stiffness-damping", "--least-step", "0.5", "--json")
    first = run("track", whole, *words, "-o", at_once)
    second = run("track", whole, *words, "-o", in_pieces, "--chunk-rows", 77)
    third = run("track", folder, *words, "-o", of_folder)
    assert sorted_rows(in_pieces) == sorted_rows(at_once)
    assert sorted_rows(of_folder) == sorted_rows(in_pieces)
    # Rows stay where the recording has them.
    for name in ("t", "x"):
        assert pq.read_table(in_pieces)[name] == pq.read_table(whole)[name]
    totals = [json.loads(result.stdout)["total"] for result in (first, second, third)]
    assert totals[1] == pytest.approx(totals[0], rel=1e-12)
    assert totals[2] == pytest.approx(totals[0], rel=1e-12)


def test_csv_in_and_out(run, folder, tmp_path):
    from pyarrow import csv

    source, at_once, in_pieces = (tmp_path / f"{k}.csv" for k in "abc")
    csv.write_csv(pq.read_table(tmp_path / "whole.parquet"), source)
    words = ("--id", "id", "--tracker", "stiffness-damping")
    run("track", source, *words, "-o", at_once)
    result = run("track", source, *words, "-o", in_pieces, "--chunk-rows", 100)
    assert ["all", "10"] in [line.split()[:2] for line in result.stdout.splitlines()]
    keys = [("id", "ascending"), ("t", "ascending")]
    expected, found = (csv.read_csv(path).sort_by(keys) for path in (at_once, in_pieces))
    assert found == expected


def test_a_large_file_goes_in_pieces_by_itself(run, folder, tmp_path, monkeypatch):
    path, out = tmp_path / "whole.parquet", tmp_path / "o.parquet"
    monkeypatch.setattr(tracking, "_LARGE", 1000)
    words = ("--id", "id", "--tracker", "stiffness-damping")
    found = json.loads(run("track", path, *words, "-o", out, "--json").stdout)
    assert found["tracks"] is None
    assert found["number"] == 10
    assert run("track", path, *words, "--sort", "-o", out).exit_code == 0
    assert "gamma_x" not in pq.read_schema(out).names


def test_partitions_in_this_process_and_in_others(run, folder, tmp_path):
    one, many = tmp_path / "o.parquet", tmp_path / "many"
    run("track", folder, "--id", "id", "-o", one)
    words = ("--jobs", 2, "--partitions", 3, "--chunk-rows", 90)
    result = run("track", folder, "--id", "id", "-o", many, *words)
    assert result.exit_code == 0, result.stderr
    assert sorted(path.name for path in many.iterdir()) == [
        f"part-{k:05d}.parquet" for k in range(3)
    ]
    assert sorted_rows(many) == sorted_rows(one)
    assert f"wrote {many}" in result.stdout


def test_one_track(run, tmp_path):
    path = tmp_path / "f.csv"
    path.write_text("t,x\n0,0\n1,10\n2,20\n")
    result = run("track", path, "--chunk-rows", 2)
    assert result.stdout.splitlines()[-1].split()[:4] == ["track", "3", "0", "2"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--plot", "p.png"], "--plot: needs the whole recording in memory"),
        (["--sort"], "--sort: needs the whole recording in memory"),
        (["--jobs", "2"], "need -o DIR"),
        (["--jobs", "2", "--scheduler", "tcp://a:1", "-o", "new"], "give one"),
        (["--jobs", "2", "-o", "plots"], "plots: holds files already; choose another folder"),
        (["--jobs", "2", "-o", "whole.parquet"], "whole.parquet: is not a folder"),
        (["--jobs", "2", "-o", "no/new"], "there is no folder"),
        (["--axes", "x,q"], "--axes: no column 'q'"),
        (["--time", "clock"], "--time: no column 'clock'"),
        (["-o", "out.xls"], "cannot write .xls"),
        (["--chunk-rows", "0"], "--chunk-rows"),
    ],
)
def test_bad_options(fails, folder, monkeypatch, words, message):
    monkeypatch.chdir(folder.parent)
    before = sorted(folder.parent.iterdir())
    assert message in fails("track", "plots", "--id", "id", *words)
    assert sorted(folder.parent.iterdir()) == before


def test_files_in_the_wrong_order(fails, folder, tmp_path):
    (folder / "part-0.parquet").rename(folder / "part-9.parquet")
    out = tmp_path / "o.parquet"
    # One that suits any times: others add a warning.
    tracker = "kalman-cv:sigma_v=1:sigma_w=1"
    line = fails("track", folder, "--id", "id", "--tracker", tracker, "-o", out)
    assert "part-9.parquet: row" in line
    assert "is earlier than" in line
    assert "(id '" in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plots", "whole.parquet"]


def test_no_rows(fails, tmp_path):
    path = tmp_path / "f.parquet"
    pq.write_table(
        pa.table({"t": pa.array([], pa.float64()), "x": pa.array([], pa.float64())}), path
    )
    out = tmp_path / "o.csv"
    for words in ([], ["-o", out], ["--jobs", "2", "-o", tmp_path / "o", "--partitions", "1"]):
        assert "holds no rows" in fails("track", path, "--chunk-rows", 5, *words)
    assert list(tmp_path.iterdir()) == [path]


def test_a_tracker_without_states(fails, folder, monkeypatch):
    class Whole:
        def run(self): ...

        start = step = predict = run

    from fuzzytrack.trackers import catalog

    monkeypatch.setattr(catalog, "make_tracker", lambda name: Whole())
    assert "Whole cannot go on from piece to piece" in fails("track", folder)
