"""Tables of tracks and of the truth, as they are found."""

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.errors import DataError
from fuzzytrack.io.formats import write_table
from fuzzytrack.io.reading import Reading
from fuzzytrack.scoring.position_files import TableOptions, read_positions, read_times


@pytest.fixture
def write(tmp_path):
    def table(text, name="tracks.csv"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return table


TRACKS = """\
t,track_id,x,y,vx,vy,kind,status
0,1,0,0,1,2,moving,confirmed
1,1,1,2,1,2,static,coasting
1,2,9,9,0,0,undecided,tentative
"""
TRUTH = "t,id,x,y\n0,a,0,0\n1,a,1,2\n"


def test_columns_are_found(write):
    (tracks, truth), notes = read_positions(write(TRACKS), write(TRUTH, "truth.csv"))
    assert tracks.id.tolist() == ["1", "1"]
    assert tracks.velocity.tolist() == [[1, 2], [1, 2]]
    assert tracks.kind.tolist() == [1, 2]
    assert truth.velocity is None
    assert truth.position.tolist() == [[0, 0], [1, 2]]
    assert notes == (
        "tracks: time t; id track_id; position x, y; kind kind; status status; velocity vx, vy",
        "truth: time t; id id; position x, y",
        "tracks: 1 row of tentative tracks left out",
    )


def test_tentative_tracks_on_request(write):
    (tracks, _), _ = read_positions(
        write(TRACKS), write(TRUTH, "truth.csv"), TableOptions(tentative=True)
    )
    assert tracks.id.tolist() == ["1", "1", "2"]


DOUBLES = """\
t,track_id,x,y,status,plot
0,1,0,0,confirmed,0
4,1,4,0,coasting,-1
4,1,5,0,confirmed,1
4,2,8,8,tentative,-1
4,2,9,9,tentative,2
"""


@pytest.mark.parametrize("tentative", [False, True])
@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_coasting_row_beside_a_plot_in_a_file(write, tmp_path, suffix, tentative):
    tracks, truth = write(DOUBLES), write("t,id,x,y\n0,a,0,0\n4,a,5,0\n", "truth.csv")
    if suffix == ".parquet":
        csv, parquet = map(pytest.importorskip, ("pyarrow.csv", "pyarrow.parquet"))
        table, tracks = csv.read_csv(tracks), tmp_path / "tracks.parquet"
        parquet.write_table(table, tracks)
    options = TableOptions(tentative=tentative)
    (found, there), _ = read_positions(tracks, truth, options)
    assert found.position[:, 0].tolist() == ([0, 5, 9] if tentative else [0, 5])
    assert found.doubles == 1 + tentative
    (note, _) = ft.score(found, there).notes
    assert note.endswith("without a plot left out, at times at which the track has one")


def test_north_and_east(write):
    files = (
        write("scenario,t_s,track_id,north_m,east_m\n2,1.5,7,10,20\n4,1.5,7,30,40\n"),
        write("scenario,target_id,t_s,north_m,east_m\n2,1,1.5,11,20\n4,1,1.5,31,40\n", "truth.csv"),
    )
    (tracks, truth), _ = read_positions(*files, TableOptions(group="scenario"))
    assert tracks.position.tolist() == [[10, 20], [30, 40]]
    assert tracks.group.tolist() == ["2", "4"]
    assert truth.group.tolist() == ["2", "4"]


def test_the_truth_has_other_columns(write):
    tracks = write("t,track_id,px,py\n0,1,3,4\n")
    truth = write("when,name,a,b,vx\n0,z,5,6,0\n", "truth.csv")
    said = TableOptions(reading=Reading.of(axes=("px", "py")))
    of_truth = TableOptions(reading=Reading.of(time="when", id="name", axes=("a", "b")))
    (found, there), _ = read_positions(tracks, truth, said, of_truth)
    assert found.position.tolist() == [[3, 4]]
    assert there.position.tolist() == [[5, 6]]
    assert there.id.tolist() == ["z"]


def test_dates_count_from_the_same_beginning(write):
    tracks = write("time,track_id,x,y\n2024-05-01T10:00:05Z,1,5,0\n2024-05-01T10:00:06Z,1,6,0\n")
    truth = write("time,id,x,y\n2024-05-01T10:00:00Z,1,0,0\n2024-05-01T10:00:10Z,1,10,0\n", "t.csv")
    (found, there), _ = read_positions(tracks, truth)
    assert (there.time - found.time[0]).tolist() == [-5, 5]
    assert ft.score(tracks, truth)["rmse"] == pytest.approx(0)


def test_seconds_of_an_epoch_count_from_the_same_beginning(write):
    tracks = write("t,track_id,x,y\n1620114892.5,1,5,0\n1620114893.5,1,6,0\n")
    truth = write("t,id,x,y\n1620114887.5,1,0,0\n1620114897.5,1,10,0\n", "truth.csv")
    assert ft.score(tracks, truth)["rmse"] == pytest.approx(0)


def test_latitudes_in_the_frame_of_the_tracks(write):
    pytest.importorskip("pymap3d")
    header = "t,{},lat,lon\n"
    rows = [(k, 63.44 + 1e-4 * k, 10.4 + 2e-4 * k) for k in range(5)]
    lines = "".join(f"{k},1,{lat},{lon}\n" for k, lat, lon in rows)
    tracks = write(header.format("track_id") + "".join(lines.splitlines(True)[1:]))
    truth = write(header.format("id") + lines, "truth.csv")
    said = TableOptions(reading=Reading.of(geodetic=("lat", "lon")))
    (found, there), _ = read_positions(tracks, truth, said)
    assert found.position == pytest.approx(there.position[1:], abs=1e-6)
    assert np.hypot(*np.diff(found.position, axis=0).T) == pytest.approx(15.0, abs=0.1)


def test_parquet(tmp_path):
    pytest.importorskip("pyarrow")
    tracks, truth = tmp_path / "tracks.parquet", tmp_path / "truth.parquet"
    t = np.arange(4.0)
    write_table(tracks, {"t": t, "track_id": ["1"] * 4, "x": t, "y": t, "kind": ["moving"] * 4})
    write_table(truth, {"t": t, "id": ["a"] * 4, "x": t, "y": t})
    assert ft.score(tracks, truth)["mota"] == 1


@pytest.mark.parametrize(
    ("tracks", "truth", "message"),
    [
        ("t,x,y\n0,1,2\n", TRUTH, "no column of the identity of tracks; there are t, x, y"),
        ("t,id,lat,lon\n0,1,2,3\n", TRUTH, "no columns x, y; `geodetic`=lat,lon takes"),
        ("t,id,x,y,kind\n0,1,2,3,idle\n", TRUTH, "column kind: 'idle'; expected undecided, moving"),
        ("t,id,x,y\n0,1,2,oops\n", TRUTH, "row 2, column y: 'oops'; expected a finite number"),
        ("t,id,x,y\n0,1,2,3\n", "t,id,x,y\n2024-05-01T00:00:00,1,2,3\n", "of different kinds"),
        ("t,id,x,y\n0,1,2,3\n0,1,2,4\n", TRUTH, "tracks: 1 has two positions at time 0"),
        ("t,id,x,y\n0,1,2,3\n", "t,id\n0,1\n", "truth.csv: no columns x, y"),
    ],
)
def test_what_is_wrong_is_named(write, tracks, truth, message):
    with pytest.raises(ValueError, match=message):
        read_positions(write(tracks), write(truth, "truth.csv"))


def test_options_that_do_not_fit(write):
    files = (write(TRACKS), write(TRUTH, "truth.csv"))
    for options, message in (
        (TableOptions(group="sea"), "`group`: no column 'sea'"),
        (TableOptions(kind="class"), "`kind`: no column 'class'"),
        (TableOptions(velocity=("vx",)), "velocity: 1 given; expected 2, one for each axis"),
        (TableOptions(reading=Reading.of(angle="x")), "holds angles; expected x and y, range"),
    ):
        with pytest.raises(DataError, match=message):
            read_positions(*files, options)


def test_files_that_look_swapped_are_noted(write):
    truth = write(TRUTH.replace("id", "track_id"), "truth.csv")
    _, notes = read_positions(truth, write(TRACKS))
    assert notes[2] == "the truth has a column status, as tracks have; are the two files swapped?"


def test_times_of_scans(write):
    tracks = write("run,t,track_id,x,y\na,2,1,0,0\nb,3,1,0,0\n")
    scans = write("run,t,own_x\na,1,0\na,2,0\nb,3,0\n", "scans.csv")
    found = read_times(scans, tracks, TableOptions(group="run"))
    assert {name: times.tolist() for name, times in found.items()} == {"a": [1, 2], "b": [3]}
    assert read_times(scans, tracks).tolist() == [1, 2, 3]
    other = write("when\n5\n", "other.csv")
    assert read_times(other, tracks, time="when").tolist() == [5]
    plots = write("run,scan,t\na,0,1\nb,0,1\na,0,2\n", "plots.csv")
    with pytest.raises(DataError, match="row 4, column scan: '0' is also in row 2; expected"):
        read_times(plots, tracks, TableOptions(group="run"))
    seconds = write("run,t_s\na,4\n", "seconds.csv")
    assert read_times(seconds, tracks).tolist() == [4]
    with pytest.raises(DataError, match="no column t, time or timestamp"):
        read_times(other, tracks)


@pytest.mark.parametrize("group", [None, "scenario"])
def test_a_table_without_rows_is_no_track(write, group):
    tracks = write("scenario,t,track_id,north,east\n")
    truth = write(
        "scenario,t,id,north,east\n2,0,a,0,0\n2,1,a,1,2\n4,0,a,0,0\n4,1,b,1,2\n", "truth.csv"
    )
    if group is None:
        truth = write("t,id,north,east\n0,a,0,0\n1,a,1,2\n", "truth.csv")
    (none, there), notes = read_positions(tracks, truth, TableOptions(group=group))
    assert len(none) == 0
    assert notes[0] == "tracks: no rows, so there is no track"
    scores = ft.score(none, there, cutoff=20.0)
    assert scores.means["ospa"] == 20.0
    assert scores.means["share_tracked"] == 0.0
    assert len(scores.groups) == (1 if group is None else 2)


def test_a_table_without_rows_has_its_columns(write):
    with pytest.raises(DataError, match="no column of the identity of tracks"):
        read_positions(write("t,x,y\n"), write(TRUTH, "truth.csv"))
