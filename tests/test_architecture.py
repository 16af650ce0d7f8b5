"""Imports point down the layers only, and files are named after what they hold."""

import ast
import importlib
from pathlib import Path

import pytest

from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import schedulers
from fuzzytrack.trackers import trackers

PACKAGE = Path(__file__).resolve().parents[1] / "fuzzytrack"

# From the bottom up; what shares a row does not know each other. See docs/architecture.md.
LAYERS = [
    {"arrays", "errors", "tasks"},
    {"plugins", "yamltree"},
    {"shipped"},
    {"gains", "kernels"},
    {"fuzzy", "io", "lanes", "normalizations"},
    {"schedulers"},
    {"trackers"},
    {"recordings", "simulation", "plotting", "testing"},
    {"testbed", "tuning"},
    {"papers", "reports"},
    {"cli"},
    {"__main__"},
]
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}


def imported_rooms(path):
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
            if node.module == "fuzzytrack":
                names = [f"fuzzytrack.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "fuzzytrack" and len(parts) > 1:
                yield parts[1]


MODULES = [p for p in sorted(PACKAGE.rglob("*.py")) if p != PACKAGE / "__init__.py"]


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_down(path):
    room = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    assert room in LEVEL, f"{room} has no layer: give it one here and in docs/architecture.md"
    for other in imported_rooms(path):
        if other in LEVEL and other != room:
            assert LEVEL[other] < LEVEL[room], f"{room} must not import {other}"


def test_the_check_sees_imports():
    assert "fuzzy" in set(imported_rooms(PACKAGE / "schedulers" / "fuzzy.py"))
    assert "gains" in set(imported_rooms(PACKAGE / "schedulers" / "fuzzy.py"))


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
