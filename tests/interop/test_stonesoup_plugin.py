"""Stone Soup finds the package, and it is missed in one line where Stone Soup is not installed."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def run(code, *paths):
    path = os.pathsep.join(map(str, (*paths, ROOT)))
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def installed(tmp_path):
    """Folder with the entry points of pyproject.toml, as an installation has them."""
    info = tmp_path / "fuzzytrack-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: fuzzytrack\nVersion: 0\n")
    lines = []
    for group, names in PROJECT["entry-points"].items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in names.items())]
    (info / "entry_points.txt").write_text("\n".join(lines))
    return tmp_path


def test_stone_soup_finds_the_plug_in(installed):
    done = run(
        "from stonesoup.plugins.fuzzytrack import GainScheduledUpdater as U\n"
        "from stonesoup.serialise import YAML\n"
        "u = U('fixed:alpha=0.5:beta=0.2', [0], [1])\n"
        "print(YAML().load(YAML().dumps(u)).tracker)",
        installed,
    )
    assert (done.stdout.strip(), done.stderr) == ("fixed:alpha=0.5:beta=0.2", "")


ABSENT = "import sys\nsys.modules['stonesoup'] = None\n"


def test_without_stone_soup_one_line_says_what_to_install():
    done = run(
        f"{ABSENT}try:\n    import fuzzytrack.interop.stonesoup\n"
        "except Exception as error:\n    print(type(error).__name__, error)"
    )
    assert done.stdout == (
        "ImportError fuzzytrack.interop.stonesoup needs Stone Soup, which is not installed; "
        "pip install 'fuzzytrack[stonesoup]'\n"
    )
    assert done.stderr == ""


def test_nothing_else_needs_stone_soup():
    done = run(
        f"{ABSENT}import fuzzytrack as ft, fuzzytrack.interop, fuzzytrack.cli.app\n"
        "ft.AlphaBetaTracker('omega-schedule').run([0, 1, 2], [0, 1, 2], 1)\n"
        "print([name for name in sys.modules if name.startswith('fuzzytrack.interop.')])"
    )
    assert (done.stdout.strip(), done.stderr) == ("[]", "")
