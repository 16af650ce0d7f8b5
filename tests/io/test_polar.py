"""Polar plots: against quadrature of the errors, the published equations, and random plots."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fuzzytrack.io.polar import cartesian_to_polar, polar_to_cartesian

ranges = st.floats(1.0, 1e6)
azimuths = st.floats(-2 * np.pi, 4 * np.pi)
elevations = st.floats(-np.pi / 2, np.pi / 2)
angle_noises = st.floats(1e-5, 0.5)
conventions = st.sampled_from(["north", "east"])


def converted(distance, azimuth, elevation=None, **noise):
    """One plot; the same without the dimension of plots."""
    third = None if elevation is None else [elevation]
    return polar_to_cartesian([distance], [azimuth], third, **noise)


# -------------------------------------------------------------------- geometry


@given(ranges, azimuths, elevations, conventions)
def test_there_and_back(distance, azimuth, elevation, convention):
    there = converted(distance, azimuth, elevation, azimuth_from=convention)
    assert there.covariance is None
    assert there.sigma is None
    assert not there.impossible.any()
    back = cartesian_to_polar(there.position, azimuth_from=convention)
    assert back.range == pytest.approx(distance, rel=1e-14)
    assert back.elevation == pytest.approx(elevation, abs=1e-7)
    assume(abs(elevation) < 1.57)
    assert 0 <= back.azimuth[0] < 2 * np.pi
    assert np.exp(1j * back.azimuth) == pytest.approx(np.exp(1j * azimuth), abs=1e-9)


@given(ranges, azimuths, conventions)
def test_there_and_back_in_the_plane(distance, azimuth, convention):
    there = converted(distance, azimuth, azimuth_from=convention)
    back = cartesian_to_polar(there.position, azimuth_from=convention)
    assert back.elevation is None
    assert back.range == pytest.approx(distance, rel=1e-14)
    assert np.exp(1j * back.azimuth) == pytest.approx(np.exp(1j * azimuth), abs=1e-12)


def test_known_places():
    quarter = np.pi / 2
    north = polar_to_cartesian([2.0] * 4, np.arange(4) * quarter).position
    assert north == pytest.approx(np.array([[0, 2], [2, 0], [0, -2], [-2, 0]]), abs=1e-15)
    east = polar_to_cartesian([2.0] * 4, np.arange(4) * quarter, azimuth_from="east").position
    assert east == pytest.approx(np.array([[2, 0], [0, 2], [-2, 0], [0, -2]]), abs=1e-15)
    up = polar_to_cartesian([2.0, 2.0], [0.0, 1.0], [np.pi / 6, quarter]).position
    assert up == pytest.approx(np.array([[0, np.sqrt(3), 1], [0, 0, 2]]), abs=1e-15)


def test_directions_that_do_not_exist_are_nan():
    flat = cartesian_to_polar([[0.0, 0.0]])
    assert flat.range == 0
    assert np.isnan(flat.azimuth)
    above = cartesian_to_polar([[0.0, 0.0, 3.0], [0.0, 0.0, 0.0], [np.nan, 1.0, 1.0]])
    assert above.range[:2].tolist() == [3, 0]
    assert np.isnan(above.azimuth).all()
    assert above.elevation[0] == pytest.approx(np.pi / 2)
    assert np.isnan(above.elevation[1:]).all()


def test_no_plots():
    none = polar_to_cartesian([], [], [], sigma_range=1, sigma_azimuth=0.1, sigma_elevation=0.1)
    assert none.position.shape == (0, 3)
    assert none.covariance.shape == (0, 3, 3)
    assert none.sigma.shape == (0, 3)
    assert cartesian_to_polar(np.zeros((0, 2))).range.shape == (0,)


# -------------------------------------------------------------------- missing and impossible


def test_missing_parts_make_missed_plots():
    plots = polar_to_cartesian(
        [1.0, np.nan, 1.0, 1.0], [0.0, 0.0, np.nan, 0.0], [0.0, 0.0, 0.0, np.nan],
        sigma_range=1.0, sigma_azimuth=0.1, sigma_elevation=0.1,
    )  # fmt: skip
    assert np.isnan(plots.position).all(axis=1).tolist() == [False, True, True, True]
    assert np.isnan(plots.covariance).all(axis=(1, 2)).tolist() == [False, True, True, True]
    assert not plots.impossible.any()


@given(
    st.sampled_from([-1.0, -9999.0, -np.inf, np.inf, 9.97e36, 5.0]),
    st.sampled_from([-2.01 * np.pi, 4.01 * np.pi, np.inf, -9999.0, 1e30, 0.5]),
    st.sampled_from([-1.6, 1.6, np.inf, -9999.0, 0.2]),
)
def test_impossible_values_are_marked_and_missed(distance, azimuth, elevation):
    fine = distance == 5 and azimuth == 0.5
    flat = converted(distance, azimuth, sigma_range=1.0, sigma_azimuth=0.01)
    assert flat.impossible[0] == (not fine)
    assert np.isnan(flat.position).all() == (not fine)
    assert np.isnan(flat.covariance).all() == (not fine)
    high = converted(distance, azimuth, elevation)
    assert high.impossible[0] == (not fine or elevation != 0.2)
    assert np.isnan(high.position).all() == high.impossible[0]


def test_the_ends_of_what_is_possible():
    degrees = np.array([-360.0, 0.0, 360.0, 720.0])
    assert not polar_to_cartesian(np.zeros(4), np.radians(degrees)).impossible.any()
    poles = polar_to_cartesian([1.0, 1.0], [0.0, 0.0], np.radians([-90.0, 90.0]))
    assert not poles.impossible.any()


anything = st.floats(allow_nan=True, allow_infinity=True)


@given(anything, anything, anything, st.floats(0, 1e15), st.floats(0, 1), st.floats(0, 1))
def test_any_numbers_are_a_finite_position_or_a_missed_plot(r, a, e, sr, sa, se):
    noise = {"sigma_range": sr, "sigma_azimuth": sa}
    for plots, cells in (
        (converted(r, a, **noise), [r, a]),
        (converted(r, a, e, **noise, sigma_elevation=se), [r, a, e]),
    ):
        missed = plots.impossible[0] or np.isnan(cells).any()
        shown = np.concatenate([plots.position.ravel(), plots.covariance.ravel()])
        assert np.isnan(shown).all() if missed else np.isfinite(shown).all()
        assert missed or (np.diagonal(plots.covariance[0]) >= 0).all()


# -------------------------------------------------------------------- noise


def plane_of_mo(r, theta, sigma_r, sigma_theta):
    """Equations of Mo et al. for the plane as printed, theta counted from x to y."""
    lam, lam4 = np.exp(-(sigma_theta**2) / 2), np.exp(-2 * sigma_theta**2)
    square, cos, sin = r**2 + sigma_r**2, np.cos(theta), np.sin(theta)
    common = (lam**-2 - 2) * r**2
    xx = common * cos**2 + square / 2 * (1 + lam4 * np.cos(2 * theta))
    yy = common * sin**2 + square / 2 * (1 - lam4 * np.cos(2 * theta))
    xy = common * sin * cos + square / 2 * lam4 * np.sin(2 * theta)
    return np.array([r * cos, r * sin]) / lam, np.array([[xx, xy], [xy, yy]])


@given(ranges, azimuths, st.floats(0, 1e3), angle_noises)
def test_as_printed_for_the_plane(distance, azimuth, sigma_range, sigma_azimuth):
    plots = converted(
        distance, azimuth, azimuth_from="east",
        sigma_range=sigma_range, sigma_azimuth=sigma_azimuth,
    )  # fmt: skip
    position, covariance = plane_of_mo(distance, azimuth, sigma_range, sigma_azimuth)
    assert plots.position[0] == pytest.approx(position, rel=1e-12, abs=1e-12 * distance)
    # The printed equations lose digits where the terms cancel.
    loss = 1e-14 * (distance**2 + sigma_range**2)
    assert plots.covariance[0] == pytest.approx(covariance, rel=1e-9, abs=loss)
    assert plots.sigma[0] == pytest.approx(np.sqrt(np.diagonal(plots.covariance[0])))


def quadrature(plot, noise):
    """Mean square of the errors of a debiased position over the errors of the plot, numerically."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(40)
    weights = weights / weights.sum()
    r, a, e = (
        value - sigma * nodes.reshape(shape)
        for value, sigma, shape in zip(plot, noise, np.eye(3, dtype=int) * 39 + 1, strict=True)
    )
    w = np.einsum("i,j,k->ijk", weights, weights, weights)
    true = np.stack(
        np.broadcast_arrays(r * np.cos(e) * np.sin(a), r * np.cos(e) * np.cos(a), r * np.sin(e))
    )
    estimate = converted(
        *plot, **dict(zip(("sigma_range", "sigma_azimuth", "sigma_elevation"), noise, strict=True))
    )
    error = estimate.position[0][:, None, None, None] - true
    return estimate.covariance[0], np.einsum("ijk,aijk,bijk->ab", w, error, error)


