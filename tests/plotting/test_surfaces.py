import numpy as np
import pytest
from lopsided import lopsided
from matplotlib import pyplot as plt
from matplotlib.path import Path
from mpl_toolkits.mplot3d.axes3d import Axes3D

import fuzzytrack as ft
from fuzzytrack.errors import NoRuleFiresWarning
from fuzzytrack.fuzzy.rulebase import Consequent, Operators, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.gains import kalata
from fuzzytrack.plotting import plot_gain_surfaces, plot_relation, plot_surface


@pytest.fixture
def drawn(monkeypatch):
    """What goes into 3-D surfaces."""
    calls, draw = [], Axes3D.plot_surface

    def spy(self, x, y, z, **options):
        calls.append((self, x, y, z))
        return draw(self, x, y, z, **options)

    monkeypatch.setattr(Axes3D, "plot_surface", spy)
    return calls


def band(ax, x, y):
    """Levels between which a filled contour plot draws a point."""
    filled = ax.collections[0]
    for low, high, path in zip(
        filled.levels[:-1], filled.levels[1:], filled.get_paths(), strict=True
    ):
        # On even-odd terms, since holes are contours too.
        if sum(Path(polygon).contains_point((x, y)) for polygon in path.to_polygons()) % 2:
            return low, high
    raise AssertionError(f"nothing drawn at {x}, {y}")


def test_surface_has_each_value_at_its_place(rules, drawn):
    system = ft.FuzzySystem(rules)
    plot_surface(rules, points=7)
    ((ax, x, y, z),) = drawn
    # Every corner of the sets is a node, beside the even ones.
    np.testing.assert_allclose(x[:, 0], [0, 5 / 3, 10 / 3, 4, 5, 20 / 3, 25 / 3, 10])
    np.testing.assert_allclose(y[0], [-1, -2 / 3, -1 / 3, 0, 0.2, 1 / 3, 2 / 3, 1], atol=1e-12)
    assert (x.min(), x.max(), y.min(), y.max()) == (0, 10, -1, 1)
    np.testing.assert_array_equal(z, system(x=x, y=y)["u"])
    assert ax.get_xlabel() == "distance (m)"
    assert ax.get_ylabel() == "y"
    assert ax.get_zlabel() == "u (s)"
    scale = ax.figure.axes[1]
    assert scale.get_ylim() == pytest.approx((z.min(), z.max()))
    assert ax.get_zlim() == pytest.approx((z.min(), z.max()))


def test_map_has_each_value_at_its_place(rules):
    system = ft.FuzzySystem(rules)
    figure, (ax,) = plot_surface(rules, points=201, style="contour")
    for x, y in np.random.default_rng(2).uniform((0.2, -0.9), (9.8, 0.9), (60, 2)):
        low, high = band(ax, x, y)
        assert low - 0.05 <= system(x=x, y=y)["u"] <= high + 0.05
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("distance (m)", "y")
    assert (ax.get_xlim(), ax.get_ylim()) == ((0, 10), (-1, 1))
    assert figure.axes[1].get_ylabel() == "u (s)"


def test_all_outputs_side_by_side_or_one(shipped):
    _, axes = plot_surface(shipped, points=5)
    assert [ax.get_zlabel() for ax in axes] == ["stiffness", "damping"]
    assert axes[0].get_position().x1 <= axes[1].get_position().x0 + 0.1
    _, axes = plot_surface(shipped, "damping", points=5)
    assert [ax.get_zlabel() for ax in axes] == ["damping"]


def test_method_is_that_of_the_system_unless_given(rules, drawn):
    coarse = ft.FuzzySystem(rules, method="table", table_nodes=3)
    for given, method, system in (
        (coarse, None, coarse),
        (coarse, "table", coarse),
        (coarse, "exact", ft.FuzzySystem(rules)),
        (rules, "relation", ft.FuzzySystem(rules, "relation")),
    ):
        plot_surface(given, points=5, method=method)
        _, x, y, z = drawn[-1]
        np.testing.assert_array_equal(z, system(x=x, y=y)["u"])


