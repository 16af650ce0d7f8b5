"""What `track` writes: the columns of tables, and tracks on the earth."""

import csv
import io
import json
import os
import threading

import gpxpy
import numpy as np
import pytest

from fuzzytrack.recordings.tracking import track as track_plots

SHIPS = 3


def ships(tmp_path, *, dated=True, rows=40):
    """Ships on straight courses, by turns, one across the date line; some plots are missing."""
    rng, lines = np.random.default_rng(2), ["mmsi,time,lat,lon"]
    for k in range(rows):
        seconds = 10 * k
        clock = f"2024-05-01T12:{seconds // 60:02d}:{seconds % 60:02d}Z" if dated else seconds
        for ship in range(SHIPS):
            noise = rng.normal(0, 3e-5, 2)
            longitude = (179.995 + 0.0005 * k * (ship - 1) + noise[0] + 180) % 360 - 180
            place = f"{-17.0 + ship + 0.001 * k + noise[1]:.6f},{longitude:.6f}"
            lines.append(f"20{ship},{clock},{place if (k + ship) % 7 else ','}")
    path = tmp_path / "ships.csv"
    path.write_text("\n".join(lines) + "\n")
    return str(path)


OPTIONS = ("--geodetic", "lat,lon", "--id", "mmsi")


def table(path):
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_table_of_ships(run, tmp_path):
    out = tmp_path / "out.csv"
    assert run("track", ships(tmp_path), *OPTIONS, "-o", str(out)).exit_code == 0
    rows = table(out)
    assert list(rows[0])[-10:] == [
        "gamma_north", "east_sd", "north_sd", "speed", "course", "latitude", "longitude",
        "coasted", "since_last", "segment",
    ]  # fmt: skip
    assert {row["time"][:17] for row in rows} == {f"2024-05-01T12:{m:02d}:" for m in range(7)}
    eastward = [row for row in rows if row["mmsi"] == "202"][-1]
    assert float(eastward["longitude"]) < 0
    assert 0 < float(eastward["course"]) < 90
    coasting = [row for row in rows if row["coasted"] == "true"]
    assert len(coasting) == sum(not row["east"] for row in rows) > 10
    later = [row for row in coasting if row["since_last"]]
    assert {row["since_last"] for row in later} == {"10.0"}
    # Where a plot is missing the position is less certain.
    assert min(float(r["east_sd"]) for r in later if r["east_sd"]) > np.median(
        [float(r["east_sd"]) for r in rows if r["east_sd"] and r["coasted"] == "false"]
    )


def test_pieces_have_the_same_rows(run, tmp_path):
    file, whole, parts = ships(tmp_path), tmp_path / "whole.csv", tmp_path / "parts.csv"
    assert run("track", file, *OPTIONS, "--sigma", "4", "-o", str(whole)).exit_code == 0
    assert (
        run(
            "track", file, *OPTIONS, "--sigma", "4", "--chunk-rows", "25", "-o", str(parts)
        ).exit_code
        == 0
    )
    found = table(parts)
    assert {row["segment"] for row in found} == {"0"}
    key = lambda row: (row["mmsi"], row["time"])  # noqa: E731
    assert sorted(found, key=key) == sorted(table(whole), key=key)
    assert list(found[0]) == list(table(whole)[0])


@pytest.mark.parametrize("suffix", ["geojson", "kml", "czml", "gpx"])
def test_ships_on_the_map_from_whole_tracks_and_pieces(run, tmp_path, suffix):
    file, whole, parts = ships(tmp_path), tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    assert run("track", file, *OPTIONS, "--sigma", "4", "-o", str(whole)).exit_code == 0
    assert (
        run(
            "track", file, *OPTIONS, "--sigma", "4", "--chunk-rows", "25", "-o", str(parts)
        ).exit_code
        == 0
    )
    text = parts.read_text().replace('"name": "b"', '"name": "a"').replace("<name>b<", "<name>a<")
    assert whole.read_text() == text


def test_the_map_has_the_rows_of_the_table(run, tmp_path):
    file = ships(tmp_path)
    for name in ("o.csv", "o.gpx", "o.geojson"):
        assert run("track", file, *OPTIONS, "-o", str(tmp_path / name)).exit_code == 0
    rows = [row for row in table(tmp_path / "o.csv") if row["latitude"]]
    with open(tmp_path / "o.gpx", encoding="utf-8") as stream:
        tracks = gpxpy.parse(stream).tracks
    assert [track.name for track in tracks] == ["200", "201", "202"]
    points = [point for track in tracks for point in track.segments[0].points]
    assert [point.latitude for point in points] == [float(row["latitude"]) for row in rows]
    assert [point.longitude for point in points] == [float(row["longitude"]) for row in rows]
    clocks = [point.time.strftime("%Y-%m-%dT%H:%M:%SZ") for point in points]
    assert clocks == [row["time"] for row in rows]
    kinds = [
        feature["geometry"]["type"]
        for feature in json.loads((tmp_path / "o.geojson").read_text())["features"]
    ]
    assert kinds == ["LineString", "LineString", "MultiLineString"]


