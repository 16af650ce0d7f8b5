"""Memory of tracks, trackers of many targets, what is refused, pickles and YAML."""

import copy
import pickle

import numpy as np
import pytest
from ruamel.yaml.constructor import ConstructorError
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment, NearestNeighbour
from stonesoup.dataassociator.probability import JPDA, PDA
from stonesoup.dataassociator.tree import DetectionKDTreeGNN2D
from stonesoup.deleter.error import CovarianceBasedDeleter
from stonesoup.deleter.multi import CompositeDeleter
from stonesoup.deleter.time import UpdateTimeStepsDeleter
from stonesoup.gater.distance import DistanceGater
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.hypothesiser.probability import PDAHypothesiser
from stonesoup.initiator.simple import MultiMeasurementInitiator, SimpleMeasurementInitiator
from stonesoup.measures import Mahalanobis
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.measurement.nonlinear import (
    Cartesian2DToBearing,
    CartesianToBearingRange,
    CombinedReversibleGaussianMeasurementModel,
)
from stonesoup.models.transition.linear import (
    CombinedLinearGaussianTransitionModel,
    ConstantVelocity,
)
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.serialise import YAML
from stonesoup.tracker.simple import (
    MultiTargetMixtureTracker,
    MultiTargetTracker,
    SingleTargetMixtureTracker,
)
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.types.track import Track
from stonesoup.types.update import Update
from stonesoup.updater.kalman import KalmanUpdater
from stonesoup_scenes import SIGMA, at, components, detected, followed, linear, plots, states

from fuzzytrack.interop.stonesoup import (
    GainScheduledInitiator,
    GainScheduledPredictor,
    GainScheduledUpdater,
    ScheduledGaussianState,
    add_to_yaml,
)
from fuzzytrack.trackers.catalog import make_tracker

MODEL = linear((0, 2), 4)
BEARING = Cartesian2DToBearing(4, (0, 2), np.eye(1))
SPEC = "track-quality"
GOOD = {
    "tracker": "fixed:alpha=0.5:beta=0.2",
    "position_mapping": (0, 2),
    "velocity_mapping": (1, 3),
}


def detection(plot, seconds):
    return Detection(plot, timestamp=at(seconds), measurement_model=MODEL)


def updated(parts, state, plot, seconds):
    predictor, updater, _ = parts
    prediction = predictor.predict(state, timestamp=at(seconds))
    return updater.update(SingleHypothesis(prediction, detection(plot, seconds)))


def started(parts, plot=(0.0, 0.0)):
    (track,) = parts[2].initiate({detection(plot, 0.0)}, at(0.0))
    return track


def vector(state):
    return np.asarray(state.state_vector, float).ravel()


# ------------------------------------------------------------------- memory


@pytest.mark.parametrize("spec", [SPEC, "kalman-cv:sigma_v=1", "omega-schedule:missed=step"])
def test_hypotheses_are_tried_and_dropped(spec):
    """Other predictions and updates between those of a track do not change it."""
    rng = np.random.default_rng(1)
    t, z = plots(1, steps=20)
    parts, other = components(spec), components(spec)
    alone, disturbed = started(parts, z[0]).state, started(other, z[0]).state
    for when, plot in zip(t[1:], z[1:], strict=True):
        for _ in range(3):
            wrong = rng.normal(1000.0, 300.0, 2)
            updated(other, disturbed, wrong, when)
            other[0].predict(disturbed, timestamp=at(when + rng.uniform(0.1, 5.0)))
        if np.isnan(plot).any():
            alone, disturbed = (
                pair[0].predict(state, timestamp=at(when))
                for pair, state in ((parts, alone), (other, disturbed))
            )
        else:
            alone = updated(parts, alone, plot, when)
            disturbed = updated(other, disturbed, plot, when)
        np.testing.assert_array_equal(vector(alone), vector(disturbed))
        np.testing.assert_array_equal(alone.covar, disturbed.covar)


def test_a_prediction_of_a_track_is_that_of_its_last_state():
    parts = components(SPEC)
    track = started(parts)
    assert parts[0].predict(track, timestamp=at(1)) is parts[0].predict(track[-1], timestamp=at(1))


