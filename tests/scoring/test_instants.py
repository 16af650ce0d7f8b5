"""When tracks and truth are compared, and where they are then."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scored_scenes import positions

from fuzzytrack.errors import DataError
from fuzzytrack.scoring.clock_lag import fitted_lag
from fuzzytrack.scoring.instants import Timing, added_at_ends, make_scene
from fuzzytrack.scoring.interpolation import at_instants, usual_interval
from fuzzytrack.scoring.positions import Positions


def path(id, times, speed=2.0, y=0.0):
    return [(float(t), id, speed * float(t), y) for t in times]


def at(found, id):
    """Instants and positions of an object, by its name."""
    mine = found.names[found.id] == id
    return found.instant[mine].tolist(), found.position[mine]


# -------------------------------------------------------------------- interpolation


def test_between_rows_but_not_over_a_gap():
    found = at_instants(positions(path(7, [0, 2, 4, 20, 22])), np.arange(0.0, 23), 3.0, 1.0)
    instants, places = at(found, 7)
    assert instants == [0, 1, 2, 3, 4, 20, 21, 22]
    assert places[:, 0] == pytest.approx(2.0 * np.array(instants))
    assert found.velocity[:5] == pytest.approx(np.tile([2.0, 0.0], (5, 1)))


def test_rows_only():
    found = at_instants(positions(path(1, [0, 1, 3])), np.arange(0.0, 5), 0.0, 1.0)
    assert at(found, 1)[0] == [0, 1, 3]


def test_beyond_the_ends():
    instants = np.arange(-3.0, 9)
    found = at_instants(positions(path(1, [0, 2, 4])), instants, 3.0, 1.0, beyond=1.0)
    where, places = at(found, 1)
    assert instants[where].tolist() == [-1, 0, 1, 2, 3, 4, 5]
    assert places[:, 0] == pytest.approx(2 * instants[where])
    # A single row stays where it is, and so does one that is far from the next.
    alone = at_instants(positions([(0.0, 1, 9.0, 9.0)]), instants, 3.0, 1.0, beyond=1.0)
    assert alone.position.tolist() == [[9.0, 9.0]] * 3
    assert np.isnan(alone.velocity).all()
    apart = at_instants(positions(path(1, [0, 7])), instants, 3.0, 1.0, beyond=1.0)
    assert apart.position[:, 0].tolist() == [0, 0, 14, 14]


def test_given_velocities_and_kinds():
    rows = Positions.make(
        "tracks",
        [0, 2, 4],
        [1, 1, 1],
        [[0, 0]] * 3,
        [[0, 4], [2, 0], [2, 0]],
        ["moving", "static", "static"],
    )
    found = at_instants(rows, np.array([0.0, 1.0, 2.0, 4.0]), 5.0, 1.0)
    assert found.velocity.tolist() == [[0, 4], [1, 2], [2, 0], [2, 0]]
    assert found.kind.tolist() == [1, 1, 2, 2]


def test_nothing_is_nowhere():
    found = at_instants(positions([]), np.arange(3.0), 5.0, 1.0)
    assert len(found) == 0
    assert np.isnan(usual_interval(positions([])))
    assert np.isnan(usual_interval(positions([(0, 1, 0, 0), (1, 2, 0, 0)])))


@given(
    st.lists(st.integers(0, 40), min_size=2, max_size=10, unique=True),
    st.lists(st.integers(-5, 45), min_size=1, max_size=10, unique=True),
)
def test_a_line_stays_a_line(times, instants):
    times, instants = sorted(times), np.array(sorted(instants), dtype=float)
    found = at_instants(positions(path(1, times)), instants, 100.0, 1.0)
    inside = [t for t in instants if times[0] <= t <= times[-1]]
    assert instants[found.instant].tolist() == inside
    assert found.position[:, 0] == pytest.approx(2 * np.array(inside), abs=1e-9)


# -------------------------------------------------------------------- instants


def instants_of(tracks, truth, **more):
    return make_scene(positions(tracks), positions(truth), Timing(**more)).time.tolist()


def test_the_times_of_rows_with_more_where_they_are_missing():
    times = [2, 3, 4, 7, 8]
    assert instants_of(path(1, times), path(1, [0, 10])) == list(range(11))
    assert instants_of(path(1, times), path(1, [2, 8])) == list(range(2, 9))
    # What is before and after the truth is not known.
    assert instants_of(path(1, times), path(1, [3, 7])) == [3, 4, 5, 6, 7]
    found = make_scene(positions(path(1, times)), positions(path(1, [0, 10])), Timing())
    assert added_at_ends(found, positions(path(1, times))) == 4
    assert added_at_ends(found, positions([])) == 11


def test_irregular_times_that_tracks_share():
    times = [0, 1, 1.8, 3, 4.1, 5]
    both = path(1, times) + path(2, times)
    assert instants_of(both, path(1, [0, 5])) == times


def test_tracks_with_times_of_their_own_are_compared_on_a_grid():
    """Those of a turning antenna: each track has its bearing's time in every turn."""
    tracks = path(1, np.arange(0, 20, 2.0)) + path(2, np.arange(0.7, 20, 2.0))
    truth = path(1, range(20)) + path(2, range(20))
    found = make_scene(positions(tracks), positions(truth), Timing())
    assert np.diff(found.time) == pytest.approx(2.0)
    assert found.n_tracks.min() >= 1
    assert found.n_tracks[1:-1].tolist() == [2] * (len(found.time) - 2)
    assert found.tracks.position[:, 0] == pytest.approx(2 * found.time[found.tracks.instant])


