import csv as csvlib
import json
import re
import shlex
import signal
import subprocess
import sys
from html import unescape

import numpy as np
import pytest
from waiting import PATIENCE

from fuzzytrack import workers
from fuzzytrack.cli import testbed as experimenting
from fuzzytrack.io import read_tracks
from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.scenario_files import load_scenario, shipped_scenarios
from fuzzytrack.testbed.montecarlo import monte_carlo

OWN = (
    "scenario: 1\nname: own\ntarget: {motion: turn, speed: 6, radius: 4500}\n"
    "sensors: {sigma: 115, detection: 0.8}\n"
)
TRACKERS = "fixed:alpha=0.5:beta=0.2,chan-style"


@pytest.fixture
def own(csv):
    return csv(OWN, "own.yaml")


def rows(path):
    with open(path, newline="") as stream:
        return list(csvlib.DictReader(stream))


# -------------------------------------------------------------------- testbed


def test_list_of_scenarios(run):
    listed = run("testbed").stdout
    assert all(f"\n{name} " in listed for name in shipped_scenarios())
    found = json.loads(run("testbed", "--json").stdout)
    assert [row["name"] for row in found] == list(shipped_scenarios())


def test_table(run, own):
    result = run("testbed", own, "--trackers", TRACKERS, "--runs", 20, "--seed", 3)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[0] == "own: 20 runs of 20 scans, scored from scan 3, seed 3"
    found = monte_carlo(load_scenario(own), experimenting.trackers_named(TRACKERS), 20, 3)
    chan, second = (line for line in lines if line.startswith("chan-style"))
    row = found.table()[1]
    cells = chan.split()
    assert float(cells[1]) == pytest.approx(row["predicted_rmse"], rel=0.01)
    assert float(cells[3]) == pytest.approx(row["predicted_rmse_se"], rel=0.1)
    mean, _, _, deviation, peak, scan = second.split()[1:]
    assert float(mean) == pytest.approx(row["predicted_mean"], rel=0.01)
    assert float(deviation) ** 2 == pytest.approx(row["predicted_variance"], rel=0.01)
    assert float(peak) == pytest.approx(row["peak"], rel=0.01)
    assert int(scan) == row["peak_scan"] + 1
    clear = row["change_low"] > 0 or row["change_high"] < 0
    assert ("*" in chan) == clear


def test_json_is_what_the_library_says(run, own):
    result = run("testbed", own, "--trackers", TRACKERS, "--runs", 5, "--json")
    found = json.loads(result.stdout)
    expected = monte_carlo(load_scenario(own), experimenting.trackers_named(TRACKERS), 5, 0)
    assert found.pop("files") == []
    assert found == json.loads(json.dumps(expected.to_json_dict()))


def test_trackers_of_the_scenario(run):
    found = json.loads(run("testbed", "kim-lee", "--runs", 2, "--json").stdout)
    names = [row["name"] for row in found["trackers"]]
    assert names == list(load_scenario("kim-lee").trackers)


def test_single_run_has_no_interval(run, own):
    result = run("testbed", own, "--trackers", TRACKERS, "--runs", 1)
    assert result.exit_code == 0
    assert "±" not in result.stdout
    assert next(x for x in result.stdout.splitlines() if x.startswith("chan-style")).endswith("–")


