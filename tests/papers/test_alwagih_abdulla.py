"""Figures that an independent implementation found; tolerances are its own plus three of our
standard errors at the number of runs used here."""

import math

import numpy as np
import pytest
from scipy import stats

from fuzzytrack.papers import alwagih_abdulla, reproduce
from fuzzytrack.papers.alwagih_abdulla import scenario, trackers
from fuzzytrack.papers.alwagih_abdulla_tables import (
    METHODS,
    SLIPS,
    TABLE_1,
    TABLE_2,
    TABLE_3,
    averages,
    changes,
    differences,
    p_value,
    table_rows,
)

RUNS = 30

pytestmark = pytest.mark.untraced


@pytest.fixture(scope="module")
def found():
    return reproduce("alwagih-abdulla", RUNS)


# ---------------------------------------------------------------- scenario S3


@pytest.mark.parametrize(
    ("method", "expected"),
    [
        ("M1", (43.56, 279.64)),
        ("M2", (46.29, 68.19)),
        ("M3", (46.23, 72.02)),
        ("M1, α = 0.01", (60.58, 1102.6)),
    ],
)
def test_without_noise(found, method, expected):
    for axis, value in zip("XY", expected, strict=True):
        within = 0.05 if value > 1000 else 0.01
        assert found.ours(f"{method}: {axis}, no noise (m)") == pytest.approx(value, abs=within)


@pytest.mark.parametrize(
    ("method", "noise", "expected", "within", "spread"),
    [
        # spread: standard deviation over runs
        ("M1", "white", (43.7, 279.6), (0.5, 1), (1.1, 2.5)),
        ("M2", "white", (46.7, 68.6), (0.5, 1), (1.2, 3.4)),
        ("M3", "white", (46.6, 72.4), (0.5, 1), (1.2, 3.4)),
        ("M4", "white", (14.0, 272.4), (0.8, 1), (1.9, 2.5)),
        ("M5", "white", (10.7, 18.0), (0.3, 0.5), (1.1, 1.9)),
        ("M5 last", "white", (19.0, 29.4), (0.5, 0.8), (1.9, 2.9)),
        ("M5 best", "white", (9.1, 16.7), (0.4, 0.6), (1.7, 2.4)),
        ("M5 soft", "white", (9.6, 17.3), (0.4, 0.6), (1.2, 1.9)),
        ("plots", "white", (14.8, 22.7), (0.1, 0.1), (1.1, 1.6)),
        ("M5", "coloured", (17.4, 21.7), (0.5, 0.6), (2.5, 3.0)),
        ("M5 last", "coloured", (23.8, 29.0), (0.5, 0.8), (2.7, 3.2)),
        ("M5 best", "coloured", (21.5, 27.2), (0.5, 0.8), (3.3, 3.9)),
        ("M5 soft", "coloured", (19.4, 25.1), (0.5, 0.6), (2.9, 3.6)),
        # without tolerances of their own, those of white noise
        ("M1", "coloured", (44.2, 279.8), (0.5, 1), (3.3, 6.0)),
        ("M2", "coloured", (48.2, 69.9), (0.5, 1), (3.6, 7.9)),
        ("M3", "coloured", (48.1, 73.6), (0.5, 1), (3.6, 7.9)),
        ("M4", "coloured", (13.4, 272.4), (0.8, 1), (2.9, 5.9)),
    ],
)
def test_errors(found, method, noise, expected, within, spread):
    for axis, value, off, deviation in zip("XY", expected, within, spread, strict=True):
        ours = found.ours(f"{method}: {axis}, {noise} (m)")
        assert ours == pytest.approx(value, abs=off + 3 * deviation / math.sqrt(RUNS))


@pytest.mark.parametrize(
    ("gain", "axis", "white", "coloured"), [("0.3", "X", 9.7, 18.1), ("0.4", "Y", 16.4, 23.9)]
)
def test_one_fixed_gain_is_as_good_as_the_bank(found, gain, axis, white, coloured):
    for noise, value in (("white", white), ("coloured", coloured)):
        ours = found.ours(f"fixed α = {gain}: {axis}, {noise} (m)")
        assert ours == pytest.approx(value, abs=0.3 + 3 * 4.5 / math.sqrt(RUNS))
        assert ours < found.ours(f"M5 last: {axis}, {noise} (m)")


