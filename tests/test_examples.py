"""Every example of the gallery runs as it stands."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("plot_*.py"))


def test_there_are_examples():
    assert EXAMPLES


# Other tests cover what it uses, with less of it; watched, it would take three times as long.
@pytest.mark.no_cover
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path, monkeypatch):
    pytest.importorskip("matplotlib")
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    monkeypatch.setattr(plt, "show", lambda *_, **__: pytest.fail("an example called show"))
    plt.close("all")
    try:
        runpy.run_path(str(path))
        for number in plt.get_fignums():
            plt.figure(number).canvas.draw()
        assert plt.get_fignums(), "an example of a gallery draws something"
    finally:
        plt.close("all")
