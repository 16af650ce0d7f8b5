import json

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.cli import tune as tuning
from fuzzytrack.fuzzy.loading import rulebase_path
from fuzzytrack.trackers.catalog import make_tracker

QUICK = ("--runs", 4, "--trials", 6, "--folds", 2)


@pytest.fixture
def recorded(csv):
    """A long straight track with noise."""
    rng = np.random.default_rng(0)
    rows = [f"{k},{4 * k + rng.normal(0, 9):.3f},{rng.normal(0, 9):.3f}" for k in range(240)]
    return csv("\n".join(["t,x,y", *rows]))


def test_a_specification_is_printed_to_be_typed(run, recorded):
    result = run("tune", recorded, "--tracker", "fixed:alpha=0.8:beta=0.9", *QUICK[2:])
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[0].startswith(f"{recorded}: 238 plots, 2 folds by blocks of time, ")
    assert lines[1] == "fewer than 3 tracks: blocks of time are held out instead of tracks"
    assert lines[2] == "RMS of innovations"
    spec = lines[-1].removeprefix("tracker: ")
    assert spec.startswith("fixed:alpha=")
    make_tracker(spec)
    assert lines[-2].startswith(("worth it: ", "not worth it: "))
    # The same in Python.
    found = ft.tune(recorded, "fixed:alpha=0.8:beta=0.9", trials=6, folds=2)
    assert found.text == spec
    for line in found.report.splitlines()[2:-1]:
        assert line.split()[0] in result.stdout
    assert found.report.splitlines()[-1] == found.verdict == lines[-2]


def test_a_tuned_rule_base_is_written(run, tmp_path):
    out = tmp_path / "tuned.yaml"
    words = ("tune", "mixed", "--tracker", "omega-schedule", "--free", "rho,lag.ps", "-o", out)
    result = run(*words, *QUICK)
    assert result.exit_code == 0, result.output
    assert f"wrote {out}" in result.stdout
    before = out.read_bytes()
    assert b"# Tuned on mixed with seed 0" in before
    # Processes, and what is printed, do not matter.
    result = run(*words, *QUICK, "--json", "--jobs", 2)
    assert out.read_bytes() == before
    found = json.loads(result.stdout)
    assert found["specification"] is None
    assert found["output"] == str(out)
    assert list(found["numbers"]) == ["lag.ps", "lag.pm", "rho"]
    assert [row["name"] for row in found["errors"]][::3] == ["start", "tuned"]
    assert found["errors"][-1]["change"] is None
    rules = ft.load_rulebase(out)
    assert float(dict(rules.scheduler)["rho"]) == found["numbers"]["rho"]
    assert rules.input("lag").sets[4].parameters[1] == found["numbers"]["lag.ps"]


def test_parameters_that_a_rule_base_does_not_hold_are_told(run, recorded, tmp_path):
    out = tmp_path / "tuned.yaml"
    words = ("--tracker", "maneuver:level=6", "--free", "noise.calm,noise.strong", "-o", out)
    result = run("tune", recorded, "--sigma", 3, *words, *QUICK)
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-2:] == [f"wrote {out}", f"tracker: {out}:level=6"]
    assert "# Give the same parameters with it: level=6." in out.read_text(encoding="utf-8")


def test_a_word_for_no_number_lists_every_word_once(fails, recorded):
    words = ("--tracker", "maneuver", "--free", "level")
    line = fails("tune", recorded, "--sigma", 3, *words, *QUICK)
    assert line.startswith("error: --free: rule base 'maneuver' has no number 'level'; allowed: ")
    assert line.count("noise.calm,") == 1


def test_numbers_without_an_effect_are_told(run, csv):
    text = rulebase_path("omega-schedule").read_text(encoding="utf-8")
    path = csv(text.replace("{singleton: [0.556]}", "{gaussmf: [0.556, 0.05]}"), "rules.yaml")
    result = run("tune", "mixed", "--tracker", path, "--free", "stiffness.M", *QUICK)
    assert "stiffness.M.sigma: without an effect on these data, left as it was" in result.stdout


