"""Commands of guides run in order, and give what the pages show."""

import re
import shlex
from pathlib import Path

import pytest
from test_documentation import ROOT, WALK, blocks
from typer.testing import CliRunner

from fuzzytrack.cli.app import app
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.conversion import translated
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.loading import load_rulebase


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    runner = CliRunner()

    def call(words, *more):
        program, *arguments = shlex.split(words)
        assert program == ".venv/bin/fuzzytrack"
        result = runner.invoke(app, [*arguments, *more], catch_exceptions=False)
        assert result.exit_code == 0, f"{words}\n{result.output}"
        return [line.split() for line in result.output.splitlines()]

    return call


@pytest.mark.untraced
@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.CacheWarning")
def test_the_guide_of_certificates(run):
    page = ROOT / "docs" / "certify.md"
    commands = list(WALK["commands"](page.read_text()))
    assert len(commands) >= 8
    for words, expected in commands:
        printed = run(words)
        for line in expected:
            assert line.split() in printed, f"{words}\n{line}"
        if "rulebase new" in words:
            # What the page says to change in the copy.
            (changed,) = blocks(page, "yaml")
            mine = Path("mine.yaml")
            text, count = re.subn(
                r"^  damping:.*?\n\n", f"{changed}\n", mine.read_text(), flags=re.M | re.S
            )
            assert count == 1
            mine.write_text(text)


@pytest.mark.untraced
@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.CacheWarning")
def test_the_guide_of_tuning(run):
    """A search of a few trials stands for those of the page, so the numbers are others."""
    commands = list(WALK["commands"]((ROOT / "docs" / "tune.md").read_text()))
    assert len([words for words, _ in commands if " tune " in words]) >= 3
    for words, expected in commands:
        tunes = words.startswith(".venv/bin/fuzzytrack tune")
        printed = run(words, *(("--trials", "4", "--folds", "2") if tunes else ()))
        if not tunes:
            assert [line.split() for line in expected if line.split() not in printed] == []
            continue
        for line in filter(None, expected):
            # The first word of each line: of a row, and of the verdict whatever it is.
            first = line.removeprefix("not ").split()[0]
            rows = [row for row in printed if first in row[:2]]
            assert rows, f"{words}\n{line}"
            if first == "start":
                # It was not searched, and all tracks are held out once.
                assert rows[0][2] == line.split()[2]
    assert Path("tuned.yaml").read_text().count("# Tuned on radar.csv with seed 0") == 1
    assert Path("tracks.csv").read_text().startswith("track,time,")
    assert Path("tracks.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.CacheWarning")
def test_the_guide_from_plots_to_tracks(run):
    commands = list(WALK["commands"]((ROOT / "docs" / "scan.md").read_text()))
    assert any(" scan " in words for words, _ in commands)
    for words, expected in commands:
        printed = run(words)
        assert [line for line in expected if line.split() not in printed] == []
    assert Path("tracks.csv").read_text().startswith("t,track_id,x,y,")
    assert Path("tracks.png").read_bytes().startswith(b"\x89PNG")


def test_the_guide_of_other_programs(run):
    page = ROOT / "docs" / "other-programs.md"
    (file,) = (text for text in blocks(page, "text") if text.startswith("[System]"))
    Path("heater.fis").write_text(file, encoding="utf-8")
    commands = list(WALK["commands"](page.read_text()))
    assert len(commands) == 4
    for words, expected in commands:
        printed = run(words)
        assert [line for line in expected if line.split() not in printed] == [], words
    notes = [text for text in blocks(page, "text") if text.startswith("note: ")]
    rules = load_rulebase("heater.yaml")
    assert [f"note: {note}\n" for note in translated(rules, "x.fll").notes] == notes
    (refused,) = (text for text in blocks(page, "text") if text.startswith("heater.fis:3"))
    with pytest.raises(RuleBaseError) as error:
        loads_fis(file.replace("'mamdani'", "'mamdanitype2'"), "heater.fis")
    assert f"{error.value}\n" == refused
    names = {}
    (code,) = blocks(page, "python")
    exec(compile(code, str(page), "exec"), names)
    assert f"# {names['opening']:.2f}\n" in code
