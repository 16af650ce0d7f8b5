"""The form of `recorded_results.npz`.

Most of what a run gives follows from its gains: the file holds for each number by how many steps of
its last bit it differs from a guess, and that is mostly 0. The guesses are the recursion of
docs/trackers.md, written out once more over arrays; a wrong one costs bytes and nothing else.
"""

import hashlib
import json
import os
from pathlib import Path

import numpy as np
from recorded_cases import GAINS, INPUTS, LANES, OUTPUTS

FILE = Path(__file__).with_name("recorded_results.npz")


def guessed(inputs, dtype, settle, gains=None):
    """Go through the outputs of a run in the order in which each can be guessed from those before.

    Parameters
    ----------
    inputs : Inputs
    dtype : str
    settle : callable
        ``settle(name, step, guess)`` gives the true values.
    gains : dict of ndarray, optional
        The gains of a run in double precision.
    """
    plots = inputs.plots.astype(dtype)
    lengths = np.diff(inputs.times, axis=0, prepend=inputs.times[:1]).astype(dtype)
    nothing = np.zeros_like(plots[0])
    before = dict.fromkeys((*GAINS, "velocity", "acceleration"), nothing)
    before["filtered"] = np.full_like(nothing, np.nan)
    half = nothing.dtype.type(0.5)
    for k, z in enumerate(plots):
        dt = lengths[k].reshape(lengths[k].shape + (1,) * (z.ndim - lengths[k].ndim))
        rate = 1 / np.where(dt > 0, dt, 1)
        x, v, a = (before[name] for name in ("filtered", "velocity", "acceleration"))
        predicted = settle("predicted", k, x + v * dt + a * (half * dt * dt))
        e = settle("innovation", k, z - predicted)
        used = ~np.isnan(e)
        now = {}
        for name in GAINS:
            near = before[name] if gains is None else gains[name][k].astype(dtype)
            now[name] = settle(name, k, np.where(used, near, np.nan))
        coasted = np.where(np.isnan(predicted), np.where(np.isnan(z), x, z), predicted)
        moved = v + a * dt
        guesses = {
            "filtered": (coasted, predicted + now["alpha"] * e),
            "velocity": (moved, moved + (now["beta"] * rate) * e),
            "acceleration": (a, a + (now["gamma"] * (half * rate * rate)) * e),
        }
        for name, (without, corrected) in guesses.items():
            before[name] = settle(name, k, np.where(used, corrected, without))
        for name in now:
            before[name] = np.where(used, now[name], before[name])


def bits(values):
    """Bits of numbers, as whole numbers; of all NaN the same."""
    values = np.where(np.isnan(values), values.dtype.type(np.nan), values)
    return np.ascontiguousarray(values).view(f"i{values.itemsize}")


def folded(steps):
    """Whole numbers without sign, small where the magnitude is small."""
    unsigned = f"u{steps.itemsize}"
    return ((steps << 1) ^ (steps >> (8 * steps.itemsize - 1))).view(unsigned)


def unfolded(numbers):
    steps = (numbers >> 1).view(f"i{numbers.itemsize}")
    return steps ^ -(numbers & 1).view(f"i{numbers.itemsize}")


def lane_guesses(inputs, outputs, count):
    """Rows of which one may lie among the lanes: 0, last plots and the last outputs."""
    seen = np.zeros_like(inputs.plots[0])
    for plots in inputs.plots:
        seen = np.where(np.isnan(plots), seen, plots)
    last = [np.zeros_like(seen), seen, *(outputs[name][-1] for name in OUTPUTS)]
    # A lane is an axis, or a track with all its axes.
    return np.concatenate([values.reshape(count, -1).T for values in last])


