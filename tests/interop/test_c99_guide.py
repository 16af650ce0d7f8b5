"""The example of the guide about C, compiled, and what the page says that it prints."""

import shutil
import subprocess

import numpy as np
import pytest
from test_documentation import ROOT, WALK, blocks
from typer.testing import CliRunner

import fuzzytrack as ft
from fuzzytrack.cli.app import app

PAGE = ROOT / "docs" / "c99.md"


@pytest.mark.untraced
@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_the_guide(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (program,) = blocks(PAGE, "c")
    (tmp_path / "node.c").write_text(program)
    for words, expected in WALK["commands"](PAGE.read_text()):
        first, *arguments = words.split()
        if first == ".venv/bin/fuzzytrack":
            result = CliRunner().invoke(app, arguments, catch_exceptions=False)
            assert result.exit_code == 0, result.output
            found = result.stdout
        else:
            done = subprocess.run([first, *arguments], capture_output=True, text=True, check=True)
            found = done.stdout
        assert found.splitlines() == [line for line in expected if line], words


def test_the_numbers_of_the_guide_are_those_of_the_package():
    plots = [[0, 0], [31, 9], [58, 21], [np.nan, np.nan], [124, 38]]
    filtered = ft.AlphaBetaTracker("stiffness-damping").run(range(5), plots).filtered
    page = PAGE.read_text()
    for k, (x, y) in enumerate(filtered):
        assert f"{k} s: x {x:.2f} m, y {y:.2f} m\n" in page
    outputs = ft.FuzzySystem("stiffness-damping")(E=0.3, dE=-0.2)
    assert "stiffness {stiffness:.4f}, damping {damping:.4f}\n".format(**outputs) in page
