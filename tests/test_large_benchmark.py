"""The measurement of large recordings, on a small one."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from fuzzytrack.recordings.partition_files import partition_of

ROOT = Path(__file__).resolve().parents[1]
PARTITIONS = 5


@pytest.fixture(scope="module", autouse=True)
def the_suite_can_be_imported():
    pytest.importorskip("resource")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield


@pytest.fixture(scope="module")
def run(the_suite_can_be_imported, tmp_path_factory):
    """The command, its status, and the figures that it wrote."""
    from benchmarks.large import main

    figures = tmp_path_factory.mktemp("figures") / "figures.json"

    def call(*arguments):
        status = main([*map(str, arguments), "--json", str(figures)])
        return status, json.loads(figures.read_text())

    return call


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("large")


@pytest.fixture(scope="module")
def made(run, folder):
    return run("make", folder / "in", "--gigabytes", 0.0004, "--files", 4, "--live", 8)


@pytest.fixture(scope="module")
def alone(run, folder, made):
    return run("one", folder / "in", "-o", folder / "one.parquet", "--rows", 700)


@pytest.fixture(scope="module")
def together(run, folder, made):
    pytest.importorskip("distributed")
    return run(
        "cluster", folder / "in", "-o", folder / "apart", "--rows", 300, "--kill",
        "--partitions", PARTITIONS,
    )  # fmt: skip


def test_a_recording_is_as_large_as_it_says(folder, made):
    status, figures = made
    files = sorted((folder / "in").iterdir())
    assert status == 0
    assert len(files) == figures["files"] == 4
    assert sum(path.stat().st_size for path in files) == figures["bytes"] >= 400_000
    assert figures["rows"] == sum(pq.read_metadata(path).num_rows for path in files) > 4_000
    columns = pq.read_metadata(files[0]).row_group(0)
    assert {columns.column(k).compression for k in range(columns.num_columns)} == {"UNCOMPRESSED"}


def test_a_recording_is_one_of_tracks_that_come_and_go(folder, made):
    table = pq.read_table(folder / "in")
    assert np.all(np.diff(table["time"].to_numpy()) > 0.0)
    tracks = table.group_by("track").aggregate([("time", "min"), ("time", "max"), ("x", "count")])
    assert len(tracks) == made[1]["tracks"] > 16
    assert set(map(len, tracks["track"].to_pylist())) == {36}
    ends = tracks["time_max"].to_numpy()
    assert np.sum(ends < table["time"].to_numpy()[-1] - 60.0) == len(tracks) - 8
    assert 0.03 < table["x"].null_count / len(table) < 0.07
    assert table["x"].is_null() == table["y"].is_null()
    scans = 1 + table["time"].to_numpy()[-1] // 4.0
    assert 0.93 < len(table) / (8 * scans) < 0.97


def test_the_seed_makes_the_recording(run, folder, made):
    small = "--gigabytes", 0.0001, "--files", 1, "--live", 8
    tables = []
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        run("make", folder / name, *small, "--seed", seed)
        tables.append(pq.read_table(folder / name))
    assert tables[0] == tables[1]
    assert tables[0]["x"] != tables[2]["x"]


def test_one_process(folder, made, alone):
    status, figures = alone
    assert status == 0
    assert figures["rows"] == made[1]["rows"] == pq.read_metadata(folder / "one.parquet").num_rows
    assert figures["bytes"] == made[1]["bytes"]
    assert figures["output bytes"] == (folder / "one.parquet").stat().st_size
    assert 2e7 < figures["peak bytes"] < 4e9
    assert figures["processor seconds"] > 0.0


def test_a_cluster_of_which_one_is_killed(folder, made, together):
    status, figures = together
    assert status == 0
    assert figures["killed"]["after tasks"] > figures["killed"]["of"] // 2
    assert figures["killed"]["of"] == 4 + PARTITIONS
    assert len(figures["workers"]) == 3
    assert figures["peak bytes"] == max(worker["peak bytes"] for worker in figures["workers"])
    assert figures["rows"] == made[1]["rows"]


def test_both_are_identical(run, folder, made, alone, together):
    status, figures = run("compare", folder / "one.parquet", folder / "apart")
    assert (status, figures["identical"]) == (0, True)
    assert (figures["rows"], figures["partitions"]) == (made[1]["rows"], PARTITIONS)


# -------------------------------------------------------------------- comparing


TRACKS = ["a", "b", "c", "a", "b", "d", "a"]


def write(path, x, tracks=TRACKS):
    time = np.arange(float(len(tracks)))
    pq.write_table(pa.table({"track": tracks, "time": time, "x": x}), path)


def write_apart(folder, x):
    folder.mkdir()
    parts = [partition_of(track, 2) for track in TRACKS]
    assert set(parts) == {0, 1}
    table = pa.table({"track": TRACKS, "time": np.arange(7.0), "x": x})
    for part in range(2):
        rows = [k for k in range(7) if parts[k] == part]
        pq.write_table(table.take(rows), folder / f"part-{part:05d}.parquet")


def test_what_is_the_same(run, tmp_path):
    x = [0.0, None, 2.0, 3.0, -0.0, 5.0, 6.0]
    write(tmp_path / "one.parquet", x)
    write_apart(tmp_path / "apart", x)
    (tmp_path / "apart" / ".part-00001.left.part.parquet").write_bytes(b"PAR1")
    assert run("compare", tmp_path / "one.parquet", tmp_path / "apart")[1]["identical"]


@pytest.mark.parametrize(
    ("place", "value"), [(0, -0.0), (1, 0.0), (3, np.nextafter(3.0, 4.0)), (6, None)]
)
def test_one_bit_is_found(run, tmp_path, place, value):
    x = [0.0, None, 2.0, 3.0, 4.0, 5.0, 6.0]
    write(tmp_path / "one.parquet", x)
    write_apart(tmp_path / "apart", [value if k == place else x[k] for k in range(7)])
    status, figures = run("compare", tmp_path / "one.parquet", tmp_path / "apart")
    assert (status, figures["identical"]) == (1, False)
    assert f"x: {{'track': '{TRACKS[place]}', 'time': {place}.0, 'x': {value}}}" in figures["why"]


def test_rows_that_lack_are_found(run, tmp_path):
    x = np.arange(7.0)
    write_apart(tmp_path / "apart", x)
    write(tmp_path / "less.parquet", x[:6], TRACKS[:6])
    status, figures = run("compare", tmp_path / "less.parquet", tmp_path / "apart")
    assert status == 1
    assert "has rows that less.parquet lacks" in figures["why"]
    write(tmp_path / "more.parquet", [*x, 7.0], [*TRACKS, "a"])
    status, figures = run("compare", tmp_path / "more.parquet", tmp_path / "apart")
    assert status == 1
    assert "ends before {'track': 'a', 'time': 7.0, 'x': 7.0}" in figures["why"]


def test_other_columns_are_found(run, tmp_path):
    write_apart(tmp_path / "apart", np.arange(7.0))
    write(tmp_path / "one.parquet", np.arange(7))
    status, figures = run("compare", tmp_path / "one.parquet", tmp_path / "apart")
    assert status == 1
    assert "or of other types" in figures["why"]


def test_nothing_is_made_of_nothing(run, tmp_path, capsys):
    with pytest.raises(SystemExit):
        run("make", tmp_path / "in", "--live", 0)
    assert "--live: must be more than 0, got 0" in capsys.readouterr().err
    assert not (tmp_path / "in").exists()


def test_a_process_that_fails_leaves_nothing(run, folder, made, tmp_path):
    with pytest.raises(SystemExit):
        run("one", folder / "in", "-o", tmp_path / "out.parquet", "--tracker", "no-such")
    assert list(tmp_path.iterdir()) == []