@pytest.mark.parametrize("spec", [SPEC, "omega-schedule:missed=step"])
def test_of_two_detections_at_one_time_the_second_leaves_the_state(spec):
    parts = components(spec)
    first = updated(parts, started(parts), (10.0, 4.0), 1.0)
    second = updated(parts, first, (70.0, 4.0), 1.0)
    assert isinstance(second, Update)
    assert second.hypothesis.measurement.state_vector[0] == 70.0
    np.testing.assert_array_equal(vector(second), vector(first))
    np.testing.assert_array_equal(second.covar, first.covar)
    states_after = [vector(updated(parts, each, (20.0, 9.0), 2.5)) for each in (first, second)]
    np.testing.assert_array_equal(*states_after)


@pytest.mark.parametrize("spec", [SPEC, "omega-schedule", "omega-schedule:missed=step"])
def test_a_detection_may_come_when_its_time_was_taken_for_missed(spec):
    """Of two sensors that look at one time, the first may see nothing."""
    parts = components(spec)
    before = updated(parts, started(parts), (10.0, 4.0), 1.0)
    missed = parts[0].predict(before, timestamp=at(2.5))
    found = updated(parts, missed, (24.0, 11.0), 2.5)
    expected = updated(parts, before, (24.0, 11.0), 2.5)
    np.testing.assert_array_equal(vector(found), vector(expected))
    np.testing.assert_array_equal(found.covar, expected.covar)


# ------------------------------------------------------------------- many targets


def many(seed, targets=4, steps=25):
    """Targets on courses far apart, missed at times, with clutter; and plots of each target."""
    rng = np.random.default_rng(seed)
    t = np.round(np.cumsum(rng.uniform(0.8, 1.2, steps)), 3)
    start = np.stack([np.arange(targets) * 500.0, np.zeros(targets)], axis=-1)
    z = start + t[:, None, None] * [5.0, 12.0] + rng.normal(0.0, SIGMA, (steps, targets, 2))
    z[3:][rng.random((steps - 3, targets)) < 0.2] = np.nan
    scans = []
    for when, scan in zip(t, z, strict=True):
        clutter = rng.uniform([-500.0, -100.0], [2000.0, 500.0], (3, 2))
        seen = scan[~np.isnan(scan).any(axis=1)]
        scans.append((at(when), {detection(each, when) for each in (*seen, *clutter)}))
    return t, z, scans


@pytest.mark.parametrize("spec", [SPEC, "omega-schedule"])
def test_many_targets_by_global_nearest_neighbors(spec):
    t, z, scans = many(2)
    predictor, updater, initiator = components(spec)
    hypothesiser = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=5)
    associator = GNNWith2DAssignment(hypothesiser)
    held = MultiMeasurementInitiator(
        prior_state=None, deleter=UpdateTimeStepsDeleter(2), data_associator=associator,
        updater=updater, min_points=3, initiator=initiator,
    )  # fmt: skip
    deleter = CovarianceBasedDeleter(1e5)
    tracker = MultiTargetTracker(held, deleter, iter(scans), associator, updater)
    _, tracks = list(tracker)[-1]
    expected = make_tracker(spec).run(t, z, SIGMA).filtered[-1]
    ends = np.array([vector(track)[[0, 2]] for track in tracks])
    distances = np.abs(ends[:, None] - expected).max(axis=2).min(axis=0)
    # A track that took clutter in place of a missed plot is another one.
    assert (distances < 1e-9).sum() >= 3
    assert distances.max() < 20.0
    whole = [track for track in tracks if len(track) == len(t)]
    assert len(whole) == 4
    assert all(isinstance(state, ScheduledGaussianState) for track in tracks for state in track)


def probabilities(predictor, updater):
    return PDAHypothesiser(
        predictor, updater, clutter_spatial_density=1e-6, prob_detect=0.9, prob_gate=0.99
    )


ASSOCIATORS = {
    "gated": lambda p, u, distances: GNNWith2DAssignment(
        DistanceGater(distances, Mahalanobis(), 5)
    ),
    "greedy": lambda p, u, distances: NearestNeighbour(distances),
    "probabilities": lambda p, u, distances: GNNWith2DAssignment(probabilities(p, u)),
    "tree": lambda p, u, distances: DetectionKDTreeGNN2D(
        distances, p, u, number_of_neighbours=5, max_distance_covariance_multiplier=5
    ),
}


