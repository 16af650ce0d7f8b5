"""The commands about configurations of scan trackers."""

import json

import numpy as np
import pytest

from fuzzytrack.scan.association import associations
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners import load_scanner, scanner_path, shipped_scanners
from fuzzytrack.tuning import scanner_tuner


@pytest.fixture
def mine(tmp_path):
    """A file that changes the default."""
    path = tmp_path / "mine.yaml"
    path.write_text("name: mine\nbased_on: default\nclutter: {cell: 20}\n")
    return path


def test_list(run):
    text = run("scanner", "list").stdout
    assert all(name in text for name in shipped_scanners())
    assert max(map(len, text.splitlines())) <= 80
    found = json.loads(run("scanner", "list", "--json").stdout)
    assert [each["name"] for each in found] == list(shipped_scanners())


def test_show(run, mine):
    text = run("scanner", "show", mine).stdout
    assert "clutter: adaptive-map" in text
    assert "side of a cell of the fine grid" in text
    assert max(map(len, text.splitlines()[1:])) <= 80
    found = json.loads(run("scanner", "show", mine, "--json").stdout)
    assert found["clutter"]["cell"] == 20
    assert (found["gate"]["part"], found["based_on"]) == ("covariance", "default")
    assert run("scanner", "show", "default").stdout.startswith("default\n")


def test_check(run, fails, mine, tmp_path):
    assert f"{mine}: ok, based on default" in run("scanner", "check", mine, "default").stdout
    found = json.loads(run("scanner", "check", mine, "--json").stdout)
    assert found[0]["ok"]
    assert found[0]["clutter"]["cell"] == 20
    mine.write_text(mine.read_text().replace("cell", "cel"))
    message = "unknown key in clutter: 'cel'; did you mean 'cell'?"
    assert fails("scanner", "check", mine).startswith(f"{mine}:3:11: {message}")
    mine.write_text("name: mine\nbased_on: default\nsensor:\n  detection: 1.2\n")
    assert f"{mine}:4:14: sensor: detection must be" in fails("scanner", "check", mine)
    mine.write_text("name: mine\nbased_on: default\ngate: rund\n")
    assert f"{mine}:3:7: unknown gate 'rund'" in fails("scanner", "check", mine)
    missing = tmp_path / "none.yaml"
    assert fails("scanner", "check", missing).count(str(missing)) == 1
    assert "unknown configuration 'nine'" in fails("scanner", "check", "nine")


def test_check_says_all_that_is_wrong(run, mine, tmp_path):
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("name: mine\nbased_on: default\ngate: rund\n")
    result = run("scanner", "check", wrong, mine, wrong, "--json")
    assert result.exit_code == 2
    assert [each["ok"] for each in json.loads(result.stdout)] == [False, True, False]
    assert len(result.stderr.splitlines()) == 2


def test_new(run, fails, tmp_path):
    path = tmp_path / "mine.yaml"
    text = run("scanner", "new", path).stdout
    assert f"fuzzytrack scanner check {path}" in text
    assert load_scanner(path).clutter == ScanTracker().clutter
    assert json.loads(path.with_name("scanner.schema.json").read_text())["title"]
    assert "exists; name another file" in fails("scanner", "new", path)
    found = json.loads(run("scanner", "new", path, "--whole", "--force", "--json").stdout)
    assert found["from"] == str(scanner_path("default"))
    assert "# m; side of a cell of the fine grid" in path.read_text()
    assert "must end in .yaml" in fails("scanner", "new", tmp_path / "mine.json")
    assert "unknown configuration" in fails("scanner", "new", tmp_path / "b.yaml", "--from", "bla")


def test_parts(run, fails):
    text = run("scanner", "parts").stdout
    assert "adaptive-map" in text
    assert max(map(len, text.splitlines())) <= 80
    text = run("scanner", "parts", "clutter").stdout
    assert "side of a cell" in " ".join(text.split())
    assert "covariance" not in text
    found = json.loads(run("scanner", "parts", "gate", "--json").stdout)
    limit = next(each for each in found if each["part"] == "covariance")["numbers"]["limit"]
    assert limit["default"] == 16.0
    assert "unknown role 'gates'; one of extraction" in fails("scanner", "parts", "gates")


def test_schema(run, tmp_path):
    shipped = scanner_path("default").with_name("scanner.schema.json").read_text()
    assert json.loads(run("scanner", "schema").stdout) == json.loads(shipped)
    run("scanner", "schema", "-o", tmp_path / "schema.json")
    assert (tmp_path / "schema.json").read_text() == shipped


PLUGIN = """
from dataclasses import dataclass
from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.part import parameter

@associations.register("first-come")
@dataclass(frozen=True, repr=False)
class FirstCome(Association):
    '''The first plot of each track that is free.'''

    plain = True
    bonus: float = parameter(1.0, "bonus", "nats", least=0)

    def kernels(self, setting):
        def cost(tracks, i, plots, j, distance, log_likelihood):
            return -1.0

        def assign(rows, count, first, plot, cost, plot_of, track_of, integers, numbers):
            for i in range(rows):
                for e in range(first[i], first[i + 1]):
                    if plot_of[i] < 0 and track_of[plot[e]] < 0:
                        plot_of[i], track_of[plot[e]] = plot[e], i

        return AssociationKernels(cost, assign)
"""