def test_times_without_a_date(run, tmp_path):
    file = ships(tmp_path, dated=False)
    for name in ("o.geojson", "o.gpx"):
        assert run("track", file, *OPTIONS, "-o", str(tmp_path / name)).exit_code == 0
    for name in ("o.kml", "o.czml"):
        result = run("track", file, *OPTIONS, "-o", str(tmp_path / name))
        assert result.exit_code == 2
        assert "needs the date of every plot" in result.stderr
        assert not (tmp_path / name).exists()


def test_positions_that_are_not_on_the_earth(run, tmp_path):
    file = tmp_path / "f.csv"
    file.write_text("t,x,y\n0,0,0\n1,1,1\n2,2,2\n")
    for more in ((), ("--chunk-rows", "2")):
        result = run("track", str(file), *more, "-o", str(tmp_path / "o.geojson"))
        assert result.exit_code == 2
        assert "needs positions on the earth; name the columns of latitude and longitude" in (
            result.stderr
        )
        assert "(--geodetic)" in result.stderr


def test_formulas_are_quoted_on_request(run, tmp_path):
    file, out = tmp_path / "f.csv", tmp_path / "o.csv"
    file.write_text("id,t,x\n=1+2,0,0\n=1+2,1,1\n=1+2,2,2\n")
    for more, id in (((), "=1+2"), (("--quote-formulas",), "'=1+2")):
        for pieces in ((), ("--chunk-rows", "2")):
            result = run("track", str(file), "--id", "id", *more, *pieces, "-o", str(out))
            assert result.exit_code == 0
            assert {row["id"] for row in table(out)} == {id}


def test_data_frames_have_numbers_for_times(tmp_path):
    file = tmp_path / "f.csv"
    file.write_text("t,x,y\n" + "".join(f"{k}.5,{3 * k},{4 * k}\n" for k in range(6)))
    frame = track_plots(str(file), sigma=1.0).to_pandas()
    assert frame["t"].tolist() == [k + 0.5 for k in range(6)]
    assert frame["coasted"].tolist() == [False] * 6
    np.testing.assert_allclose(frame["speed"][1:], 5.0)
    assert {"x_sd", "y_sd", "since_last"} <= set(frame)


def test_tracks_are_printed_as_csv(run, tmp_path):
    path, out = ships(tmp_path), tmp_path / "out.csv"
    whole = run("track", path, *OPTIONS, "-o", out)
    for more in ((), ("--chunk-rows", "20")):
        printed = run("track", path, *OPTIONS, "-o", "-", *more)
        assert printed.exit_code == 0
        rows = list(csv.DictReader(io.StringIO(printed.stdout)))
        assert sorted(map(str, rows)) == sorted(map(str, table(out)))
        # What is told is no part of the tracks.
        assert "columns: time time" in printed.stderr
        assert "wrote" not in printed.stderr
    assert f"wrote {out}" in whole.stdout


def test_nothing_is_printed_of_tracks_that_fail(fails, tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("t,x\n0,1\n1,inf\n")
    assert "row 3" in fails("track", path, "-o", "-")
    assert "--json" in fails("track", path, "-o", "-", "--json")
    assert "need -o DIR" in fails("track", path, "-o", "-", "--jobs", 2)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_read_by_one_process(fails, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    def feed():
        pipe.write_text("t,x\n0,1\n1,2\n2,4\n")

    feeder = threading.Thread(target=feed)
    feeder.start()
    message = fails("track", pipe, "--jobs", 2, "-o", tmp_path / "out")
    feeder.join()
    assert "cannot be read by several processes; save it to a file" in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("column", "options", "unit"),
    [
        ("x", (), "m"),
        ("x_km", ("--axes", "x_km"), "km"),
        ("x (slant)", ("--axes", "x (slant)"), "m"),
        ("bearing", ("--angle", "bearing"), "deg"),
        ("bearing_rad", ("--angle", "bearing_rad"), "rad"),
    ],
)
def test_innovations_have_the_unit_of_their_positions(run, tmp_path, column, options, unit):
    path = tmp_path / "plots.csv"
    path.write_text(f"t,{column}\n0,0\n1,1\n2,2\n3,3\n")
    printed = run("track", path, "--tracker", "fixed:alpha=0.5:beta=0.2", *options).stdout
    assert f"innovation RMS ({unit})  " in printed
