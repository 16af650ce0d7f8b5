"""A state is continued by a tracker with the parameters of the one that it comes from."""

import pickle
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.origin import Origin, digest_of
from fuzzytrack.trackers.track_store import TrackStore

T, Z = np.arange(4.0), np.array([0.0, 10.0, 19.0, 31.0])

#: Trackers whose states have one layout, in pairs.
ALIKE = {
    "fixed gains": ("fixed:alpha=0.5:beta=0.2", "fixed:alpha=0.5:beta=0.3"),
    "kalman": ("kalman-cv:sigma_v=1:sigma_w=1", "kalman-cv:sigma_v=2:sigma_w=1"),
    "rule bases": ("stiffness-damping", "stiffness-damping-wide"),
    "periods": ("stiffness-damping:period=1", "stiffness-damping:period=2"),
    "levels": ("maneuver:level=3", "maneuver:level=4"),
    "missed": ("fixed:alpha=0.5:beta=0.2", "fixed:alpha=0.5:beta=0.2:missed=step"),
    "pairs": (
        "imm:quiet_sigma=0.1:maneuver_sigma=1:sigma_w=1",
        "imm:quiet_sigma=0.1:maneuver_sigma=2:sigma_w=1",
    ),
    "models": ("imm-two:level=3:sigma_w=1", "imm-two:level=30:sigma_w=1"),
}


@pytest.mark.parametrize(
    ("names", "compiled"),
    [*((pair, False) for pair in ALIKE.values()), (ALIKE["fixed gains"], True)],
    ids=[*ALIKE, "compiled"],
)
def test_states_of_other_parameters_are_refused(names, compiled):
    one, other = map(make_tracker, names)
    sigma = 1.0
    state = one.run(T, Z, sigma).state
    assert state.rows == other.run(T, Z, sigma).state.rows
    if compiled:
        one.compile()
        other.compile()
        # With a compiled step that has been used.
        other.step(other.start(0.0, 0.0, sigma), 1.0, 1.0, sigma)
    for go_on in (
        lambda: other.step(state, 40.0, 4.0, sigma),
        lambda: other.run([4.0], [40.0], sigma, state=state),
        lambda: other.predict(state, 4.0),
        lambda: TrackStore(other, 1).add(one.run(T, Z[:, None], sigma).state),
    ):
        with pytest.raises(ValueError, match="state: it comes from") as refused:
            go_on()
        message = str(refused.value)
        assert repr(one) in message
        assert repr(other) in message
        assert "\n" not in message
    expected = one.step(state, 40.0, 4.0, sigma)
    equal = make_tracker(names[0])
    np.testing.assert_array_equal(equal.step(state, 40.0, 4.0, sigma).lanes, expected.lanes)
    again = pickle.loads(pickle.dumps(state))
    np.testing.assert_array_equal(equal.step(again, 40.0, 4.0, sigma).lanes, expected.lanes)
    with pytest.raises(ValueError, match="state: it comes from"):
        other.step(again, 40.0, 4.0, sigma)


def test_trackers_of_one_text_are_told_apart():
    rules = ft.load_rulebase("stiffness-damping")
    output = replace(rules.outputs[0], universe=replace(rules.outputs[0].universe, high=0.36))
    one, other = (
        ft.AlphaBetaTracker(ft.FuzzyScheduler(replace(r, name="mine")))
        for r in (rules, replace(rules, outputs=(output, rules.outputs[1])))
    )
    assert repr(one) == repr(other)
    with pytest.raises(ValueError, match="of the same name, with other parameters; give a state"):
        other.step(one.run(T, Z).state, 40.0, 4.0)


def test_a_store_and_its_states_pickle():
    tracker = make_tracker("stiffness-damping")
    store = TrackStore(tracker, 1)
    slots = store.add(tracker.start([[1.0], [2.0]], 0.0))
    state = store.gather(slots)
    assert len(pickle.dumps(state)) < 2_000
    copy = pickle.loads(pickle.dumps(store))
    copy.step(slots, [[2.0], [3.0]], 1.0)
    copy.scatter(slots, tracker.step(state, [[2.0], [3.0]], 1.0))
    with pytest.raises(ValueError, match="state: it comes from"):
        copy.scatter(slots, make_tracker("fixed:alpha=1:beta=1").start([[1.0], [2.0]], 0.0))


def test_a_state_that_says_no_tracker_is_refused():
    tracker = make_tracker("fixed:alpha=0.5:beta=0.2")
    state = tracker.run(T, Z).state
    old = ft.TrackState(state.time, state.shape, state.lanes, state.rows)
    with pytest.raises(ValueError, match="or by another release of fuzzytrack"):
        tracker.step(old, 40.0, 4.0)


NAMES = ["stiffness-damping", "maneuver:level=3", "imm-three", "kalman-cv:sigma_v=1"]


def test_digests_are_the_same_in_every_process():
    code = (
        "from fuzzytrack.trackers.catalog import make_tracker\n"
        "from fuzzytrack.trackers.origin import digest_of\n"
        f"print([digest_of(make_tracker(n)) for n in {NAMES!r}])"
    )
    environment = {**__import__("os").environ, "PYTHONHASHSEED": "7"}
    other = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert eval(other.stdout) == [digest_of(make_tracker(n)) for n in NAMES]


# ---------------------------------------------------------------- digests

VALUES = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False), st.text(max_size=3)
    ),
    lambda parts: st.lists(parts, max_size=3).map(tuple),
    max_leaves=6,
)


@given(VALUES, VALUES)
def test_digests_are_equal_exactly_for_equal_values(one, other):
    assert (digest_of(one) == digest_of(other)) == (one == other)


@given(*[st.floats(0.01, 1)] * 4)
def test_origins_are_the_same_exactly_for_equal_trackers(alpha, beta, other_alpha, other_beta):
    one, other = (
        ft.AlphaBetaTracker(ft.FixedGains(*gains))
        for gains in ((alpha, beta), (other_alpha, other_beta))
    )
    pickled = pickle.loads(pickle.dumps(Origin(one)))
    assert Origin(one).is_same(Origin(other)) == (one == other)
    assert pickled.is_same(Origin(other)) == (one == other)
    assert pickled.text == repr(one)


class Plain(ft.GainScheduler):
    """A scheduler that is no dataclass, with a number and a function."""

    def __init__(self, gain, function):
        self.gain, self.function = gain, function

    def initial_memory(self, n_axes):
        return ()

    def kernel(self, n_axes):
        gain = self.gain
        return lambda e, change, dt, sigma, memory: (gain, gain, 0.0, 1.0, memory)


def test_digests_of_other_objects_follow_from_their_parts():
    def digest(gain, function):
        return digest_of(ft.AlphaBetaTracker(Plain(gain, function)))

    first, second = (lambda x: x + 1), (lambda x: x + 2)
    assert digest(0.5, first) == digest(0.5, lambda x: x + 1)
    assert digest(0.5, first) != digest(0.25, first)
    assert digest(0.5, first) != digest(0.5, second)
    assert digest_of({"a": 1, "b": 2}) == digest_of({"b": 2.0, "a": 1.0})
    assert digest_of(np.arange(3)) != digest_of(np.arange(4))
    assert digest_of({1, 2}) != digest_of({1, 3})
    assert digest_of(KalmanCV) != digest_of(Plain)
    round_trip: list = []
    round_trip.append(round_trip)
    assert digest_of(round_trip)
    assert digest_of("a".upper) != digest_of("b")
    assert digest_of(Plain(1, None).kernel) != digest_of(Plain(2, None).kernel)