def test_only_m4_in_x_is_not_like_the_averages(found):
    rows = [r for r in found.rows if r.table in ("Table 1", "Table 2") and r.published is not None]
    assert len(rows) == 20
    differing = {r.quantity for r in rows if r.verdict == "differs"}
    assert differing == {"M4: X, white (m)", "M4: X, coloured (m)"}
    assert all(r.why and r.se > 0 and r.runs == RUNS for r in rows)


def test_the_published_average_is_beside_ours(found):
    row = next(r for r in found.rows if r.quantity == "M2: Y, coloured (m)")
    mean = (78.7142 + 84.7149 + 102.6156 + 79.9087 + 85.0407) / 5
    assert row.published == pytest.approx(mean, rel=1e-12)


def test_few_runs_have_the_same_numbers_whether_compiled_or_not(found, monkeypatch):
    shares = []
    plain = reproduce("alwagih-abdulla", 2, progress=shares.append)
    monkeypatch.setattr(alwagih_abdulla, "_COMPILED_RUNS", 1)
    assert reproduce("alwagih-abdulla", 2).rows == plain.rows
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_one_run_has_no_standard_errors():
    assert all(r.se is None for r in reproduce("alwagih-abdulla", 1).rows)


def test_the_first_two_plots_are_clean_and_their_errors_count_as_none():
    experiment = scenario("coloured")
    assert (experiment.name, experiment.sensors.clean) == ("s3-coloured", 2)
    tracker = trackers()["M1"]
    errors = tracker.run(experiment.time, experiment.position).predicted - experiment.position
    assert np.isnan(errors[:2]).all()
    with pytest.raises(ValueError, match="noise: unknown 'pink'; one of white, coloured"):
        scenario("pink")


def test_pictures(found):
    plt = pytest.importorskip("matplotlib.pyplot")
    for name, draw in found.pictures.items():
        figure = draw()
        (axes,) = figure.axes
        drawn = [line for line in axes.lines if not line.get_label().startswith("_")]
        assert len(drawn) == 4
        if name.startswith("fig"):
            assert [label.get_text() for label in axes.get_yticklabels()] == list(METHODS)
            assert drawn[0].get_xdata()[0] in (
                float(averages(TABLE_1)["M1", "X"]), float(averages(TABLE_2)["M1", "X"])
            )  # fmt: skip
        plt.close(figure)


# ---------------------------------------------------------------- printed tables


def test_tables_1_and_2_have_the_averages_read_off_the_paper():
    for errors, x, y in (
        (TABLE_1, (39.9, 37.0, 36.7, 25.9, 11.0), (299.0, 63.2, 66.6, 271.8, 18.3)),
        (TABLE_2, (50.0, 43.8, 43.3, 33.1, 17.3), (294.8, 86.2, 86.5, 277.3, 21.9)),
    ):
        mean = averages(errors)
        for method, *values in zip(METHODS, x, y, strict=True):
            ours = [float(mean[method, axis]) for axis in "XY"]
            assert ours == pytest.approx(values, abs=0.0501)


def test_recomputation_against_floating_point():
    errors = np.array(TABLE_2, dtype=float).reshape(5, 2, 5)
    expected = (errors[:, :, :2, None] - errors[:, :, None, 2:]).mean(axis=0)
    ours = np.array(differences(TABLE_2), dtype=float).reshape(2, 2, 3)
    np.testing.assert_allclose(ours, expected.swapaxes(0, 1), rtol=1e-12)
    percent = 100 * (1 - errors[:, :, 2:] / errors[:, :, :1])
    np.testing.assert_allclose(
        np.array(changes(TABLE_2), dtype=float), percent.reshape(10, 3), rtol=1e-11
    )


def test_just_the_known_slips_differ():
    rows = [r for r in table_rows() if r.table != "Section 7"]
    assert len(rows) == 12 + 12 + 30 + 30
    assert {(r.table, r.quantity) for r in rows if r.verdict == "differs"} == set(SLIPS)
    assert {(r.table, r.quantity): r.why for r in rows if r.why} == SLIPS


