"""Imports point down the layers and in no circle; files are named after what they hold."""

import importlib
import re
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from import_graph import circles, import_graph, modules_of

from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import schedulers
from fuzzytrack.trackers import trackers

PACKAGE = Path(__file__).resolve().parents[1] / "fuzzytrack"
ARCHITECTURE = PACKAGE.parent / "docs" / "architecture.md"
MODULES = modules_of(PACKAGE)


pytestmark = pytest.mark.untraced


@cache
def graph_of_package():
    """Made in a test: every process that tests are distributed to collects all of them."""
    return import_graph(PACKAGE)


def layers(text):
    """Rooms of each layer, from the bottom up, out of the table of layers in the docs."""
    section = text.partition("## Layers\n")[2].partition("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    return [re.findall(r"`(\w+)`", cell) for cell in reversed(rows)]


# Rooms that share a layer do not import each other.
LEVEL = {
    room: level for level, rooms in enumerate(layers(ARCHITECTURE.read_text())) for room in rooms
}


def room_of(module):
    """First part of a name below the package; the package itself for its ``__init__``."""
    return module.split(".")[:2][-1]


@pytest.mark.parametrize("module", MODULES)
def test_imports_point_down(module):
    mine = room_of(module)
    assert mine in LEVEL, f"{mine} has no layer: give it one in docs/architecture.md"
    for other in map(room_of, graph_of_package()[module]):
        if other != mine:
            assert LEVEL[other] < LEVEL[mine], f"{mine} must not import {other}"


def test_no_circle_of_imports():
    assert circles(graph_of_package()) == []


def test_only_kernels_imports_numba():
    numba = re.compile(r"^\s*(?:import|from) (?:numba|llvmlite)\b", re.MULTILINE)
    found = {
        room_of(".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts))
        for path in PACKAGE.rglob("*.py")
        if numba.search(path.read_text(encoding="utf-8"))
    }
    assert found == {"kernels"}


def test_only_the_command_line_names_its_options():
    option = re.compile(r"(?<![\w-])--[a-z]|[ \"]-o ")
    found = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        if option.search(path.read_text(encoding="utf-8"))
    }
    assert {path for path in found if not path.startswith("cli/")} == set()


# -------------------------------------------------------------------- names

# A normalization shares its file with its variants: the first word of its name is the file's.
NAMED_AS_REGISTERED = [
    *((plugin, plugin.name) for registry in (schedulers, trackers) for plugin in registry),
    *((plugin, plugin.name.partition("-")[0]) for plugin in normalizations),
]


@pytest.mark.parametrize(
    ("plugin", "name"), NAMED_AS_REGISTERED, ids=lambda value: getattr(value, "name", "")
)
def test_a_file_is_named_as_what_it_holds_is_registered(plugin, name):
    if plugin.package == "fuzzytrack":
        assert plugin.factory.__module__.rpartition(".")[2] == name.replace("-", "_")


@pytest.mark.parametrize("room", ["schedulers", "trackers", "normalizations"])
def test_all_that_is_registered_is_exported(room):
    module = importlib.import_module(f"fuzzytrack.{room}")
    for plugin in getattr(module, room):
        if plugin.package == "fuzzytrack":
            assert plugin.factory.__name__ in module.__all__


def test_no_two_modules_of_tests_have_one_name():
    """Tests import their helpers by name alone: in one process, the first of that name is found."""
    counts = Counter(path.name for path in Path(__file__).parent.rglob("*.py"))
    assert {name for name, n in counts.items() if n > 1} <= {"conftest.py"}


# -------------------------------------------------------------------- docs/architecture.md


def test_every_room_of_the_layers_exists():
    assert sorted(LEVEL) == sorted({room_of(module) for module in MODULES})


def test_every_module_that_the_docs_name_exists():
    text = ARCHITECTURE.read_text()
    paths = set(re.findall(r"`(\w+(?:/\w+)+)`", text))
    files = {str(path.relative_to(PACKAGE).with_suffix("")) for path in PACKAGE.rglob("*.py")}
    folders = {str(path.relative_to(PACKAGE)) for path in PACKAGE.rglob("*") if path.is_dir()}
    assert paths, "modules are written `room/module`"
    assert sorted(paths - files - folders) == []
    # Tables of modules: the head names the room, the first cell of a row its modules.
    tables = re.findall(r"\| Module of `(\w+)` \|.*\n\|[-|]+\|\n((?:\|.*\n)+)", text)
    assert tables
    for where, rows in tables:
        for row in rows.splitlines():
            for name in re.findall(r"`(\w+)`", row.split("|")[1]):
                assert f"{where}/{name}" in files | folders, f"{where} has no module {name}"


def test_the_reference_has_public_modules_only():
    pages = [path.read_text() for path in (ARCHITECTURE.parent / "api").glob("*.rst")]
    named = re.findall(r"^   (fuzzytrack[\w.]+)$", "\n".join(pages), re.MULTILINE)
    assert set(named) <= set(MODULES)
    assert len(named) == len(set(named))
    machinery = {module for module in named if room_of(module) in {"cli", "kernels", "lanes"}}
    # A plug-in that is a tracker is made of these.
    assert machinery == {f"fuzzytrack.lanes.{name}" for name in ("program", "start", "layout")}


# -------------------------------------------------------------------- the checks themselves


def tree(folder, sources):
    """Import graph of a package ``p`` of small modules, added to those that are there."""
    for name, source in sources.items():
        path = folder / "p" / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)
    return import_graph(folder / "p")


