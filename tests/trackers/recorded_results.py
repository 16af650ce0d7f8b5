"""What all trackers gave when `recorded_results.npz` was recorded, and how to record it again.

The file shows that a change leaves every number as it was; `test_recorded_results.py` compares. It
is recorded anew only where numbers change on purpose::

    python tests/trackers/recorded_results.py -o tests/trackers/recorded_results.npz

A few cases may differ in the last bit on another machine, and have a tolerance in the test. On the
machine that recorded them, ``--compare FILE`` compares these to the last bit, too.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from recorded_cases import CASES, GAINS, INPUTS, LANES, OUTPUTS, tracker_of
from recorded_file import bits, load, save

import fuzzytrack as ft

#: What some of the runs are told to keep.
KEEP = (("filtered",), ("velocity", "gains"), ("predicted", "innovation"), ("acceleration",), ())

#: Coordinates from which a job is compiled, and some.
LARGE = 250_000


@dataclass(frozen=True)
class Replay:
    """Numbers that a tracker gave in one way, to be compared with those recorded.

    Attributes
    ----------
    inputs : str
        Key of `INPUTS`.
    dtype : str
        Precision.
    way : str
        How the tracker was called, in words.
    outputs : dict of ndarray
        Some of `OUTPUTS` and `LANES`.
    at : tuple
        Where in the recorded arrays they lie; not for `LANES`.
    repeats : int
        How many times each track was given.
    calls, lane_steps : int, optional
        Python functions that were called, and steps of lanes that were done meanwhile. In plain
        Python there are more calls than steps; compiled code makes none.
    compiled : bool
        Whether it is to have run compiled.
    """

    inputs: str
    dtype: str
    way: str
    outputs: dict
    at: tuple = ()
    repeats: int = 1
    calls: int | None = None
    lane_steps: int = 0
    compiled: bool = False


def outputs_of(run):
    """Arrays of a state, or of a result as far as it kept them, by name."""
    of_state = isinstance(run, ft.TrackState)
    found = {}
    for name in OUTPUTS:
        if name in GAINS:
            if of_state or "gains" in run.kept:
                found[name] = getattr(run.gains, name)
        elif of_state or name in run.kept:
            found[name] = getattr(run, "position" if of_state and name == "filtered" else name)
    return found


def lanes_of(state):
    """What a step writes of a state."""
    return state.lanes[: state.rows.results]


def whole(result):
    """All that is recorded of a result."""
    return {**outputs_of(result), LANES: lanes_of(result.state)}


def counted(function):
    """What a function gives, and how many Python functions it calls in this thread."""
    calls, before = 0, sys.getprofile()

    def note(frame, event, argument):
        nonlocal calls
        calls += event == "call"

    sys.setprofile(note)
    try:
        value = function()
    finally:
        sys.setprofile(before)
    return value, calls


def replays(case, options=""):
    """Run a tracker in all ways that give the recorded numbers.

    The order matters: what has been compiled once serves all runs and steps that follow.

    Parameters
    ----------
    case : Case
    options : str
        As for `tracker_of`.

    Yields
    ------
    Replay
    """
    tracker = tracker_of(case, options)
    for name, given in INPUTS.items():
        yield from _runs(case, tracker, name, given, "float64", "plain")
        if case.streams:
            yield _stream(case, tracker, name, given, "stream, plain")
    if case.single:
        for name, given in INPUTS.items():
            yield from _runs(case, tracker, name, given, "float32", "single")
            yield from _large(case, tracker, name, given, "float32", LARGE // 16)
    if case.compiled:
        for name, given in INPUTS.items():
            yield from _large(case, tracker, name, given, "float64", LARGE)
            yield from _runs(case, tracker, name, given, "float64", "compiled")
        if case.streams:
            tracker.compile(2)
            for name, given in INPUTS.items():
                yield _stream(case, tracker, name, given, "stream, compiled")
                many = given.repeated(500)
                yield _stream(case, tracker, name, many, "long stream, compiled", 500)


def track(case, tracker, given, dtype, **settings):
    sigma = given.sigma if case.noise else None
    return tracker.run(given.times, given.plots, sigma, dtype=dtype, **settings)


def _runs(case, tracker, name, given, dtype, way):
    """Tracks at once, in parts, with less kept, and one of them alone."""
    steps, tracks = given.plots.shape[:2]
    if way == "plain":
        result, calls = counted(lambda: track(case, tracker, given, dtype))
        evidence = (calls, steps * tracks)
    else:
        # Counting would make the compiler, which is Python, several times slower.
        result, evidence = track(case, tracker, given, dtype), (None, 0)
    yield Replay(name, dtype, way, whole(result), (), 1, *evidence)

    last = outputs_of(result.state)
    if dtype == "float32":
        last = {key: values.astype(dtype) for key, values in last.items()}
    yield Replay(name, dtype, f"{way}, last state", last, (-1,))

    state, parts = None, []
    for ends in ((0, 1), (1, 5), (5, steps)):
        part = track(case, tracker, given.part(slice(*ends)), dtype, state=state)
        state, parts = part.state, [*parts, outputs_of(part)]
    joined = {key: np.concatenate([part[key] for part in parts]) for key in OUTPUTS}
    yield Replay(name, dtype, f"{way}, in parts", {**joined, LANES: lanes_of(state)})

    # Compiled, a run without innovation and gains has code of its own; once a case is enough.
    for keep in KEEP if case.compiled or dtype == "float64" else KEEP[1:3]:
        kept = track(case, tracker, given, dtype, keep=keep)
        assert kept.kept == keep
        yield Replay(
            name, dtype, f"{way}, keep={keep}", {**outputs_of(kept), LANES: lanes_of(kept.state)}
        )

    places = [(0,), (1,)]
    if result.state.lanes.shape[1] == given.plots[0].size:
        # Axes do not know of one another.
        places.append((2, 1))
    for place in places:
        alone = track(case, tracker, given.track(*place), dtype)
        called = f"{way}, track {place[0]}{', axis 1' if len(place) > 1 else ''} alone"
        yield Replay(name, dtype, called, outputs_of(alone), (slice(None), *place))


def _large(case, tracker, name, given, dtype, coordinates):
    """A job large enough to be compiled; the second time nothing is left to compile."""
    steps, tracks = given.plots.shape[:2]
    repeats = -(-coordinates // given.plots.size)
    many = given.repeated(repeats)
    shared = track(case, tracker, many, dtype, threads=2)
    yield Replay(name, dtype, "large job, two threads", whole(shared), (), repeats)
    result, calls = counted(lambda: track(case, tracker, many, dtype, threads=1))
    evidence = (calls, steps * tracks * repeats, True)
    yield Replay(name, dtype, "large job", whole(result), (), repeats, *evidence)


def _stream(case, tracker, name, given, way, repeats=1):
    def sigma_at(k):
        if not case.noise:
            return None
        return given.sigma if np.ndim(given.sigma) == 0 else given.sigma[k]

    def follow():
        states = [tracker.start(given.plots[0], given.times[0], sigma_at(0))]
        for k in range(1, len(given.plots)):
            states.append(tracker.step(states[-1], given.plots[k], given.times[k], sigma_at(k)))
        return states

    states, calls = counted(follow)
    steps = [outputs_of(state) for state in states]
    outputs = {key: np.stack([step[key] for step in steps]) for key in OUTPUTS}
    outputs[LANES] = lanes_of(states[-1])
    lane_steps = given.plots.shape[0] * given.plots.shape[1]
    compiled = "compiled" in way
    evidence = (None, 0) if compiled and repeats == 1 else (calls, lane_steps)
    return Replay(name, "float64", way, outputs, (), repeats, *evidence, compiled)


def recorded(case, options=""):
    """What goes into the file of a case: by inputs and precision, the arrays by name."""
    tracker = tracker_of(case, options)
    return {
        (name, dtype): whole(track(case, tracker, given, dtype))
        for name, given in INPUTS.items()
        for dtype in (("float64", "float32") if case.single else ("float64",))
    }


# ------------------------------------------------------------------ comparison

#: For cases that are `tolerant`, by precision: of the largest magnitude of an output.
TOLERANCES = {"float64": 1e-12, "float32": 1e-5}


def first_difference(expected, found, tolerance=0.0):
    """Where two arrays differ first, or None.

    Parameters
    ----------
    expected, found : ndarray
    tolerance : float
        Of the largest finite magnitude in `expected`. With 0 all bits count but those of NaN, and
        with them the sign of a zero.

    Returns
    -------
    tuple of int, or str, or None
        An index; words, if the arrays are not of one shape and type.
    """
    if (expected.shape, expected.dtype) != (found.shape, found.dtype):
        return f"{expected.dtype} of shape {expected.shape} is now {found.dtype} of {found.shape}"
    differs = bits(expected) != bits(found)
    if tolerance:
        known = np.abs(expected[np.isfinite(expected)])
        margin = tolerance * known.max(initial=0.0)
        with np.errstate(invalid="ignore"):
            differs &= ~(np.abs(expected - found) <= margin)
    return tuple(np.argwhere(differs)[0].tolist()) if differs.any() else None


def expected_of(replay, outputs):
    """What a replay ought to have given, out of what was recorded."""
    expected = {}
    for name in replay.outputs:
        values = outputs[name]
        if name == LANES:
            tracks = INPUTS[replay.inputs].plots.shape[1]
            lanes = values.reshape(len(values), tracks, -1)
            values = np.repeat(lanes, replay.repeats, axis=1).reshape(len(values), -1)
        else:
            values = np.repeat(values, replay.repeats, axis=1)[replay.at]
        expected[name] = values
    return expected


def complaints(case, replay, outputs, exact=False):
    """Say of each output that is not as it was recorded where it differs first.

    Parameters
    ----------
    case : Case
    replay : Replay
    outputs : dict of ndarray
        What was recorded with these inputs, in this precision.
    exact : bool
        Whether to compare to the last bit, whatever the case allows.

    Returns
    -------
    list of str
    """
    found = []
    tolerance = TOLERANCES[replay.dtype] if case.tolerant and not exact else 0.0
    for name, expected in expected_of(replay, outputs).items():
        values = np.asarray(replay.outputs[name])
        # Rows of a state are of different units.
        rows = range(len(expected)) if name == LANES and len(expected) == len(values) else (...,)
        for row in rows:
            place = first_difference(expected[row], values[row], tolerance)
            if place is None:
                continue
            if not isinstance(place, str):
                old, new = (float(array[row][place]) for array in (expected, values))
                at = [row, *place] if name == LANES else list(place)
                place = f"at {at} {old!r} ({old.hex()}) is now {new!r} ({new.hex()})"
            found.append(
                f"{case.name}: {name} of the inputs {replay.inputs!r} in {replay.dtype}, "
                f"{replay.way}: {place}"
            )
            break
    return found


def main():
    """Record, or compare to the last bit."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("-o", "--output", type=Path, metavar="FILE", help="record to a file")
    what.add_argument(
        "--compare", type=Path, metavar="FILE",
        help="compare with a file to the last bit, also where another machine may differ",
    )  # fmt: skip
    parser.add_argument(
        "--options", default="", metavar=":NAME=VALUE", help="parameters for all trackers"
    )
    given = parser.parse_args()
    if given.output:
        save(given.output, {case.name: recorded(case, given.options) for case in CASES})
        return 0
    kept, bad = load(given.compare), 0
    for case in CASES:
        for replay in replays(case, given.options):
            outputs = kept[case.name][replay.inputs, replay.dtype]
            for line in complaints(case, replay, outputs, exact=True):
                print(line)
                bad += 1
    print(f"{len(CASES)} cases, {bad} differences")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