@pytest.fixture
def unregistered():
    """What a test has registered is forgotten after it."""
    yield
    associations.unregister("first-come")


@pytest.mark.usefixtures("unregistered")
def test_a_part_of_a_script_is_there_with_the_option(run, fails, mine, tmp_path):
    script = tmp_path / "parts.py"
    script.write_text(PLUGIN)
    mine.write_text("name: mine\nbased_on: default\nassociation: {part: first-come, bonus: 2}\n")
    assert "unknown association 'first-come'" in fails("scanner", "check", mine)
    assert ": ok" in run("scanner", "check", mine, "--plugin", script).stdout
    text = run("scanner", "parts", "association", "--plugin", script).stdout
    assert "The first plot of each track" in text
    found = run("scanner", "schema", "--plugin", script).stdout
    assert "first-come" in found


# -------------------------------------------------------------------- tune


@pytest.fixture
def no_runs(monkeypatch):
    """How far two numbers are from those that are best stands for what runs would give."""

    def values(self, tracker):
        if tracker is None:
            return np.full(len(self.groups), np.inf)
        far = np.log([tracker.gate.limit / 12, tracker.confirmation.hits / 5])
        return np.full(len(self.groups), far @ far)

    monkeypatch.setattr(scanner_tuner._Trials, "_values", values)


TUNE = (
    "scanner", "tune", "default", "crossing:scans.count=8", "--runs", "1",
    "--free", "confirmation.hits,gate.limit",
)  # fmt: skip


@pytest.mark.usefixtures("no_runs")
def test_tune(run, tmp_path):
    out = tmp_path / "tuned.yaml"
    result = run(*TUNE, "--trials", "14", "--json", "-o", out)
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["numbers"].keys() == {"confirmation.hits", "gate.limit"}
    assert found["mean"]["tuned"] < found["mean"]["start"]
    tuned = load_scanner(out)
    assert tuned.gate.limit == pytest.approx(found["numbers"]["gate.limit"])
    assert tuned.confirmation.hits == found["numbers"]["confirmation.hits"]
    assert tuned.clutter == ScanTracker().clutter


@pytest.mark.usefixtures("no_runs")
def test_tune_prints_the_numbers_and_the_configuration(run, tmp_path):
    lines = run(*TUNE, "--trials", "7").stdout.splitlines()
    assert lines[0] == "1 recording, 7 trials, seed 0"
    rows = [line.split() for line in lines]
    start = [row[:2] for row in rows if row[:1] in (["confirmation.hits"], ["gate.limit"])]
    assert start[:2] == [["gate.limit", "16"], ["confirmation.hits", "3"]]
    assert "based_on: default" in lines
    out = tmp_path / "tuned.yaml"
    assert run(*TUNE, "--trials", "7", "-o", out).stdout.splitlines()[-1] == f"wrote {out}"


def test_tune_that_is_interrupted_is_resumed(run, tmp_path, monkeypatch):
    count = 0

    def values(self, tracker):
        nonlocal count
        count += 1
        if count == 12:
            raise KeyboardInterrupt
        return np.full(len(self.groups), 1.0)

    monkeypatch.setattr(scanner_tuner._Trials, "_values", values)
    words = (*TUNE, "--trials", "18", "--state", tmp_path / "state.json")
    result = run(*words)
    assert result.exit_code == 130
    assert f"the search is in {tmp_path / 'state.json'}; continue with --resume" in result.stderr
    assert run(*words, "--resume").exit_code == 0
    # The start and the best, before and after; a generation of six was kept.
    assert count == 12 + 12 + 2
    count = 11
    assert run(*TUNE, "--trials", "18").exit_code == 130


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--free", "gate.limt"], "no number 'gate.limt'"),
        (["--metric", "osp"], "unknown 'osp'"),
        (["-o", "tuned.csv"], "output: tuned.csv must end in .yaml"),
        (["--lag", "soon"], "--lag: "),
        (["--period", "soon"], "--period: "),
    ],
)
def test_what_cannot_be_tuned_is_told_in_one_line(fails, words, said):
    assert said in fails("scanner", "tune", "default", "crossing:scans.count=8", *words)


def test_a_list_in_place_of_a_number_and_a_key_that_is_none(fails, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("name: mine\nbased_on: default\nsensor: {range_noise: [1]}\n")
    said = fails("scanner", "check", file)
    assert said.endswith(
        "mine.yaml:3:23: sensor: range_noise must be a number >= 0 (m), not a list"
    )
    file.write_text("name: mine\ntracks: 3\n")
    assert "allowed: name, scanner, description, based_on" in fails("scanner", "check", file)