def test_an_interrupted_search_is_resumed(run, tmp_path, monkeypatch):
    state = tmp_path / "state.json"
    words = ("tune", "mixed", "--tracker", "fixed", "--state", state, *QUICK)

    def interrupted(*args, **options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(tuning, "tune_tracker", interrupted)
        result = run(*words)
        # Before the first trial there is nothing to continue with.
        assert (result.exit_code, result.stderr) == (130, "interrupted\n")
        state.write_text("losses")
        result = run(*words)
        assert result.exit_code == 130
        assert result.stderr == (f"interrupted; the search is in {state}; continue with --resume\n")
        assert run("tune", "mixed", "--tracker", "fixed").exit_code == 130
    state.unlink()
    assert run(*words).exit_code == 0
    assert run(*words, "--resume").exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("mixed", "--tracker", "kalmn-cv"), "tracker 'kalmn-cv': no such tracker; did you mean"),
        (
            ("mixed", "--tracker", "fixed", "--free", "gama"),
            "--free: tracker 'fixed' has no number",
        ),
        (("mixed", "--tracker", "omega-schedule", "--free", "a"), "--free: rule base 'omega-sched"),
        (("mixed", "--tracker", "tipper"), "scheduler setting"),
        (("mixed", "--tracker", "fixed", "-o", "x.yaml"), "--output: a tuned fixed has no file"),
        (("mixed", "--tracker", "fixed", "--resume"), "--resume: needs the state file"),
        (("plots.csv", "--tracker", "fixed"), "plots.csv: "),
        (("nowhere.yaml", "--tracker", "fixed"), "nowhere.yaml"),
        (("mixed", "--tracker", "fixed", "--runs", "2"), "plots can be scored"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(fails, plots, words, message):
    assert message in fails("tune", *[plots if w == "plots.csv" else w for w in words])


def test_plots_are_read_as_track_reads_them(run, csv, tmp_path):
    rng = np.random.default_rng(2)
    rows = ["time,id,range,azimuth"]
    for id, bearing in (("A", 359.0), ("B", 30.0), ("C", 200.0)):
        r = 9000 + 40 * np.arange(90) + rng.normal(0, 20, 90)
        azimuth = bearing + 0.05 * np.arange(90) + rng.normal(0, 0.1, 90)
        r[50] = 99_999
        rows += [
            f"{4 * k},{id},{a:.1f},{b % 360:.3f}"
            for k, (a, b) in enumerate(zip(r, azimuth, strict=True))
        ]
    plots, out = csv("\n".join(rows)), tmp_path / "tuned.yaml"
    words = ("--polar", "range,azimuth", "--id", "id")
    # Its noise is estimated, and each axis has its own.
    words = (*words, "--tracker", "maneuver", "--free", "noise", *QUICK[2:])
    result = run("tune", plots, *words, "-o", out)
    assert result.exit_code == 0, result.output
    assert "3 plots beyond the gate, not used" in result.stderr
    assert result.stdout.splitlines()[-1] == f"tracker: {out}:axes=own"
    found = json.loads(run("tune", plots, *words, "--json").stdout)
    assert found["parameters"] == "axes=own"
    assert found["notes"] == ["3 plots beyond the gate, not used"]
    # The start is what `track` runs: the same innovations, from the third plot of each track on.
    tracked = ft.track(plots, polar=("range", "azimuth"), id="id")
    assert tracked.spec == "maneuver:axes=own"
    squares = [(r.innovation[3:] ** 2).sum(axis=1) for r in tracked.results]
    used = np.delete(np.concatenate(squares), [47, 47 + 87, 47 + 174])
    start = ft.tune(
        plots, "maneuver", polar=("range", "azimuth"), id="id", free=["noise"], trials=1, folds=3
    ).rows[0]
    assert start.held_out == pytest.approx(np.sqrt(used.mean()), rel=0.03)


def test_bearings_are_tuned_on_the_circle_as_track_tracks_them():
    rng = np.random.default_rng(5)
    bearing = (340 + 0.3 * np.arange(220) + rng.normal(0, 1, 220)) % 360
    plots = {"t": np.arange(220), "bearing": bearing}
    spec = "fixed:alpha=0.5:beta=0.3"
    (result,) = ft.track(plots, spec, angle="bearing").results
    found = ft.tune(plots, spec, angle="bearing", trials=1, folds=2)
    innovations = result.innovation[2:]
    assert np.abs(np.diff(bearing)).max() > 300
    assert found.rows[0].held_out == pytest.approx(np.sqrt((innovations**2).mean()), rel=1e-9)


def test_data_without_sigma_are_refused_where_it_is_needed(fails, csv):
    # Every second plot repeats the one before: there is no noise to be seen.
    rows = [f"{k},{40 * (k // 2)},0" for k in range(480)]
    plots = csv("\n".join(["t,x,y", *rows]))
    line = fails("tune", plots, "--tracker", "omega-schedule")
    assert line.startswith("error: --sigma: omega-schedule needs the standard deviation")
    assert "repeat the one before, so that their noise cannot be estimated" in line


def test_a_search_that_is_not_there_cannot_be_resumed(fails, recorded, tmp_path):
    state = tmp_path / "none.json"
    line = fails("tune", recorded, "--tracker", "fixed", "--state", state, "--resume")
    assert line.startswith(f"error: --resume: {state} does not exist")
    assert not state.exists()
