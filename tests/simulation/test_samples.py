import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.io.geodetic import LocalFrame
from fuzzytrack.simulation import SAMPLES, make_sample

#: Samples whose plots have identities, or are of one target.
TRACKED = [name for name, kind in SAMPLES.items() if kind.command == "track"]

COLUMNS = {
    "radar": ["time", "track", "range", "azimuth"],
    "ais": ["time", "mmsi", "lat", "lon", "sog", "cog"],
    "adsb": ["time", "icao24", "lat", "lon", "alt"],
    "sonar": ["time", "x", "y"],
    "scans": ["scan", "time", "x", "y", "own_x", "own_y"],
}


def followed(name, seed):
    """Truth, plots and filtered positions (m), each of shape (n, n_axes), of all tracks."""
    sample, reading = make_sample(name, seed), dict(SAMPLES[name].reading)
    found = ft.track(sample.plots, **reading)
    # The true positions in the same frame: read as plots, of which none is left out.
    place = {key: value for key, value in reading.items() if not key.startswith("sigma")}
    if "geodetic" in place:
        # The frame of the plots, whose origin is their first one.
        frame = [sample.plots[key][0] for key in place["geodetic"]]
        place["site"] = tuple(float(value) for value in frame)
    true = ft.track(sample.truth, tracker="fixed:alpha=1:beta=1", gate=None, **place)
    pairs = list(zip(true.results, found.results, strict=True))
    return (
        np.concatenate([one.measured for one, _ in pairs]),
        np.concatenate([other.measured for _, other in pairs]),
        np.concatenate([other.filtered for _, other in pairs]),
    )


def rms(errors):
    return np.sqrt(np.nanmean(np.sum(errors**2, axis=-1)))


@pytest.mark.parametrize("seed", [0, 7])
@pytest.mark.parametrize("name", TRACKED)
def test_tracks_of_a_sample_are_nearer_to_the_truth_than_its_plots(name, seed):
    truth, plots, filtered = followed(name, seed)
    seen = ~np.isnan(plots).any(axis=1)
    assert rms((filtered - truth)[seen]) < 0.9 * rms((plots - truth)[seen])


@pytest.mark.parametrize("name", TRACKED)
def test_a_sample_is_small_and_its_truth_has_the_same_rows(name):
    sample = make_sample(name)
    assert list(sample.plots) == list(sample.truth) == COLUMNS[name]
    lengths = {len(values) for side in (sample.plots, sample.truth) for values in side.values()}
    assert len(lengths) == 1
    assert 200 <= lengths.pop() <= 2000
    identity = SAMPLES[name].reading.get("id", "time")
    for same in ("time", identity):
        np.testing.assert_array_equal(sample.plots[same], sample.truth[same])
    assert sorted(sample.plots["time"]) == list(sample.plots["time"])
    measured = [values for key, values in sample.truth.items() if key not in ("time", identity)]
    assert np.isfinite(np.array(measured, float)).all()


@pytest.mark.parametrize("name", SAMPLES)
def test_the_same_seed_gives_the_same_sample_and_another_seed_another_one(name):
    one, again, other = make_sample(name, 3), make_sample(name, 3), make_sample(name, 4)
    for key, values in one.plots.items():
        np.testing.assert_array_equal(values, again.plots[key])
    last = COLUMNS[name][-1]
    assert not np.array_equal(one.plots[last], other.plots[last])


def test_plots_of_the_radar_have_its_noise_and_some_are_missed():
    sample = make_sample("radar")
    error = {key: sample.plots[key] - sample.truth[key] for key in ("range", "azimuth")}
    turned = (error["azimuth"] + 180) % 360 - 180
    assert np.nanstd(error["range"]) == pytest.approx(30, rel=0.15)
    assert np.nanstd(turned) == pytest.approx(0.1, rel=0.15)
    missed = np.isnan(sample.plots["range"])
    np.testing.assert_array_equal(missed, np.isnan(sample.plots["azimuth"]))
    assert 0.03 < missed.mean() < 0.15


def test_a_plot_of_the_radar_is_made_when_the_beam_points_to_its_target():
    truth = make_sample("radar").truth
    late = (truth["time"] / 4 - truth["azimuth"] / 360 + 0.5) % 1 - 0.5
    # Each scan is early or late by at most 2 %, counted from the first one.
    assert np.abs(late).max() < 0.041
    for id in set(truth["track"]):
        steps = np.diff(truth["time"][np.array(truth["track"]) == id])
        assert 3.7 < steps.min() < steps.max() < 4.4


def test_places_of_ships_and_aircraft_move_at_their_speed():
    truth = make_sample("ais").truth
    frame = LocalFrame(54.2, 12.05)
    times = np.array([text.rstrip("Z") for text in truth["time"]], "datetime64[s]").astype(float)
    for id in set(truth["mmsi"]):
        own = np.array(truth["mmsi"]) == id
        place = frame.to_local(truth["lat"][own], truth["lon"][own]).position
        steps, way = np.diff(times[own]), np.diff(place, axis=0)
        speed = np.linalg.norm(way, axis=1) / steps * 3600 / 1852
        course = np.degrees(np.arctan2(way[:, 0], way[:, 1]))
        middle = truth["cog"][own][1:] - np.diff(np.unwrap(truth["cog"][own], period=360)) / 2
        # In a longer time without reports a ship may turn by much.
        short = steps <= 15
        assert np.abs(speed - truth["sog"][own][1:])[short].max() < 0.2
        assert np.abs((course - middle + 180) % 360 - 180)[short].max() < 4
        assert steps.min() >= 1
        assert steps.max() > 30


def test_the_sonar_has_spikes_and_gaps():
    sample = make_sample("sonar")
    far = np.hypot(*(sample.plots[key] - sample.truth[key] for key in "xy")) > 20
    assert 5 < far.sum() < 50
    assert not far[:10].any()
    assert np.sum(np.diff(sample.plots["time"]) > 10) == 2


def test_scans_have_clutter_and_most_true_targets_have_a_plot_nearby():
    sample = make_sample("scans")
    assert list(sample.plots) == COLUMNS["scans"]
    assert list(sample.truth) == ["time", "id", "x", "y", "vx", "vy"]
    plots, truth = (
        {key: np.array(values, float) for key, values in side.items()}
        for side in (sample.plots, sample.truth)
    )
    assert (np.diff(plots["scan"]) >= 0).all()
    assert 500 <= len(plots["scan"]) <= 2000
    # The truth has the time of the end of a scan; its plots were made in the 1.68 s before.
    near, used = 0, np.zeros(len(plots["x"]), bool)
    for time, *at in zip(truth["time"], truth["x"], truth["y"], strict=True):
        inside = (plots["time"] <= time) & (plots["time"] > time - 1.7)
        close = inside & (np.hypot(plots["x"] - at[0], plots["y"] - at[1]) < 20)
        near += close.any()
        used |= close
    assert 0.6 < near / len(truth["x"]) <= 1
    assert 0.3 < used.mean() < 0.8


@pytest.mark.parametrize(
    ("name", "seed", "message"),
    [("sonr", 0, "no such sample 'sonr'; did you mean 'sonar'"), ("ais", -1, "seed must not be")],
)
def test_a_wrong_name_or_seed_is_refused(name, seed, message):
    with pytest.raises(ValueError, match=message):
        make_sample(name, seed)