@pytest.mark.parametrize("name", ASSOCIATORS)
def test_associators_are_used_as_they_are(name):
    t, z, scans = many(2, steps=12)
    predictor, updater, initiator = components(SPEC)
    distances = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=5)
    associator = ASSOCIATORS[name](predictor, updater, distances)
    deleter = CompositeDeleter([UpdateTimeStepsDeleter(3), CovarianceBasedDeleter(1e5)])
    tracker = MultiTargetTracker(initiator, deleter, iter(scans), associator, updater)
    _, tracks = list(tracker)[-1]
    whole = [track for track in tracks if len(track) == len(t)]
    expected = make_tracker(SPEC).run(t, z, SIGMA).filtered[-1]
    ends = np.array([vector(track)[[0, 2]] for track in whole])
    assert np.abs(ends[:, None] - expected).max(axis=2).min(axis=0).max() < 20.0


@pytest.mark.parametrize(
    ("kind", "associator"), [(MultiTargetMixtureTracker, JPDA), (SingleTargetMixtureTracker, PDA)]
)
def test_mixture_trackers_are_refused(kind, associator):
    _, _, scans = many(3, steps=6)
    predictor, updater, initiator = components(SPEC)
    deleter = UpdateTimeStepsDeleter(5)
    mixture = associator(probabilities(predictor, updater))
    tracker = kind(initiator, deleter, iter(scans), mixture, updater)
    with pytest.raises(ValueError, match=r"no memory of a tracker.*mixture tracker \(PDA, JPDA\)"):
        for _ in tracker:
            pass


# ------------------------------------------------------------------- pickles and YAML


@pytest.mark.parametrize("spec", [SPEC, "kalman-cv:sigma_v=1", "maneuver:level=5"])
def test_tracks_go_on_from_pickles_and_copies(spec):
    parts = components(spec)
    places = parts[1].position_mapping
    model = linear(places, 6 if parts[1].acceleration_mapping else 4)
    t, z = plots(9, steps=24, missed=0.3)
    z[-1] = z[-2] = 1050.0
    track = followed(parts, detected(t, z, model))
    for cut in (1, 2, 9, 15):
        for again in (lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy):
            predictor, updater, initiator, state = again((*parts, track[cut - 1]))
            for when, plot in zip(t[cut:], z[cut:], strict=True):
                prediction = predictor.predict(state, timestamp=at(when))
                state = prediction
                if not np.isnan(plot).any():
                    seen = Detection(plot, timestamp=at(when), measurement_model=model)
                    state = updater.update(SingleHypothesis(prediction, seen))
            np.testing.assert_array_equal(vector(state), vector(track))
            np.testing.assert_array_equal(state.covar, track.covar)
            assert initiator.initiate({seen}, at(0.0))


@pytest.fixture
def yaml():
    """Stone Soup's YAML, which knows the package by its entry point where that is installed."""
    made = YAML()
    add_to_yaml(made)
    return made


@pytest.mark.parametrize("spec", ["stiffness-damping:missed=step", "maneuver:level=5"])
def test_components_go_through_yaml(yaml, spec):
    parts = components(spec)
    given = DistanceHypothesiser(*parts[:2], Mahalanobis(), missed_distance=5)
    text = yaml.dumps({"hypothesiser": given, "initiator": parts[2]})
    assert f"tracker: {spec}" in text
    found = yaml.load(text)
    again = found["hypothesiser"]
    for one, two in zip(
        (*parts,), (again.predictor, again.updater, found["initiator"]), strict=True
    ):
        assert type(one) is type(two)
        for name in type(one).properties:
            assert getattr(two, name) == getattr(one, name) or (
                list(getattr(two, name)) == list(getattr(one, name))
            )
    assert yaml.dumps({"hypothesiser": again, "initiator": found["initiator"]}) == text


