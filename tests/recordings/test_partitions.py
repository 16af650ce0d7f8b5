import os
import signal

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.io import PlotFiles, Reading
from fuzzytrack.recordings import partitions as partitions_module
from fuzzytrack.recordings.partitions import track_partitions

# Times at random lie much closer together than fixed gains allow.
pytestmark = pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")

TRACKER = AlphaBetaTracker(FixedGains(0.5, 0.2))


@pytest.fixture
def files(tmp_path):
    rng = np.random.default_rng(8)
    found = []
    for k in range(3):
        table = {
            "id": [f"track {i}" for i in rng.integers(0, 30, 500)],
            "t": 500.0 * k + np.arange(500),
            "x": rng.normal(size=500),
        }
        found.append(str(tmp_path / f"f{k}.parquet"))
        pq.write_table(pa.table(table), found[-1])
    return found


def sorted_rows(folder):
    return pq.read_table(folder).sort_by([("id", "ascending"), ("t", "ascending")])


def test_a_cluster_that_loses_a_worker(files, tmp_path):
    distributed = pytest.importorskip("distributed")
    plots = PlotFiles.of(files, Reading.of(id="id"))
    here = track_partitions(TRACKER, plots, tmp_path / "here", partitions=1)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = client.run(os.getpid)
        killed = []

        def kill_one(share):
            # The files are sorted, the partitions under way.
            if share >= 0.3 and not killed:
                killed.append(pids.popitem()[1])
                os.kill(killed[0], signal.SIGKILL)

        there = track_partitions(
            TRACKER, plots, tmp_path / "there", partitions=12, rows=20,
            executor=client.get_executor(), progress=kill_one,
        )  # fmt: skip
        assert killed
        # The scheduler may not have noticed yet: its answer is an error then.
        assert killed[0] not in client.run(os.getpid, on_error="return").values()
    assert sorted_rows(tmp_path / "there") == sorted_rows(tmp_path / "here")
    assert (there.tracks, there.plots) == (here.tracks, here.plots) == (30, 1500)
    assert there.summary == pytest.approx(here.summary, rel=1e-12)
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_dir()) == ["here", "there"]
    # Nothing is left of what was being written when the worker was lost.
    names = sorted(path.name for path in (tmp_path / "there").iterdir())
    assert names == [f"part-{number:05d}.parquet" for number in range(12)]


def test_what_a_lost_worker_began_is_removed(files, tmp_path, monkeypatch):
    plots = PlotFiles.of(files, Reading.of(id="id"))
    original = partitions_module._track_partition

    def leave_a_draft(job, partition):
        job.part(partition).with_name(f".part-{partition}.draft.parquet").write_bytes(b"begun")
        return original(job, partition)

    monkeypatch.setattr(partitions_module, "_track_partition", leave_a_draft)
    track_partitions(TRACKER, plots, tmp_path / "out", partitions=2)
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["part-00000.parquet", "part-00001.parquet"]


def test_a_partition_is_announced_before_it_is_tracked(files, tmp_path, monkeypatch):
    announced = []
    monkeypatch.setattr(partitions_module, "announce", lambda *given: announced.append(given))
    plots = PlotFiles.of(files, Reading.of(id="id"))
    track_partitions(TRACKER, plots, tmp_path / "out", partitions=3)
    assert announced == [(TRACKER, len(plots.columns.axes), len(plots.columns.axes) * 500)] * 3


def test_a_text_names_the_tracker(files, tmp_path):
    plots = PlotFiles.of(files, Reading.of(id="id"))
    track_partitions("fixed:alpha=0.5:beta=0.2", plots, tmp_path / "a", partitions=1)
    track_partitions(TRACKER, plots, tmp_path / "b", partitions=1)
    assert sorted_rows(tmp_path / "a") == sorted_rows(tmp_path / "b")


def test_a_partition_may_be_empty(files, tmp_path):
    plots = PlotFiles.of(files)  # one track
    table = pq.read_table(files[0]).slice(0, 9)
    pq.write_table(table, files[0])
    (tmp_path / "out").mkdir()
    track_partitions(TRACKER, plots.only(0), tmp_path / "out", partitions=4, rows=2)
    counts = [pq.read_metadata(p).num_rows for p in sorted((tmp_path / "out").iterdir())]
    assert sorted(counts) == [0, 0, 0, 9]


def test_errors_name_the_row_of_the_recording(files, tmp_path):
    plots = PlotFiles.of(files, Reading.of(id="id"))
    back = PlotFiles.of(files[::-1], Reading.of(id="id"))
    with pytest.raises(
        DataError, match=r"f1.parquet: row \d+, column t: time \d+ \(id 'track \d+'\) is ear"
    ):
        track_partitions(TRACKER, back, tmp_path / "out", partitions=2, rows=99)
    empty = pq.read_table(files[0]).slice(0, 0)
    pq.write_table(empty, files[0])
    with pytest.raises(DataError, match=r"f0\.parquet: holds no rows"):
        track_partitions(TRACKER, plots.only(0), tmp_path / "out", partitions=2)
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == []


def test_partitions_at_least_one(files, tmp_path):
    with pytest.raises(ValueError, match="partitions must be at least 1, got 0"):
        track_partitions(TRACKER, PlotFiles.of(files), tmp_path / "out", partitions=0)


def test_totals_do_not_depend_on_the_order_in_which_tasks_finish(files, tmp_path, monkeypatch):
    plots = PlotFiles.of(files, Reading.of(id="id"))
    original = partitions_module.run_tasks
    forth = track_partitions(TRACKER, plots, tmp_path / "forth", partitions=7)
    monkeypatch.setattr(
        partitions_module, "run_tasks", lambda *given: reversed(list(original(*given)))
    )
    back = track_partitions(TRACKER, plots, tmp_path / "back", partitions=7)
    assert back == forth