@settings(max_examples=40)
@given(
    st.floats(10, 1e4), azimuths, elevations, st.floats(0, 3), st.floats(0, 0.5), st.floats(0, 0.5)
)
def test_the_covariance_is_the_mean_square_error_given_the_plot(r, a, e, sr, sa, se):
    found, expected = quadrature((r, a, e), (sr, sa, se))
    assert found == pytest.approx(expected, rel=1e-7, abs=1e-11 * r**2)
    assert np.array_equal(found, found.T)


@given(ranges, azimuths, elevations, st.floats(1e-3, 1e3), angle_noises, angle_noises)
def test_covariances_are_positive(r, a, e, sr, sa, se):
    noise = {"sigma_range": sr, "sigma_azimuth": sa}
    flat = converted(r, a, **noise).covariance[0]
    high = converted(r, a, e, **noise, sigma_elevation=se).covariance[0]
    for covariance in (flat, high):
        assert np.linalg.eigvalsh(covariance).min() > -1e-12 * np.trace(covariance)
        assert (np.diagonal(covariance) > 0).all()


@given(ranges, azimuths, st.floats(0, 1e3), angle_noises)
def test_a_level_plot_without_noise_in_elevation_is_one_in_the_plane(r, a, sr, sa):
    flat = converted(r, a, sigma_range=sr, sigma_azimuth=sa)
    high = converted(r, a, 0.0, sigma_range=sr, sigma_azimuth=sa, sigma_elevation=0.0)
    assert np.array_equal(high.position[:, :2], flat.position)
    assert np.array_equal(high.covariance[:, :2, :2], flat.covariance)
    assert not high.covariance[:, 2].any()


