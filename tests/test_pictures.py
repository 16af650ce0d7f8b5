"""The page of all pictures, which the documentation generates."""

import importlib.util
from pathlib import Path

import pytest
from matplotlib import pyplot as plt

from fuzzytrack import plotting

PATH = Path(__file__).resolve().parents[1] / "docs" / "_extensions" / "pictures.py"


@pytest.fixture(scope="module")
def page():
    spec = importlib.util.spec_from_file_location("pictures", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_public_function_is_on_the_page(page):
    lines = [line for some in page.PICTURES.values() for line in some]
    assert {page.function_of(line) for line in lines} == set(plotting.__all__)
    assert len(set(lines)) == len(lines)


def test_the_page_names_each_file_beside_its_line(page, tmp_path, monkeypatch):
    lines = ['plot_surface("valve")', "plot_stability_regions()", 'plot_surface("tipper")']
    monkeypatch.setattr(page, "PICTURES", {"Some": lines[:2], "Others": lines[2:]})
    monkeypatch.setattr(page, "SETUP", "from fuzzytrack.plotting import *\n")
    before = plt.get_fignums()
    page.write(tmp_path)
    text = (tmp_path / "pictures.md").read_text()
    files = ["plot_surface-1.png", "plot_stability_regions-1.png", "plot_surface-2.png"]
    for line, file in zip(lines, files, strict=True):
        assert (tmp_path / "pictures" / file).read_bytes().startswith(b"\x89PNG")
        entry = text.split(f"pictures/{file}")[1].split("```")[0]
        assert line in entry
    assert text.index("## Some") < text.index(lines[0]) < text.index("## Others")
    assert plt.get_fignums() == before
