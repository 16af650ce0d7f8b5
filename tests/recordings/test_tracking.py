"""Recorded plots tracked in one call."""

import math

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.recordings.preparation import DEFAULT_TRACKER, DEFAULT_WITHOUT_NOISE
from fuzzytrack.trackers.catalog import make_tracker


@pytest.fixture
def plots():
    """A target that flies straight for 60 s, seen with a deviation of 3 m."""
    rng = np.random.default_rng(5)
    t = np.arange(60.0)
    truth = np.stack([12 * t, 300 - 4 * t], axis=1)
    return t, truth + rng.normal(size=truth.shape) * 3


def as_text(t, z):
    rows = (f"{a},{b},{c}" for a, (b, c) in zip(t.tolist(), z.tolist(), strict=True))
    return "\n".join(["t,x,y", *rows]) + "\n"


def test_arrays_frames_tables_and_files_give_the_same(plots, tmp_path):
    pandas = pytest.importorskip("pandas")
    arrow = pytest.importorskip("pyarrow")
    t, z = plots
    path = tmp_path / "plots.csv"
    path.write_text(as_text(t, z))
    columns = {"t": t, "x": z[:, 0], "y": z[:, 1]}
    whole = ft.track((t, z), sigma=3.0)
    for same in (columns, pandas.DataFrame(columns), arrow.table(columns), path, str(path)):
        other = ft.track(same, sigma=3.0)
        np.testing.assert_array_equal(other.results[0].filtered, whole.results[0].filtered)
    direct = make_tracker(DEFAULT_TRACKER).run(t, z, 3.0)
    np.testing.assert_array_equal(whole.results[0].filtered, direct.filtered)


def test_the_noise_is_estimated_unless_it_is_given(plots):
    tracked = ft.track(plots)
    decoder = tracked.recording.decoder
    assert decoder.sigma == pytest.approx(3.0, rel=0.3)
    error = decoder.noise_errors[0]
    assert 0 < error < 1
    assert ft.track(plots, sigma=[3.0, 4.0]).recording.decoder.sigma == (3.0, 4.0)
    # What the axes share would be wrong for both.
    assert "own" in repr(ft.track(plots, sigma=[3.0, 9.0]).tracker)


def test_too_few_plots_for_an_estimate_are_tracked_without_noise(plots):
    t, z = plots
    tracked = ft.track((t[:5], z[:5]))
    assert any(DEFAULT_WITHOUT_NOISE in note for note in tracked.findings.notes)
    expected = make_tracker(DEFAULT_WITHOUT_NOISE).run(t[:5], z[:5])
    np.testing.assert_array_equal(tracked.results[0].filtered, expected.filtered)
    # A tracker that is named is never replaced.
    with pytest.raises(ValueError, match="needs the standard deviation"):
        ft.track((t[:5], z[:5]), DEFAULT_TRACKER)
    fixed = ft.track((t[:5], z[:5]), "fixed:alpha=0.5:beta=0.2")
    assert any("too few plots" in note for note in fixed.findings.notes)


def test_a_table_of_all_tracks(plots):
    pandas = pytest.importorskip("pandas")
    t, z = plots
    stamps = pandas.Timestamp("2024-03-01T10:00:00Z") + pandas.to_timedelta(t, unit="s")
    frame = pandas.DataFrame({"time": stamps, "id": "a", "x": z[:, 0], "y": z[:, 1]})
    tracked = ft.track(frame, id="id", sigma=3.0)
    table = tracked.to_pandas()
    assert len(table) == 60
    assert list(table["id"].unique()) == ["a"]
    np.testing.assert_array_equal(table["x"], z[:, 0])
    np.testing.assert_array_equal(table["x_filtered"], tracked.results[0].filtered[:, 0])
    assert table["speed"].iloc[-1] == pytest.approx(math.hypot(12, 4), rel=0.1)
    assert table["course"].iloc[-1] == pytest.approx(math.degrees(math.atan2(12, -4)), abs=5)
    assert table["x_sd"].iloc[-1] < 3


