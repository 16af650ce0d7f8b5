"""`fuzzytrack score`."""

import json

import numpy as np
import pytest

import fuzzytrack as ft

TRUTH = "t,id,x,y\n" + "".join(
    f"{t},{id},{5 * t},{100 * k}\n" for t in range(0, 21, 2) for k, id in enumerate("ab")
)


def tracks_of(times, ids=(1, 2), offset=1.0, group=""):
    return "".join(
        f"{group}{t},{id},{5 * t + offset},{100 * k}\n" for t in times for k, id in enumerate(ids)
    )


@pytest.fixture
def files(csv):
    tracks = csv("t,track_id,x,y\n" + tracks_of(range(4, 21)), "tracks.csv")
    return tracks, "--truth", csv(TRUTH, "truth.csv")


def cells(output, name):
    """Numbers of the line of a metric."""
    (line,) = [line for line in output.splitlines() if line.startswith(name + "  ")]
    return line[len(name) :].split()


def test_every_metric(run, files):
    result = run("score", *files)
    assert result.exit_code == 0, result.stderr
    found = ft.score(*(str(files[k]) for k in (0, 2)))
    assert result.stdout.splitlines()[0] == "2 true objects, 2 tracks, 21 instants"
    assert cells(result.stdout, "RMSE of matched (m)") == ["1"]
    assert cells(result.stdout, "share tracked") == [f"{found['share_tracked']:.4g}"]
    assert cells(result.stdout, "time to first match (s)") == ["4"]
    assert "note: truth: time t; id id; position x, y" in result.stderr
    assert max(map(len, result.stdout.splitlines())) <= 80


def test_polar_tracks(run, files, csv):
    lines = [
        f"{t},1,{np.hypot(5 * t, 30)},{np.degrees(np.arctan2(5 * t, 30))}\n" for t in range(21)
    ]
    polar = csv("t,track_id,range,azimuth\n" + "".join(lines), "polar.csv")
    plain = csv("t,id,x,y\n" + "".join(f"{t},1,{5 * t},30\n" for t in range(21)), "plain.csv")
    for words in (
        (polar, "--truth", plain, "--polar", "range,azimuth"),
        (plain, "--truth", polar, "--truth-polar", "range,azimuth"),
        (polar, "--truth", polar, "--polar", "range,azimuth"),
    ):
        result = run("score", *words)
        assert result.exit_code == 0, result.stderr
        assert float(cells(result.stdout, "OSPA (m)")[0]) == pytest.approx(0, abs=1e-9)
    asked = run("score", polar, "--truth", plain)
    assert asked.exit_code == 2
    assert "--polar=range,azimuth takes range and azimuth" in asked.stderr


def test_json_is_what_the_library_says(run, files):
    told = json.loads(run("score", *files, "--cutoff", 9, "--order", 1, "--json").stdout)
    found = ft.score(str(files[0]), str(files[2]), cutoff=9.0, order=1.0)
    assert told["mean"] == pytest.approx(found.means)
    assert told["truth"] == str(files[2])
    assert told["settings"] == {"cutoff": 9, "order": 1, "within": 15, "match": 15, "window": 10}


def test_groups_are_a_line_each(run, csv):
    lines = tracks_of(range(21), group="calm,") + tracks_of(range(21), offset=3.0, group="rough,")
    tracks = csv("sea,t,track_id,x,y\n" + lines, "tracks.csv")
    result = run("score", tracks, "--truth", csv(TRUTH, "truth.csv"), "--group", "sea")
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    assert lines[1].split()[:3] == ["sea", "OSPA", "tracked"]
    assert lines[3].split()[:3] == ["calm", "1", "1"]
    assert lines[4].split()[:3] == ["rough", "3", "1"]
    assert lines[6].split()[:3] == ["mean", "2", "1"]
    assert max(map(len, lines)) <= 80


def test_kinds_have_columns(run, csv):
    text = "t,track_id,x,y,kind\n"
    for t in range(21):
        text += f"{t},1,{5 * t},0,moving\n{t},9,-400,0,static\n"
    words = ("score", csv(text, "tracks.csv"), "--truth", csv(TRUTH, "truth.csv"))
    every, listed = run(*words), run(*words, "--truth-lists", "moving")
    assert every.stdout.splitlines()[1].split() == ["all", "tracks", "moving", "static"]
    assert cells(every.stdout, "static false (s/min)") == ["60", "0", "60"]
    assert float(cells(every.stdout, "spuriousness")[0]) == 0.5
    assert cells(listed.stdout, "spuriousness")[0] == "0"
    assert "21 rows of static tracks far from the truth left out" in listed.stderr


def test_names_of_columns(run, csv):
    tracks = csv(
        "run,when,n,a,b,va,vb,k\n1,3,5,0,0,1,1,moving\n1,4,5,1,1,1,1,moving\n", "tracks.csv"
    )
    truth = csv("episode,hour,name,p,q\n1,3,z,0,0\n1,4,z,1,1\n", "truth.csv")
    result = run(
        *("score", tracks, "--truth", truth, "--time", "when", "--id", "n", "--axes", "a,b"),
        *("--velocity", "va,vb", "--kind", "k", "--group", "run", "--truth-time", "hour"),
        *("--truth-id", "name", "--truth-axes", "p,q", "--truth-group", "episode", "--json"),
    )
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["mean"]["ospa"] == told["mean"]["velocity_accuracy"] == 0
    assert told["groups"][0]["group"] == "1"
    assert list(told["mean_by_kind"]) == ["moving"]


