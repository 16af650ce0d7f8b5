"""The command `scan`: plots without identities."""

import csv as csv_files
import json

import numpy as np
import pytest


@pytest.fixture
def harbor(csv):
    """Two boats and some clutter, 25 scans; the tenth has no plot."""
    random, lines = np.random.default_rng(11), ["scan,t,x,y"]
    for k in range(25):
        if k == 10:
            continue
        t = 1.7 * k
        boats = [(3 * t, 50), (-80, 4 * t)]
        clutter = random.uniform(-300, 300, (random.poisson(2), 2)).tolist()
        for x, y in [*boats, *clutter]:
            noise = random.normal(0, 0.7, 2)
            lines.append(f"{k},{t:.2f},{x + noise[0]:.3f},{y + noise[1]:.3f}")
    return csv("\n".join(lines) + "\n")


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv_files.DictReader(stream))


def test_tracks_of_a_harbor(run, harbor, tmp_path):
    out = tmp_path / "tracks.csv"
    result = run("scan", harbor, "-o", out)
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[:4] == [
        "columns: time t; position x, y",
        "scans: by column scan",
        "configuration: default",
        "sigma: that of the configuration",
    ]
    assert result.stdout.splitlines()[-1] == f"wrote {out}"
    rows = rows_of(out)
    assert list(rows[0]) == [
        "t", "track_id", "x", "y", "x_velocity", "y_velocity", "speed", "course", "x_sd", "y_sd",
        "x_velocity_sd", "y_velocity_sd", "status", "kind", "existence", "since_last", "plot",
    ]  # fmt: skip
    assert {row["kind"] for row in rows} == {"moving"}
    assert len({row["track_id"] for row in rows}) == 2
    last = {row["track_id"]: row for row in rows}
    for row in last.values():
        assert float(row["speed"]) == pytest.approx(3.5, abs=1)
    # The tenth scan is known by the numbers of the others.
    assert {row["t"] for row in rows if row["status"] == "coasting"} == {"17.0"}
    # A row of the file: the plot is near the track.
    lines = harbor.read_text().splitlines()
    for row in rows:
        if row["plot"] != "-1":
            x, y = map(float, lines[int(row["plot"]) - 1].split(",")[2:])
            assert np.hypot(x - float(row["x"]), y - float(row["y"])) < 4


def test_json(run, harbor, tmp_path):
    result = run("scan", harbor, "--json", "-o", tmp_path / "t.csv")
    found = json.loads(result.stdout)
    assert found["total"]["scans"] == 25
    assert found["total"]["empty_scans"] == found["empty_scans"] == 1
    assert found["total"]["tracks"] == found["total"]["moving"] == 2
    assert found["scans_by"]["column"] == "scan"
    assert found["groups"] is None
    assert found["output"] == str(tmp_path / "t.csv")


def test_standard_output_and_chosen_columns(run, harbor):
    result = run("scan", harbor, "-o", "-", "--output-columns", "id=track_id,t,x")
    assert result.stdout.splitlines()[0] == "id,t,x"
    assert "configuration: default" in result.stderr


def test_tentative_tracks(run, harbor, tmp_path):
    out = tmp_path / "tracks.csv"
    assert run("scan", harbor, "--tentative", "-o", out).exit_code == 0
    assert {row["status"] for row in rows_of(out)} == {"tentative", "confirmed", "coasting"}


def test_groups(run, csv, harbor, tmp_path):
    head, *lines = harbor.read_text().splitlines()
    both = [f"{name},{line}" for name in ("a", "b") for line in lines]
    path, out = csv("\n".join([f"place,{head}", *both]) + "\n", "both.csv"), tmp_path / "out.csv"
    result = run("scan", path, "--group", "place", "-o", out)
    assert result.exit_code == 0, result.output
    rows = rows_of(out)
    ids = [{row["track_id"] for row in rows if row["place"] == name} for name in ("a", "b")]
    assert len(ids[0]) == len(ids[1]) == 2
    assert not ids[0] & ids[1]
    assert [line.split()[0] for line in result.stdout.splitlines()[-5:-1] if line] == [
        "a", "b", "all",
    ]  # fmt: skip


