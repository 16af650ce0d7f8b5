import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fuzzytrack.cli.app import app
from fuzzytrack.fuzzy.loading import rulebase_path


@pytest.fixture
def run():
    """Run the command in this process; gives exit code, stdout and stderr."""
    runner = CliRunner()
    return lambda *words: runner.invoke(app, [str(word) for word in words])


@pytest.fixture
def fails(run):
    """Run a command that must fail in one line; gives that line."""

    def call(*words):
        result = run(*words)
        assert result.exit_code == 2, result.output
        lines = result.stderr.splitlines()
        assert len(lines) == 1, result.stderr
        assert result.stdout == ""
        return lines[0]

    return call


@pytest.fixture
def csv(tmp_path):
    """Write a file; gives its path."""

    def write(text, name="plots.csv"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.fixture
def plots(csv):
    return csv("t,x,y\n0,0,0\n1,10,5\n2,,\n3,31,15\n4,39,21\n")


@pytest.fixture
def real():
    """Path of a real data file, or skip."""
    beside = Path(__file__).resolve().parents[2].parent / "shared" / "data"
    folder = Path(os.environ.get("FUZZYTRACK_DATA", beside))

    def find(name):
        if not (folder / name).is_file():
            pytest.skip(f"no {name} in FUZZYTRACK_DATA or beside the project")
        return folder / name

    return find


@pytest.fixture
def mine(tmp_path):
    """A copy of a shipped rule base, to change."""
    path = tmp_path / "mine.yaml"
    path.write_bytes(rulebase_path("stiffness-damping").read_bytes())
    return path