def test_a_grid_of_a_given_step():
    assert instants_of(path(1, [0, 1, 2]), path(1, [0, 2]), step=0.5) == [0, 0.5, 1, 1.5, 2]


def test_given_instants():
    tracks = path(1, [1, 2, 3])
    assert instants_of(tracks, path(1, [0, 9]), times=np.array([5.0, 1, 2, 3, 4])) == [
        1,
        2,
        3,
        4,
        5,
    ]
    with pytest.raises(ValueError, match="scans: must be finite times, at least one"):
        instants_of(tracks, path(1, [0, 9]), times=np.array([]))


def test_without_any_track():
    assert instants_of([], path(1, [0, 2, 4])) == [0, 2, 4]
    assert instants_of([], [(0, 1, 0.0, 0.0)]) == [0]
    assert instants_of([(3, 1, 0.0, 0.0)], path(1, [0, 3, 6])) == [0, 3, 6]


def test_one_row_of_each():
    found = make_scene(positions(path(1, [4])), positions(path(2, [4])), Timing())
    assert (len(found.time), len(found.truth), len(found.tracks)) == (1, 1, 1)


def test_a_track_of_a_turning_antenna_has_no_gap_between_scans():
    # Its beam passes the target at the beginning of a scan and at the end of the next one, and a
    # row without a plot is at the end.
    times = [0.1, 7.9, 8.2, 15.8, 20.0, 24.1]
    scans = np.arange(4.0, 28, 4)
    other = path(2, scans - 2)
    truth = positions(path(1, scans) + path(2, scans))
    found = make_scene(positions(path(1, times) + other), truth, Timing(times=scans))
    assert at(found.tracks, 1)[0] == [0, 1, 2, 3, 4, 5]
    lost = [each for each in times if each not in (8.2, 15.8)]
    found = make_scene(positions(path(1, lost) + other), truth, Timing(times=scans))
    assert at(found.tracks, 1)[0] == [0, 4, 5]


def test_a_lag_moves_the_truth():
    found = make_scene(positions(path(1, range(10))), positions(path(1, range(10))), Timing(lag=2))
    assert found.time.tolist() == list(range(2, 12))
    assert at(found.truth, 1)[1][:, 0] == pytest.approx(2 * (found.time - 2))