@pytest.mark.parametrize("suffix", ["parquet", "geojson", "ast"])
def test_other_formats(run, harbor, tmp_path, suffix):
    pytest.importorskip({"parquet": "pyarrow", "geojson": "pymap3d", "ast": "struct"}[suffix])
    out = tmp_path / f"tracks.{suffix}"
    result = run("scan", harbor, "--site", "63.4,10.4", "-o", out)
    assert result.exit_code == 0, result.output
    assert out.stat().st_size > 500


def test_a_picture(run, harbor, tmp_path):
    picture, out = tmp_path / "tracks.png", tmp_path / "tracks.csv"
    result = run("scan", harbor, "--plot", picture, "-o", out)
    assert result.exit_code == 0, result.output
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert rows_of(out)


def test_python_gives_the_same(run, harbor, tmp_path):
    from fuzzytrack import track_scans

    out, other = tmp_path / "tracks.csv", tmp_path / "other.csv"
    run("scan", harbor, "-o", out)
    found = track_scans(harbor)
    found.write(other)
    assert out.read_text() == other.read_text()
    assert len(found) == 2
    assert "2 tracks by default" in found._repr_html_()
    assert found.result.of_track(int(found.result.track_ids[0])).kind.max() == 1
    table = found.to_pandas()
    assert table["status"].tolist() == [row["status"] for row in rows_of(out)]


# -------------------------------------------------------------------- what is wrong


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        (
            "scan,t,x,y\n0,0,1,1\n",
            ["--scan", "scn"],
            "--scan: no column 'scn'; did you mean 'scan'",
        ),
        ("scan,t,x\n0,0,1\n", [], "plots of a scan have two coordinates"),
        ("scan,t,a,b\n0,0,1,1\n", [], "no columns x, y or x_m, y_m"),
        ("scan,t,x,y\n", [], "holds no rows"),
        ("", [], "is empty"),
        (
            "scan,t,x,y\n0,5,1,1\n1,4,1,1\n",
            [],
            "row 3, column t: the scan '1' of column scan ends at 4, not later",
        ),
        ("scan,t,x,y\n0,nan,1,1\n", [], "row 2, column t: 'nan'"),
        ("scan,t,x,y\n0,0,1,abc\n", [], "row 2, column y: 'abc'"),
        ("t,x,y\n0,1,1\n5,1,1\n4,1,1\n", ["--period", "2"], "row 4, column t: 4 is earlier than 5"),
        ("t,x,y\n0,1,1\n1,1,1\n", [], "cannot tell which plots are of one scan"),
        ("scan,t,x,y\n0,0,1,1\n", ["--period", "-1"], "--period: expected a number > 0"),
        ("scan,t,x,y\n0,0,1,1\n", ["--own", "a,b"], "--own: no column 'a'"),
        ("scan,t,x,y\n0,0,1,1\n", ["--group", "g"], "--group: no column 'g'"),
        ("scan,t,x,y\n0,0,1,1\n", ["--sigma", "auto"], "--sigma: cannot be estimated"),
        ("scan,t,x,y\n0,0,1,1\n", ["--stale"], "--stale: is about plots of one track"),
        ("scan,t,x,y\n0,0,1,1\n", ["--sectors", "2"], "--sectors: must be from 4 to 1024, got 2"),
        ("scan,t,x,y\n0,0,1,1\n", ["--config", "defalt"], "defalt"),
        ("scan,t,x,y\n0,0,1,1\n", ["--tracker", "air"], "--tracker: 'air' is a configuration of"),
        ("scan,t,x,y\n0,0,,1\n", ["-o", "a.csv"], "no plot can be used: 1 row without a position"),
        ("scan,t,x,y\n0,0,1,1\n", ["--output-columns", "t"], "--output-columns: are those of -o"),
        ("scan,t,x,y\n0,0,1,1\n", ["-o", "a.csv", "--output-columns", "u"], "no column 'u'"),
        ("scan,t,x,y\n0,0,1,1\n", ["-o", "-", "--json"], "--json: -o - writes the tracks"),
        ("scan,t,x,y\n0,0,1,1\n", ["-o", "a.kml"], ".kml needs positions on the earth"),
    ],
)
def test_errors_are_one_line(fails, csv, text, options, said):
    assert said.lstrip("-") in fails("scan", csv(text), *options).replace("`", "").lstrip("-")