def test_more_than_two_inputs_need_the_others(drawn):
    three = lopsided(extra_input=True)
    with pytest.raises(ValueError, match="at must give w"):
        plot_surface(three)
    assert plt.get_fignums() == []
    plot_surface(three, points=5, inputs=("y", "w"), at={"x": 3.0})
    (ax, y, w, z) = drawn[-1]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("y", "w")
    np.testing.assert_array_equal(z, ft.FuzzySystem(three)(x=3.0, y=y, w=w)["u"])


def test_one_input_gives_a_curve(valve):
    _, (ax,) = plot_surface(valve, points=31)
    (line,) = ax.lines
    x = np.linspace(0, 3, 31)
    np.testing.assert_array_equal(line.get_xdata(), x)
    np.testing.assert_array_equal(line.get_ydata(), ft.FuzzySystem(valve)(flow=x)["opening"])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("flow", "valve opening")


@pytest.mark.parametrize("style", ["surface", "contour"])
def test_constant_surface(rules, style):
    flat = RuleBase(
        "flat", rules.inputs, rules.outputs, (Rule((("x", "a"),), (Consequent("u", "c"),)),)
    )
    everywhere = RuleBase(
        "everywhere",
        rules.inputs,
        rules.outputs,
        tuple(Rule((("x", n),), (Consequent("u", "c"),)) for n in "abc"),
        Operators(defuzzification="weighted-centers"),
    )
    figure, _ = plot_surface(everywhere, points=5, style=style)
    figure.canvas.draw()
    # Where nothing fires there is a hole.
    with pytest.warns(NoRuleFiresWarning):
        figure, _ = plot_surface(flat, points=5, style=style)
    figure.canvas.draw()


@pytest.mark.parametrize("style", ["surface", "contour"])
def test_surface_without_any_value(rules, style):
    corner = RuleBase(
        "corner", rules.inputs, rules.outputs, (Rule((("x", "a"),), (Consequent("u", "c", 0.0),)),)
    )
    with pytest.warns(NoRuleFiresWarning):
        figure, _ = plot_surface(corner, points=5, style=style)
    figure.canvas.draw()


def test_gain_surfaces_go_through_the_w_domain(shipped, drawn):
    _, axes = plot_gain_surfaces(shipped, points=9)
    assert [ax.get_zlabel() for ax in axes] == ["position gain α", "velocity gain β"]
    (_, x, y, alpha), (_, _, _, beta) = drawn
    outputs = ft.FuzzySystem(shipped)(E=x, dE=y)
    expected = ft.alpha_beta_from_w(outputs["stiffness"], outputs["damping"])
    np.testing.assert_allclose([alpha, beta], expected, rtol=1e-14)


def with_outputs(rules, names):
    outputs = tuple(Variable(name, Universe(0, 8, 81), rules.outputs[0].sets) for name in names)
    concluded = tuple(
        Rule(rule.conditions, tuple(Consequent(n, rule.consequents[0].set_name) for n in names))
        for rule in rules.rules
    )
    return RuleBase("direct", rules.inputs, outputs, concluded)


