"""The example of the guide, and what the page says that it gives."""

import numpy as np
import pytest
from test_documentation import ROOT, blocks, find_stone_soup

import fuzzytrack as ft
from fuzzytrack.interop.stonesoup import from_stonesoup, stonesoup_metrics


def test_the_guide(monkeypatch):
    find_stone_soup(monkeypatch)
    page = ROOT / "docs" / "stonesoup.md"
    names = {"np": np, "ft": ft}
    for block in blocks(page, "python"):
        exec(compile(block, str(page), "exec"), names)
    assert "len(tracks)                                  # 2\n" in page.read_text()
    assert len(names["tracks"]) == 2
    true, times, epoch = names["true"], names["times"], names["begin"]
    for tracks in (names["tracks"], names["theirs"]):
        positions = from_stonesoup(tracks, epoch=epoch)
        ours = ft.score(positions, true, order=1, scans=times).groups[0].metrics
        theirs = stonesoup_metrics(tracks, true, epoch=epoch)
        for name in ("ospa", "gospa"):
            assert 0.1 < ours[name] < 8.0
            assert theirs[name] == pytest.approx(ours[name])
        assert theirs["completeness"] == 1.0
