from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack.fuzzy.rulebase import Consequent
from fuzzytrack.fuzzy.variable import Universe
from fuzzytrack.gains import kalata
from fuzzytrack.plotting import plot_gain_plane

FIXED = (0.5377, 0.2018)


def lines(ax):
    return {line.get_label(): np.array(line.get_data()).T for line in ax.lines}


def gains(*pairs):
    alpha, beta = np.array(pairs, dtype=float).T
    return ft.Gains(alpha, beta, np.zeros_like(alpha))


def test_draws_the_gains_visited_without_nan(result, shipped):
    _, ax = plot_gain_plane(result, shipped, mark={"fixed pair": FIXED})
    drawn = lines(ax)
    known = np.isfinite(result.gains.alpha)
    assert not known.all()
    expected = np.stack([result.gains.alpha[known], result.gains.beta[known]], axis=-1)
    np.testing.assert_array_equal(drawn["gains visited"], np.unique(expected, axis=0))
    np.testing.assert_array_equal(drawn["fixed pair"], [FIXED])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("position gain α", "velocity gain β")
    assert [t.get_text() for t in ax.get_legend().get_texts()] == [
        "edge of stability",
        "critical damping",
        "Benedict–Bordner",
        "gains visited",
        "limits of stiffness-damping",
        "fixed pair",
    ]


def test_references_are_the_known_curves():
    drawn = lines(plot_gain_plane(gains((1, 1)))[1])
    corners = {tuple(p) for p in drawn["edge of stability"]}
    assert corners == {(0, 0), (2, 0), (0, 4)}
    alpha, beta = drawn["critical damping"].T
    # Equal poles: z² - (2 - α - β) z + 1 - α has no discriminant.
    np.testing.assert_allclose((2 - alpha - beta) ** 2, 4 * (1 - alpha), atol=1e-12)
    assert (alpha.min(), alpha.max()) == (0, 1)
    assert (beta.min(), beta.max()) == (0, 4)
    alpha, beta = drawn["Benedict–Bordner"].T
    np.testing.assert_allclose(beta * (2 - alpha), alpha**2, atol=1e-14)
    assert 2 * alpha[-1] + beta[-1] == pytest.approx(4)


def test_box_is_the_image_of_its_edge():
    box = ((0.2, 0.8), (0.1, 1.3))
    outline = lines(plot_gain_plane({}, box)[1])["limits of stiffness and damping"]
    stiffness, damping = ft.w_from_alpha_beta(*outline.T)
    assert stiffness.min() == pytest.approx(0.2)
    assert damping.max() == pytest.approx(1.3)
    on_edge = np.isclose(stiffness, 0.2) | np.isclose(stiffness, 0.8)
    on_edge |= np.isclose(damping, 0.1) | np.isclose(damping, 1.3)
    assert on_edge.all()
    np.testing.assert_array_equal(outline[0], outline[-1])


def test_box_of_direct_gains_is_a_rectangle():
    outline = lines(plot_gain_plane({}, ft.load_rulebase("chan-style"))[1])["limits of chan-style"]
    assert outline.min(axis=0) == pytest.approx([0.3, 0.1])
    assert outline.max(axis=0) == pytest.approx([0.9, 0.6])


def test_box_of_stiffness_alone_is_a_part_of_kalatas_curve():
    rules = ft.load_rulebase("omega-schedule")
    outline = lines(plot_gain_plane({}, rules)[1])["limits of omega-schedule"]
    universe = rules.output("stiffness").universe
    stiffness = np.linspace(universe.low, universe.high, len(outline))
    # ω₀ = √λ/2
    np.testing.assert_allclose(outline.T, kalata((2 * stiffness) ** 2), rtol=1e-12)


def test_box_of_three_gains_is_that_of_the_first_two():
    base = ft.load_rulebase("chan-style")
    (alpha, beta), (first, *_) = base.outputs, base.rules
    gamma = replace(beta, name="gamma", universe=Universe(0.0, 0.5, 51))
    more = replace(first, consequents=(*first.consequents, Consequent("gamma", beta.sets[0].name)))
    rules = replace(base, outputs=(gamma, beta, alpha), rules=(more, *base.rules[1:]), layout=None)
    outline = lines(plot_gain_plane({}, rules)[1])["limits of chan-style"]
    assert outline.min(axis=0) == pytest.approx([0.3, 0.1])
    assert outline.max(axis=0) == pytest.approx([0.9, 0.6])


def test_several_trackers_have_labels_and_colors(result):
    _, ax = plot_gain_plane({"a": result, "b": result.gains, "c": gains((1, 1))})
    assert {"a", "b", "c"} <= set(lines(ax))
    styles = {(li.get_color(), li.get_marker()) for li in ax.lines if li.get_label() in "abc"}
    assert len(styles) == 3


def test_a_small_cloud_gets_an_inset():
    _, ax = plot_gain_plane(gains((0.5, 0.2), (0.6, 0.25), (0.5, 0.2)), mark={"m": FIXED})
    (window,) = ax.child_axes
    (x0, x1), (y0, y1) = window.get_xlim(), window.get_ylim()
    assert x0 < 0.5
    assert x1 > 0.6
    assert x1 - x0 < 0.3
    assert y0 < 0.2
    assert y1 > 0.25
    np.testing.assert_array_equal(lines(window)["gains visited"], [(0.5, 0.2), (0.6, 0.25)])


def test_a_large_cloud_gets_none_unless_asked():
    wide = gains((0.1, 0.1), (1.1, 1.0))
    assert not plot_gain_plane(wide)[1].child_axes
    assert plot_gain_plane(wide, inset=True)[1].child_axes
    assert not plot_gain_plane(gains((0.5, 0.2)), inset=False)[1].child_axes


def test_gains_far_outside_do_not_spoil_the_picture():
    _, ax = plot_gain_plane(gains((0.5, 0.2), (0.52, 0.21), (30.0, -5.0)))
    assert ax.get_xlim()[1] < 2.1
    assert ax.child_axes[0].get_xlim()[1] < 1
    np.testing.assert_array_equal(lines(ax)["gains visited"][-1], [30, -5])


def test_nothing_to_draw_is_the_plane_alone():
    figure, ax = plot_gain_plane(gains((np.nan, np.nan)))
    assert not ax.child_axes
    figure.canvas.draw()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: plot_gain_plane(7), "gains: must be Gains.* got int"),
        (lambda r: plot_gain_plane({"a": 7}), "gains: 'a' must be Gains.* got int"),
        (lambda r: plot_gain_plane({}, r), "box: lopsided has outputs u; needed are stiffness"),
        (lambda r: plot_gain_plane({}, ((0, 1),)), r"box: must be \(\(low, high\)"),
        (lambda r: plot_gain_plane({}, ((1, 0), (0, 1))), "box: must be"),
        (lambda r: plot_gain_plane({}, ((-1, 0), (0, 1))), "box: must be .*not negative"),
        (lambda r: plot_gain_plane({}, mark={"m": 0.5}), r"mark: 'm' must be a pair"),
        (lambda r: plot_gain_plane({}, mark={"m": (0.5, np.nan)}), r"mark: 'm' must be a pair"),
        (lambda r: plot_gain_plane({}, ax=[]), "ax: needs 1"),
    ],
)
def test_wrong_arguments(call, message, rules):
    with pytest.raises(ValueError, match=message):
        call(rules)
    assert plt.get_fignums() == []
