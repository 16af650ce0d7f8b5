import importlib
import json
import math

import pytest

from fuzzytrack.papers import PAPERS, Reproduction, Row, reproduce
from fuzzytrack.papers.catalog import reproduce_all
from fuzzytrack.papers.reproduction import row
from fuzzytrack.papers.zhang_jiang.vessels import Traffic


@pytest.mark.parametrize(
    ("ours", "se", "verdict"),
    [
        (10.4, None, "matches"),
        (10.6, None, "differs"),
        (10.6, 0.1, "matches"),
        (9.2, 0.1, "differs"),
    ],
)
def test_a_verdict_allows_for_rounding_and_two_standard_errors(ours, se, verdict):
    found = row("Table 1", "speed (m/s)", ours, published=10.0, within=0.5, se=se)
    assert found == Row("Table 1", "speed (m/s)", 10.0, ours, se, None, verdict)


def test_what_is_not_published_has_no_verdict():
    assert row("Fig. 2", "peak (m)", 3.0, se=math.nan).verdict == "not stated"
    assert row("Fig. 2", "peak (m)", 3.0, se=math.nan).se is None


def test_a_quantity_is_found_in_its_table():
    rows = (row("A", "x", 1.0), row("B", "x", 2.0), row("B", "y", 3.0))
    found = Reproduction("p", "title", rows)
    assert found.ours("y") == 3.0
    assert found.ours("x", "B") == 2.0
    for quantity in ("x", "z"):
        with pytest.raises(KeyError, match=quantity):
            found.ours(quantity)


def test_json_has_the_rows():
    found = Reproduction("p", "title", (row("A", "x", 1.0, published=2.0),), ("a note",))
    text = json.loads(json.dumps(found.to_json_dict()))
    assert text["rows"] == [
        {
            "table": "A", "quantity": "x", "published": 2.0, "ours": 1.0,
            "se": None, "runs": None, "verdict": "differs", "why": "",
        }
    ]  # fmt: skip
    assert (text["paper"], text["notes"]) == ("p", ["a note"])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"name": "kim"}, "name: unknown paper 'kim'; one of alwagih-abdulla, kim-lee"),
        ({"name": "kim-lee", "runs": 0}, "runs must be at least 1, got 0"),
        ({"name": "kim-lee", "seed": -1}, "seed must not be negative, got -1"),
    ],
)
def test_bad_requests_are_named(wrong, message):
    with pytest.raises(ValueError, match=message):
        reproduce(**wrong)


@pytest.mark.parametrize("name", PAPERS)
def test_every_paper_has_its_module(name):
    module = importlib.import_module(f"fuzzytrack.papers.{PAPERS[name]}")
    assert module.RUNS >= 1
    assert callable(module.reproduce)


@pytest.mark.parametrize("paper", PAPERS)
def test_every_paper_runs_and_draws(paper, monkeypatch):
    """With two runs, and traced; the numbers are tested for each paper by itself."""
    from matplotlib import pyplot as plt

    few = Traffic(vessels=10, scans=30, clutter=5)
    monkeypatch.setattr("fuzzytrack.papers.zhang_jiang.reproduction.TRAFFIC", few)
    shares = []
    found = reproduce(paper, 2, progress=shares.append)
    assert found.rows
    assert all(isinstance(r.ours, float) for r in found.rows)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    for draw in found.pictures.values():
        plt.close(draw())


def test_progress_of_several_papers_rises_to_1(monkeypatch):
    shares = []
    cost = {"zhang-jiang": 0.3, "kim-lee": 0.1}
    monkeypatch.setattr("fuzzytrack.papers.catalog._COST", cost)

    def made(runs, seed, progress):
        progress(0.5)
        progress(1.0)
        return (runs, seed)

    for name in ("kim_lee", "zhang_jiang"):
        monkeypatch.setattr(f"fuzzytrack.papers.{name}.reproduce", made)
    found = reproduce_all(["zhang-jiang", "kim-lee"], 3, 5, shares.append)
    assert found == [(3, 5), (3, 5)]
    assert shares == pytest.approx([0.375, 0.75, 0.875, 1.0])