@pytest.mark.parametrize("command", [("scan",), ("scanner", "tune")])
def test_the_help_lists_no_options_about_single_tracks(run, command):
    text = run(*command, "--help").stdout
    listed = {word.strip(",") for word in text.split() if word.startswith("--")}
    assert {"--sigma", "--valid", "--polar"} <= listed
    assert not {"--id", "--stale", "--duplicates", "--least-step", "--max-gap"} & listed
    assert "COL,COL|auto" not in text
    assert "--max-coast" in run("track", "--help").stdout


def test_rows_without_a_position_are_told(run, csv):
    rows = [f"{k},{k},{'' if k == 2 else 5},5" for k in range(5)]
    result = run("scan", csv("\n".join(["scan,t,x,y", *rows]) + "\n"))
    assert result.exit_code == 0
    assert result.stdout.splitlines()[-1] == "1 row without a position left out"


# -------------------------------------------------------------------- real plots


def test_autoferry(run, real, tmp_path):
    plots = real("autoferry_radar/radar_detections.csv")
    out = tmp_path / "tracks.csv"
    result = run(
        "scan", plots, "--scans", real("autoferry_radar/radar_scans.csv"), "--scan", "scan",
        "--group", "scenario", "--axes", "north_m,east_m", "-o", out,
        "--output-columns", "scenario,t_s,track_id,north_m,east_m",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    rows = rows_of(out)
    assert list(rows[0]) == ["scenario", "t_s", "track_id", "north_m", "east_m"]
    assert {row["scenario"] for row in rows} == {"2", "4", "16"}
    groups = {}
    for row in rows:
        groups.setdefault(row["track_id"], set()).add(row["scenario"])
    assert all(len(names) == 1 for names in groups.values())


def test_polar_plots(run, real, tmp_path):
    plots = real("adsb_turns/radar_plots_sim.csv")
    out = tmp_path / "tracks.csv"
    result = run("scan", plots, "--polar", "range_m,az_deg", "--scan", "scan", "-o", out, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["total"]["scans"] == 1125
    assert found["plots"] + found["faults"]["missed"] == 1576


def test_given_noise_takes_the_place_of_that_of_the_configuration(run, csv, tmp_path):
    """The deviations of tracks follow the options, in the directions of range and bearing."""
    lines = ["scan,t,range,azimuth", *(f"{k},{2 * k},{900 + 2 * k},0" for k in range(30))]
    plots, out = csv("\n".join(lines) + "\n"), tmp_path / "tracks.csv"

    def deviations(*options):
        result = run("scan", plots, "--polar", "range,azimuth", "-o", out, *options)
        assert result.exit_code == 0, result.output
        row = rows_of(out)[-1]
        return float(row["x_sd"]), float(row["y_sd"])

    usual = deviations()
    exact = deviations("--sigma-range", "0.2", "--sigma-azimuth", "0.02")
    wide = deviations("--sigma-range", "2", "--sigma-azimuth", "0.02")
    assert exact[0] < usual[0]
    assert exact[1] < usual[1]
    assert wide[1] > 2 * exact[1]


def test_plots_of_aircraft_are_noted(run, csv):
    """They do not suit the usual configuration, which finds no track."""
    lines = ["scan,t,x,y"]
    lines += [f"{k},{4 * k},{600 * k},{j * 20_000}" for k in range(20) for j in range(2)]
    result = run("scan", csv("\n".join(lines) + "\n"))
    assert result.exit_code == 0, result.output
    assert "note: neighboring plots of successive scans are typically 600 m apart" in result.stderr
    assert "use config air (at most 350 m/s)" in result.stderr
    assert "note: no track was confirmed in 20 scans" in result.stderr
    told = json.loads(run("scan", csv("\n".join(lines) + "\n"), "--json").stdout)["notes"]
    assert len(told) == 3
