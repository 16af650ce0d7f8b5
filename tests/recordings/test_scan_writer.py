"""What is written of the tracks of a scan tracker."""

import csv
import json

import numpy as np
import pytest
from scan_reports import EveryPlot, reports

from fuzzytrack import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.recordings.scan_run import ScanTotals, run_scans
from fuzzytrack.recordings.scan_table import ScanTable
from fuzzytrack.recordings.scan_writer import check_scan_tracks, scan_writer
from fuzzytrack.scan.scan import Scan

TWO = reports([
    # scan, time, id, x, y, vx, vy, status, kind, since_last, plot
    (0, 0.0, 1, 10.0, 20.0, 3.0, 4.0, 1, 1, 0.0, 7),
    (1, 2.0, 1, 16.0, 28.0, 3.0, 4.0, 2, 1, 2.0, -1),
    (1, 1.9, 2, -5.0, 0.0, 0.0, 0.0, 0, 2, 0.0, 9),
])  # fmt: skip


def table_of(columns=None, *, group="", chosen=None, **reading):
    given = {"scan": [0, 0], "t": [0.0, 0.0], "x": [1.0, 2.0], "y": [3.0, 4.0], "g": ["a", "a"]}
    plots = ScanPlots.of({**given, **(columns or {})}, Reading.of(**reading))
    return ScanTable.of(plots.files.decoder, group, chosen)


def written(path, table, group="", some=TWO):
    with scan_writer(path, table) as write:
        write(group, some)
    if path.suffix == ".csv":
        with open(path, encoding="utf-8", newline="") as stream:
            return list(csv.DictReader(stream))
    return path


def test_columns_of_a_table(tmp_path):
    rows = written(tmp_path / "tracks.csv", table_of())
    assert rows[0] == {
        "t": "0.0", "track_id": "1", "x": "10.0", "y": "20.0", "x_velocity": "3.0",
        "y_velocity": "4.0", "speed": "5.0", "course": rows[0]["course"], "x_sd": "1.0",
        "y_sd": "2.0", "x_velocity_sd": "0.25", "y_velocity_sd": "0.5", "status": "confirmed",
        "kind": "moving", "existence": "0.75", "since_last": "0.0", "plot": "7",
    }  # fmt: skip
    assert float(rows[0]["course"]) == pytest.approx(np.degrees(np.arctan2(3, 4)))
    assert [(row["status"], row["kind"], row["plot"]) for row in rows[1:]] == [
        ("coasting", "moving", "-1"),
        ("tentative", "static", "9"),
    ]
    assert rows[1]["existence"] == rows[2]["course"] == ""


def test_course_of_axes_that_are_north_and_east(tmp_path):
    columns = {"north_m": [1.0, 2.0], "east_m": [3.0, 4.0]}
    table = table_of(columns, axes=("north_m", "east_m"))
    assert table.north_first
    rows = written(tmp_path / "tracks.csv", table)
    assert float(rows[0]["course"]) == pytest.approx(np.degrees(np.arctan2(4, 3)))
    assert not table_of(columns, axes=("east_m", "north_m")).north_first
    assert not table_of().north_first


def test_chosen_columns_under_other_names(tmp_path):
    table = table_of(
        {"t_s": [0.0, 0.0]},
        time="t_s",
        group="g",
        chosen=("scenario=g", "t_s", "track_id", "north=y", "x"),
    )
    rows = written(tmp_path / "tracks.csv", table, "a")
    assert rows[0] == {"scenario": "a", "t_s": "0.0", "track_id": "1", "north": "20.0", "x": "10.0"}


@pytest.mark.parametrize(
    ("chosen", "said"),
    [
        (("spede",), "output_columns: no column 'spede'; did you mean 'speed'?"),
        (("x", "x=y"), "two columns of the output would be 'x'"),
        (("latitude",), "no column 'latitude'"),
        (("longitude",), "since_last, plot"),
    ],
)
def test_columns_that_are_not_there(chosen, said):
    with pytest.raises(DataError) as error:
        table_of(chosen=chosen)
    assert said in str(error.value)