def test_a_model_within_goes_through_yaml(yaml):
    given = GainScheduledUpdater(**GOOD, measurement_model=MODEL)
    found = yaml.load(yaml.dumps(given)).measurement_model
    assert isinstance(found, LinearGaussian)
    np.testing.assert_array_equal(found.covar(), MODEL.covar())
    assert list(found.mapping) == [0, 2]


def test_tracks_go_on_from_yaml(yaml):
    parts = components(SPEC)
    t, z = plots(10, steps=12)
    track = followed(parts, detected(t, z, MODEL))
    (found,) = yaml.load(yaml.dumps([track]))
    assert isinstance(found, Track)
    np.testing.assert_array_equal(states(found), states(track))
    later = [vector(updated(parts, each, (1100.0, 1050.0), t[-1] + 1.5)) for each in (found, track)]
    np.testing.assert_array_equal(*later)


@pytest.mark.parametrize(
    ("tag", "message"),
    [
        ("predictor.GainScheduledPredictor", "fixed.*needs alpha and beta"),
        ("predictor.Nothing", "there is no component fuzzytrack.*Nothing"),
        ("nothing.Nothing", "there is no component"),
        ("plots.position_of", "there is no component"),
    ],
)
def test_wrong_yaml_is_refused_at_its_place(yaml, tag, message):
    text = (
        f"a: !fuzzytrack.interop.stonesoup.{tag}\n"
        "- tracker: fixed\n- position_mapping: [0]\n- velocity_mapping: [1]\n"
    )
    with pytest.raises(ConstructorError, match=f"(?s){message}.*line 1"):
        yaml.load(text)


# ------------------------------------------------------------------- what is refused


@pytest.mark.parametrize("kind", [GainScheduledPredictor, GainScheduledUpdater])
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tracker": "omega-shedule"}, "did you mean 'omega-schedule'"),
        ({"tracker": make_tracker("fixed:alpha=0.5:beta=0.2")}, "tracker: must be a text"),
        ({"tracker": "fixed:alpha=0.5"}, "needs beta"),
        ({"tracker": "imm-two"}, "'imm-two' is no alpha-beta tracker"),
        ({"tracker": "bank"}, "'bank' is no alpha-beta tracker"),
        ({"position_mapping": ()}, "position_mapping: is empty"),
        ({"position_mapping": 0}, "position_mapping: must be the places"),
        ({"position_mapping": "02"}, "position_mapping: must be the places"),
        ({"position_mapping": (0.0, 2.0)}, "position_mapping: must be the places"),
        ({"velocity_mapping": (1,)}, r"velocity_mapping: \(1,\) has 1 places"),
        ({"velocity_mapping": (1, 2)}, "must be the numbers from 0 to 3, each once"),
        ({"velocity_mapping": (1, 5)}, "must be the numbers from 0 to 3, each once"),
        ({"position_mapping": (0, -2)}, "must be the numbers from 0 to 3, each once"),
        ({"acceleration_mapping": (4, 5)}, "has no acceleration; leave it out"),
        (
            {"tracker": "maneuver:level=5"},
            "'maneuver:level=5' has an acceleration; give its place",
        ),
        (
            {"tracker": "maneuver:level=5", "acceleration_mapping": (4,)},
            r"acceleration_mapping: \(4,\) has 1 places",
        ),
    ],
)
def test_properties_that_do_not_fit_are_refused(kind, changes, message):
    with pytest.raises(ValueError, match=message) as raised:
        kind(**{**GOOD, **changes})
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GainScheduledPredictor(**GOOD), "acceleration_noise: .* has none of its own"),
        (lambda: GainScheduledPredictor(**GOOD, acceleration_noise=-1), "acceleration_noise"),
        (
            lambda: GainScheduledPredictor(**GOOD, acceleration_noise="a"),
            "acceleration_noise must be a number, got 'a'",
        ),
        (lambda: GainScheduledInitiator(**GOOD, velocity_deviation=0), "velocity_deviation"),
        (
            lambda: GainScheduledInitiator(
                tracker="maneuver:level=5", position_mapping=[0], velocity_mapping=[1],
                acceleration_mapping=[2], velocity_deviation=1,
            ),
            "acceleration_deviation: .* has none of its own",
        ),
    ],
)  # fmt: skip
def test_standard_deviations_are_checked(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_noise_of_the_tracker_is_taken():
    kalman = {**GOOD, "tracker": "kalman-cv:sigma_v=2"}
    carried = {**GOOD, "tracker": "omega-schedule:covariance=2"}
    for properties in (kalman, carried):
        parts = components(properties["tracker"], noise=2.0)
        found = GainScheduledPredictor(**properties).predict(started(parts), timestamp=at(3))
        expected = parts[0].predict(started(parts), timestamp=at(3))
        np.testing.assert_array_equal(found.covar, expected.covar)
    accelerating = {
        "tracker": "kalman-ca:sigma_v=2:acceleration_sigma=3", "position_mapping": [0],
        "velocity_mapping": [1], "acceleration_mapping": [2], "velocity_deviation": 4.0,
    }  # fmt: skip
    seen = Detection([5.0], timestamp=at(0), measurement_model=linear((0,), 3))
    (track,) = GainScheduledInitiator(**accelerating).initiate({seen}, at(0))
    np.testing.assert_array_equal(track.covar, np.diag([SIGMA**2, 16.0, 9.0]))


def test_properties_cannot_change():
    with pytest.raises(AttributeError, match="readonly"):
        components(SPEC)[0].tracker = "omega-schedule"


def test_states_without_a_memory_are_refused():
    predictor, updater, _ = parts = components(SPEC)
    plain = GaussianState(np.zeros(4), np.eye(4), timestamp=at(0))
    simple = SimpleMeasurementInitiator(plain)
    (track,) = simple.initiate({detection((0.0, 0.0), 0.0)}, at(0))
    for state in (plain, track):
        with pytest.raises(ValueError, match="has no memory of a tracker; start tracks with Gain"):
            predictor.predict(state, timestamp=at(1))
    # A Kalman predictor carries the memory along, but does not move it.
    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(1), ConstantVelocity(1)])
    foreign = KalmanPredictor(motion).predict(started(parts), timestamp=at(1))
    for state in (plain, foreign):
        with pytest.raises(ValueError, match="is not from GainScheduledPredictor"):
            updater.update(SingleHypothesis(state, detection((0.0, 0.0), 1.0)))