@given(ranges, azimuths, st.floats(0.1, 10), st.floats(1e-8, 1e-6))
def test_small_noise_is_that_of_the_linear_conversion(r, a, sr, sa):
    covariance = converted(r, a, sigma_range=sr, sigma_azimuth=sa).covariance[0]
    along, across = np.array([np.sin(a), np.cos(a)]), np.array([np.cos(a), -np.sin(a)])
    assert along @ covariance @ along == pytest.approx(sr**2, rel=1e-6)
    assert across @ covariance @ across == pytest.approx(
        (r**2 + sr**2) * sa**2, rel=1e-3, abs=1e-14 * sr**2
    )


def test_no_noise_gives_the_plain_position_and_zeros():
    exact = converted(7e5, 1.0, sigma_range=0.0, sigma_azimuth=0.0)
    assert np.array_equal(exact.position, converted(7e5, 1.0).position)
    assert not exact.covariance.any()


def random_plots(seed, place, noise, count=400_000):
    """Plots of a target at rest: range, azimuth and elevation with Gaussian errors."""
    rng = np.random.default_rng(seed)
    pairs = zip(place, noise, strict=True)
    return [value + sigma * rng.standard_normal(count) for value, sigma in pairs]


@pytest.mark.parametrize("degrees", [2.0, 10.0, 30.0])
def test_positions_are_unbiased_where_plain_ones_are_not(degrees):
    """At 100 km and 10°, plain positions are 1.5 km too near; debiased ones within the noise."""
    place, noise = (100e3, 0.7, 0.4), (50.0, np.radians(degrees), np.radians(degrees) / 3)
    r, a, e = random_plots(1, place, noise)
    true = converted(*place).position[0]
    sigmas = {"sigma_range": noise[0], "sigma_azimuth": noise[1]}
    flat_true = converted(*place[:2]).position[0]
    flat = polar_to_cartesian(r, a, **sigmas).position
    high = polar_to_cartesian(r, a, e, **sigmas, sigma_elevation=noise[2]).position
    for found, right in ((flat, flat_true), (high, true)):
        standard_error = found.std(axis=0) / np.sqrt(len(found))
        assert (np.abs(found.mean(axis=0) - right) < 4 * standard_error).all()
    plain = polar_to_cartesian(r, a).position.mean(axis=0)
    bias = np.exp(-(noise[1] ** 2) / 2) - 1
    assert plain - flat_true == pytest.approx(bias * flat_true, abs=5 * noise[1] * 100e3 / 630)
    if degrees == 10.0:
        assert np.linalg.norm(plain - flat_true) == pytest.approx(1512, abs=60)