@pytest.mark.parametrize(
    "back",
    [
        "from p.a import x",
        "from p import a",
        "import p.a",
        "def f():\n    from p.a import x",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from p.a import x",
        "import importlib\ndef f():\n    importlib.import_module('p.a')",
        "from importlib import import_module\ndef f(name):\n    import_module(f'p.{name}')",
    ],
)
def test_a_circle_of_two_is_seen(tmp_path, back):
    graph = tree(tmp_path, {"a": "from p import b", "b": "from p.c import y", "c": back})
    assert circles(graph) == ["p.a -> p.b -> p.c -> p.a"]


def test_a_shortest_circle_is_told_for_each_group(tmp_path):
    sources = {
        "a": "import p.b",
        "b": "import p.c\nimport p.a",
        "c": "import p.a",
        "d": "import p.e",
        "e": "import p.d",
        "f": "import p.a\nimport p.d",
    }
    graph = tree(tmp_path, sources)
    assert circles(graph) == ["p.a -> p.b -> p.a", "p.d -> p.e -> p.d"]


def test_a_module_imports_the_init_of_its_own_package_only_by_name(tmp_path):
    sources = {"q/__init__": "from p.q.a import x", "q/a": "from p.q.b import y", "q/b": ""}
    assert circles(tree(tmp_path, sources)) == []
    graph = tree(tmp_path, {"q/b": "from p.q import x"})
    assert circles(graph) == ["p.q -> p.q.a -> p.q.b -> p.q"]


def test_a_module_imports_the_init_of_another_package_along(tmp_path):
    sources = {"q/__init__": "from p.q.a import x", "q/a": "from p.r.b import y", "r/b": ""}
    assert tree(tmp_path, sources)["p.q.a"] == {"p.r.b"}
    graph = tree(tmp_path, {"r/__init__": "import p.q.a"})
    assert graph["p.q.a"] == {"p.r", "p.r.b"}
    assert circles(graph) == ["p.q -> p.q.a -> p.r -> p.q"]


def test_a_method_plot_may_import_pictures_and_nothing_else_may(tmp_path):
    drawn = "class A:\n    def plot(self):\n        from p.plotting import draw"
    sources = {
        "a": drawn,
        "b": drawn.replace("plot(self)", "draw(self)"),
        "c": drawn.replace("plotting", "a"),
        "d": "def plot():\n    from p.plotting import draw",
        "plotting": "from p.a import A",
    }
    graph = tree(tmp_path, sources)
    assert graph["p.a"] == set()
    assert graph["p.b"] == graph["p.d"] == {"p.plotting"}
    assert graph["p.c"] == {"p.a"}


def test_relative_imports_are_refused(tmp_path):
    with pytest.raises(ValueError, match="line 2: write the import with the name of the package"):
        tree(tmp_path, {"a": "x = 1\nfrom . import b"})
