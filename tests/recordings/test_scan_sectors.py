"""Plots of a turning antenna, tracked sector by sector and scan by scan."""

import pickle
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from turning_radar import turning_radar

from fuzzytrack import DataError, load_scanner, track_scans
from fuzzytrack.recordings.antenna_turn import AntennaTurn, turn_of_antenna
from fuzzytrack.recordings.scan_rows import ScanRows
from fuzzytrack.recordings.scan_sectors import Beam, SectorPass
from fuzzytrack.scan.extraction.merging import Merging
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.track_reports import TrackReports


def rows_of(columns):
    n = len(columns["t"])
    return ScanRows(
        columns["t"],
        np.stack([columns["x"], columns["y"]], axis=1),
        np.full((n, 2), np.nan),
        np.arange(1, n + 1),
        np.full(n, ""),
        np.full(n, ""),
    )


def targets_of(result, where):
    """Which target each report is near, -1 for none, and how far from it."""
    reports = result.reports
    nearest, far = [], []
    for time, position in zip(reports.time, reports.position, strict=True):
        apart = np.hypot(*(where(time) - position).T)
        nearest.append(int(apart.argmin()) if apart.min() < 15 else -1)
        far.append(apart.min())
    return np.array(nearest), np.array(far)


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize("sectors", [4, 8, 32])
def test_tracks_are_those_of_whole_scans(sectors, clockwise):
    columns, who, where = turning_radar(3, clockwise=clockwise)
    whole = track_scans(columns, period=2.5, own=("0", "0")).result
    by_sector = track_scans(columns, sectors=sectors)
    parts = by_sector.result
    found = [targets_of(result, where) for result in (whole, parts)]
    # The same targets have one track each, and no other track is reported.
    for (nearest, _), result in zip(found, (whole, parts), strict=True):
        pairs = set(zip(nearest.tolist(), result.reports.track_id.tolist(), strict=True))
        assert len(pairs) == len({target for target, _ in pairs}) == len(result.track_ids)
    assert set(found[0][0].tolist()) == set(found[1][0].tolist()) != {-1}
    # As near to the truth, with as many reports: the differences are starts and ends of tracks.
    rms = [np.sqrt(np.mean(far**2)) for _, far in found]
    assert rms[1] == pytest.approx(rms[0], rel=0.1)
    rows = [len(result.reports) for result in (whole, parts)]
    assert abs(rows[1] - rows[0]) <= 0.02 * rows[0]
    # No plot is used twice, and each target's plots go to its own track.
    used = parts.reports.plot[parts.reports.plot >= 0]
    assert len(set(used.tolist())) == len(used)
    right = who[used - 1] == found[1][0][parts.reports.plot >= 0]
    assert right.mean() > 0.99
    assert by_sector.totals.plots == len(who)


def test_reports_come_within_two_sectors():
    columns, _, _ = turning_radar(4)
    rows = rows_of(columns)
    beam = Beam.of(turn_of_antenna(rows), 0.0)
    sectors = SectorPass(ScanTracker().start(), beam, 16)
    assert sectors.latency == pytest.approx(2 * 2.5 / 16, rel=1e-3)
    waited = []
    for k in range(len(rows)):
        for _, reports in sectors.advance(rows.take(slice(k, k + 1))):
            hit = reports.plot >= 0
            waited += (columns["t"][k] - reports.time[hit]).tolist()
    # A plot is answered when the first one comes after its two sectors: at most a step later.
    assert len(waited) > 100
    assert min(waited) > 0
    assert np.quantile(waited, 0.95) < sectors.latency + np.diff(columns["t"]).max()