def test_folder(run, fails, own, tmp_path, monkeypatch):
    folder = tmp_path / "out"
    words = ("testbed", own, "--trackers", TRACKERS, "-o", folder)
    # What an interruption may leave.
    monte_carlo(load_scenario(own), experimenting.trackers_named(TRACKERS), 10, 0, folder=folder)
    assert "holds files already; name another folder, continue with" in fails(*words, "--runs", 10)
    assert "give one of them" in fails(*words, "--resume", "--force")
    result = run(*words, "--runs", 15, "--resume")
    assert (result.exit_code, result.stderr) == (0, "")
    files = {p.name for p in folder.iterdir()} - {"chunks"}
    assert {"results.json", "report.html", "error-over-time.png", "trajectories.png"} <= files
    assert all(f"wrote {folder / name}" in result.stdout for name in files)
    assert (folder / "trajectories.png").read_bytes().startswith(b"\x89PNG")
    page = unescape((folder / "report.html").read_text())
    shown = shlex.split(re.search("<code>(.*?)</code>", page)[1])
    # The command on the page gives the same numbers.
    assert shown[:3] == ["fuzzytrack", "testbed", str(own)]
    again = json.loads(run(*shown[1:], "--json").stdout)
    after = json.loads((folder / "results.json").read_text())
    alone = json.loads(run(*words[:-2], "--runs", 15, "--json").stdout)
    del alone["files"], again["files"]
    assert after == alone == again
    # Another job takes the place of the finished one; its pictures were drawn above.
    monkeypatch.setattr("fuzzytrack.reports.html_report.report_pictures", lambda found: {})
    assert run(*words, "--runs", 2, "--seed", 5, "--force").exit_code == 0
    assert json.loads((folder / "results.json").read_text())["runs"] == 2
    assert [file.name for file in (folder / "chunks").glob("*.npz")] == ["runs-000000000-2.npz"]


def test_processes_give_the_same_numbers(run):
    words = ("testbed", "constant-velocity", "--trackers", TRACKERS, "--runs", 130, "--json")
    assert run(*words, "--jobs", 2).stdout == run(*words).stdout


def test_cluster_gives_the_same_numbers(run, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "_PATIENCE", PATIENCE)
    words = ("testbed", "constant-velocity", "--trackers", TRACKERS, "--runs", 5, "--json")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0"
    ) as cluster:
        found = run(*words, "--scheduler", cluster.scheduler_address)
    assert (found.exit_code, found.stderr) == (0, "")
    assert found.stdout == run(*words).stdout


def test_no_cluster_there(fails, own, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "_PATIENCE", 0.2)
    words = ("testbed", own, "--trackers", TRACKERS, "--scheduler")
    expected = "error: --scheduler: no Dask scheduler answers at 'tcp://127.0.0.1:9': Timed out"
    assert fails(*words, "tcp://127.0.0.1:9").startswith(expected)
    assert "unknown address scheme 'foo'" in fails(*words, "foo://there")


def test_no_dask_there(fails, own, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    line = fails("testbed", own, "--trackers", TRACKERS, "--scheduler", "tcp://127.0.0.1:9")
    assert line.endswith("needs Dask, which is not installed; pip install 'fuzzytrack[dask]'")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("mixt",), "error: unknown scenario 'mixt'; did you mean 'mixed'?"),
        (("none.yaml",), "error: cannot read scenario 'none.yaml': No such file or directory"),
        (("mixed", "--resume"), "error: --resume needs -o DIR"),
        (("mixed", "--jobs", "2", "--scheduler", "x"), "error: --jobs and --scheduler: give one"),
        (("mixed", "--trackers", "a,a"), "error: --trackers: 'a' is given twice"),
        (("mixed", "--trackers", "a"), "error: tracker 'a': no such tracker"),
        (("mixed", "-o", "no/such"), "error: no/such: there is no folder"),
    ],
)
def test_bad_words(fails, words, expected):
    assert fails("testbed", *words).startswith(expected)


def test_bad_scenarios_are_named_with_their_place(fails, csv, own):
    path = csv(OWN.replace("turn", "trun"), "bad.yaml")
    assert fails("testbed", path).startswith(f"{path}:3:18: unknown motion 'trun'; did you mean")
    assert fails("simulate", path, "-o", "x.csv").startswith(f"{path}:3:18: ")
    line = fails("testbed", own)
    assert line == "error: --trackers: needed, since scenario 'own' names none"


def test_folder_that_is_none(fails, own, csv):
    line = fails("testbed", own, "--trackers", TRACKERS, "-o", csv("", "file"))
    assert line.endswith("is not a folder")


