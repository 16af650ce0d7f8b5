import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io import Columns, Piece, PlotDescription
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.geodetic import LocalFrame
from fuzzytrack.io.times import Clock
from fuzzytrack.recordings.judge import Gate, Judge
from fuzzytrack.recordings.streaming import OpenTracks
from fuzzytrack.recordings.track_table import TrackRows, TrackTable
from fuzzytrack.trackers.catalog import make_tracker

XY = TrackTable("t", "id", ("x", "y"))


def tracked(tracker, t, z, sigma=None, *, table=XY, cut=None, **piece):
    """Columns for a track, which is run in two pieces if it is cut."""
    tracker, rows, found = make_tracker(tracker), TrackRows(table), []
    state = None
    z = np.asarray(z, dtype=float)
    for part in (slice(0, cut), slice(cut, None)) if cut else (slice(None),):
        result = tracker.run(t[part], z[part], sigma, state=state, keep=table.outputs)
        state = result.state
        outputs = {name: getattr(result, name) for name in table.outputs if name != "gains"}
        outputs |= {name: getattr(result.gains, name) for name in ("alpha", "beta", "gamma")}
        one = Piece.of(["a"] * len(t[part]), t[part], z[part])
        extra = {name: values[part] for name, values in piece.items()}
        found.append(rows.values(replace(one, **extra), outputs))
    return {name: np.concatenate([values[name] for values in found]) for name in found[0]}


# -------------------------------------------------------------------- which columns


def test_columns_of_a_plane():
    assert XY.names == (
        "id", "t",
        "x", "x_predicted", "x_filtered", "x_velocity", "x_innovation",
        "alpha_x", "beta_x", "gamma_x",
        "y", "y_predicted", "y_filtered", "y_velocity", "y_innovation",
        "alpha_y", "beta_y", "gamma_y",
        "speed", "course", "coasted", "since_last",
    )  # fmt: skip


def test_columns_that_are_there_only_if_they_say_something():
    table = replace(
        XY, id="", gamma=False, deviation=True, segment=True, frame=LocalFrame(60.0, 5.0)
    )
    assert table.names[-9:] == (
        "x_sd", "y_sd", "speed", "course", "latitude", "longitude", "coasted", "since_last",
        "segment",
    )  # fmt: skip
    assert table.names[0] == "t"
    assert "gamma_x" not in table.names
    space = replace(XY, axes=("x", "y", "z"), frame=LocalFrame(60.0, 5.0))
    assert space.names[-5:] == ("latitude", "longitude", "altitude", "coasted", "since_last")
    line = replace(XY, axes=("x",), frame=LocalFrame(60.0, 5.0))
    assert line.names[-2:] == ("coasted", "since_last")
    assert line.names[-3] == "gamma_x"
    assert "speed" not in replace(XY, axes=("bearing",), period=360.0).names


@pytest.mark.parametrize(("axes", "name"), [(("x", "speed"), "speed"), (("t", "x"), "t")])
def test_columns_of_one_name(axes, name):
    with pytest.raises(DataError, match=f"two columns of the output would be '{name}'"):
        _ = replace(XY, axes=axes).names


@pytest.mark.parametrize(
    ("tracker", "gamma", "deviation"),
    [
        ("maneuver", True, True),
        ("stiffness-damping", False, False),
        ("fixed:alpha=0.5:beta=0.2", False, False),
        ("fixed:alpha=0.5:beta=0.2:gamma=0.1", True, False),
        ("kalman-cv:sigma_v=1", False, True),
        ("bank:lowest=0.2:highest=0.8:members=3:selection=best", False, False),
        ("window-search", False, False),
        ("imm:quiet_sigma=1:maneuver_sigma=5", True, True),
        ("imm:quiet_sigma=1:maneuver_sigma=5:maneuver=cv", False, True),
        ("imm-two", True, True),
    ],
)
def test_what_a_tracker_gives(tracker, gamma, deviation):
    columns, made = Columns("t", "id", ("x", "y")), make_tracker(tracker)
    unknown = PlotDecoder(columns, PlotDescription(), Clock())
    table = TrackTable.of(replace(unknown, noise=(2.0, 2.0)), made)
    assert (table.gamma, table.deviation, table.segment) == (gamma, deviation, True)
    assert not TrackTable.of(unknown, made).deviation
    assert ("position_variance" in table.outputs) == deviation
    if not gamma:
        plots = np.random.default_rng(0).normal(0, 9, (30, 2))
        assert not np.nan_to_num(made.run(np.arange(30.0), plots, 1.0).gains.gamma).any()