def test_a_notebook_gets_a_table_and_a_picture(plots):
    t, z = plots
    ids = np.where(np.arange(60) % 2, "<b>", "a&b")
    html = ft.track({"t": t, "id": ids, "x": z[:, 0], "y": z[:, 1]}, id="id", sigma=3)._repr_html_()
    assert ">&lt;b&gt;</th>" in html
    assert "a&amp;b" in html
    assert "data:image/png;base64," in html
    assert html.count("<tr>") == 3


def test_more_tracks_than_a_notebook_lists():
    ids = np.repeat(np.arange(14), 3)
    tracked = ft.track(
        {"t": np.tile([0, 1, 2], 14), "id": ids, "x": np.arange(42.0)}, id="id", sigma=1.0
    )
    assert "and 4 more" in tracked._repr_html_()
    assert len(tracked) == 14


def test_a_gap_divides_a_track(plots, tmp_path):
    t, z = plots
    late = np.where(t < 30, t, t + 20_000)
    tracked = ft.track((late, z), sigma=3.0)
    assert [track.segment for track in tracked.recording.tracks] == [0, 1]
    assert tracked.findings.cleaning.segments == 1
    tracked.write(tmp_path / "out.csv")
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert [line.rsplit(",", 1)[1] for line in (lines[0], lines[1], lines[-1])] == [
        "segment",
        "0",
        "1",
    ]
    assert len(ft.track((late, z), sigma=3.0, max_gap=None)) == 1


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"polr": ("x", "y")}, TypeError, "no option 'polr'.*did you mean 'polar'"),
        ({"axes": ["q"]}, ft.DataError, "plots: `axes`: no column 'q'"),
        ({"sigma": -1.0}, ValueError, "sigma: must be > 0, got -1"),
        ({"sigma": (1.0, 2.0, 3.0)}, ft.DataError, "sigma: 3 given for 2 axes"),
        ({"duplicates": "some"}, ValueError, "duplicates: 'some'; expected one of"),
    ],
)
def test_wrong_options(plots, options, error, message):
    with pytest.raises(error, match=message):
        ft.track(plots, **options)


def test_what_is_no_recording():
    with pytest.raises(TypeError, match="plots must be a file, a folder, a data frame"):
        ft.track(5)
    with pytest.raises(ft.DataError, match="column 't' has 2 rows, column 'x' has 1"):
        ft.track({"t": [0, 1], "x": [1]})
    with pytest.raises(ft.DataError, match=r"plots: shape must be .* got \(2, 2, 2\)"):
        ft.track(([0, 1], np.zeros((2, 2, 2))))


def test_masked_plots_are_missed(plots):
    t, z = plots
    masked = np.ma.masked_array(z, mask=np.zeros(z.shape, dtype=bool))
    masked[10] = np.ma.masked
    bare = z.copy()
    bare[10] = math.nan
    found, expected = ft.track((t, masked), sigma=3.0), ft.track((t, bare), sigma=3.0)
    np.testing.assert_array_equal(found.results[0].filtered, expected.results[0].filtered)
    assert found.totals.missed == 1


def test_several_files_are_one_recording(plots, tmp_path):
    t, z = plots
    for name, part in (("a.csv", slice(0, 25)), ("b.csv", slice(25, None))):
        (tmp_path / name).write_text(as_text(t[part], z[part]))
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    found, expected = ft.track(files, sigma=3.0), ft.track((t, z), sigma=3.0)
    np.testing.assert_array_equal(found.results[0].filtered, expected.results[0].filtered)


@pytest.mark.filterwarnings("error")
def test_numbers_beyond_any_use_are_counted_without_a_warning():
    t = np.arange(20.0)
    tracked = ft.track((t, np.stack([np.where(t % 2, 1e308, -1e308), t], axis=1)), sigma=1.0)
    assert tracked.findings.cleaning.fills == 20