@pytest.mark.parametrize("twice", [False, True])
def test_states_that_another_component_has_changed_are_refused(twice):
    """They have the memory of the state before."""
    parts = components(SPEC)
    state = updated(parts, started(parts), (10.0, 4.0), 1.0)
    when = 1.0 if twice else 2.0
    prediction = parts[0].predict(state, timestamp=at(when))
    changed = KalmanUpdater().update(SingleHypothesis(prediction, detection((30.0, 9.0), when)))
    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(1), ConstantVelocity(1)])
    for foreign in (changed, KalmanPredictor(motion).predict(state, timestamp=at(2))):
        assert foreign.memory is not None
        with pytest.raises(ValueError, match="is not that of its memory; predict and update it"):
            parts[0].predict(foreign, timestamp=at(3))


def test_states_of_another_tracker_are_refused():
    state = started(components("fixed:alpha=0.5:beta=0.2")).state
    other = components("fixed:alpha=0.5:beta=0.3")
    with pytest.raises(ValueError, match=r"beta=0\.2' cannot be continued by .*beta=0\.3'"):
        other[0].predict(state, timestamp=at(1))
    prediction = components("fixed:alpha=0.5:beta=0.2")[0].predict(state, timestamp=at(1))
    with pytest.raises(ValueError, match="give initiator, predictor and updater the same"):
        other[1].update(SingleHypothesis(prediction, detection((1.0, 1.0), 1.0)))


def test_times_are_checked():
    parts = components(SPEC)
    state = updated(parts, started(parts), (10.0, 4.0), 2.0)
    for when in (at(1), None):
        with pytest.raises(ValueError, match="timestamp: must not be earlier"):
            parts[0].predict(state, timestamp=when)
    prediction = parts[0].predict(state, timestamp=at(3))
    with pytest.raises(ValueError, match="predict for the time of the detection"):
        parts[1].update(SingleHypothesis(prediction, detection((1.0, 1.0), 4.0)))


