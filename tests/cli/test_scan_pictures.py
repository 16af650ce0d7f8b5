"""Pictures and the page that the command `scan` writes."""

import base64
import json
import re

import numpy as np
import pytest


@pytest.fixture
def boats(csv):
    """Two boats in 20 scans, in two recordings of ten scans each."""
    lines = ["run,scan,t,north_m,east_m"]
    for k in range(20):
        t = 1.7 * k
        for north, east in ((3 * t, 50.0), (-80.0, 4 * t)):
            lines.append(f"{'ab'[k // 10]},{k},{t:.2f},{north:.2f},{east:.2f}")
    return csv("\n".join(lines) + "\n")


def data_of(path):
    text = re.search(r'id="data">(.*?)</script>', path.read_text("utf-8"), re.DOTALL)[1]
    return json.loads(text)


def test_a_picture_and_a_page_are_written_beside_the_tracks(run, boats, tmp_path):
    page, picture, out = (tmp_path / name for name in ("p.html", "p.png", "t.csv"))
    axes = ("--axes", "north_m,east_m")
    result = run("scan", boats, *axes, "--animate", page, "--plot", picture, "-o", out)
    assert result.exit_code == 0, result.output
    wrote = [f"wrote {path}" for path in (out, picture, page)]
    assert result.stdout.splitlines()[-3:] == wrote
    assert picture.read_bytes().startswith(b"\x89PNG")
    data = data_of(page)
    assert data["axes"] == ["east", "north"]
    assert data["reports"]["ids"] == ["1", "2"]
    assert len(np.frombuffer(base64.b64decode(data["times"]), "<f8")) == 20
    plots = np.frombuffer(base64.b64decode(data["plots"]["place"]), "<f4").reshape(-1, 2)
    place = plots + data["origin"]
    np.testing.assert_allclose(place[:2], [[50, 0], [0, -80]], atol=1e-3)
    assert f"<h1>Tracks of {boats.name}</h1>" in page.read_text("utf-8")


def test_of_several_groups_the_first_is_on_the_page(run, boats, tmp_path):
    page = tmp_path / "p.html"
    options = ("--axes", "north_m,east_m", "--group", "run", "--json")
    result = run("scan", boats, *options, "--animate", page)
    assert json.loads(result.stdout)["animate"] == str(page)
    assert json.loads(result.stdout)["plot"] is None
    assert f"<h1>Tracks of {boats.name}, a</h1>" in page.read_text("utf-8")
    assert len(np.frombuffer(base64.b64decode(data_of(page)["times"]), "<f8")) == 10


@pytest.mark.parametrize(("lag", "late"), [("2", 2.0), ("auto", 2.5), ("none", 0.0)])
def test_the_truth_is_drawn_by_the_clock_of_the_plots(run, boats, csv, tmp_path, lag, late):
    page = tmp_path / "p.html"
    lines = ["t,target,north_m,east_m"]
    for k in range(-10, 26):
        # Sampled at other times than the scans, by a clock that is 2.5 s slow.
        t = 2.0 * k
        lines += [f"{t - 2.5},1,{3 * t},50", f"{t - 2.5},2,-80,{4 * t}"]
    words = ("scan", boats, "--axes", "north_m,east_m", "--animate", page, "--lag", lag)
    result = run(*words, "--truth", csv("\n".join(lines) + "\n", "truth.csv"))
    assert result.exit_code == 0, result.stderr
    assert (" s behind the truth (fitted" in result.stderr) == (lag == "auto")
    time = np.frombuffer(base64.b64decode(data_of(page)["truth"]["time"]), "<f8")
    np.testing.assert_allclose(np.unique(time), 2.0 * np.arange(-10, 26) - 2.5 + late, atol=0.05)


def test_a_lag_that_cannot_be_used_is_refused(run, boats, csv, tmp_path):
    truth = csv("run,t,target,north_m,east_m\na,0,1,0,50\na,9,1,27,50\n", "truth.csv")
    words, out = ("scan", boats, "--axes", "north_m,east_m", "--lag"), tmp_path / "t.csv"
    told = "error: --lag: is that of the plots behind --truth; give it\n"
    assert run(*words, "2", "--plot", tmp_path / "p.png").stderr == told
    shown = ("--truth", truth, "--plot", tmp_path / "p.png", "-o", out)
    assert "--lag: expected seconds, GROUP=SECONDS" in run(*words, "late", *shown).stderr
    none = run(*words, "a=2", *shown)
    assert (none.exit_code, out.exists()) == (2, False)
    assert "--lag: is given by group, but there are no groups" in none.stderr
    other = run(*words, "b=2", *shown, "--group", "run")
    assert "--lag: has no group 'a'" in other.stderr


def test_another_group_with_the_truth(run, boats, csv, tmp_path):
    page, picture = tmp_path / "p.html", tmp_path / "p.png"
    truth = csv(
        "run,t,target,north_m,east_m\na,0,1,0,50\nb,17,1,51,50\nb,25.5,1,76.5,50\n", "truth.csv"
    )
    words = ("scan", boats, "--axes", "north_m,east_m", "--group", "run", "--show")
    shown = ("--animate", page, "--plot", picture, "--truth", truth)
    result = run(*words, "b", *shown)
    assert result.exit_code == 0, result.stderr
    assert f"<h1>Tracks of {boats.name}, b</h1>" in page.read_text("utf-8")
    told = data_of(page)["truth"]
    assert told["names"] == ["1"]
    assert np.frombuffer(base64.b64decode(told["time"]), "<f8").tolist() == [17, 25.5]
    out = tmp_path / "t.csv"
    none = run(*words, "c", *shown, "-o", out)
    told = "error: --show: no group 'c'; expected one of a, b\n"
    assert (none.exit_code, none.stderr) == (2, told)
    assert not out.exists()
    for option, value in (("--show", "a"), ("--truth", truth)):
        alone = run("scan", boats, option, value, "-o", out)
        assert alone.exit_code == 2
        assert f"{option}: is for --plot and --animate; give one of them" in alone.stderr
    assert "--show: is one of the groups" in run(*words[:4], "--show", "a", *shown).stderr


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("p.png", "--animate: {path}: is a page; give it the suffix .html"),
        ("none/p.html", "{path}: there is no folder"),
    ],
)
def test_a_page_that_cannot_be_written_is_refused_before_the_work(
    run, boats, tmp_path, name, message
):
    path, out = tmp_path / name, tmp_path / "t.csv"
    result = run("scan", boats, "--axes", "north_m,east_m", "--animate", path, "-o", out)
    assert result.exit_code == 2
    assert message.format(path=path) in result.stderr.replace("\n", "")
    assert not out.exists()