@pytest.mark.untraced
def test_a_target_that_moves_by_more_than_its_noise_is_not_gated():
    """As a drone with a positioning error of centimeters."""
    rng = np.random.default_rng(9)
    t = np.arange(400.0)
    # Accelerations of up to 4 m/s² for 4 s each.
    z = np.cumsum(np.cumsum(np.repeat(rng.uniform(-4, 4, (100, 2)), 4, axis=0), axis=0), axis=0)
    z += 0.05 * rng.normal(size=z.shape)
    tracked = ft.track((t, z))
    sigma = tracked.recording.decoder.sigma
    assert tracked.findings.rejected == 0
    assert len(tracked) == 1
    # What is told is taken as told.
    assert ft.track((t, z), sigma=0.05).findings.rejected > 0
    assert ft.track((t, z), sigma=sigma, gate=None).findings.rejected == 0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "no file is given"),
        ({}, "holds no columns"),
        ({"t": 1.0, "x": 2.0}, "column 't': shape \\(\\); expected one value a row"),
    ],
)
def test_plots_that_are_none(given, message):
    with pytest.raises(ft.DataError, match=message):
        ft.track(given)


def test_a_frame_with_two_columns_of_one_name():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame([[0.0, 1.0, 2.0]], columns=["t", "x", "x"])
    with pytest.raises(ft.DataError, match="two columns are called 'x'"):
        ft.track(frame)


@pytest.mark.parametrize("gate", ["x", math.nan, -1, math.inf, True])
def test_a_gate_of_another_kind_is_named(plots, gate):
    with pytest.raises(ValueError, match="gate: must be a "):
        ft.track(plots, gate=gate)


def test_a_format_of_another_kind_is_named(plots):
    with pytest.raises(ValueError, match="format: must be the name of a format, got 3"):
        ft.track(plots, format=3)


def test_masked_whole_numbers_stay_exact():
    first = 1_700_000_000_000_000_000
    time = np.ma.masked_array(first + np.arange(5) * 7, mask=False)
    x = np.ma.masked_array(np.arange(5.0), mask=[0, 0, 1, 0, 0])
    tracked = ft.track({"t_ns": time, "x": x}, "stiffness-damping", sigma=1.0, least_step=1e-9)
    assert np.diff(tracked.recording.tracks[0].time).tolist() == pytest.approx([7e-9] * 4)
    assert tracked.totals.missed == 1


def test_longitudes_may_count_from_0_to_360():
    t = np.arange(40.0)
    noise = np.random.default_rng(3).normal(size=(2, 40)) * 1e-5
    lat, lon = 10 + 1e-4 * t + noise[0], 359.998 + 1e-4 * t + noise[1]
    for east in (lon % 360, lon - 170):
        given = {"t": t, "lat": lat, "lon": east}
        tracked = ft.track(given, geodetic=("lat", "lon"), sigma=1.0)
        same = {"t": t, "lat": lat, "lon": (east + 180) % 360 - 180}
        usual = ft.track(same, geodetic=("lat", "lon"), sigma=1.0)
        filtered = [each.results[0].filtered for each in (tracked, usual)]
        assert tracked.totals.plots == usual.totals.plots == 40
        assert np.ptp(filtered[0], axis=0) == pytest.approx(np.ptp(filtered[1], axis=0), abs=0.1)


def test_a_longitude_that_stands_for_none_is_no_origin():
    t = np.arange(20.0)
    lon = np.where(t == 0, 181.0, 5 + 1e-4 * t)
    tracked = ft.track({"t": t, "lat": 10 + 0 * t, "lon": lon}, geodetic=("lat", "lon"), sigma=1.0)
    assert tracked.totals.missed == 1


def test_no_line_joins_a_full_circle_and_zero():
    t = np.arange(12.0)
    tracked = ft.track({"t": t, "bearing": (354 + t) % 360}, angle="bearing", sigma=0.2)
    axes = tracked.plot().axes[0]
    assert axes.get_ylabel() == "bearing (deg)"
    joining = [line for line in axes.get_lines() if line.get_linestyle() != "None"]
    assert joining
    for line in joining:
        steps = np.abs(np.diff(np.asarray(line.get_ydata(), dtype=float)))
        assert not (steps > 180).any()
