"""The feed of the benchmark of live runs: every plot once, late ones within the lateness."""

from collections import Counter

from benchmarks.live import TOGETHER, plots


def test_every_track_has_a_plot_in_every_scan_and_late_ones_are_in_reach():
    parts = list(plots(tracks=7, hz=10.0, scans=50, lateness=2.0, late=0.2))
    assert all(part.count(b"\n") == TOGETHER for part in parts[:-1])
    rows = [line.decode().split(",") for line in b"".join(parts).splitlines()]
    assert Counter(row[1] for row in rows) == {f"T{k}": 50 for k in range(7)}
    newest, late = {}, 0
    for time, track, *_ in rows:
        last = newest.get(track, -1.0)
        assert float(time) != last
        assert float(time) > last - 2.0
        late += float(time) < last
        newest[track] = max(last, float(time))
    assert late > 10


def test_a_feed_without_late_plots_is_in_order():
    lines = b"".join(plots(3, 1.0, 4, 0.0, 0.0)).splitlines()
    times = [float(line.split(b",")[0]) for line in lines]
    assert times == sorted(times)
    assert len(times) == 12
