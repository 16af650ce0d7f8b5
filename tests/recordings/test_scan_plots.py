"""Recordings of plots without identities, read as scans."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack import DataError, track_scans
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_plots import ScanPlots, scans_of


def plots_of(**columns):
    return {name: np.asarray(values) for name, values in columns.items()}


def read(data, reading=None, **options):
    made = ScanPlots.of(data, Reading.of(**(reading or {})), **options)
    return made, list(made.scans())


THREE = plots_of(
    n=[1, 1, 2, 3, 3],
    t=[0.0, 0.0, 2.0, 4.1, 4.1],
    x=[1.0, 2.0, 1.1, 1.2, 2.2],
    y=[5.0, 6.0, 5.1, 5.2, 6.2],
)


def test_scans_by_a_column():
    made, found = read(THREE, scan="n")
    assert [group for group, _ in found] == ["", "", ""]
    scans = [scan for _, scan in found]
    assert [scan.time for scan in scans] == [0.0, 2.0, 4.1]
    assert [scan.rows.tolist() for scan in scans] == [[1, 2], [3], [4, 5]]
    np.testing.assert_array_equal(scans[2].positions, [[1.2, 5.2], [2.2, 6.2]])
    assert all(scan.times is None and scan.covariances is None for scan in scans)
    assert all(math.isnan(scan.own[0] + scan.own[1]) for scan in scans)
    assert (made.findings.scans, made.findings.plots, made.findings.empty) == (3, 5, 0)


def test_the_place_of_a_radar_that_does_not_move_is_given_as_numbers():
    _, found = read(THREE, scan="n", own=("-20", "3.5"))
    assert [scan.own for _, scan in found] == [(-20.0, 3.5)] * 3


def test_plots_in_range_and_azimuth_have_their_radar_at_the_origin():
    data = plots_of(scan=[0, 1], t=[0.0, 1.0], r=[10.0, 11.0], az=[90.0, 91.0])
    _, found = read(data, {"polar": ("r", "az")})
    assert [scan.own for _, scan in found] == [(0.0, 0.0)] * 2
    with pytest.raises(ValueError, match="own: plots in range and azimuth are relative"):
        read(data, {"polar": ("r", "az")}, own=("1", "2"))


def test_a_column_with_a_usual_name_is_found():
    made = ScanPlots.of({"scan": THREE["n"], **THREE})
    assert made.said == "by column scan"


def test_missing_numbers_are_scans_without_a_plot():
    data = plots_of(scan=[1, 1, 4], t=[0.0, 0.0, 3.0], x=[0, 1, 2], y=[0, 1, 2])
    made, found = read(data)
    assert [(scan.time, len(scan)) for _, scan in found] == [(0, 2), (1, 0), (2, 0), (3, 1)]
    assert made.findings.empty == 2


def test_own_times_of_plots():
    data = plots_of(scan=[0, 0, 1], t=[0.3, 0.1, 2.2], x=[0, 1, 2], y=[0, 1, 2])
    _, found = read(data)
    assert found[0][1].time == 0.3
    np.testing.assert_array_equal(found[0][1].times, [0.3, 0.1])


def test_rows_without_a_position_are_counted_and_still_make_a_scan():
    data = plots_of(scan=[0, 1, 2], t=[0, 1, 2], x=[0, math.nan, 2], y=[0, 1, 1e20])
    made, found = read(data)
    assert [len(scan) for _, scan in found] == [1, 0, 0]
    assert (made.findings.missed, made.findings.fills, made.findings.empty) == (2, 1, 2)
    assert made.findings.sentences() == (
        "2 rows without a position left out",
        "1 of these with a value beyond any use",
    )


def test_copies_need_not_follow_each_other():
    data = plots_of(n=[0] * 5, t=[0.0] * 5, x=[2.0, 1.0, 2.0, 3.0, 1.0], y=[0.0, 1.0, -0.0, 0, 1])
    made, found = read(data, scan="n")
    assert found[0][1].rows.tolist() == [1, 2, 4]
    assert made.findings.copies == 2


def test_copies_of_a_plot_are_dropped():
    data = plots_of(scan=[0, 0, 0], t=[0, 0, 0], x=[1, 1, 2], y=[3, 3, 3])
    made, found = read(data)
    assert found[0][1].rows.tolist() == [1, 3]
    assert made.findings.copies == 1


def test_groups_begin_again():
    data = plots_of(
        place=["a", "a", "b", "b"], scan=[0, 1, 0, 1], t=[5, 6, 0, 1], x=range(4), y=range(4)
    )
    _, found = read(data, group="place")
    assert [(group, scan.time) for group, scan in found] == [("a", 5), ("a", 6), ("b", 0), ("b", 1)]


def test_a_group_that_comes_again_is_an_error():
    data = plots_of(g=["a", "b", "a"], scan=[0, 0, 1], t=[0, 0, 1], x=range(3), y=range(3))
    with pytest.raises(DataError, match="row 3, column g: 'a' comes again after 'b'"):
        read(data, group="g")
    _, found = read(data, {"sort": True}, group="g")
    assert [group for group, _ in found] == ["a", "a", "b"]


# -------------------------------------------------------------------- own position and noise


def test_position_of_the_radar():
    data = {**THREE, "rx": [7.0] * 5, "ry": [1, 1, 2, 3, 3]}
    made, found = read(data, scan="n", own=("rx", "ry"))
    assert [scan.own for _, scan in found] == [(7, 1), (7, 2), (7, 3)]
    assert "position of the radar from columns rx, ry" in made.findings.notes
    _, usual = read({**THREE, "own_x_m": data["rx"], "own_y_m": data["ry"]}, scan="n")
    assert [scan.own for _, scan in usual] == [(7, 1), (7, 2), (7, 3)]


def test_faults_of_the_position_of_the_radar_are_counted():
    ox = np.arange(10) * 5.0
    ox[3], ox[7] = np.nan, 1e4
    n, here = np.arange(10), np.zeros(10)
    data = plots_of(n=n, t=n * 1.0, x=ox + 100, y=here + 1, own_x=ox, own_y=here)
    data["x"][3] = 100.0
    made, found = read(data, scan="n")
    assert found[3][1].own == (10.0, 0.0)
    assert made.findings.sentences() == (
        "1 scan without the position of the radar: that of the one before was taken",
        "2 jumps of the position of the radar, taken as they are",
    )
    data["own_x"][:] = np.nan
    made, found = read(data, scan="n")
    assert "10 scans without the position of the radar: it is not known" in (
        made.findings.sentences()
    )


def test_plots_relative_to_own_ship():
    data = {**THREE, "sx": [7.0] * 5, "sy": [1, 1, 2, 3, 3]}
    made, found = read(data, {"own_ship": ("sx", "sy")}, scan="n")
    assert "position of the radar from columns sx, sy" in made.findings.notes
    assert [scan.own for _, scan in found] == [(7, 1), (7, 2), (7, 3)]
    np.testing.assert_array_equal(found[1][1].positions, [[8.1, 7.1]])


def test_polar_plots_have_the_covariance_of_their_noise():
    data = plots_of(scan=[0, 0], t=[0, 0], range=[1000, 500], az=[0, 90])
    reading = {"polar": ("range", "az"), "sigma_range": 5, "sigma_azimuth": 1}
    _, ((_, scan),) = read(data, reading)
    np.testing.assert_allclose(scan.positions, [[0, 1000], [500, 0]], rtol=1e-3, atol=1e-9)
    across = math.radians(1)
    np.testing.assert_allclose(scan.covariances[0], [(1000 * across) ** 2, 0, 25], 0.02, 1)
    np.testing.assert_allclose(scan.covariances[1], [25, 0, (500 * across) ** 2], 0.02, 1)
    _, ((_, plain),) = read(data, {"polar": ("range", "az")})
    assert plain.covariances is None


def test_standard_deviations_of_cartesian_plots():
    _, found = read({**THREE, "s": np.arange(1.0, 6.0)}, {"sigma": ("s", 2.0)}, scan="n")
    np.testing.assert_array_equal(found[0][1].covariances, [[1, 0, 4], [4, 0, 4]])


def test_a_list_of_scans(tmp_path):
    listed = tmp_path / "scans.csv"
    listed.write_text(
        "n,t,own_x,own_y\n0,-2,1,1\n1,0,2,1\n2,2,3,1\n3,4,4,1\n4,6,5,1\n", encoding="utf-8"
    )
    made, found = read(THREE, scan="n", scans=listed)
    assert [(scan.time, len(scan)) for _, scan in found] == [
        (-2, 0), (0, 2), (2, 1), (4.1, 2), (6, 0),
    ]  # fmt: skip
    assert [scan.own[0] for _, scan in found] == [1, 2, 3, 4, 5]
    assert made.findings.empty == 2


def test_polar_plots_about_the_positions_of_a_list(tmp_path):
    listed = tmp_path / "scans.csv"
    listed.write_text("scan,t,own_x,own_y\n0,0,100,50\n", encoding="utf-8")
    data = plots_of(scan=[0], t=[0], range=[10.0], az=[90.0])
    _, ((_, scan),) = read(data, {"polar": ("range", "az")}, scan="scan", scans=listed)
    np.testing.assert_allclose(scan.positions, [[110, 50]])
    assert scan.own == (100, 50)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("n,t\n1,0\n1,1\n", "row 3, column n: '1' is also in row 2; expected each scan once"),
        ("n,t\n1,0\n2,0\n", "row 3, column t: 0 is not later than 0 of the scan before"),
        ("n,t\n1,0\n3,1\n", "row 3: scan '2' is not in"),
        ("n,t\n2,0\n1,1\n3,2\n", "row 3: scan '2' comes after '1'"),
        ("m,t\n1,0\n", "`scan`: no column 'n'"),
        ("n,time\n1,0\n", "`time`: no column 't'"),
        ("n,t\n", "holds no rows"),
    ],
)
def test_lists_that_do_not_fit(tmp_path, text, said):
    listed = tmp_path / "scans.csv"
    listed.write_text(text, encoding="utf-8")
    with pytest.raises(DataError) as error:
        read(THREE, scan="n", scans=listed)
    assert said in str(error.value)


# -------------------------------------------------------------------- recognition


def turning(period, *, n=40, turns=20, start=3.0, clockwise=True, seed=1, missed=0.3):
    """Fixed targets seen by a turning antenna; the turn of each plot."""
    rng = np.random.default_rng(seed)
    bearing, distance = rng.uniform(0, 2 * np.pi, n), rng.uniform(1e3, 2e4, n)
    turn, target = np.meshgrid(np.arange(turns), np.arange(n), indexing="ij")
    keep = rng.uniform(size=turn.shape) > missed
    turn, target = turn[keep], target[keep]
    share = bearing[target] / (2 * np.pi)
    time = start + period * (turn + (share if clockwise else 1 - share))
    order = np.argsort(time)
    x, y = distance * np.sin(bearing), distance * np.cos(bearing)
    columns = plots_of(t=time[order], x=x[target][order], y=y[target][order])
    return columns, turn[order], target[order]


@pytest.mark.parametrize("period", [1.0, 2.437, 12.0])
@pytest.mark.parametrize("clockwise", [True, False])
def test_a_turning_antenna_is_recognized_by_bearings(period, clockwise):
    columns, _, target = turning(period, clockwise=clockwise)
    made = ScanPlots.of(columns)
    assert made.cut.rule == "period"
    assert made.cut.period == pytest.approx(period, rel=1e-3)
    assert ("counter-" in made.said) is not clockwise
    # No target twice in a scan: the scans are turns.
    for scan in scans_of(columns):
        seen = target[scan.rows - 1]
        assert len(set(seen.tolist())) == len(seen)


def test_a_turning_antenna_is_recognized_by_the_longest_time_without_a_long_gap():
    columns, _, _ = turning(2.437)
    # Five times some plots, and 70 hours without any between them.
    columns["t"] += np.searchsorted([30, 60, 90, 400], np.arange(len(columns["t"]))) * 252_000.0
    made = ScanPlots.of(columns)
    assert made.cut.rule == "period"
    assert made.cut.period == pytest.approx(2.437, rel=1e-3)


def test_equal_times_are_recognized():
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(1.6, 1.76, 30))
    t = np.repeat(times, 4)
    data = plots_of(t=t, x=rng.normal(0, 100, 120), y=rng.normal(0, 100, 120))
    made, found = read(data)
    assert made.said.startswith("plots of equal time are a scan; one every 1.6")
    assert [scan.time for _, scan in found] == times.tolist()


def test_gaps_are_recognized_and_silent_scans_put_in():
    rng = np.random.default_rng(4)
    # Scans of some plots within 20 ms; the fourth has none.
    starts = np.array([k * 2.0 for k in range(20) if k != 4])
    t = np.sort((starts[:, None] + rng.uniform(0, 0.02, (19, 5))).ravel())
    data = plots_of(t=t, x=rng.normal(0, 100, 95), y=rng.normal(0, 100, 95))
    made, found = read(data)
    assert made.cut.rule == "gaps"
    assert made.cut.period == pytest.approx(2.0, rel=0.05)
    sizes = [len(scan) for _, scan in found]
    assert sizes == [5, 5, 5, 5, 0, *[5] * 15]


def test_a_few_plots_are_not_recognized():
    t = np.arange(5) * 1.0
    with pytest.raises(DataError, match="5 plots are too few to recognize it; name the column"):
        ScanPlots.of(plots_of(t=t, x=t, y=t))


def test_what_is_not_recognized_says_what_to_give():
    rng = np.random.default_rng(5)
    t = np.arange(50) + rng.uniform(0, 0.3, 50)
    data = plots_of(t=t, x=rng.normal(0, 100, 50), y=rng.normal(0, 100, 50))
    with pytest.raises(DataError, match=r"cannot tell which plots are of one scan.*`scan`"):
        ScanPlots.of(data)


def test_one_target_shows_no_turn():
    t = np.arange(100) * 10.0
    seen = np.random.default_rng(6).uniform(size=100) < 0.8
    data = plots_of(t=t[seen], x=100 + 3 * t[seen], y=200 - t[seen])
    made, found = read(data)
    assert made.said == "each plot is a scan; one every 10 s"
    assert [len(scan) for _, scan in found] == seen[
        seen.argmax() : 100 - seen[::-1].argmax()
    ].tolist()


def test_targets_at_equal_times_show_no_turn():
    # The antenna could turn either way, and more than once between two plots.
    side = np.tile([1.0, -1.0], 50)
    data = plots_of(t=np.arange(100) * 1.0, x=300 * side, y=100 * side)
    with pytest.raises(DataError, match="cannot tell which plots are of one scan"):
        ScanPlots.of(data)


@pytest.mark.parametrize("period", [60.0, 3.0, 0.05])
def test_a_period_that_the_plots_deny_is_noted(period):
    columns, *_ = turning(2.4)
    said = "the antenna turns clockwise in 2.4 s, by the bearings of the plots; leave `period` out"
    tracked = track_scans(columns, period=period)
    notes = [note for note in tracked.job.plots.findings.notes if "position" not in note]
    assert notes == [f"`period` is {period:.4g} s, but {said}, or give 2.4"]
    assert not ScanPlots.of(columns, period=2.41).findings.doubt


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(0, 0.35), min_size=3, max_size=12),
    st.integers(1, 4),
    st.floats(0.3, 20),
)
def test_scans_at_once_are_found_by_a_period_that_varies(jitter, plots, period):
    times = np.cumsum(period * (1 + np.array(jitter)))
    t = np.repeat(times, plots)
    data = plots_of(t=t, x=np.arange(len(t)) * 1.0, y=np.zeros(len(t)))
    _, found = read(data, period=period)
    assert [scan.time for _, scan in found if len(scan)] == times.tolist()
    assert [len(scan) for _, scan in found if len(scan)] == [plots] * len(times)


def test_turns_without_a_plot_are_scans():
    _, found = read(plots_of(t=[0.0, 10.1], x=[0, 1], y=[0, 1]), period=2)
    assert [(round(scan.time, 9), len(scan)) for _, scan in found] == [
        (0, 1), (2, 0), (4, 0), (6, 0), (8, 0), (10.1, 1),
    ]  # fmt: skip
    _, long = read(plots_of(t=[0.0, 1e6], x=[0, 1], y=[0, 1]), period=2)
    assert len(long) == 102


# -------------------------------------------------------------------- order


def test_times_that_fall():
    data = plots_of(t=[0.0, 5.0, 4.0, 9.0], x=range(4), y=range(4))
    with pytest.raises(DataError, match=r"row 3, column t: 4 is earlier than 5.*`sort`"):
        read(data, period=2)
    _, found = read(data, {"sort": True}, period=2)
    assert [scan.rows.tolist() for _, scan in found if len(scan)] == [[1], [3, 2], [4]]
    made, found = read(data, period=2, lateness=0)
    assert made.findings.late == 1
    made, found = read(data, period=2, lateness=1)
    assert made.findings.late == 0
    assert [scan.rows.tolist() for _, scan in found if len(scan)] == [[1], [3, 2], [4]]


def test_scans_that_fall_back():
    data = plots_of(scan=[0, 1, 2], t=[0, 5, 4], x=range(3), y=range(3))
    with pytest.raises(DataError, match="row 3, column t: the scan '2' of column scan ends at 4"):
        read(data)
    made, found = read(data, lateness=0)
    assert (len(found), made.findings.late) == (2, 1)


def test_a_scan_that_comes_again():
    data = plots_of(scan=[0, 1, 0], t=[0, 1, 2], x=range(3), y=range(3))
    with pytest.raises(DataError, match="row 3, column scan: scan '0' comes again after '1'"):
        read(data)


def test_midnight():
    t = [86390.0, 86394.0, 86398.0, 2.0, 6.0]
    data = plots_of(scan=range(5), t=t, x=range(5), y=range(5))
    made, found = read(data)
    assert [scan.time for _, scan in found] == [86390, 86394, 86398, 86402, 86406]
    assert made.findings.wraps == 1


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 30), st.sampled_from(["scan", "period", "late"]), st.integers(0, 5))
def test_pieces_of_any_size_give_the_same_scans(rows, how, seed):
    columns, turn, _ = turning(2.0, n=8, turns=6, seed=seed)
    options = {"period": 2.0}
    if how == "scan":
        columns, options = {"scan": turn, **columns}, {}
    if how == "late":
        rng = np.random.default_rng(seed)
        shuffled = np.argsort(columns["t"] + rng.uniform(0, 0.8, len(turn)))
        columns = {name: values[shuffled] for name, values in columns.items()}
        options["lateness"] = 0.4
    whole = ScanPlots.of(columns, **options)
    pieces = ScanPlots.of(columns, **options)
    pairs = zip(whole.scans(), pieces.scans(rows=rows), strict=True)
    for (_, one), (_, other) in pairs:
        assert one.time == other.time
        assert one.rows.tolist() == other.rows.tolist()
        np.testing.assert_array_equal(one.positions, other.positions)
    assert whole.findings == pieces.findings


# -------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("reading", "options", "said"),
    [
        ({}, {"period": 0}, "period: must be from 0.001 to 86400 s, got 0"),
        ({}, {"period": 2, "scan": "n"}, "scan and period: both say"),
        ({}, {"sectors": 3}, "sectors: must be from 4 to 1024, got 3"),
        ({}, {"sectors": 8, "scan": "n"}, "scan and sectors: sectors follow the antenna"),
        ({}, {"sectors": 8}, "the bearings of the plots do not follow an antenna; `sectors`"),
        ({}, {"lateness": -1}, "lateness: must be a number of seconds >= 0"),
        ({}, {"scan": "m"}, "`scan`: no column 'm'"),
        ({}, {"scan": "n", "group": "g"}, "`group`: no column 'g'"),
        ({}, {"scan": "n", "own": ("a", "b")}, "`own`: no column 'a'"),
        ({}, {"scan": "n", "own": ("x",)}, "own: 1 given; expected two columns"),
        ({"axes": ("x",)}, {"scan": "n"}, "plots of a scan have two coordinates"),
        ({"angle": "x"}, {"scan": "n"}, "plots of a scan have two coordinates"),
        ({"sigma": "auto"}, {"scan": "n"}, "sigma: cannot be estimated"),
        ({"max_gap": 5}, {"scan": "n"}, "max_gap: is about plots of one track"),
        ({"stale": 5}, {"scan": "n"}, "stale: is about plots of one track"),
    ],
)
def test_options_that_do_not_fit(reading, options, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        read(THREE, reading, **options)


def test_plots_are_in_a_fixed_frame_or_relative():
    data = {**THREE, "ox": [1] * 5, "oy": [1] * 5}
    with pytest.raises(ValueError, match="own and own_ship: plots are in a fixed frame, or"):
        read(data, {"own_ship": ("ox", "oy")}, scan="n", own=("ox", "oy"))


def test_polar_plots_are_relative():
    data = plots_of(scan=[0], t=[0], range=[1.0], az=[2.0], ox=[1], oy=[1])
    with pytest.raises(DataError, match="`own_ship`=ox,oy adds its position"):
        read(data, {"polar": ("range", "az")}, own=("ox", "oy"))


def test_no_usable_plot_is_an_error():
    data = plots_of(n=[0, 0, 1], t=[0.0, 0.0, 1.0], x=[np.nan] * 3, y=[1.0, 2.0, 3.0])
    with pytest.raises(DataError, match="no plot can be used: 3 rows without a position"):
        track_scans(data, scan="n")


def test_a_scan_cell_may_not_be_empty():
    data = {**THREE, "n": ["1", "1", "", "3", "3"]}
    with pytest.raises(DataError, match="row 3, column n: an empty cell"):
        read(data, scan="n")


def test_identities_are_not_used():
    made, found = read({**THREE, "track_id": list("abcde")}, scan="n")
    assert len(found) == 3
    assert "column 'track_id': identities of plots are not used" in made.findings.notes
    made, _ = read({**THREE, "who": list("abcde")}, {"id": "who"}, scan="n")
    assert "column 'who': identities of plots are not used" in made.findings.notes


def test_positions_beyond_all_numbers_are_named_by_their_row():
    y = [0.0] * 7 + [-3e12]
    data = {"t": range(8), "x": [0.0] * 8, "y": y}
    with pytest.raises(DataError, match=r"row 8, columns x, y: a position of -3e\+12 m; expected"):
        list(ScanPlots.of(data, period=1.0).scans())


def test_a_scan_that_is_not_later_is_named_by_its_word():
    data = {"scan": ["a", "a", "b"], "t": [0.0, 1.0, 1.0], "x": [0, 1, 2], "y": [0, 1, 2]}
    with pytest.raises(DataError, match=r"row 3, column t: the scan 'b' of column scan ends at 1,"):
        list(ScanPlots.of(data).scans())
