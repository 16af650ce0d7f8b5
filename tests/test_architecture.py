"""Imports point down the layers only."""

import ast
from pathlib import Path

import pytest

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
