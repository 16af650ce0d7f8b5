"""In Stone Soup's trackers a track is that of `AlphaBetaTracker.run`."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup_scenes import (
    SIGMA,
    at,
    components,
    detected,
    followed,
    linear,
    mappings,
    plots,
    states,
)

from fuzzytrack.schedulers import schedulers
from fuzzytrack.schedulers.catalog import scheduling_rulebases
from fuzzytrack.trackers.catalog import make_tracker

SPECS = {
    "benedict-bordner": "benedict-bordner:alpha=0.4",
    "fading-memory": "fading-memory:xi=0.6",
    "fixed": "fixed:alpha=0.5:beta=0.2:gamma=0.05",
    "fuzzy": "fuzzy:rules=stiffness-damping",
    "growing-memory": "growing-memory:limit=6",
    "innovation": "innovation:window=3",
    "kalman-ca": "kalman-ca:sigma_v=0.5:acceleration_sigma=1",
    "kalman-cv": "kalman-cv:sigma_v=0.5",
    "linear-combination": "linear-combination:limit=20",
    "track-quality": "track-quality",
}
VARIANTS = [
    "fixed:alpha=0.5:beta=0.2",
    "fixed:alpha=0.5:beta=0.2:gamma=0.05:missed=step",
    "fixed:alpha=0.5:beta=0.2:start=one-point",
    "fixed:alpha=0.5:beta=0.2:covariance=2",
    "kalman-cv:sigma_v=0.5:sigma_w=2",
    "kalman-cv:sigma_v=0.5:velocity_sigma=30:start=one-point",
    "maneuver:level=5:axes=own",
    "maneuver:level=5:covariance=2",
    "omega-schedule:missed=step",
    "track-quality:missed=step",
]
EVERY = [*SPECS.values(), *scheduling_rulebases(), *VARIANTS]
# In one and three dimensions: axes alone, and together; with acceleration that lasts and decays.
SOME = [SPECS["fixed"], "omega-schedule", "maneuver:level=5"]


def test_every_scheduler_is_there():
    assert set(SPECS) == set(schedulers.names())


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@pytest.mark.parametrize(
    ("spec", "n_axes"), [(spec, 2) for spec in EVERY] + [(spec, n) for spec in SOME for n in (1, 3)]
)
def test_a_single_target(spec, n_axes):
    tracker = make_tracker(spec)
    if spec == "maneuver:level=5:covariance=2":
        assert tracker.covariance == 2
    t, z = plots(n_axes, n_axes)
    assert 0.1 < np.isnan(z[:, 0]).mean() < 0.35
    places = mappings(n_axes, tracker.uses_acceleration)
    model = linear(places["position_mapping"], n_axes * len(places))
    track = followed(components(spec, n_axes), detected(t, z, model))
    found, expected = states(track), tracker.run(t, z, SIGMA)
    assert len(found) == len(t)
    for name, values in (
        ("position_mapping", expected.filtered),
        ("velocity_mapping", expected.velocity),
        ("acceleration_mapping", expected.acceleration),
    ):
        if name in places:
            np.testing.assert_allclose(found[:, places[name]], values, rtol=0, atol=1e-9)


STEPS = st.lists(
    st.tuples(st.integers(1, 20_000), st.booleans(), st.integers(-500, 500), st.booleans()),
    min_size=1,
    max_size=12,
)


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@given(steps=STEPS, spec=st.sampled_from(["track-quality", "kalman-cv:sigma_v=1", *VARIANTS[:3]]))
def test_any_times_and_misses(steps, spec):
    """Also where a plot comes after a prediction for its time, and where there are two."""
    tracker = make_tracker(spec)
    places = mappings(1, tracker.uses_acceleration)
    model = linear((0,), len(places))
    predictor, updater, initiator = components(spec, 1)

    def seen(plot, when):
        return Detection([plot], timestamp=at(when), measurement_model=model)

    (track,) = initiator.initiate({seen(0.0, 0.0)}, at(0.0))
    times, plots_, milliseconds = [0.0], [0.0], 0
    for gap, is_seen, plot, twice in steps:
        milliseconds += gap
        when = milliseconds / 1000
        state = predictor.predict(track, timestamp=at(when))
        if twice:
            state = predictor.predict(state, timestamp=at(when))
        if is_seen:
            state = updater.update(SingleHypothesis(state, seen(plot, when)))
            if twice:
                again = predictor.predict(state, timestamp=at(when))
                state = updater.update(SingleHypothesis(again, seen(-1e6, when)))
        track.append(state)
        times.append(when)
        plots_.append(plot if is_seen else np.nan)
    expected = tracker.run(times, np.array(plots_)[:, None], SIGMA)
    scale = np.abs(expected.filtered).max() + np.abs(expected.velocity).max() + 1.0
    found = states(track)
    np.testing.assert_allclose(found[:, :1], expected.filtered, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(found[:, 1:2], expected.velocity, rtol=0, atol=1e-9 * scale)
    assert (np.linalg.eigvalsh(track.covar) > -1e-9 * np.trace(track.covar)).all()