def normalized_square(error, covariance):
    """Mean over the plots of the error's square, measured by its covariance."""
    solved = np.linalg.solve(covariance, error[..., None])[..., 0]
    return np.mean(np.sum(error * solved, axis=1))


@pytest.mark.parametrize("degrees", [0.1, 1.0, 10.0, 20.0])
def test_errors_are_as_large_as_the_covariance_says(degrees):
    """The normalized square is the number of axes, where that of plain positions is 2700 (10°)."""
    place, noise = (100e3, 0.7, 0.4), (50.0, np.radians(degrees), np.radians(degrees) / 3)
    r, a, e = random_plots(2, place, noise, 100_000)
    sigmas = {"sigma_range": noise[0], "sigma_azimuth": noise[1]}
    flat_true, true = converted(*place[:2]).position[0], converted(*place).position[0]
    flat = polar_to_cartesian(r, a, **sigmas)
    high = polar_to_cartesian(r, a, e, **sigmas, sigma_elevation=noise[2])
    few, many = (0.98, 1.02) if degrees <= 10 else (0.98, 1.04)
    assert 2 * few < normalized_square(flat.position - flat_true, flat.covariance) < 2 * many
    assert 3 * few < normalized_square(high.position - true, high.covariance) < 3 * many
    if degrees == 10.0:
        plain = polar_to_cartesian(r, a).position - flat_true
        along, across = np.stack([np.sin(a), np.cos(a)]), np.stack([np.cos(a), -np.sin(a)])
        lengths = (noise[0], r * noise[1])
        parts = [(plain.T * way).sum(axis=0) for way in (along, across)]
        linear = sum(np.mean((part / n) ** 2) for part, n in zip(parts, lengths, strict=True))
        assert linear == pytest.approx(2700, rel=0.05)


# -------------------------------------------------------------------- wrong arguments


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"azimuth": [1.0, 2.0]}, r"`azimuth`: shape \(2,\); .* \(1,\), as `range` has"),
        ({"range": 1.0}, r"`range`: shape \(\); expected one value for each plot$"),
        ({"azimuth_from": "south"}, "`azimuth_from`: 'south'; expected north or east"),
        ({"sigma_range": 1.0}, "`sigma_azimuth`: is missing; `sigma_range` was given"),
        ({"sigma_azimuth": 0.1}, "`sigma_range`: is missing; `sigma_azimuth` was given"),
        ({"sigma_elevation": 0.1}, "`sigma_elevation`: the plots have no elevation"),
        (
            {"elevation": [0.1], "sigma_range": 1.0, "sigma_azimuth": 0.1},
            "`sigma_elevation`: is missing; `sigma_range` was given",
        ),
        (
            {"sigma_range": 1.0, "sigma_azimuth": [3.0]},
            r"`sigma_azimuth`: 3 rad \(171.887°\) at plot 0; expected 0 to 1 rad \(57.2958°\)",
        ),
        (
            {"sigma_range": -1.0, "sigma_azimuth": 0.1},
            r"`sigma_range`: -1; expected 0 to 1e\+15",
        ),
        ({"sigma_range": np.nan, "sigma_azimuth": 0.1}, "`sigma_range`: nan; expected"),
        ({"sigma_range": [1.0, 1.0], "sigma_azimuth": 0.1}, r"`sigma_range`: shape \(2,\)"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises(ValueError, match=message):
        polar_to_cartesian(**{"range": [1.0], "azimuth": [1.0], **arguments})


def test_wrong_positions():
    with pytest.raises(ValueError, match=r"`position`: shape \(1, 4\); expected \(n, 2\) or"):
        cartesian_to_polar(np.zeros((1, 4)))
    with pytest.raises(ValueError, match="expected north or east"):
        cartesian_to_polar(np.zeros((1, 2)), azimuth_from="west")