def test_gain_surfaces_of_direct_gains_are_the_outputs(rules, drawn):
    base = ft.load_rulebase("chan-style")
    plot_gain_surfaces(base, points=5)
    (_, x, y, alpha), (_, _, _, beta) = drawn
    outputs = ft.FuzzySystem(base)(E=x, dE=y)
    np.testing.assert_array_equal(alpha, outputs["alpha"])
    np.testing.assert_array_equal(beta, outputs["beta"])
    _, axes = plot_gain_surfaces(
        with_outputs(rules, ("beta", "gamma", "alpha")), points=5, style="contour"
    )
    assert len(axes) == 3


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r, v: plot_surface(r, "v"), "output: unknown 'v'; one of u"),
        (lambda r, v: plot_surface(r, style="3d"), "style: unknown '3d'; one of surface, contour"),
        (lambda r, v: plot_surface(r, method="fast"), "method: unknown 'fast'; one of exact"),
        (lambda r, v: plot_surface(r, points=1), "points must be at least 2, got 1"),
        (lambda r, v: plot_surface(v, points=1), "points: must be at least 2, got 1"),
        (lambda r, v: plot_surface(v, at={"w": 1.0}), "inputs, at: only for several inputs"),
        (lambda r, v: plot_gain_surfaces(r), "rules: lopsided has outputs u; gains need"),
        (lambda r, v: plot_gain_surfaces(r, style="x"), "style: unknown 'x'"),
        (lambda r, v: plot_relation(r), "rules: lopsided has inputs x, y"),
        (lambda r, v: plot_relation(v, "flow"), "output: unknown 'flow'; one of opening"),
        (lambda r, v: plot_relation(v, at=3.5), r"at: must be within \[0, 3\], got 3.5"),
        (lambda r, v: plot_relation(v, at=float("nan")), "at: must be within"),
    ],
)
def test_wrong_arguments(call, message, rules, valve):
    with pytest.raises(ValueError, match=message):
        call(rules, valve)
    assert plt.get_fignums() == []


def test_relation_is_drawn_cell_by_cell(valve):
    figure, (ax,) = plot_relation(valve)
    (mesh,) = ax.collections
    matrix = ft.FuzzySystem(valve).relation("opening")
    np.testing.assert_array_equal(mesh.get_array(), matrix.T)
    corners = mesh.get_coordinates()
    middles = (corners[:-1, :-1] + corners[1:, 1:]) / 2
    x, y = valve.inputs[0].universe.values, valve.outputs[0].universe.values
    np.testing.assert_allclose(middles[:, :, 0], np.broadcast_to(x, (121, 121)), atol=1e-12)
    np.testing.assert_allclose(
        middles[:, :, 1], np.broadcast_to(y[:, None], (121, 121)), atol=1e-12
    )
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("flow", "valve opening")
    assert figure.axes[1].get_ylabel() == "membership in the relation"


def test_slice_is_the_column_and_its_crisp_value(valve):
    system = ft.FuzzySystem(valve)
    _, (image, cut) = plot_relation(system, at=1.25)
    assert image.lines[0].get_xdata()[0] == 1.25
    fuzzy, crisp = cut.lines
    np.testing.assert_array_equal(fuzzy.get_ydata(), system.relation("opening")[50])
    assert crisp.get_xdata()[0] == pytest.approx(system(flow=1.25)["opening"])
    texts = [t.get_text() for t in cut.get_legend().get_texts()]
    assert texts == ["fuzzy output, flow = 1.25", "crisp output 1.75"]
    assert cut.get_xlabel() == "valve opening"


def test_relation_of_weighted_centers_has_a_row_a_set(valve):
    base = RuleBase(
        "centers",
        valve.inputs,
        valve.outputs,
        valve.rules,
        Operators(defuzzification="weighted-centers"),
    )
    _, (image, cut) = plot_relation(base, at=0.5)
    assert [t.get_text() for t in image.get_yticklabels()] == ["zero", "small", "medium", "large"]
    (spikes,) = (c for c in cut.collections if c.get_label().startswith("fuzzy output"))
    tops = {round(s[0][0], 6): s[1][1] for s in spikes.get_segments()}
    assert tops == {0.0: 0.0, 1.0: 0.0, 2.0: 0.5, 3.0: 0.5}


def test_slice_where_no_rule_fires_has_no_crisp_value(valve):
    base = RuleBase("part", valve.inputs, valve.outputs, valve.rules[:1])
    figure, (_, cut) = plot_relation(base, at=2.5)
    assert len(cut.lines) == 1
    figure.canvas.draw()


def test_gains_of_stiffness_alone_are_kalatas():
    _, axes = plot_gain_surfaces(ft.load_rulebase("omega-schedule"), points=7)
    for ax, gain in zip(axes, kalata(4 * 0.778**2), strict=True):
        (line,) = ax.lines
        assert line.get_ydata()[[0, -1]] == pytest.approx([gain, gain])
    plt.close("all")
