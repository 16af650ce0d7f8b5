import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from fuzzytrack import gains, plotting

MAKERS = {
    "noise": lambda: plotting.plot_noise_ratio(),
    "lag": lambda: plotting.plot_noise_against_lag({"fixed": (0.5377, 0.2018)}),
    "circle cost": lambda: plotting.plot_circle_cost(),
    "circle gains": lambda: plotting.plot_circle_gains(kappas=[0.1, 1, 10, 7000, 1e4]),
    "circle gains, 3": lambda: plotting.plot_circle_gains(kappas=[1, 10], order=3),
    "curves": lambda: plotting.plot_optimal_curves(),
    "optimal": lambda: plotting.plot_optimal_gains(),
    "optimal, 3": lambda: plotting.plot_optimal_gains(3, ratio=2.0),
    "motion": lambda: plotting.plot_motion_gains([1.5], [-2, -0.5, 0.5, 2]),
    "motion, 3": lambda: plotting.plot_motion_gains(order=3),
}


def lines(ax):
    return {line.get_label(): np.array(line.get_data(), dtype=float).T for line in ax.lines}


@pytest.mark.parametrize("name", MAKERS)
def test_pictures_are_whole_and_labeled(name):
    figure, axes = MAKERS[name]()
    assert isinstance(figure, Figure)
    assert plt.get_fignums() == [figure.number]
    for ax in np.ravel(axes):
        assert ax.get_xlabel()
        assert ax.get_ylabel()
        assert ax.get_legend() is not None
        # Legends hide no data.
        figure.canvas.draw()
        assert ax.get_legend().get_window_extent().y1 <= ax.get_window_extent().y0
    tight, whole = figure.get_tightbbox(), figure.bbox_inches
    assert min(tight.x0, tight.y0) >= -0.01
    assert tight.x1 <= whole.x1 + 0.01
    assert tight.y1 <= whole.y1 + 0.01


def test_contours_have_their_noise_ratio():
    _, ax = plotting.plot_noise_ratio([0.5, 2.0], of="filtered")
    (contours,) = ax.collections
    for level, path in zip((0.5, 2.0), contours.get_paths(), strict=True):
        # Without the ends at the edge, where the ratio has a pole between two points of the grid.
        alpha, beta = path.vertices.T
        good = (alpha > 0.2) & (beta > 0.1) & (4 - 2 * alpha - beta > 0.1)
        assert good.sum() > 20
        ratio = gains.noise_ratio(alpha[good], beta[good], of="filtered")
        np.testing.assert_allclose(ratio, level, rtol=0.02)


def test_nothing_lies_below_the_least_noise():
    _, ax = plotting.plot_noise_against_lag({"fixed": (0.5377, 0.2018)})
    drawn = lines(ax)
    best = drawn["least noise for the lag"]
    for label in ("Kalata", "Benedict–Bordner", "critically damped", "fixed"):
        lag, noise = drawn[label].T
        known = (lag > best[:, 0].min()) & (lag < best[:, 0].max())
        least = np.interp(np.log(lag[known]), np.log(best[::-1, 0]), np.log(best[::-1, 1]))
        assert (np.log(noise[known]) >= least - 1e-4).all()
    np.testing.assert_allclose(drawn["fixed"], [[1 / 0.2018, 0.7446]], rtol=1e-3)


def test_circle():
    _, ax = plotting.plot_circle_cost()
    (label,) = (name for name in lines(ax) if name.startswith("minimum"))
    np.testing.assert_allclose(lines(ax)[label], [[0.45171283, 0.45217978]], atol=1e-4)


def test_gains_on_a_circle_end_where_the_minimum_does():
    weights = [0.1, 2.0, 1000.0, 2000.0, 1e4]
    _, (left, right) = plotting.plot_circle_gains(kappas=weights)
    thin, thick = (np.array(line.get_ydata()) for line in left.lines[:2])
    np.testing.assert_array_equal(np.isnan(thin), [False] * 4 + [True])
    # Overtaken at 1090 m².
    np.testing.assert_array_equal(np.isnan(thick), [False] * 3 + [True] * 2)
    assert {"0.1 m²", "2 m²", "1000 m²"} <= {text.get_text() for text in right.texts}


def test_optimal_curves_are_the_closed_forms():
    _, ax = plotting.plot_optimal_curves()
    drawn = lines(ax)
    alpha, beta = drawn["transient, constant velocity"].T
    np.testing.assert_allclose(beta * (2 - alpha), alpha**2, rtol=1e-9)
    alpha, beta = drawn["steady lag, constant acceleration"].T
    np.testing.assert_allclose((2 * alpha + beta) ** 2, 4 * beta, rtol=1e-9)


def test_optimal_gains_of_three():
    _, axes = plotting.plot_optimal_gains(3, ratio=0.0)
    for first, second in zip(axes[0].lines, axes[1].lines, strict=True):
        np.testing.assert_array_equal(first.get_ydata(), second.get_ydata())
    assert [line.get_label() for line in axes[0].lines] == ["α", "β", "γ"]


def test_motion_jumps_only_when_accelerating():
    _, (ax,) = plotting.plot_motion_gains([1.5], [-0.01, 0.01])
    drawn = lines(ax)
    start = gains.optimal_for_velocity(gains.velocity_index(1.5, 3, 200**0.5))
    np.testing.assert_allclose(drawn["v = 1.5 m/s, decelerating"][-1], start)
    np.testing.assert_allclose(drawn["v = 1.5 m/s, decelerating"][0], start, atol=0.05)
    assert drawn["v = 1.5 m/s, accelerating"][0, 1] < 0.3 * start[1]


def test_given_axes():
    figure = Figure()
    axes = figure.subplots(1, 3)
    assert plotting.plot_noise_ratio(ax=axes[0]) == (figure, axes[0])
    assert plotting.plot_optimal_gains(axes=axes)[0] is figure
    assert plotting.plot_motion_gains(order=3, axes=axes)[0] is figure
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: plotting.plot_noise_ratio([2, 1]), "levels must be one or more increasing"),
        (lambda: plotting.plot_noise_ratio(of="x"), "of must be one of"),
        (lambda: plotting.plot_noise_against_lag({"a": (2, 1)}), "stability triangle"),
        (lambda: plotting.plot_circle_cost(dt=0), "dt must be finite and > 0"),
        (lambda: plotting.plot_circle_gains(order=4), "order must be 2 or 3, got 4"),
        (lambda: plotting.plot_circle_gains(dt=-1), "dt must be finite and > 0"),
        (lambda: plotting.plot_circle_gains(kappas=[0, 1]), "kappas must be finite and > 0"),
        (lambda: plotting.plot_optimal_gains(4), "order must be 2 or 3, got 4"),
        (lambda: plotting.plot_optimal_gains(3, -1), "ratio must be finite and >= 0"),
        (lambda: plotting.plot_optimal_gains(axes=[]), "axes: needs 3"),
        (lambda: plotting.plot_motion_gains(order=1), "order must be 2 or 3, got 1"),
        (lambda: plotting.plot_motion_gains([0]), "velocities must be finite and > 0"),
        (lambda: plotting.plot_motion_gains([1], [1, 0]), "accelerations must be increasing"),
    ],
)
def test_wrong_arguments(call, message):
    with pytest.raises(ValueError, match=message):
        call()
    assert plt.get_fignums() == []
