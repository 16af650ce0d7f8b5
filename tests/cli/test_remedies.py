"""Typical mistakes of a newcomer: one line that names the place and the remedy."""

import gzip

import pytest

from fuzzytrack.fuzzy.loading import rulebase_path

TEXT = rulebase_path("stiffness-damping").read_text("utf-8")
LINE = next(n for n, line in enumerate(TEXT.splitlines(), 1) if "nl: {trapmf" in line)
SET = "nl: {trapmf: [-1, -1, -0.6, -0.3]}"


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("\n  E:", "\n\tE:", (LINE - 4, 1), "a tab; indent with blanks"),
        (
            "\n    universe: [-1, 1, 41]\n    sets: &",
            "\n   universe: [-1, 1, 41]\n    sets: &",
            (LINE - 2, 4),
            "wrong indentation: no line above that it may belong to begins in column 4",
        ),
        (
            SET,
            SET.replace("]}", "}"),
            (LINE, 20),
            f"'[' is closed by no ']', or a comma is missing, before line {LINE}, column 39",
        ),
        (
            SET,
            SET.replace("]}", "]"),
            (LINE, 11),
            f"'{{' is closed by no '}}', or a comma is missing, before line {LINE + 1}, column 7",
        ),
        ("name: st", "name st", (3, 1), "no ':' with a blank after it follows this word"),
        (
            "label: normalized error\n",
            "label: 'one\n",
            (LINE - 3, 12),
            "quotation mark is not closed",
        ),
        ("label: normalized error\n", "label: a: b\n", (LINE - 3, 13), "put the text in quotes"),
    ],
    ids=["tab", "indentation", "bracket", "brace", "colon", "quote", "second colon"],
)
def test_mistakes_in_yaml_are_named_where_they_begin(fails, csv, old, new, place, message):
    assert old in TEXT
    path = csv(TEXT.replace(old, new, 1), "mine.yaml")
    line = fails("rulebase", "show", path)
    assert line.startswith(f"{path}:{place[0]}:{place[1]}: not YAML: ")
    assert message in line


@pytest.mark.parametrize(
    ("raw", "what"),
    [
        (gzip.compress(TEXT.encode()), "is compressed by gzip, not text; unpack it first"),
        (b"\x28\xb5\x2f\xfd\x04\x00", "is compressed by zstd, not text; unpack it first"),
        (b"PK\x03\x04\xff\xff", "is a zip archive, not text; unpack it first"),
        (TEXT.encode("utf-16"), "byte 0xff is not valid UTF-8; save the text as UTF-8"),
    ],
)
def test_a_rule_base_that_is_no_text(fails, csv, raw, what):
    path = csv(raw, "mine.yaml")
    assert fails("rulebase", "show", path) == f"{path}:1:1: {what}"


def test_the_text_of_another_program_in_a_file_of_ours(fails, csv):
    path = csv("[System]\nName='tipper'\n", "mine.yaml")
    assert fails("rulebase", "show", path).endswith("is this a file of another program?")


@pytest.mark.parametrize(
    "command",
    ["rulebase show", "track plots.csv --tracker", "rulebase new -o y.yaml", "surface", "certify"],
)
@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("x.fcl", "x.fcl: a file of IEC 61131-7, which is not read; .yaml, .fis (MATLAB) and .fll"),
        ("x.yaml.gz", "x.yaml.gz: is compressed; unpack it, and name the file .yaml"),
    ],
)
def test_files_that_are_no_rule_bases(fails, plots, monkeypatch, command, file, message):
    monkeypatch.chdir(plots.parent)
    assert fails(*command.split(), file).startswith(f"error: {message}")


@pytest.mark.parametrize(
    ("tracker", "message"),
    [
        ("fixed:alpha=0.5,beta=0.2", "write fixed:alpha=0.5:beta=0.2"),
        ("fixed:alpha=0.5 , beta=0.2", "write fixed:alpha=0.5:beta=0.2"),
        (
            "alpha=0.5,beta=0.2",
            "parameters have colons between them; write NAME:alpha=0.5:beta=0.2",
        ),
        ("alpha=0.5", "a name is missing; write NAME:alpha=0.5"),
        ("my,a=1.yaml:gate=2,start=one-point", "write my,a=1.yaml:gate=2:start=one-point"),
        # What stands in the path of a file is no parameter.
        ("my,a=1.yaml", "cannot read rule base 'my,a=1.yaml': No such file"),
    ],
)
def test_parameters_of_a_tracker_that_are_written_otherwise(fails, plots, tracker, message):
    assert message in fails("track", plots, "--tracker", tracker)


def test_parameters_in_a_list_of_trackers(fails):
    assert fails("testbed", "strong", "--trackers", "fixed:alpha=0.5,beta=0.2") == (
        "error: --trackers: 'beta=0.2' is a parameter; a colon stands before it: "
        "fixed:alpha=0.5:beta=0.2"
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("track a.csv --runs 5", "error: No such option: --runs; it belongs to demo, compare, "),
        (
            "surface maneuver --json",
            "error: No such option: --json; it belongs to demo, sample, track, scan, and ",
        ),
        ("cache --at E=1", "error: No such option: --at; it belongs to surface, rulebase explain"),
        (
            "track a.csv --trackers maneuver",
            "error: No such option: --trackers; did you mean --tracker?",
        ),
        ("cache --nothing-like-it", "error: No such option: --nothing-like-it (see "),
        ("cache -q", "error: No such option: -q (see "),
        ("trak a.csv", "error: No such command 'trak'"),
    ],
)
def test_options_and_commands_that_do_not_exist(fails, words, message):
    assert fails(*words.split()).startswith(message)


def test_a_unit_after_a_number(fails, plots):
    assert fails("track", plots, "--sigma", "2m") == (
        f"error: {plots}: --sigma: '2m' is no number; write it without a unit"
    )


def test_a_tracker_that_needs_the_noise_is_named(fails, csv):
    few = csv("t,x\n0,0\n1,1\n2,2\n")
    assert fails("track", few, "--tracker", "kalman-cv:sigma_v=1") == (
        "error: --sigma: kalman-cv:sigma_v=1 needs the standard deviation of the plots (m)"
    )


def test_a_note_about_too_few_plots_names_the_column(run, csv):
    result = run("track", csv("t,up\n0,0\n1,1\n2,2\n"), "--axes", "up")
    assert "too few plots to estimate their noise: up has 0 runs" in result.stderr


@pytest.mark.parametrize("columns", [("--axes", "x"), ("--angle", "x")])
def test_a_site_of_one_coordinate(fails, plots, columns):
    line = fails("track", plots, *columns, "--site", "50,8")
    assert line == "error: --site: one coordinate has no place on earth; leave it out"
