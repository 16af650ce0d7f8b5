import csv as csvlib
import json
import math

import numpy as np
import pytest

from fuzzytrack.cli import compare as comparing
from fuzzytrack.cli import demo as demonstration
from fuzzytrack.cli import output
from fuzzytrack.cli import track as tracking
from fuzzytrack.io import read_tracks
from fuzzytrack.trackers.catalog import make_tracker


def rows(path):
    with open(path, newline="") as stream:
        return list(csvlib.DictReader(stream))


def test_track_prints_a_summary(run, plots):
    result = run("track", plots, "--sigma", "2")
    assert result.exit_code == 0
    assert result.stderr == ""
    columns, tracker, sigma, head, _, row = result.stdout.splitlines()
    assert tracker == "tracker: maneuver"
    assert columns == "columns: time t; no id: one track; position x, y"
    assert sigma == "sigma: 2"
    assert head.split() == [
        "plots",
        "missed",
        "duration",
        "(s)",
        "innovation",
        "RMS",
        "(m)",
        "mean",
        "α",
        "mean",
        "β",
    ]
    assert row.split()[:4] == ["track", "4", "1", "4"]


def test_track_writes_what_the_tracker_says(run, plots, tmp_path):
    out, picture = tmp_path / "out.csv", tmp_path / "out.png"
    result = run("track", plots, "-o", out, "--plot", picture, "--tracker", "chan-style")
    assert f"wrote {out}\nwrote {picture}\n" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    (track,) = read_tracks(plots).tracks
    expected = make_tracker("chan-style").run(track.time, track.plots)
    back = read_tracks(out, axes=["x_predicted", "y_predicted"]).tracks[0]
    np.testing.assert_array_equal(back.plots, expected.predicted)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.csv", "out.png", "plots.csv"]


def test_track_as_json(run, csv):
    path = csv("t,id,x\n0,007,1\n1,007,2\n2,007,3\n0,b,1\n")
    result = run("track", path, "--id", "id", "--json")
    found = json.loads(result.stdout)
    assert [t["id"] for t in found["tracks"]] == ["007", "b"]
    assert [t["segment"] for t in found["tracks"]] == [0, 0]
    assert found["tracker"] == "stiffness-damping"
    assert found["tracks"][0]["innovation_rms"] == 0
    assert found["tracks"][1]["innovation_rms"] is None
    assert found["total"]["plots"] == 4
    assert found["axes"] == ["x"]


def test_innovation_rms_by_hand(run, plots):
    found = json.loads(run("track", plots, "--tracker", "fixed:alpha=1:beta=1", "--json").stdout)
    # (10, 5) a second; (30, 15) is predicted for (31, 15), 2 s after the plot before; then
    # (41.5, 20) with v = (10.5, 5)
    errors = [(1, 0), (39 - 41.5, 21 - 20)]
    expected = math.sqrt(np.mean([x * x + y * y for x, y in errors]))
    assert found["total"]["innovation_rms"] == pytest.approx(expected)
    assert found["total"]["alpha"] == 1


def test_many_tracks_give_totals_only(run, csv):
    text = "".join(f"{t},{k},{t * k}\n" for k in range(30) for t in range(4))
    result = run("track", csv("t,id,x\n" + text), "--id", "id")
    columns, tracker, *lines = result.stdout.splitlines()
    assert tracker == "tracker: stiffness-damping"
    assert columns == "columns: time t; id id; position x"
    assert len(lines) == 3
    assert lines[2].split()[:4] == ["all", "30", "120", "0"]


def test_several_tracks_in_one_picture(run, csv, tmp_path):
    path = csv("t,id,x\n0,a,1\n1,a,2\n2,a,3\n0,b,1\n1,b,1\n")
    result = run("track", path, "--id", "id", "--plot", tmp_path / "p.svg")
    assert "all 2" in result.stdout
    assert (tmp_path / "p.svg").read_bytes().startswith(b"<?xml")


def test_sorting_on_request(run, fails, csv):
    path = csv("t,x\n0,0\n2,2\n1,1\n")
    assert "row 4, column t: time 1 is earlier than 2 in row 3" in fails("track", path)
    assert run("track", path, "--sort").exit_code == 0


BAD_FILES = {
    "text": ("t,x\n0,0\n1,abc\n", "row 3, column x: 'abc'"),
    "infinite": ("t,x\n0,inf\n", "row 2, column x: 'inf'"),
    "repeated": ("t,x\n0,0\n0,1\n", "row 3, column t: time 0 repeats that of row 2"),
    "empty": ("", "is empty"),
    "header only": ("t,x\n", "holds no rows"),
    "columns": ("time,a,b\n0,0,0\n", "--axes; there are time, a, b"),
    "quoted column": ("time,`a`\n0,0\n", "--axes; there are time, `a`"),
}


