import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.recordings.large_jobs import LargeJob

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))


@pytest.fixture
def plots(tmp_path):
    path = tmp_path / "plots.csv"
    path.write_text("t,id,x,y\n0,a,0,1\n0,b,9,8\n1,a,5,2\n2,a,,3\n1,b,7,7\n3,a,16,4\n")
    return path


def test_a_job_counts_with_and_without_a_file(plots, tmp_path):
    job = LargeJob.of(plots, FIXED, rows=2, id="id", axes=["y", "x"])
    assert job.files.columns.axes == ("y", "x")
    totals = job.track(None)
    assert (totals.tracks, totals.plots, totals.missed, totals.duration) == (2, 5, 1, 4.0)
    shares = []
    assert job.track(tmp_path / "out.csv", shares.append) == totals
    assert shares[-1] == 1.0
    times = np.genfromtxt(tmp_path / "out.csv", delimiter=",", skip_header=1, usecols=1)
    np.testing.assert_array_equal(times, [0, 0, 1, 2, 1, 3])


def test_a_job_apart_is_the_same(plots, tmp_path):
    pytest.importorskip("pyarrow")
    job = LargeJob.of(plots, FIXED, id="id")
    assert LargeJob.of(plots, "fixed:alpha=0.5:beta=0.2", id="id") == job
    apart = job.track_apart(tmp_path / "out", partitions=2)
    assert apart.tracks == 2
    assert apart.summary == pytest.approx(job.track(None).summary, rel=1e-12)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "part-00000.parquet",
        "part-00001.parquet",
    ]


def test_messages_name_arguments(plots, tmp_path):
    class Whole:
        def run(self): ...

        start = step = predict = run

    with pytest.raises(ValueError, match=r"^tracker: Whole cannot go on from piece to piece"):
        LargeJob.of(plots, Whole())
    with pytest.raises(TypeError, match=r"^tracker must be a Tracker, .* got object$"):
        LargeJob.of(plots, object())
    with pytest.raises(DataError, match=r"plots\.csv: `axes`: no column 'q'"):
        LargeJob.of(plots, FIXED, axes=["q"])
    job = LargeJob.of(plots, FIXED, id="id")
    with pytest.raises(ValueError, match=r"^jobs and scheduler: give one"):
        job.track_apart(tmp_path / "out", jobs=2, scheduler="tcp://a:1")
    assert not (tmp_path / "out").exists()
