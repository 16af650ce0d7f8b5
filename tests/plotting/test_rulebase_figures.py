import numpy as np
import pytest
from lopsided import lopsided
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import fuzzytrack as ft
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase
from fuzzytrack.plotting import plot_memberships, plot_rulebase, plot_rules


def cells(ax):
    """Text and color of every cell, by column and row."""
    image = ax.images[0].get_array()
    return {
        tuple(text.get_position()): (text.get_text(), tuple(image[text.get_position()[::-1]]))
        for text in ax.texts
    }


def ticks(axis):
    return [label.get_text() for label in axis.get_ticklabels()]


def colors_of_sets(ax):
    return {line.get_label(): tuple(line.get_color()) for line in ax.lines}


def test_table_has_each_conclusion_at_its_place(shipped):
    _, axes = plot_rules(shipped)
    _, outputs = plot_memberships(shipped, shipped.output_names)
    assert [ax.get_title() for ax in axes] == ["then stiffness is", "then damping is"]
    for ax, outline, output in zip(axes, outputs, shipped.output_names, strict=True):
        across, down = ticks(ax.xaxis), ticks(ax.yaxis)
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("E is", "dE is")
        found, colors = cells(ax), colors_of_sets(outline)
        assert len(found) == 49
        for rule in shipped.rules:
            where = dict(rule.conditions)
            (said,) = [c.set_name for c in rule.consequents if c.output == output]
            place = across.index(where["E"]), down.index(where["dE"])
            assert found[place] == (said, pytest.approx(colors[said]))


def test_larger_conclusions_are_lighter(shipped):
    _, (ax, _) = plot_memberships(shipped, shipped.output_names)
    colors = colors_of_sets(ax)
    light = [np.dot(colors[name], (0.3, 0.59, 0.11)) for name in "ZSML"]
    assert light == sorted(light)
    assert light[0] < 0.2 < 0.6 < light[-1]


def test_a_list_of_rules():
    maneuver = ft.load_rulebase("maneuver")
    _, (ax,) = plot_rules(maneuver)
    assert ticks(ax.xaxis) == [
        "if surprise is",
        "and agreement is",
        "then noise is",
        "and retention is",
    ]
    found = cells(ax)
    for row, rule in enumerate(maneuver.rules):
        asked = dict(rule.conditions)
        said = {c.output: c.set_name for c in rule.consequents}
        words = [found[k, row][0] for k in range(4)]
        assert words[:2] == [asked.get(n, "·") for n in maneuver.input_names]
        assert words[2:] == [said.get(n, "·") for n in maneuver.output_names]


def test_shares_of_two_sets_and_rules_that_are_left_out(rules):
    def rule(x, y, *says):
        return Rule((("x", x), ("y", y)), tuple(Consequent("u", *each) for each in says))

    both = rule("a", "b", ("a", 0.25), ("e", 0.75))
    _, (ax,) = plot_rules(
        RuleBase("shares", rules.inputs, rules.outputs, (both, rule("b", "b", ("c", 0.0))))
    )
    (text, color), (silent, white) = cells(ax)[2, 0], cells(ax)[2, 1]
    low, high = (colors_of_sets(plot_memberships(rules, "u")[1][0])[name] for name in "ae")
    assert text == "a@0.25+e@0.75"
    np.testing.assert_allclose(color, 0.25 * np.array(low) + 0.75 * np.array(high))
    assert (silent, white) == ("c@0", (1.0, 1.0, 1.0))


def test_a_long_list_says_how_much_is_left_out(monkeypatch):
    from fuzzytrack.plotting import rulebases

    monkeypatch.setattr(rulebases, "SHOWN", 4)
    _, (ax,) = plot_rules("maneuver")
    assert cells(ax)[0, 4][0] == "and 2 more"
    assert ticks(ax.yaxis) == ["1", "2", "3", "4"]


@pytest.mark.parametrize(
    ("name", "titles", "names"),
    [
        ("stiffness-damping", 6, ["3d", "3d"]),
        ("tipper", 3, ["3d"]),
        ("omega-schedule", 2, ["rectilinear"]),
    ],
)
def test_one_picture(name, titles, names):
    figure, axes = plot_rulebase(name, points=5)
    figure.canvas.draw()
    assert sum(bool(ax.get_title()) for ax in axes) == titles
    assert [ax.name for ax in axes][-len(names) :] == names
    assert figure.get_suptitle() == name


def test_in_a_figure_of_mine_without_surfaces_of_three_inputs():
    mine = Figure()
    figure, axes = plot_rulebase(lopsided(extra_input=True), figure=mine)
    assert figure is mine
    assert len(axes) == 3 + 1 + 1
    assert plt.get_fignums() == []
    _, axes = plot_rulebase(lopsided(), points=5, style="contour", figure=Figure())
    assert [ax.name for ax in axes] == ["rectilinear"] * 5
    with pytest.raises(ValueError, match="style: unknown 'x'; one of surface, contour"):
        plot_rulebase(lopsided(), style="x")
    with pytest.raises(ValueError, match="axes: needs 2 matplotlib Axes"):
        plot_rules("stiffness-damping", axes=Figure().subplots())
