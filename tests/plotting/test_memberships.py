import numpy as np
import pytest
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.plotting import plot_memberships


def curves(ax):
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def base(variable):
    output = Variable("u", Universe(0, 1, 11), (FuzzySet("z", "trimf", (0, 0.5, 1)),))
    rule = Rule(((variable.name, variable.sets[0].name),), (Consequent("u", "z"),))
    return RuleBase("one", (variable,), (output,), (rule,))


def overlaps(figure, ax):
    """Whether any two set names cover each other, as drawn."""
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    return any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])


def test_lines_are_the_membership_functions(rules):
    _, axes = plot_memberships(rules)
    assert len(axes) == 3
    for ax, variable in zip(axes, (*rules.inputs, *rules.outputs), strict=True):
        lines = curves(ax)
        assert tuple(lines) == variable.set_names
        for fuzzy_set in variable.sets:
            x, y = lines[fuzzy_set.name].get_data()
            grades = fuzzy_set.membership(x)
            np.testing.assert_array_equal(np.nan_to_num(y), grades)
            # Left out is the axis alone, up to where the set begins.
            inside = np.flatnonzero(grades)
            assert np.isfinite(y[max(inside[0] - 1, 0) : inside[-1] + 2]).all()
            assert (x[0], x[-1]) == (variable.universe.low, variable.universe.high)
            assert np.nanmax(y) == 1.0
        assert ax.get_xlabel() == variable.axis_label
        assert ax.get_ylabel() == "membership"
        assert [t.get_text() for t in ax.texts] == list(variable.set_names)
    assert [ax.get_title() for ax in axes] == ["input x", "input y", "output u"]
    assert axes[0].get_xlabel() == "distance (m)"


def test_ends_of_the_universe_are_ticks(shipped):
    _, axes = plot_memberships(shipped, ["damping", "E"])
    for ax, ends in zip(axes, ((0.54, 0.89), (-1.0, 1.0)), strict=True):
        ticks = ax.get_xticks()
        assert (ticks[0], ticks[-1]) == ends


def test_names_stay_apart_where_sets_crowd():
    crowd = Variable(
        "e",
        Universe(-1, 1, 201),
        tuple(
            FuzzySet(f"term{k}", "trimf", (c - 0.02, c, c + 0.02))
            for k, c in enumerate(np.linspace(-0.05, 0.05, 6))
        ),
    )
    figure, (ax, _) = plot_memberships(base(crowd))
    assert not overlaps(figure, ax)
    assert ax.get_ylim()[1] > max(t.get_position()[1] for t in ax.texts) + 0.08


def test_shipped_names_stay_apart(shipped):
    figure, axes = plot_memberships(shipped)
    assert not any(overlaps(figure, ax) for ax in axes)


def test_a_name_longer_than_the_panel_stays_at_its_peak():
    long = Variable("e", Universe(0, 1, 11), (FuzzySet("w" * 200, "trimf", (0, 0.3, 1)),))
    _, (ax, _) = plot_memberships(base(long))
    assert ax.texts[0].get_position()[0] == 0.3


def test_spikes_and_vertical_flanks():
    sharp = Variable(
        "e",
        Universe(0, 1, 11),
        (FuzzySet("box", "trapmf", (0.2, 0.2, 0.4, 0.4)), FuzzySet("spike", "singleton", (0.73,))),
    )
    _, (ax, _) = plot_memberships(base(sharp))
    lines = curves(ax)
    np.testing.assert_array_equal(lines["spike"].get_data(), [[0.73, 0.73], [0.0, 1.0]])
    x, y = lines["box"].get_data()
    assert x[y > 0][0] == 0.2
    assert x[y > 0][-1] == 0.4
    assert np.diff(x[np.flatnonzero(np.diff(y))]).min() > 0
    assert x[np.flatnonzero(y > 0)[0] - 1] == np.nextafter(0.2, 0)


def test_sets_beyond_the_universe_are_named_at_its_end():
    rising = Variable("e", Universe(0, 1, 11), (FuzzySet("high", "sigmf", (0.5, 10.0)),))
    figure, (ax, _) = plot_memberships(base(rising))
    assert 0.9 < ax.texts[0].get_position()[0] <= 1.0
    figure.canvas.draw()


def test_a_system_will_do(rules):
    _, axes = plot_memberships(ft.FuzzySystem(rules), "y")
    assert len(axes) == 1
    with pytest.raises(ValueError, match="variables: unknown 'z'; one of x, y, u"):
        plot_memberships(rules, ["x", "z"])
    assert len(plt.get_fignums()) == 1
