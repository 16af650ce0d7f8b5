"""Pictures that values draw of themselves, and those of certificates."""

import numpy as np
import pytest
from matplotlib import pyplot as plt

import fuzzytrack as ft
from fuzzytrack.gains.certificate import error_matrix
from fuzzytrack.plotting import plot_certificate, plot_memberships
from fuzzytrack.scan import Scan, ScanTracker
from fuzzytrack.testbed.comparison import compare
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.recorded_comparison import compare_recorded

FIXED = "fixed:alpha=0.5:beta=0.2"


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def line(ax, label):
    (found,) = (each for each in ax.lines if each.get_label() == label)
    return np.array(found.get_data(), dtype=float)


def test_a_refuted_set_shows_an_error_that_grows_as_the_certificate_says():
    found = ft.certify("stiffness-damping", steps=(1, 4))
    figure, (plane, errors) = plot_certificate(found)
    plots, sizes = line(errors, "error, with the sequence of gains")
    assert plots[-1] == len(sizes) - 1 >= 60
    # Once around, without the function's own way of counting.
    length = len(found.sequence)
    growth = sizes[2 * length] / sizes[length]
    assert growth == pytest.approx(found.growth**length, rel=1e-6)
    error = np.eye(2)
    for (alpha, beta), elapsed in zip(found.sequence, found.elapsed, strict=True):
        error = error_matrix(alpha, beta, elapsed) @ error
    assert max(abs(np.linalg.eigvals(error))) == pytest.approx(growth, rel=1e-6)
    shown = set(map(tuple, line(plane, "gains of the sequence").T))
    assert shown == set(map(tuple, np.unique(found.sequence, axis=0)))
    assert errors.get_title() == "refuted"
    assert found.plot() is not figure


def test_a_certified_set_shows_the_bound():
    found = ft.certify("omega-schedule")
    _, (plane, errors) = plot_certificate(found)
    _, sizes = line(errors, "bound, for any order of gains")
    np.testing.assert_allclose(sizes, found.rate ** np.arange(61))
    corners = line(plane, "corners of the set").T
    assert {tuple(c) for c in corners} == {tuple(v) for v in found.vertices}


def test_gains_from_a_covariance_show_the_contraction():
    found = ft.certify("maneuver")
    (errors,) = found.plot().axes
    plots, left = line(errors, "worst sequence that was found")
    assert dict(zip(plots[1:], left[1:], strict=True)) == found.contraction
    assert (plots[0], left[0]) == (0, 1)


def test_values_draw_themselves():
    rules = ft.load_rulebase("stiffness-damping")
    assert rules.plot().get_suptitle() == "stiffness-damping"
    (surface,) = ft.FuzzySystem(rules).plot("damping", style="contour", points=5).axes[:1]
    assert surface.get_xlabel() == rules.input("E").axis_label
    (sets,) = rules.output("damping").plot().axes
    assert sets.get_title() == "variable damping"
    assert [each.get_label() for each in sets.lines][:4] == list(rules.output("damping").set_names)
    with pytest.raises(ValueError, match="variables"):
        plot_memberships(rules.output("damping"), "stiffness")
    t = np.arange(20.0)
    result = ft.AlphaBetaTracker(FIXED).run(t, np.stack([t, t**2], axis=1))
    assert result.plot(truth=result.measured).axes[0].get_xlabel().startswith("x")


def points(ax):
    """Numbers of the trackers, from above."""
    drawn = [each for each in ax.lines if each.get_marker() not in (None, "None", "")]
    return [x for each in drawn for x in np.asarray(each.get_xdata(), dtype=float).tolist()]


def test_results_draw_their_errors():
    t = np.arange(20.0)
    truth = np.stack([t, t**2], axis=1)
    found = compare([FIXED, "chan-style"], t, truth, 1.0, 3, 0)
    (ax,) = found.plot().axes
    np.testing.assert_allclose(points(ax), found.predicted_rmse)
    results = monte_carlo("llinas-m2", [FIXED, "chan-style"], runs=3, seed=0)
    (ax,) = results.plot().axes
    np.testing.assert_allclose(points(ax), results.rmse())
    columns = {"t": np.arange(250), "x": np.random.default_rng(0).normal(0, 1, 250).cumsum()}
    tuned = ft.tune(columns, "fixed", trials=4, folds=2)
    (ax,) = tuned.plot().axes
    assert ax.get_xlabel() == "RMS of innovations, held out"
    np.testing.assert_allclose(points(ax), [row.held_out for row in tuned.rows])
    for truth_of, label in (({}, "RMS of innovations"), ({"truth": "x"}, "RMSE of prediction")):
        recorded = compare_recorded([FIXED, "chan-style"], columns, sigma=0.1, **truth_of)
        (ax,) = recorded.plot().axes
        assert ax.get_xlabel() == label
        np.testing.assert_allclose(points(ax), recorded.errors)


def test_a_scan_result_draws_its_tracks_and_lists_them():
    scans = [
        Scan(1.7 * k, np.array([[300.0 + 5.0 * k, 200.0], [-80.0, 4.0 * k]])) for k in range(15)
    ]
    result = ScanTracker().run(scans)
    names = [text.get_text() for text in result.plot(scans).axes[0].get_legend().get_texts()]
    assert names == ["plots", "moving", "start", "in the last scan", "radar"]
    page = result._repr_html_()
    assert "Scan tracker default" in page
    # Three facts, and a row for each of two tracks.
    assert page.count("<td") == 3 + 2 * 4
    assert ">moving<" in page
    assert "No track was reported" in ScanTracker().run([])._repr_html_()