@pytest.mark.parametrize("command", ["track", "compare"])
@pytest.mark.parametrize(("text", "message"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_files(fails, csv, command, text, message):
    noise = ["--noise", "1"] if command == "compare" else []
    line = fails(command, csv(text), *noise)
    assert line.startswith("error: ")
    assert message in line


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--tracker", "stifness-damping"], "no such tracker; did you mean 'stiffness-damping'?"),
        (["--tracker", "fixed:alpha=2"], "needs beta"),
        (["--tracker", "valve"], "valve cannot schedule gains"),
        (["--tracker", "no.yaml"], "cannot read rule base 'no.yaml'"),
        (["--axes", "x,q"], "--axes: no column 'q'"),
        (["--axes", "x,"], "--axes: a name is missing"),
        (["--sigma", "0"], "--sigma must be > 0"),
        (["--sigma", "a"], "--sigma: no column 'a'"),
        (["--sgima", "1"], "--sgima"),
        (["-o", "no/out.csv"], "no/out.csv: there is no folder"),
        (["-o", "out.xls"], "cannot write .xls"),
        (["-o", "plots.csv"], "plots.csv: is the input"),
        (["--plot", "plots.csv"], "cannot draw .csv; one of .png"),
        (["--plot", "no/a.png"], "there is no folder"),
        (["--plot", "d.png"], "d.png: is a folder"),
        (["--plot", "a"], "cannot draw without suffix"),
    ],
)
def test_bad_options(fails, plots, monkeypatch, words, message):
    monkeypatch.chdir(plots.parent)
    (plots.parent / "d.png").mkdir()
    before = plots.read_text()
    assert message in fails("track", plots.name, *words)
    assert plots.read_text() == before


def test_no_file_and_folder_for_a_file(fails, tmp_path):
    assert fails("track", tmp_path / "a.csv").endswith("a.csv: No such file or directory")
    assert fails("track", tmp_path).endswith("holds no Parquet and no CSV files")
    assert "Missing argument 'FILE|DIR...'" in fails("track")


def test_bad_name_cannot_reach_the_terminal(fails):
    line = fails("track", "a\x1b[31m\nb.csv")
    assert "a\\x1b[31m b.csv" in line


def test_picture_that_fails_leaves_nothing(fails, plots, tmp_path, monkeypatch):
    picture = tmp_path / "p.png"
    picture.write_bytes(b"old")

    def fail(self, path, **options):
        path.write_bytes(b"half")
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    assert "No space left" in fails("track", plots, "--plot", picture)
    assert picture.read_bytes() == b"old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["p.png", "plots.csv"]


def test_interruption(run, plots, monkeypatch, tmp_path):
    def interrupt(*args, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(tracking, "track_recording", interrupt)
    result = run("track", plots)
    assert result.exit_code == 130
    assert result.stderr == "interrupted\n"


def test_progress_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with output.progress("reading") as watch:
        watch(0.5)
        watch(1.0)
    assert "reading" in capsys.readouterr().err


# -------------------------------------------------------------------- compare


@pytest.fixture
def truth(csv):
    return csv("t,x,y\n" + "".join(f"{k},{9 * k},{k * k}\n" for k in range(20)), "truth.csv")


def test_compare(run, truth):
    words = ("compare", truth, "--noise", "3", "--runs", "5", "--seed", "2")
    first, second = run(*words), run(*words)
    assert first.exit_code == 0
    assert first.stdout == second.stdout
    assert first.stdout.startswith("5 runs of 18 scans, noise 3 m on each axis, seed 2\n")
    for name in (*comparing.DEFAULT_TRACKERS.split(","), "the plots themselves"):
        assert f"\n{name} " in first.stdout
    assert max(map(len, first.stdout.splitlines())) <= 80
    assert first.stdout.count("±") == 8


def test_compare_as_json(run, truth):
    result = run(
        "compare", truth, "--noise", "3", "--runs", "1", "--trackers", "chan-style", "--json"
    )
    found = json.loads(result.stdout)
    assert found["scans"] == 18
    assert found["trackers"][0]["name"] == "chan-style"
    assert found["trackers"][0]["predicted_error"] is None
    assert "±" not in run("compare", truth, "--noise", "3", "--runs", "1").stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--noise", "0"], "--noise must be > 0"),
        (["--noise", "-1"], "--noise must be > 0"),
        (["--noise", "nan"], "--noise must be > 0"),
        (["--noise", "1", "--runs", "0"], "--runs"),
        (["--noise", "1", "--seed", "-1"], "--seed"),
        (["--noise", "1", "--trackers", "a,,b"], "--trackers: a name is missing"),
        (["--noise", "1", "--trackers", "chan-style,chan-style"], "is given twice"),
    ],
)
def test_bad_comparisons(fails, truth, words, message):
    assert message in fails("compare", truth, *words)