def pack(inputs, outputs, near=None):
    """Numbers of a run as one row of whole numbers, most of them 0.

    Parameters
    ----------
    inputs : Inputs
    outputs : dict of ndarray
    near : dict of ndarray, optional
        The same in double precision.

    Returns
    -------
    row : ndarray
    chosen : list of int
        Guess for each row of the lanes, see `lane_guesses`.
    """
    dtype = outputs["filtered"].dtype
    steps = {name: np.empty(inputs.plots.shape, f"i{dtype.itemsize}") for name in OUTPUTS}

    def settle(name, k, guess):
        values = outputs[name][k]
        steps[name][k] = bits(values) - bits(guess)
        return values

    guessed(inputs, dtype, settle, near)
    lanes, chosen = outputs[LANES].astype(dtype), []
    assert np.array_equal(lanes, outputs[LANES], equal_nan=True)
    if near is None:
        guesses = lane_guesses(inputs, outputs, lanes.shape[1])
        wrong = bits(lanes)[:, None] != bits(guesses)
        chosen = wrong.sum(axis=-1).argmin(axis=-1).tolist()
    guess = guesses[chosen] if near is None else near[LANES].astype(dtype)
    parts = (*steps.values(), bits(lanes) - bits(guess))
    return np.concatenate([folded(part).ravel() for part in parts]), chosen


def unpack(row, chosen, inputs, dtype, near=None):
    """Numbers of a run; the reverse of `pack`."""
    sizes = np.cumsum([inputs.plots.size] * len(OUTPUTS))
    *parts, rest = np.split(unfolded(row), sizes)
    steps = {name: p.reshape(inputs.plots.shape) for name, p in zip(OUTPUTS, parts, strict=True)}
    outputs = {name: np.empty(inputs.plots.shape, dtype) for name in OUTPUTS}

    def settle(name, k, guess):
        outputs[name][k] = (bits(guess) + steps[name][k]).view(dtype)
        return outputs[name][k]

    guessed(inputs, dtype, settle, near)
    if near is None:
        guess = lane_guesses(inputs, outputs, rest.size // len(chosen))[chosen]
    else:
        guess = near[LANES].astype(dtype)
    lanes = (bits(guess) + rest.reshape(guess.shape)).view(dtype)
    return {**outputs, LANES: lanes.astype(np.float64)}


def digest_of_inputs():
    digest = hashlib.sha256()
    for given in INPUTS.values():
        for values in (given.times, given.plots, given.sigma):
            digest.update(bits(np.asarray(values, dtype=np.float64)).astype("<i8").tobytes())
    return digest.hexdigest()


def save(path, results):
    """Write a file, whole or not at all.

    Parameters
    ----------
    path : Path
    results : dict
        For each case by name what `recorded` gives.
    """
    entries, rows = [], {"float64": [], "float32": []}
    for case, runs in results.items():
        for (name, dtype), outputs in runs.items():
            near = None if dtype == "float64" else runs[name, "float64"]
            row, chosen = pack(INPUTS[name], outputs, near)
            rows[dtype].append(row)
            entries.append((case, name, dtype, row.size, chosen))
    index = json.dumps({"inputs": digest_of_inputs(), "entries": entries})
    arrays = {"index": np.frombuffer(index.encode(), np.uint8)}
    for dtype, parts in rows.items():
        numbers = np.concatenate(parts)
        # First bytes of all numbers first: nearly all are 0.
        ordered = numbers.astype(f">u{numbers.itemsize}").view(np.uint8)
        arrays[dtype] = np.ascontiguousarray(ordered.reshape(-1, numbers.itemsize).T)
    draft = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with draft.open("xb") as stream:
            np.savez_compressed(stream, **arrays)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def load(path=FILE):
    """Read a file; the reverse of `save`."""
    with np.load(path) as arrays:
        index = json.loads(arrays["index"].tobytes())
        rows = {}
        for dtype in ("float64", "float32"):
            size = np.dtype(dtype).itemsize
            ordered = np.ascontiguousarray(arrays[dtype].T).view(f">u{size}")
            rows[dtype] = ordered.ravel().astype(f"u{size}")
    if index["inputs"] != digest_of_inputs():
        raise ValueError(f"{path} was recorded with other inputs: record it anew")
    results, used = {}, {"float64": 0, "float32": 0}
    for case, name, dtype, size, chosen in index["entries"]:
        row = rows[dtype][used[dtype] : used[dtype] + size]
        used[dtype] += size
        runs = results.setdefault(case, {})
        near = None if dtype == "float64" else runs[name, "float64"]
        runs[name, dtype] = unpack(row, chosen, INPUTS[name], dtype, near)
    return results
