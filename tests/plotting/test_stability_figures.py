import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from fuzzytrack.gains import Region, from_abc, is_stable, noise_ratio, poles, region
from fuzzytrack.plotting import plot_noise_surfaces, plot_stability_regions, plot_stability_volume
from fuzzytrack.plotting.noise import _noise_surface
from fuzzytrack.plotting.stability import _surfaces

VOLUMES = [(s, what) for s in ("gains", "abc") for what in ("bounds", "critical", "dividing")]


def nothing_is_clipped(figure):
    figure.canvas.draw()
    tight, whole = figure.get_tightbbox(), figure.bbox_inches
    assert min(tight.x0, tight.y0) >= -0.01
    assert tight.x1 <= whole.x1 + 0.01
    assert tight.y1 <= whole.y1 + 0.01


def test_regions_are_those_of_the_theory():
    figure, ax = plot_stability_regions()
    names = {
        "Ia": Region.UNDERDAMPED,
        "Ib": Region.UNDERDAMPED_NEGATIVE,
        "IIa": Region.OVERDAMPED,
        "IIb": Region.NYQUIST,
        "α > 1": Region.MIXED,
    }
    drawn = {c.get_label().split(":")[0]: c.get_paths()[0] for c in ax.collections}
    assert set(drawn) == set(names)
    points = np.random.default_rng(0).uniform((0, 0), (2, 4), (400, 2))
    for name, path in drawn.items():
        inside = path.contains_points(points, radius=-0.01) | path.contains_points(
            points, radius=0.01
        )
        sure = path.contains_points(points, radius=-0.01) & path.contains_points(
            points, radius=0.01
        )
        found = region(*points.T)
        assert (found[sure] == names[name]).all()
        assert (found[~inside] != names[name]).all()
    for text in ax.texts:
        assert region(*text.get_position()) == names[text.get_text()]
    nothing_is_clipped(figure)


@pytest.mark.parametrize(("space", "surfaces"), VOLUMES)
def test_volume(space, surfaces):
    figure, ax = plot_stability_volume(space, surfaces)
    assert len(ax.collections) == len(_surfaces(surfaces))
    assert "γ" in ax.get_zlabel() or space == "abc"
    limits = (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())
    for line in ax.lines:
        for values, (low, high) in zip(line.get_data_3d(), limits, strict=True):
            assert np.min(values) >= low - 1e-12
            assert np.max(values) <= high + 1e-12
    nothing_is_clipped(figure)


def test_bounds_are_on_the_edge_of_stability():
    for label, _, mesh in _surfaces("bounds"):
        triple = from_abc(*(m[1:-1, 1:-1] for m in mesh))
        if "γ = 0" in label:
            assert (triple[2] == 0).all()
            continue
        np.testing.assert_allclose(np.abs(poles(*triple)).max(axis=-1), 1, atol=1e-7)


def test_surfaces_inside_have_equal_or_turned_poles():
    for _, _, mesh in _surfaces("critical"):
        a, b, _ = mesh
        np.testing.assert_allclose((a + b) ** 2, 4 * b, atol=1e-12)
    for label, _, (a, b, _) in _surfaces("dividing"):
        np.testing.assert_allclose(
            a if label.startswith("a = 1") else a + b, 1 if label[0] == "a" else 2
        )


@pytest.mark.parametrize("level", [0.2, 1.0, 10.0, 50.0])
def test_noise_surface_has_its_noise_ratio(level):
    a, b, c = _noise_surface(level)
    good = (c > -1) & (b > 1e-6) & (4 - 2 * a - b > 1e-6)
    gains = from_abc(a[good], b[good], c[good])
    assert is_stable(*gains).all()
    assert good.mean() > 0.7
    np.testing.assert_allclose(noise_ratio(*gains), level, rtol=1e-6)


@pytest.mark.parametrize("space", ["gains", "abc"])
def test_noise_surfaces(space):
    figure, ax = plot_noise_surfaces([1, 10], space)
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts == ["ρ² = 1", "ρ² = 10"]
    assert len(ax.collections) == 2
    nothing_is_clipped(figure)


def test_given_axes():
    figure = Figure()
    flat, solid = figure.add_subplot(121), figure.add_subplot(122, projection="3d")
    assert plot_stability_regions(ax=flat) == (figure, flat)
    assert plot_stability_volume(ax=solid) == (figure, solid)
    assert plot_noise_surfaces(ax=solid) == (figure, solid)
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: plot_stability_volume("w"), "space: unknown 'w'; one of gains, abc"),
        (lambda: plot_stability_volume("abc", "all"), "surfaces: unknown 'all'"),
        (lambda: plot_stability_volume(ax=Figure().subplots()), "projection='3d'"),
        (lambda: plot_noise_surfaces([1], "w"), "space: unknown 'w'"),
        (lambda: plot_noise_surfaces([]), "levels must be one or more increasing"),
        (lambda: plot_noise_surfaces([-1]), "levels must be finite and > 0, got -1"),
    ],
)
def test_wrong_arguments(call, message):
    with pytest.raises(ValueError, match=message):
        call()
    assert plt.get_fignums() == []