def test_too_short_to_compare(fails, csv):
    assert "too short" in fails("compare", csv("t,x\n0,0\n"), "--noise", "1")


# -------------------------------------------------------------------- demo


def test_demo(run, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(demonstration, "save_picture", lambda path, draw: drawn.append(draw()))
    folder = tmp_path / "made"
    result = run("demo", "-o", folder, "--runs", "1", "--json")
    found = json.loads(result.stdout)
    assert len(found["files"]) == 10
    assert len(drawn) == 7
    assert json.loads((folder / "results.json").read_text())["trackers"] == found["trackers"]
    assert found["trackers"][0]["name"] == "maneuver"
    assert [r["tracker"] for r in rows(folder / "comparison.csv")] == [
        t["name"] for t in found["trackers"]
    ]
    assert len(rows(folder / "track.csv")) == 181
    again = run("demo", "-o", folder, "--runs", "1", "--force")
    assert "RMSE of position" in again.stdout
    assert f"wrote {folder / 'track.png'}" in again.stdout
    from matplotlib import pyplot as plt

    plt.close("all")


def test_demo_needs_a_folder(fails, plots):
    assert fails("demo", "-o", plots).endswith("is not a folder")
    assert "there is no folder" in fails("demo", "-o", plots.parent / "no" / "where")


@pytest.mark.parametrize(
    ("words", "more"),
    [
        (("demo",), ""),
        (("testbed", "strong"), ", continue with --resume"),
        (("reproduce", "zhang-jiang"), ""),
    ],
)
def test_a_folder_with_files_is_left_alone_by_every_command(fails, plots, words, more):
    folder = plots.parent
    assert fails(*words, "-o", folder) == (
        f"error: {folder}: holds files already; name another folder{more}, "
        "or replace them with --force"
    )
    assert [path.name for path in folder.iterdir()] == ["plots.csv"]


# -------------------------------------------------------------------- real data


def test_uav(run, real, tmp_path):
    path, out = real("uav_gps/uav_enu.csv"), tmp_path / "o.csv"
    columns = ("--time", "t_s", "--axes", "x_m,y_m")
    found = json.loads(run("track", path, *columns, "-o", out, "--json").stdout)
    assert found["total"]["plots"] == len(rows(out)) == 965
    assert found["total"]["duration"] == 964
    compared = run("compare", path, *columns, "--noise", "10", "--runs", "3", "--json")
    errors = {t["name"]: t["predicted_rmse"] for t in json.loads(compared.stdout)["trackers"]}
    assert 12 < errors["fixed:alpha=0.5377:beta=0.2018"] < 14
    assert 12 < errors["stiffness-damping"] < 14.5


def test_airliner(run, real):
    path = real("adsb_turns/truth_1s.csv")
    found = json.loads(run("track", path, "--id", "icao24", "--json").stdout)
    assert [(t["id"], t["plots"]) for t in found["tracks"]] == [("484506", 4501)]
    words = ("--noise", "10", "--runs", "2", "--trackers", "fixed:alpha=0.5377:beta=0.2018")
    compared = run("compare", path, "--id", "icao24", *words, "--json")
    (fixed,) = json.loads(compared.stdout)["trackers"]
    assert 15 < fixed["predicted_rmse"] < 16


def test_a_tracker_that_looks_ahead_is_said_to(run, plots):
    words = ("compare", plots, "--noise", "1", "--runs", "2", "--trackers")
    assert (
        "bank:selection=hindsight uses the plot" in run(*words, "bank:selection=hindsight").stderr
    )
    assert run(*words, "bank").stderr == ""


def test_identities_cannot_control_the_terminal(run, csv):
    name = "\x1b[31m" + "q" * 60
    text = "".join(f"{t},{name},{t}\n" for t in range(3))
    printed = run("track", csv("t,id,x\n" + text), "--id", "id").stdout
    assert "\x1b" not in printed
    assert "\\x1b[31m" in printed
    assert "q" * 40 not in printed
