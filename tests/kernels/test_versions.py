"""The versions of Numba that were tried; see `fuzzytrack.kernels` for why that matters."""

import tomllib
from importlib.metadata import version
from pathlib import Path

from packaging.requirements import Requirement

PYPROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def test_the_installed_numba_was_tried():
    listed = tomllib.loads(PYPROJECT.read_text())["project"]["dependencies"]
    for name in ("numba", "llvmlite"):
        (tried,) = (r for r in map(Requirement, listed) if r.name == name)
        assert {bound.operator for bound in tried.specifier} == {">=", "<"}
        assert version(name) in tried.specifier, (
            f"{name} {version(name)} is installed, and fuzzytrack was tried with "
            f"{name}{tried.specifier} only. It uses private parts of Numba: run `python -m pytest "
            "tests/kernels tests/lanes tests/trackers`, and if all but this test pass, change the "
            f'line "{tried}" in pyproject.toml.'
        )