# -------------------------------------------------------------------- speed and course


@pytest.mark.parametrize(
    ("velocity", "course"),
    [((0, 1), 0), ((1, 1), 45), ((1, 0), 90), ((0, -1), 180), ((-1, 0), 270), ((-1, 1), 315)],
)
def test_course_is_clockwise_from_north(velocity, course):
    """x is to the east and y to the north, whatever the third axis is."""
    t = np.arange(4.0)
    for z_axis in ((), (7.0,)):
        table = replace(XY, axes=("x", "y", "z")[: 2 + len(z_axis)])
        z = t[:, None] * np.array([*velocity, *z_axis])
        found = tracked("fixed:alpha=0.5:beta=0.2", t, z, table=table)
        np.testing.assert_allclose(found["course"][1:], course, atol=1e-12)
        np.testing.assert_allclose(found["speed"][1:], math.hypot(*velocity))
        # After one plot a velocity is not known.
        assert math.isnan(found["speed"][0])
        assert math.isnan(found["course"][0])


def test_a_target_that_stands_still_has_no_course():
    found = tracked("fixed:alpha=0.5:beta=0.2", np.arange(3.0), np.ones((3, 2)))
    # After the second plot a velocity of exactly 0 cannot be told from one that is not known.
    assert found["speed"].tolist()[2:] == [0.0]
    assert np.isnan(found["course"]).all()


# -------------------------------------------------------------------- plots that were used


@pytest.mark.parametrize("start", ["two-point", "one-point"])
def test_coasted_and_since_last(start):
    z = [[math.nan] * 2, [0, 0], [math.nan] * 2, [1, 1], [2, math.nan], [math.nan] * 2, [4, 4]]
    t = np.array([0, 1, 2.5, 3, 4, 7, 8])
    found = tracked(f"fixed:alpha=0.5:beta=0.2:start={start}", t, z)
    assert found["coasted"].tolist() == [True, False, True, False, False, True, False]
    np.testing.assert_array_equal(found["since_last"], [math.nan, 0, 1.5, 0, 0, 3, 0])
    # A plot that lacks a coordinate is missed by a tracker that uses all of them at once.
    found = tracked("maneuver", t, z, 1.0, table=replace(XY, deviation=True))
    assert found["coasted"].tolist() == [True, False, True, False, True, True, False]
    np.testing.assert_array_equal(found["since_last"], [math.nan, 0, 1.5, 0, 1, 4, 0])
    assert (np.diff(found["x_sd"][3:6]) > 0).all()


@pytest.mark.parametrize("cut", [1, 2, 3, 4, 5])
def test_pieces_agree_with_the_whole(cut):
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.5, 1.5, 9))
    z = rng.normal(0, 5, (9, 2))
    z[[2, 5]] = math.nan
    table = replace(XY, deviation=True, frame=LocalFrame(60.0, 5.0))
    whole = tracked("maneuver", t, z, 2.0, table=table)
    parts = tracked("maneuver", t, z, 2.0, table=table, cut=cut)
    assert list(whole) == list(table.names)
    for name in whole:
        np.testing.assert_array_equal(whole[name], parts[name], err_msg=name)


def test_segments():
    t = np.arange(4.0)
    table = replace(XY, segment=True)
    found = tracked("fixed:alpha=0.5:beta=0.2", t, np.ones((4, 2)), table=table)
    assert found["segment"].tolist() == [0, 0, 0, 0]
    found = tracked(
        "fixed:alpha=0.5:beta=0.2",
        t,
        np.ones((4, 2)),
        table=table,
        segments=np.array([0, 0, 1, 1]),
    )
    assert found["segment"].tolist() == [0, 0, 1, 1]


# -------------------------------------------------------------------- angles and places


@pytest.mark.parametrize(("period", "north"), [(360.0, 359.0), (2 * math.pi, 6.27)])
def test_angles_are_within_the_circle(period, north):
    table = TrackTable("t", "id", ("bearing",), period=period)
    step = (period - north) * 1.5
    z = north + step * np.arange(5.0)[:, None]
    found = tracked("fixed:alpha=0.5:beta=0.2", np.arange(5.0), z, table=table)
    for name in ("bearing", "bearing_filtered"):
        np.testing.assert_allclose(found[name], z[:, 0] % period, atol=1e-9)
    np.testing.assert_allclose(found["bearing_predicted"][2:], z[2:, 0] % period, atol=1e-9)
    np.testing.assert_allclose(found["bearing_velocity"][1:], step)
    assert not found["coasted"].any()


