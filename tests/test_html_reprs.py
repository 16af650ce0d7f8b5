"""HTML of values in notebooks: well formed, escaped, without scripts, and what is in it."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.fuzzy.rulebase import Consequent
from fuzzytrack.gains.covariance_certificate import CovarianceLimits, certify_covariance
from fuzzytrack.html_reprs import Cell, as_text, block, curves, facts, paragraph, table, tint
from fuzzytrack.schedulers.reachable_gains import certify
from fuzzytrack.testbed.comparison import compare
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.recorded_comparison import compare_recorded

EMPTY = {"img", "line", "polyline"}


class Reader(HTMLParser):
    """Tags that are open, and the text of each cell by its row."""

    def __init__(self):
        super().__init__()
        self.open, self.rows, self.attributes = [], [], []

    def handle_starttag(self, tag, attributes):
        self.attributes += attributes
        if tag not in EMPTY:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_startendtag(self, tag, attributes):
        self.attributes += attributes

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data


def rows_of(html):
    """Cells of all tables of well-formed HTML that runs nothing and loads nothing."""
    reader = Reader()
    reader.feed(html)
    assert reader.open == []
    assert "<script" not in html
    for name, value in reader.attributes:
        assert not name.startswith("on")
        assert name not in ("src", "href") or value.startswith("data:")
    return reader.rows


# -------------------------------------------------------------------- parts


def test_text_is_escaped_and_cells_are_not_escaped_again():
    bad = "<script>alert(1)</script> & \"'"
    html = block(bad, paragraph(bad), table([bad], [[bad], [Cell("<i>x</i>")]]), facts({bad: bad}))
    assert rows_of(html) == [[bad], [bad], ["x"], [bad, bad]]
    assert paragraph("") == ""


def test_long_tables_say_how_much_is_left_out():
    html = table(["n"], [[str(n)] for n in range(63)], what="plots", best=1)
    assert len(rows_of(html)) == 61
    assert "and 3 more plots" in html
    assert html.count('class="best"') == 1
    assert "more" not in table(["n"], [])


@pytest.mark.parametrize(
    ("number", "error", "text"),
    [
        (1.23456, np.nan, "1.235"),
        (12345.6, np.nan, "12346"),
        (1.23456, 0.0123, "1.235 ± 0.012"),
        (123.0, 45.0, "123 ± 45"),
        (np.nan, 1.0, "–"),
        (-np.inf, 1.0, "-inf"),
        (0.0, 0.0, "0"),
    ],
)
def test_numbers_have_the_digits_that_their_error_allows(number, error, text):
    assert as_text(number, error) == text


def test_tints_differ_and_let_the_page_through():
    colors = [tint(share) for share in (0, 0.25, 0.5, 0.75, 1)]
    assert len(set(colors)) == 5
    assert all(float(re.search(r",([\d.]+)\)$", color)[1]) < 0.5 for color in colors)


def test_curves_are_drawn_where_they_are_not_zero():
    x = np.linspace(0, 10, 11)
    html = curves(x, {"<a>": np.maximum(0, 1 - x / 2), "b": np.ones(11)}, [0, 1])
    first, second = re.findall(r'points="([^"]*)"', html)
    assert first == "0.0,14.0 30.0,44.0 60.0,74.0"
    assert second == "0.0,14.0 300.0,14.0"
    assert "&lt;a&gt;" in html
    assert rows_of(html) == []


# -------------------------------------------------------------------- values


def test_a_table_of_words_is_shown_as_it_was_written():
    rules = ft.load_rulebase("stiffness-damping")
    head, *rows = rows_of(rules._repr_html_())
    assert head == ["dE \\ E", "nl", "nm", "ns", "ze", "ps", "pm", "pl"]
    assert [row[0] for row in rows] == list(rules.input("dE").set_names)
    cells = {
        (row[0], column): cell
        for row in rows
        for column, cell in zip(head[1:], row[1:], strict=True)
    }
    for rule in rules.rules:
        at = dict(rule.conditions)
        words = {c.output: c.set_name for c in rule.consequents}
        assert cells[at["dE"], at["E"]] == f"{words['stiffness']} {words['damping']}"


def test_a_list_of_rules_has_a_row_for_each():
    tipper = ft.load_rulebase("tipper")
    unsure = Consequent("tip", "average", 0.5)
    first = replace(tipper.rules[0], consequents=(*tipper.rules[0].consequents, unsure))
    rules = replace(tipper, name="<b>odd</b>", rules=(first, *tipper.rules[1:]))
    html = rules._repr_html_()
    assert "&lt;b&gt;odd&lt;/b&gt;" in html
    assert rows_of(html) == [
        ["rule", "if service", "if food", "then tip"],
        ["1", "poor", "", "cheap average @0.5"],
        ["2", "", "rancid", "cheap"],
        ["3", "good", "", "average"],
        ["4", "excellent", "", "generous"],
        ["5", "", "delicious", "generous"],
    ]


@pytest.mark.parametrize("name", shipped_rulebases())
def test_every_shipped_rule_base_and_its_system_are_small(name):
    system = ft.FuzzySystem(name)
    rows_of(system.rules._repr_html_())
    html = system._repr_html_()
    variables = [*system.rules.inputs, *system.rules.outputs]
    assert [row[1] for row in rows_of(html)[1 : len(variables) + 1]] == [
        variable.axis_label for variable in variables
    ]
    assert html.count("<svg") == len(variables)
    assert len(html) < 40_000
    for variable in variables:
        assert html.count(variable.drawing()) >= 1
        rows_of(variable._repr_html_())


def test_certificates_show_what_proves_or_refutes():
    html = certify("stiffness-damping", steps=(1, 2))._repr_html_()
    assert "certified" in html
    assert "time between rows in [1, 2] s" in html
    assert rows_of(html)[0] == ["measure", "√(eᵀPe)"]
    found = certify("stiffness-damping", steps=(1, 4))
    html = found._repr_html_()
    assert f"by a factor of {found.growth:.4f} a plot" in html
    rows = rows_of(html)[1:]
    assert [float(row[2]) for row in rows] == pytest.approx(found.sequence[:, 0], rel=1e-3)
    assert [float(row[1]) for row in rows] == pytest.approx(found.elapsed, rel=1e-3)
    polygon = certify("omega-schedule", steps=(1, 2))
    assert f"polygon of {len(polygon.polygon)} corners" in polygon._repr_html_()
    open_question = replace(polygon, verdict="not decided", rate=1.25)._repr_html_()
    assert "may grow by a factor of 1.2500 a plot" in open_question


def test_certificates_of_covariances_show_what_is_left_of_the_error():
    found = certify_covariance(CovarianceLimits((0.12, 2), (1, 4)), (5,))
    rows = rows_of(found._repr_html_())
    assert rows[0] == ["noise (a₀)", "[0.12, 2]"]
    assert rows[-1] == ["5", f"{found.contraction[5]:.3f}"]
    assert "does not apply" in certify_covariance(CovarianceLimits((0, 2), (1, 4)))._repr_html_()


def test_results_of_trackers_show_their_errors():
    t = np.arange(30.0)
    truth = np.stack([3 * t, np.sin(t)], axis=1)
    found = compare(["fixed:alpha=0.5:beta=0.2", "stiffness-damping"], t, truth, 2.0, 5, 0)
    head, *rows, plots = rows_of(found._repr_html_())
    assert head[-2:] == ["vs fixed:alpha=0.5:beta=0.2", ""]
    assert [row[4] for row in rows] == found.marks
    assert [row[0] for row in rows] == list(found.names)
    assert rows[1][3] == f"{100 * found.predicted_change[1]:+.1f} %"
    assert plots[2] == as_text(found.measured_rmse)
    results = monte_carlo("llinas-m2", list(found.names), runs=3, seed=0)
    head, *rows, plots = rows_of(results._repr_html_())
    assert head[:3] == ["tracker", "predicted RMSE (m)", "filtered RMSE (m)"]
    assert rows[0][2].startswith(f"{results.rmse('filtered')[0]:.4g}"[:3])
    assert len(plots) == len(head)


def test_trackers_on_recorded_plots_show_their_innovations_or_errors():
    rng = np.random.default_rng(0)
    t, x = np.arange(120), 2.0 * np.arange(120)
    columns = {"t": t, "x": x + rng.normal(0, 3, 120), "u": x}
    names = ["fixed:alpha=0.5:beta=0.2", "stiffness-damping"]
    found = compare_recorded(names, columns, axes=["x"])
    head, *rows, before = rows_of(found._repr_html_())
    assert head == ["RMS of innovations", "", f"vs {names[0]} (95 %)", ""]
    assert [row[1] for row in rows] == [as_text(score.rms) for score in found.scores]
    assert rows[1][2] == found.scores[1].change.text
    assert before[:2] == ["the plot before", as_text(found.before)]
    found = compare_recorded(names, columns, axes=["x"], truth="u")
    head, *rows, plots = rows_of(found._repr_html_())
    assert head[:3] == ["RMSE of position", "predicted", "filtered"]
    assert [row[2] for row in rows] == [as_text(score.true.filtered) for score in found.scores]
    assert plots[2] == as_text(found.measured_rmse)


def test_a_run_shows_what_it_kept():
    t, z = np.arange(9.0), np.arange(18.0).reshape(9, 2)
    z[4] = np.nan
    tracker = ft.AlphaBetaTracker("fixed:alpha=0.5:beta=0.2")
    facts_of = dict(rows_of(tracker.run(t, z)._repr_html_()))
    assert facts_of["plots"] == "8, 1 missed"
    assert facts_of["mean α"] == "0.5"
    assert float(facts_of["RMS of innovations"]) == pytest.approx(0, abs=1e-9)
    kept = dict(rows_of(tracker.run(t, z, keep=("filtered",))._repr_html_()))
    assert "mean α" not in kept
    nothing = dict(rows_of(tracker.run([], np.empty((0, 3, 2)))._repr_html_()))
    assert (nothing["steps"], nothing["tracks"]) == ("0", "3")


def test_a_tuned_tracker_shows_its_report():
    rng = np.random.default_rng(0)
    columns = {"t": np.arange(300), "x": rng.normal(0, 1, 300).cumsum()}
    found = ft.tune(columns, "fixed", trials=6, folds=2)
    html = found._repr_html_()
    assert found.verdict.partition(":")[0] in html
    names = [row[0] for row in rows_of(html)]
    assert names == ["", *(row.name for row in found.rows), "free number", "alpha", "beta"]
