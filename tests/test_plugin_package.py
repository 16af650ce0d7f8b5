"""The example plug-in and fuzzytrack's own wheel, installed and run in a fresh environment."""

import json
import os
import re
import subprocess
import sysconfig
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Fresh environment with both packages; only their dependencies are shared with this one."""
    home = tmp_path_factory.mktemp("environment")
    venv.create(home, with_pip=True)
    scripts = home / ("Scripts" if os.name == "nt" else "bin")
    python = scripts / "python"
    site = subprocess.run(
        [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()
    # The folder is put on the path, but its .pth files are not read: an editable fuzzytrack in it
    # stays invisible, and the wheel is what is tested.
    (Path(site) / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    packages = [str(ROOT), str(ROOT / "examples" / "plugin")]
    done = subprocess.run(
        [python, "-m", "pip", "install", "-qq", "--no-deps", *packages],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return scripts, Path(site)


def run(*command, cwd):
    environ = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "COV", "PYTEST"))}
    return subprocess.run(
        [str(part) for part in command], cwd=cwd, env=environ, capture_output=True, text=True
    )


def test_the_plugin_passes_its_own_tests(environment):
    scripts, _ = environment
    tests = ROOT / "examples" / "plugin" / "tests"
    command = (scripts / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", tests)
    done = run(*command, cwd=ROOT / "examples" / "plugin")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "passed" in done.stdout


def test_the_command_line_lists_the_plugin(environment, tmp_path):
    scripts, _ = environment
    done = run(scripts / "fuzzytrack", "trackers", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = {row["name"]: row for row in json.loads(done.stdout)}
    assert rows["two-speed"]["package"] == "fuzzytrack-two-speed"
    assert rows["averaged"]["kind"] == "tracker"
    assert rows["soft-sign"]["kind"] == "normalization"


def test_the_command_line_tracks_with_the_plugin(environment, tmp_path):
    scripts, _ = environment
    (tmp_path / "plots.csv").write_text("t,x\n0,0\n1,10\n2,21\n3,\n4,41\n")
    words = ("track", "plots.csv", "--tracker", "averaged:quiet=0.2", "--json")
    done = run(scripts / "fuzzytrack", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["total"]["alpha"] == 0.5


CONFIGURATION = """\
name: mine
based_on: default
association: {part: first-come, bonus: 2}
"""


def test_a_configuration_names_the_association(environment, tmp_path):
    scripts, _ = environment
    (tmp_path / "mine.yaml").write_text(CONFIGURATION)
    done = run(scripts / "fuzzytrack", "scanner", "check", "mine.yaml", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)[0]["association"] == {"part": "first-come", "bonus": 2.0}
    done = run(scripts / "fuzzytrack", "scanner", "parts", "association", "--json", cwd=tmp_path)
    found = {row["part"]: row["package"] for row in json.loads(done.stdout)}
    assert found["first-come"] == "fuzzytrack-two-speed"
    (tmp_path / "mine.yaml").write_text(CONFIGURATION.replace("bonus: 2", "bonus: -2"))
    done = run(scripts / "fuzzytrack", "scanner", "check", "mine.yaml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("mine.yaml:3:40: association: bonus must be a number >= 0")


def test_a_scan_tracker_with_the_association_tracks(environment, tmp_path):
    """In plain Python: nothing is compiled, so that the test takes no longer than it must."""
    scripts, _ = environment
    (tmp_path / "mine.yaml").write_text(CONFIGURATION)
    code = """
import numpy as np
from fuzzytrack.scan import Scan
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.scanners import load_scanner

session = ScanSession(load_scanner("mine.yaml"), plain=True)
for k in range(12):
    plots = np.array([[3.0 * k, 50.0], [-80.0, 4.0 * k]])
    reports = session.step(Scan(1.7 * k, plots))
print(*reports.track_id)
"""
    done = run(scripts / "python", "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["1", "2"]


@pytest.mark.parametrize(
    ("page", "module", "words"),
    [
        ("write-a-tracker", "averaged", ('@trackers.register("averaged")\n', ", trackers")),
        ("formats", "sonar_log", ('@readers.register("sonar-log")\n', ", readers")),
    ],
)
def test_the_plugin_is_that_of_the_page(page, module, words):
    text = (ROOT / "docs" / f"{page}.md").read_text()
    code = re.search(r"^```python\n(.*?)^```", text, re.M | re.S)[1]
    package = ROOT / "examples" / "plugin" / "fuzzytrack_two_speed" / f"{module}.py"
    # An entry point stands in the place of the decorator.
    for word in words:
        code = code.replace(word, "")
    assert package.read_text().endswith(code)


def test_the_wheel_carries_rule_bases_and_configurations(environment, tmp_path):
    scripts, site = environment
    code = (
        "import fuzzytrack as ft; print(ft.__file__); "
        "print(*(ft.load_rulebase(name).name for name in ft.shipped_rulebases())); "
        "print(*(ft.load_scanner(name).name for name in ft.shipped_scanners()))"
    )
    done = run(scripts / "python", "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    where, names, scanners = done.stdout.splitlines()
    assert Path(where).is_relative_to(site)
    assert "stiffness-damping" in names.split()
    assert {"default", "zhang-jiang"} <= set(scanners.split())