@pytest.mark.parametrize(
    ("table", "quantity", "printed", "ours"),
    [
        ("Table 3", "M1 - M3 in X, average", 4.7713, 3.2747),
        ("Table 3", "M2 - M3 in X, average", 0.3343, 0.2891),
        ("Table 3", "M2 - M4 in X, average", 11.8137, 11.1014),
        ("Table 3", "M2 - M3 in Y, average", 3.5122, -3.4251),
        ("Table 3", "M1 - M3 in Y, average", 232.2810, 232.3681),
        ("Table 3", "M1 - M4 in Y, average", 27.3819, 27.2110),
        ("Table 3", "M2 - M4 in Y, average", -208.4113, -208.5822),
        ("Table 4", "M1 - M3 in X, average", 9.4102, 6.7077),
        ("Table 4", "M2 - M3 in X, average", 0.5262, 0.5207),
        ("Table 4", "M2 - M4 in X, average", 11.8695, 10.6918),
        ("Table 4", "M2 - M3 in Y, average", 0.5287, -0.3415),
        ("Table 5", "M4 in Y, experiment 4 (%)", 99.0708, 7.0792),
        ("Table 5", "M4 in Y, experiment 5 (%)", 9.4433, 9.3365),
        ("Table 6", "M3 in Y, experiment 2 (%)", 69.5368, 69.5386),
        ("Table 6", "M5 in Y, experiment 1 (%)", 92.6098, 92.6096),
    ],
)
def test_slips(table, quantity, printed, ours):
    (row,) = [r for r in table_rows() if (r.table, r.quantity) == (table, quantity)]
    assert row.published == printed
    assert row.ours == pytest.approx(ours, abs=0.51e-4)


def test_why_the_slips_are_what_they_are_said_to_be():
    white = np.array(TABLE_1, dtype=float)
    x, y = white[::2], white[1::2]
    printed = np.array(TABLE_3, dtype=float)
    # Absolute differences, with mixed signs
    assert abs(x[:, 0] - x[:, 2]).mean() == pytest.approx(printed[0, 0], abs=1e-4)
    assert abs(x[:, 1] - x[:, 3]).mean() == pytest.approx(printed[2, 1], abs=1e-4)
    # One average of M3 and one of M4 explain both rows of Y.
    m3, m4 = y[:, 2].mean() + 0.0871, y[:, 3].mean() - 0.1709
    m1, m2 = y[:, :2].mean(axis=0)
    expected = [m1 - m3, m1 - m4, m3 - m2, m2 - m4]
    np.testing.assert_allclose([*printed[1, :2], *printed[3, :2]], expected, atol=1e-4)
    assert (y[:, 2] > y[:, 1]).all()
    assert y[3, 0] * (1 - 0.990708) == pytest.approx(2.79, abs=0.005)
    assert y[4, 0] * (1 - 0.094433) == pytest.approx(278.191, abs=5e-4)


@pytest.mark.parametrize("errors", [TABLE_1, TABLE_2])
@pytest.mark.parametrize("axis", "XY")
@pytest.mark.parametrize("pair", [("M1", "M3"), ("M2", "M4"), ("M2", "M3")])
def test_p_values(errors, axis, pair):
    lines = np.array(errors, dtype=float)["XY".index(axis) :: 2]
    first, second = (lines[:, METHODS.index(name)] for name in pair)
    expected = stats.ttest_rel(first, second).pvalue
    assert p_value(errors, *pair, axis) == pytest.approx(expected, rel=1e-9)


def test_most_differences_are_not_very_highly_significant(found):
    assert found.ours("paired t-tests with p < 0.001") == 11
    for noise in ("white", "coloured"):
        assert found.ours(f"p of M1 - M3 in X, {noise}") == pytest.approx(0.32, abs=0.005)
    assert found.ours("p of M2 - M4 in X, white") == pytest.approx(0.16, abs=0.006)
    assert found.ours("p of M2 - M4 in X, coloured") == pytest.approx(0.13, abs=0.005)
    assert found.ours("M4 over M3 in Y, white") == pytest.approx(4.08, abs=0.01)