def test_clocks_and_scans(run, csv, files):
    late = csv(
        "t,track_id,x,y\n" + tracks_of([t + 3.0 for t in range(21)], offset=-15.0), "late.csv"
    )
    words = ("score", late, *files[1:])
    given = json.loads(run(*words, "--lag", "3", "--json").stdout)
    assert given["mean"]["rmse"] == pytest.approx(0, abs=1e-9)
    assert given["groups"][0]["lag"] == 3
    fitted = json.loads(run(*words, "--lag", "auto", "--json").stdout)
    assert fitted["groups"][0]["lag"] == pytest.approx(3, abs=0.01)
    scans = csv("t\n" + "".join(f"{t}\n" for t in range(10, 21)), "scans.csv")
    told = json.loads(run("score", *files, "--scans", scans, "--json").stdout)
    assert told["groups"][0]["instants"] == 11
    assert told["mean"]["share_tracked"] == 1


def test_a_picture(run, files, tmp_path):
    target = tmp_path / "ospa.png"
    result = run("score", *files, "--plot", target)
    assert result.exit_code == 0
    assert target.read_bytes().startswith(b"\x89PNG")
    assert result.stdout.splitlines()[-1] == f"wrote {target}"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--lag", "soon"),
            "error: --lag: expected seconds, GROUP=SECONDS,…, auto or none, got 'soon'",
        ),
        (("--cutoff", "0"), "error: --cutoff: must be a finite distance > 0 m, got 0"),
        (("--order", "0.5"), "error: --order: must be at least 1 and finite, got 0.5"),
        (("--window", "0"), "error: --window: must be a whole number of instants >= 1, got 0"),
        (("--step", "-1"), "error: --step: expected a number > 0, got '-1'"),
        (("--truth-lists", "few"), "error: --truth-lists: 'few'; expected all or moving"),
        (("--truth-lists", "moving"), "error: --truth-lists: tracks have no kind"),
        (("--plot", "ospa.doc"), "error: ospa.doc: cannot draw .doc"),
        (("--id", "name"), "no column 'name'"),
        (("--truth-id", "name"), "no column 'name'"),
        (("--group", "sea"), "no column 'sea'"),
    ],
)
def test_errors_are_one_line(fails, files, words, message):
    assert message in fails("score", *files, *words)


def test_files_that_are_not_there(fails, files, tmp_path):
    assert "nothing.csv" in fails("score", tmp_path / "nothing.csv", *files[1:])
    assert "--truth" in fails("score", files[0])


def test_real_boats_with_a_late_clock(run, real, csv):
    """Plots near a boat as if they were its track: the lag that the data's notes give is found."""
    plots = np.genfromtxt(real("autoferry_radar/radar_detections.csv"), delimiter=",", names=True)
    truth = real("autoferry_radar/ground_truth.csv")
    same = {}
    for row in plots:
        same.setdefault((row["scenario"], row["t_s"]), []).append(row)
    lines = [
        f"{row['scenario']:.0f},{row['t_s']},{k},{row['north_m']},{row['east_m']}\n"
        for rows in same.values()
        for k, row in enumerate(rows)
    ]
    tracks = csv("scenario,t_s,track_id,north_m,east_m\n" + "".join(lines), "tracks.csv")
    words = ("--truth", truth, "--group", "scenario", "--lag", "auto", "--json")
    told = json.loads(run("score", tracks, *words).stdout)
    found = {group["group"]: group["lag"] for group in told["groups"]}
    # In scenario 4 plots of the two boats are merged, and the least is flat.
    for name, lag, error in (("2", 2.25, 0.3), ("4", 3.0, 0.8), ("16", 1.75, 0.3)):
        assert found[name] == pytest.approx(lag, abs=error)
    words = ("--truth", truth, "--group", "scenario", "--lag", "2=2.25,4=3.5,16=1.75", "--json")
    told = json.loads(run("score", tracks, *words).stdout)
    assert [group["lag"] for group in told["groups"]] == [2.25, 3.5, 1.75]


def test_a_tracker_that_found_nothing(run, csv):
    none, truth = csv("t,track_id,x,y\n", "none.csv"), csv(TRUTH, "truth.csv")
    scans = csv("scan,t\n" + "".join(f"{t},{t}\n" for t in range(5)), "scans.csv")
    for words in ((), ("--scans", scans)):
        result = run("score", none, "--truth", truth, *words)
        assert result.exit_code == 0, result.output
        assert cells(result.stdout, "OSPA (m)") == ["20"]
    assert "5 instants" in result.stdout


def test_a_window_longer_than_the_recording_is_all_of_it(run, files):
    long = run("score", *files, "--window", 10**12)
    assert long.exit_code == 0, long.output
    assert cells(long.stdout, "OSPA(2) (m)") == cells(
        run("score", *files, "--window", 21).stdout, "OSPA(2) (m)"
    )


def test_a_lag_by_group_needs_groups(run, files):
    result = run("score", *files, "--lag", "2=1.5")
    assert result.exit_code == 2
    assert result.stderr == (
        "error: --lag: is given by group, but there are no groups; expected one number\n"
    )


def test_tracks_of_another_time_are_noted(run, csv, files):
    late = csv("t,id,x,y\n" + "".join(f"{9000 + t},a,0,0\n" for t in range(9)), "late.csv")
    result = run("score", files[0], "--truth", late)
    assert "no track has a row within the time of the truth; --lag" in result.stderr