def test_a_plot_of_another_turn_starts_a_track():
    """The measured angle may be given within the circle, and the filtered one beyond it."""
    table = TrackTable("t", "id", ("bearing",), period=360.0)
    rows, none = TrackRows(table), np.array([[math.nan], [math.nan]])
    names = ("velocity", "alpha", "beta", "gamma")
    outputs = {"predicted": none, "innovation": none, **dict.fromkeys(names, none)}
    outputs["filtered"] = np.array([[359.0], [361.0]])
    piece = Piece.of(["a", "a"], [0, 1], [[359.0], [1.0]])
    assert rows.values(piece, outputs)["coasted"].tolist() == [False, False]


def test_places():
    frame = LocalFrame(60.0, 179.99)
    t = np.arange(4.0)
    found = tracked(
        "fixed:alpha=0.5:beta=0.2", t, 1000.0 * np.c_[t, 0 * t], table=replace(XY, frame=frame)
    )
    back = frame.to_local(found["latitude"], found["longitude"]).position
    np.testing.assert_allclose(back, np.c_[found["x_filtered"], found["y_filtered"]], atol=1e-6)
    assert found["longitude"][0] > 0 > found["longitude"][-1]
    space = replace(XY, axes=("x", "y", "z"), frame=LocalFrame(60.0, 5.0, 100.0))
    found = tracked("fixed:alpha=0.5:beta=0.2", t, np.c_[0 * t, 0 * t, 10 * t], table=space)
    np.testing.assert_allclose(found["altitude"], 100 + 10 * t)


# -------------------------------------------------------------------- times


@pytest.mark.parametrize(
    ("cells", "typed", "wanted"),
    [
        (["00.50", "1e0"], False, ["00.50", "1e0"]),
        (["00.50", "1e0"], True, [0.5, 1.0]),
        (["1", "2"], True, [1.0, 2.0]),
        (["1588204800000000001", "1"], True, [1588204800000000001, 1]),
        (["12:00:00", "12:00:01"], True, ["12:00:00", "12:00:01"]),
        (np.array([1, 2]), False, [1, 2]),
        (None, False, [5.0, 6.0]),
    ],
)  # fmt: skip
def test_times_as_they_were_read(cells, typed, wanted):
    piece = replace(Piece.of(["a", "a"], [5, 6], np.zeros((2, 1))), time_cells=cells)
    found = TrackRows(XY, typed=typed).times(piece)
    assert list(found) == wanted
    assert [type(value) for value in np.asarray(found).tolist()] == [type(x) for x in wanted]


# -------------------------------------------------------------------- plots that were judged


@pytest.mark.parametrize("cuts", [(0, 40), (0, 11, 23, 40)])
def test_plots_that_a_gate_rejects(cuts):
    """A wild plot, and a track that begins again elsewhere; in one piece and in several."""
    t = np.arange(40.0)
    z = np.c_[10 * t, 5 * t] + np.random.default_rng(0).normal(0, 2, (40, 2))
    z[10] += 500
    z[11] = math.nan
    z[20:] += 900
    table = replace(XY, deviation=True)
    tracks, rows = OpenTracks("maneuver", 2.0, table.outputs, Judge(Gate())), TrackRows(table)
    piece, found = Piece.of(["a"] * 40, t, z), []
    for begin, end in pairwise(cuts):
        part = piece.take(np.arange(begin, end))
        found.append(rows.values(part, tracks.advance(part).outputs))
    values = {name: np.concatenate([part[name] for part in found]) for name in found[0]}
    assert np.flatnonzero(values["coasted"]).tolist() == [10, 11, 20, 21, 22]
    np.testing.assert_array_equal(values["since_last"][[9, 10, 11, 12, 22, 23]], [0, 1, 2, 0, 3, 0])
    # Where it begins again its velocity is not known, and its position is that of the plot.
    assert np.isnan(values["speed"]).nonzero()[0].tolist() == [0, 23]
    assert values["x_sd"][23] == 2.0
    assert (np.diff(values["x_sd"][19:23]) > 0).all()