def test_lost_workers_are_one_line(fails, own, monkeypatch):
    def broken(*words, **options):
        raise workers.BrokenExecutor

    monkeypatch.setattr(experimenting, "monte_carlo", broken)
    line = fails("testbed", own, "--trackers", TRACKERS, "--jobs", 2)
    assert line.startswith("error: --jobs: a worker process died")


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("options", [(), ("-o", "out")])
def test_interruption_says_how_to_go_on(tmp_path, options):
    (tmp_path / "own.yaml").write_text(OWN)
    words = ["fuzzytrack", "testbed", "own.yaml", "--trackers", TRACKERS, "--runs", "500", *options]
    code = (
        "import signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from fuzzytrack.cli import main\n"
        "from fuzzytrack.testbed import montecarlo\n"
        "whole = montecarlo.run_chunk\n"
        "def part(*words):\n"
        "    if words[-1].start: signal.raise_signal(signal.SIGINT)\n"
        "    return whole(*words)\n"
        "montecarlo.run_chunk = part\n"
        f"sys.argv = {words!r}\n"
        "main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 130
    if not options:
        assert done.stderr == "interrupted\n"
        return
    assert done.stderr == "interrupted; finished runs are in out; continue with --resume\n"
    assert [p.suffix for p in (tmp_path / "out").iterdir()] == [""]
    assert len(list((tmp_path / "out" / "chunks").glob("*.npz"))) == 1


def test_workers_leave_interrupts_to_the_first_process():
    before = signal.getsignal(signal.SIGINT)
    try:
        workers._begin(())
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


# -------------------------------------------------------------------- simulate


def test_simulated_plots_can_be_tracked(run, own, tmp_path):
    out = tmp_path / "plots.csv"
    result = run("simulate", own, "--runs", 3, "--seed", 5, "-o", out)
    assert (result.exit_code, result.stdout) == (0, f"wrote {out}\n")
    assert run("track", out, "--id", "run").exit_code == 0
    scenario = load_scenario(own)
    plots = scenario.sensors.measure(scenario.position, streams(5, 3))
    tracks = read_tracks(out, id="run").tracks
    assert [track.id for track in tracks] == ["0", "1", "2"]
    for k, track in enumerate(tracks):
        np.testing.assert_array_equal(track.time, scenario.time)
        np.testing.assert_array_equal(track.plots, plots.z[:, k])
    table = rows(out)
    assert list(table[0]) == [
        *("run", "t_s", "x_m", "y_m", "true_x_m", "true_y_m", "sigma_x_m", "sigma_y_m")
    ]
    missed = [row for row in table if not row["x_m"]]
    assert len(missed) == np.isnan(plots.z[..., 0]).sum() > 0
    assert all(row["true_x_m"] and not row["sigma_x_m"] for row in missed)
    assert {row["sigma_y_m"] for row in table} == {"115.0", ""}


def test_plots_are_those_of_the_testbed(run, own, tmp_path):
    out = tmp_path / "plots.csv"
    run("simulate", own, "--runs", 2, "--seed", 5, "-o", out)
    found = monte_carlo(load_scenario(own), experimenting.trackers_named(TRACKERS), 2, 5)
    np.testing.assert_array_equal(read_tracks(out, id="run").tracks[0].plots, found.sample.plots)


def test_truth_alone(run, tmp_path):
    out = tmp_path / "truth.parquet"
    assert run("simulate", "warship", "--truth", "--runs", 9, "-o", out).exit_code == 0
    (track,) = read_tracks(out).tracks
    np.testing.assert_array_equal(track.plots, load_scenario("warship").position)
    out = tmp_path / "set.csv"
    run("simulate", "report", "--truth", "--runs", 4, "-o", out)
    tracks = read_tracks(out, id="run").tracks
    position = load_scenario("report").position
    for k, track in enumerate(tracks):
        np.testing.assert_array_equal(track.plots, position[:, k])
    assert len(tracks) == 4


def test_axes_without_a_letter_are_numbered(run, csv, tmp_path):
    text = OWN.replace(
        "motion: turn, speed: 6, radius: 4500", "waypoints: [[0,0,0,0], [9,9,9,9]], leg: 600"
    )
    out = tmp_path / "plots.csv"
    run("simulate", csv(text, "four.yaml"), "-o", out)
    assert "x4_m" in rows(out)[0]


def test_what_cannot_be_written(fails, own, tmp_path):
    assert "cannot write .xls" in fails("simulate", own, "-o", tmp_path / "x.xls")
    assert "there is no folder" in fails("simulate", own, "-o", tmp_path / "no" / "x.csv")
    assert "Missing option '--output'" in fails("simulate", own)
