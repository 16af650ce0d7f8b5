"""The examples of the gallery: `make docs` runs each of them once, and fails if one fails."""

import re
import runpy
import warnings
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*/plot_*.py"))


@pytest.fixture(scope="module")
def gallery():
    with warnings.catch_warnings():
        return runpy.run_path(str(ROOT / "docs" / "conf.py"))["sphinx_gallery_conf"]


def test_the_documentation_runs_every_example(gallery):
    assert (ROOT / "docs" / gallery["examples_dirs"]).resolve() == ROOT / "examples"
    folders = {(ROOT / "docs" / each).resolve() for each in gallery["subsection_order"]}
    assert {path.parent for path in EXAMPLES} == folders
    assert gallery["abort_on_example_error"]
    assert not {"plot_gallery", "ignore_pattern", "expected_failing_examples"} & gallery.keys()
    assert len(EXAMPLES) >= 17
    for path in EXAMPLES:
        assert re.search(gallery["filename_pattern"], str(path))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_a_script_with_a_title_that_waits_for_nobody(path):
    source = path.read_text()
    compile(source, str(path), "exec")
    title, line, *_ = source.removeprefix('"""').lstrip().splitlines()
    assert line == "=" * len(line)
    assert len(line) >= len(title)
    assert ".show()" not in source
