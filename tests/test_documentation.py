"""The code on the pages runs, and the rule bases on them load."""

import re
import runpy
import shlex
import shutil
import sys
import tomllib
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from typer.testing import CliRunner

import fuzzytrack as ft
from fuzzytrack.cli.app import COMMANDS, app
from fuzzytrack.io.formats import write_table
from fuzzytrack.io.readers import readers
from fuzzytrack.normalizations import normalizations
from fuzzytrack.scan.scanners.roles import ROLES
from fuzzytrack.schedulers import schedulers
from fuzzytrack.simulation import make_sample
from fuzzytrack.trackers import trackers

ROOT = Path(__file__).resolve().parents[1]
REGISTRIES = (schedulers, trackers, normalizations, readers)
# README and quickstart are walked by `make walk`; what it finds on a page is found here.
WALK = runpy.run_path(str(ROOT / ".ci" / "walk.py"))
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "papers").glob("*.md")),
]


def blocks(page, language):
    return WALK["blocks"](page.read_text(), language)


def shown_files(page):
    """Files that a page shows in full: their names, followed by their text."""
    return re.findall(
        r"^`([\w.]+)`[^\n]*:\n\n```text\n(.*?)^```", page.read_text(), flags=re.M | re.S
    )


@pytest.fixture
def a_folder_with_plots(tmp_path, monkeypatch):
    """Files of plots under the names that pages use, in the working directory."""
    (tmp_path / "plots.csv").write_text("t,x,y\n0,0.0,0.0\n1,10.2,4.9\n2,,\n3,31.0,15.3\n")
    write_table(tmp_path / "radar.csv", make_sample("radar").plots)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")


def find_stone_soup(monkeypatch):
    """Make it know the plug-in, as it does after an installation with these entry points."""
    pytest.importorskip("stonesoup", reason="Stone Soup is not installed")
    plugin = import_module("fuzzytrack.interop.stonesoup")
    monkeypatch.setitem(sys.modules, "stonesoup.plugins.fuzzytrack", plugin)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
@pytest.mark.usefixtures("a_folder_with_plots")
def test_python_on_the_page_runs(page, monkeypatch):
    if page.stem == "stonesoup":
        find_stone_soup(monkeypatch)
    if page.stem == "c99" and not any(map(shutil.which, ("cc", "gcc", "clang"))):
        pytest.skip("no C compiler is installed")
    registries = (*REGISTRIES, *ROLES.values())
    known = {registry: registry.names() for registry in registries}
    rules = ft.load_rulebase("stiffness-damping")
    for name, text in shown_files(page):
        Path(name).write_text(text)
    # Classes of the page pickle: they can be found in a module.
    module = ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)
    vars(module).update(
        {
            # What a reader has at hand from the pages before.
            "ft": ft,
            "np": np,
            "rules": rules,
            "system": ft.FuzzySystem(rules),
            "tracker": ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)),
            "t": np.arange(4.0),
            "z": np.array([0.0, 10.0, 19.0, 31.0]),
            "z0": 0.0,
            "t0": 0.0,
            "z1": 1.0,
            "t1": 1.0,
            "MyScheduler": lambda: ft.FixedGains(0.5, 0.2),
        }
    )
    try:
        for block in blocks(page, "python"):
            exec(compile(block, str(page), "exec"), vars(module))
    finally:
        for registry in registries:
            for name in set(registry.names()) - set(known[registry]):
                registry.unregister(name)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_rule_bases_on_the_page_load(page):
    for block in blocks(page, "yaml"):
        if block.startswith("rulebase:"):
            ft.loads_rulebase(block, page.name)


@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.CacheWarning")
@pytest.mark.parametrize(
    ("page", "number"),
    [("docs/real-data.md", 10), ("docs/which-tracker.md", 5), ("docs/score.md", 2)],
)
def test_commands_on_pages_about_files_run(page, number, tmp_path, monkeypatch):
    """Their files are those on the page; of the output, each line that is shown is there."""
    page = ROOT / page
    monkeypatch.chdir(tmp_path)
    for name, text in shown_files(page):
        (tmp_path / name).write_text(text)
    commands = list(WALK["commands"](page.read_text()))
    assert len(commands) >= number
    runner = CliRunner()
    for words, expected in commands:
        program, *arguments = shlex.split(words)
        assert program == ".venv/bin/fuzzytrack"
        result = runner.invoke(app, arguments, catch_exceptions=False)
        fails = any(line.startswith("error:") for line in expected)
        assert result.exit_code == (2 if fails else 0), f"{words}\n{result.output}"
        found = [line.split() for line in result.output.splitlines()]
        for line in expected:
            assert line.split() in found, f"{words}\n{line}\nis not in\n{result.output}"


def test_the_page_of_installation_has_every_extra():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    page = (ROOT / "docs" / "install.md").read_text()
    rows = re.findall(r"^\| `fuzzytrack\[(\w+)\]` \| (\w+)", page, flags=re.M)
    assert [name for name, _ in rows] == list(project["optional-dependencies"])
    for name, first in rows[:-4]:
        assert project["optional-dependencies"][name][0].startswith(first)


def test_the_page_of_commands_has_every_command():
    page = (ROOT / "docs" / "cli.md").read_text()
    listed = re.findall(r"^\| `fuzzytrack ([a-z]+)", page, flags=re.M)
    assert sorted(listed) == sorted(COMMANDS)


def test_there_is_something_to_run():
    assert sum(len(blocks(page, "python")) for page in PAGES) >= 8
    assert any(b.startswith("rulebase:") for page in PAGES for b in blocks(page, "yaml"))


def test_the_page_of_plugins_lists_every_registry():
    page = (ROOT / "docs" / "plugins.md").read_text()
    table = re.findall(r"^\| [\w ]+ \| \{class\}.* \| `(fuzzytrack\.\w+)` \|$", page, flags=re.M)
    assert sorted(table) == sorted(registry.group for registry in REGISTRIES)