@pytest.mark.parametrize(
    ("seen", "model", "message"),
    [
        ([1.0, 2.0], None, "neither the detection nor the component has one"),
        ([1.0], linear((0,), 4), "LinearGaussian does not measure the position on every axis"),
        ([1.0], BEARING, "does not measure the position"),
        (
            [0.1, 0.1],
            CombinedReversibleGaussianMeasurementModel([BEARING, BEARING]),
            "does not measure the position",
        ),
        ([1.0, 2.0], linear((0, 1), 2), "states have 2 places, those of the mappings 4"),
        ([1.0, 2.0], linear((0, 2), 6), "states have 6 places, those of the mappings 4"),
        ([1.0, np.nan], MODEL, "is not finite; leave it out"),
        ([1.0, np.inf], MODEL, "is not finite; leave it out"),
        ([1.0, 2.0], LinearGaussian(4, (0, 2), np.zeros((2, 2))), "place 0 .* must be positive"),
        (
            [0.1, 9.0],
            CartesianToBearingRange(4, mapping=(0, 1), noise_covar=np.eye(2)),
            "place 2 of position_mapping has the variance 0, .* a mapping with the places",
        ),
    ],
)
def test_detections_that_are_no_positions_are_refused(seen, model, message):
    found = Detection(seen, timestamp=at(0), measurement_model=model)
    with pytest.raises(ValueError, match=message):
        components(SPEC)[2].initiate({found}, at(0))


def test_a_track_begins_at_the_time_of_its_detection():
    """Within a scan detections have times of their own."""
    predictor, updater, initiator = components("fixed:alpha=0.5:beta=0.2")
    (track,) = initiator.initiate({detection((0.0, 0.0), 1.0)}, at(3))
    assert track.timestamp == at(1)
    prediction = predictor.predict(track, timestamp=at(5))
    found = updater.update(SingleHypothesis(prediction, detection((20.0, 8.0), 5.0)))
    np.testing.assert_array_equal(vector(found), [20.0, 5.0, 8.0, 2.0])


def test_a_model_may_be_given_to_the_components():
    common = {**GOOD, "measurement_model": MODEL}
    initiator = GainScheduledInitiator(**common, velocity_deviation=30)
    predictor = GainScheduledPredictor(**GOOD, acceleration_noise=1)
    (track,) = initiator.initiate({Detection([1.0, 2.0])}, at(0))
    assert track.timestamp == at(0)
    prediction = predictor.predict(track, timestamp=at(1))
    bare = Detection([11.0, 6.0], timestamp=at(1))
    found = GainScheduledUpdater(**common).update(SingleHypothesis(prediction, bare))
    np.testing.assert_array_equal(vector(found), [11.0, 10.0, 6.0, 4.0])


def test_what_a_detection_says_of_velocity_is_not_used():
    covar = np.diag([4.0, 1.0, 4.0, 1.0])
    model = LinearGaussian(4, (0, 1, 2, 3), covar)
    parts = components(SPEC)
    whole = Detection([10.0, 99.0, 4.0, 99.0], timestamp=at(0), measurement_model=model)
    (track,) = parts[2].initiate({whole}, at(0))
    np.testing.assert_array_equal(vector(track), [10.0, 0.0, 4.0, 0.0])
    assert track.covar[0, 0] == 4.0


def test_a_linear_model_may_mix_the_axes():
    class Turned(LinearGaussian):
        def matrix(self, **kwargs):
            return np.array([[1.0, 0.0, 1.0, 0.0], [1.0, 0.0, -2.0, 0.0]])

    model = Turned(4, (0, 2), np.diag([1.0, 9.0]))
    seen = Detection([30.0, -30.0], timestamp=at(0), measurement_model=model)
    (track,) = components(SPEC)[2].initiate({seen}, at(0))
    np.testing.assert_allclose(vector(track)[[0, 2]], [10.0, 20.0])
    inverse = np.array([[2.0, 1.0], [1.0, -1.0]]) / 3
    np.testing.assert_allclose(
        track.covar[np.ix_([0, 2], [0, 2])], inverse @ np.diag([1.0, 9.0]) @ inverse.T
    )