@pytest.mark.untraced
@settings(max_examples=10, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(st.lists(st.integers(1, 900), max_size=6), st.integers(0, 900))
def test_pieces_and_a_pickle_give_the_same_reports(cuts, saved):
    columns, _, _ = turning_radar(5, targets=8, turns=20, clutter=8)
    rows = rows_of(columns)
    beam = Beam.of(turn_of_antenna(rows), 0.0)

    def run(cuts, saved=None):
        sectors = SectorPass(ScanTracker().start(), beam, 8)
        found = []
        edges = [0, *sorted(cuts), len(rows)]
        for first, last in pairwise(edges):
            found += [each for _, each in sectors.advance(rows.take(slice(first, last)))]
            if first == saved:
                sectors = pickle.loads(pickle.dumps(sectors))
        found += [each for _, each in sectors.finish()]
        return TrackReports.joined(found)

    one, other = run([]), run([*cuts, saved], saved)
    for name in ("time", "track_id", "position", "plot", "status"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_the_beam_follows_an_antenna_that_slows_down():
    columns, who, where = turning_radar(6, turns=60, drift=0.002)
    found = track_scans(columns, sectors=16)
    nearest, _ = targets_of(found.result, where)
    assert (nearest >= 0).all()
    assert len(set(nearest.tolist())) >= 0.8 * (who.max() + 1)
    pairs = set(zip(nearest.tolist(), found.result.reports.track_id.tolist(), strict=True))
    assert len(pairs) == len(set(nearest.tolist()))


def test_groups_have_antennas_of_their_own():
    one, _, _ = turning_radar(7, targets=8, turns=20)
    other, _, _ = turning_radar(8, targets=8, turns=20)
    # The second begins with the antenna elsewhere.
    later = {name: values[37:] for name, values in other.items()}
    both = {name: np.append(one[name], later[name]) for name in one}
    group = np.repeat(["a", "b"], [len(one["t"]), len(later["t"])])
    found = track_scans({"g": group, **both}, group="g", sectors=8)
    for name, columns in (("a", one), ("b", later)):
        alone = track_scans(columns, sectors=8).result.reports
        reports = found.results[name].reports
        # The period is recognized by other plots, to some digits.
        np.testing.assert_allclose(reports.position, alone.position, atol=1e-3)
    first, second = (set(found.results[name].track_ids.tolist()) for name in "ab")
    assert not first & second


def test_the_place_of_a_radar_is_that_of_its_beam():
    columns, *_ = turning_radar(4, turns=12)
    at_origin = track_scans(columns, sectors=8)
    moved = {**columns, "x": columns["x"] + 4e3, "y": columns["y"] - 2e3}
    moved["x"][5] = np.nan
    there = track_scans(moved, sectors=8, own=("4000", "-2000"))
    assert len(there) == len(at_origin)
    found = there.job.plots.findings
    assert (found.missed, found.plots) == (1, len(columns["t"]) - 1)


def test_a_long_silence():
    columns, _, _ = turning_radar(9, targets=5, turns=12, clutter=5)
    later = {**columns, "t": columns["t"] + 1e3 * 2.5}
    both = {name: np.append(columns[name], later[name]) for name in columns}
    found = track_scans(both, sectors=8)
    assert found.totals.plots == 2 * len(columns["t"])
    assert found.totals.scans < 8 * 150


def test_plots_without_bearings_of_their_own():
    t = np.repeat(np.arange(40.0), 5)
    rng = np.random.default_rng(1)
    data = {"t": t, "x": rng.normal(0, 100, 200), "y": rng.normal(0, 100, 200)}
    with pytest.raises(DataError, match="do not follow an antenna; `sectors` needs plots"):
        track_scans(data, sectors=8)
    with pytest.raises(DataError, match=r"an antenna that turns in 2.5 s"):
        track_scans(data, sectors=8, period=2.5)


def test_a_part_that_merges_plots_needs_whole_scans():
    data, _, _ = turning_radar(0, turns=12)
    merging = replace(load_scanner("default"), extraction=Merging())
    with pytest.raises(DataError, match=r"`sectors`: configuration default merges plots"):
        track_scans(data, merging, sectors=8)


@given(st.floats(0.5, 20), st.booleans(), st.floats(-50, 50), st.floats(0, 500))
def test_a_beam_points_where_the_antenna_does(period, clockwise, start, time):
    antenna = AntennaTurn(period, clockwise, start, 1.0)
    beam = Beam.of(antenna, start)
    angle = float(antenna.phase(time))
    offset = 1000 * np.array([[np.sin(angle), np.cos(angle)]])
    place = beam.places(offset, np.array([time]))
    assert place[0] == pytest.approx((time - start) / period, abs=1e-6)
    assert beam.time_at(beam.turns_at(time)) == pytest.approx(time, abs=1e-6)


def test_a_session_with_an_empty_scan_knows_its_tracks():
    session = ScanTracker().start()
    rows = np.empty(0, dtype=np.int64)
    session.step(Scan(0.0, np.zeros((1, 2)), rows=np.array([5])))
    assert session.tracks().plot.tolist() == [5]
    session.step(Scan(1.0, np.empty((0, 2)), rows=rows))
    assert session.tracks().plot.tolist() == [-1]
    plots = np.array([[0.0, 0.0], [900.0, 0.0]])
    session.advance(Scan(2.0, plots, rows=np.array([7, 8])), due=[True])
    assert session.tracks().plot.tolist() == [7, 8]
    session.advance(Scan(3.0, plots[1:], rows=np.array([9])), due=[False, True])
    assert session.tracks().plot.tolist() == [-1, 9]