def test_gaps_of_the_truth():
    truth = positions(path(1, [0, 1, 2, 30, 31]))
    tracks = positions(path(1, range(32)))
    assert len(make_scene(tracks, truth, Timing()).truth) == 5
    assert len(make_scene(tracks, truth, Timing(max_gap=28)).truth) == 32


def test_what_is_wrong_is_named():
    with pytest.raises(DataError, match="truth: has no positions"):
        instants_of(path(1, [0, 1]), [])
    with pytest.raises(DataError, match=r"truth: known from 0 to 1 s .* go from 5 to 6 s"):
        instants_of(path(1, [5, 6]), path(1, [0, 1]), times=np.array([5.0, 6.0]))
    with pytest.raises(DataError, match="expected at most 5,000,000 instants"):
        instants_of(path(1, [0, 1]), path(1, [0, 1]), step=1e-8)
    for name in ("step", "max_gap"):
        with pytest.raises(ValueError, match=f"{name}: must be a finite number of seconds > 0"):
            Timing(**{name: 0.0})
    with pytest.raises(ValueError, match="lag: must be a finite number of seconds, got nan"):
        Timing(lag=np.nan)


# -------------------------------------------------------------------- lag


def turning(times, k):
    t = np.asarray(times, dtype=float)
    return 100 * k + 60 * np.sin(t / 9 + k), 60 * np.cos(t / 9 + k)


def two_boats(lag, noise=1.0, seed=0):
    """Tracks with other identities than the truth, and one of something else, by a late clock."""
    rng = np.random.default_rng(seed)
    truth, tracks = [], []
    for k in (1, 2):
        t = np.arange(0, 120, 0.5)
        truth += list(zip(t, [k] * len(t), *turning(t, k), strict=True))
        t = np.arange(10, 110, 2.0)
        x, y = turning(t, k)
        x, y = x + rng.normal(0, noise, len(t)), y + rng.normal(0, noise, len(t))
        tracks += list(zip(t + lag, [k + 10] * len(t), x, y, strict=True))
    tracks += [(t + lag, 99, 0.0, 300.0) for t in np.arange(10, 110, 2.0)]
    return positions(tracks), positions(truth)


@pytest.mark.parametrize("lag", [-4.3, 0.0, 1.7, 9.0])
def test_a_lag_is_found_without_identities(lag):
    found = fitted_lag(*two_boats(lag), 20.0, Timing())
    assert found.unknown == ""
    assert found.lag == pytest.approx(lag, abs=0.1)
    assert found.distance < 2
    if abs(lag) > 1:
        assert found.before > 2 * found.distance
        where = "behind" if lag > 0 else "ahead of"
        assert f"s {where} the truth (fitted" in found.sentence


def test_a_lag_that_cannot_be_told():
    tracks, truth = two_boats(0.0)
    few = fitted_lag(tracks.where(np.arange(5)), truth, 20.0, Timing())
    assert (few.lag, few.unknown) == (0.0, "there are too few rows of tracks")
    assert few.sentence.startswith("no lag was taken off: there are")
    far = positions([(t, 1, 5000.0, 0.0) for t in range(60)])
    assert "too few rows come near" in fitted_lag(far, truth, 20.0, Timing()).unknown
    faster = [(float(t), 1, t * t / 10, 0.0) for t in range(200)]
    later = [(t + 15.0, *rest) for t, *rest in faster]
    beyond = fitted_lag(positions(later), positions(faster), 200.0, Timing())
    assert (beyond.lag, beyond.unknown) == (0.0, "no lag within ±12 s fits best")
    rng = np.random.default_rng(1)
    still = [(float(t), 1, *rng.normal(0, 3, 2)) for t in range(100)]
    moored = positions([(float(t), 1, 0.0, 0.0) for t in range(100)])
    slow = fitted_lag(positions(still), moored, 20.0, Timing())
    assert (slow.lag, slow.unknown) == (0.0, "the objects move too slowly to tell it")
    assert "too few rows" in fitted_lag(tracks, positions([]), 20.0, Timing()).unknown