def test_parquet_has_types(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    table = table_of({"t": ["2024-05-01T12:00:00Z"] * 2})
    found = parquet.read_table(written(tmp_path / "tracks.parquet", table)).to_pydict()
    assert str(found["t"][1])[:19] == "2024-05-01 12:00:02"
    assert found["track_id"] == [1, 1, 2]
    assert found["plot"] == [7, -1, 9]


@pytest.mark.parametrize(
    ("cells", "first", "second"),
    [
        (["5.5", "5.5"], "0.0", "2.0"),
        (["1620114891.5"] * 2, "1620114891.5", "1620114893.5"),
        (["1620114891500"] * 2, "1620114891500.0", "1620114893500.0"),
        (["1620114891500000000"] * 2, "1620114891500000000", "1620114893500000000"),
        (["2024-05-01T23:59:59Z"] * 2, "2024-05-01T23:59:59Z", "2024-05-02T00:00:01Z"),
    ],
)
def test_times_as_the_recording_has_them(tmp_path, cells, first, second):
    rows = written(tmp_path / "tracks.csv", table_of({"t": cells}))
    assert [row["t"] for row in rows[:2]] == [first, second]


def test_times_of_day():
    table = table_of({"t": ["12:00:00"] * 2})
    assert table.times(np.array([43200.0, 86401.0]), typed=False) == ["12:00:00", "00:00:01"]
    assert table.time_of_day(np.array([86401.0]))[0] == 1.0


GEO = {"lat": [63.4, 63.4], "lon": [10.4, 10.4], "t": ["2024-05-01T12:00:00Z"] * 2}


def test_tracks_on_the_earth(tmp_path):
    table = table_of(GEO, geodetic=("lat", "lon"))
    rows = written(tmp_path / "tracks.csv", table)
    assert float(rows[0]["latitude"]) == pytest.approx(63.4 + 20 / 111_500, abs=1e-5)
    found = json.loads(written(tmp_path / "tracks.geojson", table, "a").read_text())
    assert [f["properties"]["id"] for f in found["features"]] == ["a/1", "a/2"]
    one = found["features"][0]
    assert len(one["geometry"]["coordinates"]) == 2
    assert one["properties"]["speeds"] == [5, 5]
    for suffix in ("kml", "czml"):
        assert written(tmp_path / f"tracks.{suffix}", table).stat().st_size > 100


def test_axes_north_and_east_about_a_site(tmp_path):
    columns = {"n": [1.0, 2.0], "e": [3.0, 4.0]}
    table = table_of(columns, axes=("n", "e"), site=(60.0, 10.0))
    rows = written(tmp_path / "tracks.csv", table)
    # x = 10 m is to the north.
    assert float(rows[0]["latitude"]) == pytest.approx(60 + 10 / 111_400, abs=1e-6)
    assert float(rows[0]["longitude"]) == pytest.approx(10 + 20 / 55_800, abs=1e-6)


def test_asterix(tmp_path):
    pytest.importorskip("asterix.generated", reason="libasterix is not installed")
    columns = {**GEO, "n": [1.0, 2.0], "e": [3.0, 4.0]}
    table = table_of(columns, axes=("n", "e"))
    path = written(tmp_path / "tracks.ast", table)
    from fuzzytrack.io.recording import read_tracks

    found = read_tracks(path)
    assert [track.id for track in found.tracks] == ["T1", "T2"]
    # East comes first.
    np.testing.assert_array_equal(found.tracks[0].plots, [[20, 10], [28, 16]])
    assert found.tracks[0].time_cells[0] == 43200.0


def test_formats_that_do_not_fit(tmp_path):
    for name, table, said in (
        ("tracks.geojson", table_of(), "needs positions on the earth"),
        ("tracks.kml", table_of(site=(60, 10)), "needs the date"),
        ("tracks.ast", table_of(chosen=("t",)), "only tables have columns"),
        ("tracks.xyz", table_of(), ".csv, .parquet, .geojson, .kml, .czml, .gpx, .ast or"),
    ):
        with pytest.raises(DataError, match=said):
            check_scan_tracks(tmp_path / name, table)


def test_nothing_is_left_of_a_file_that_fails(tmp_path):
    def fail(path):
        with scan_writer(path, table_of()) as write:
            write("", TWO)
            raise KeyError

    for name in ("tracks.csv", "tracks.ast"):
        with pytest.raises(KeyError):
            fail(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


# -------------------------------------------------------------------- the run


def scan(time, n, first=1):
    return Scan(time, np.zeros((n, 2)), rows=np.arange(first, first + n))


def test_each_group_is_tracked_by_itself_and_no_identity_comes_again():
    scans = [("a", scan(0.0, 2)), ("a", scan(1.0, 3)), ("b", scan(0.0, 2)), ("b", scan(1.0, 1))]
    found = list(run_scans(EveryPlot(), scans))
    assert [each.reports.track_id.tolist() for each in found] == [[2], [4, 5], [7], []]
    assert [each.group for each in found] == ["a", "a", "b", "b"]
    more = list(run_scans(EveryPlot(), scans, tentative=True))
    assert [each.reports.track_id.tolist() for each in more] == [[1, 2], [3, 4, 5], [6, 7], [8]]


def test_totals():
    scans = [("", scan(0.0, 2)), ("", scan(1.0, 0)), ("", scan(2.0, 1))]
    totals = ScanTotals()
    for each in run_scans(EveryPlot(), scans, tentative=True):
        totals.add(each)
    assert totals.summary == {
        "scans": 3, "empty_scans": 1, "plots": 3, "rows": 3, "rows_with_plot": 3, "tracks": 1,
        "undecided": 0, "moving": 1, "static": 0, "tentative": 2,
    }  # fmt: skip
    both = ScanTotals()
    both.merge(totals)
    both.merge(totals)
    assert both.summary["scans"] == 6
    assert both.summary["tracks"] == 1
