"""What `recorded_results.npz` holds the results of: trackers, and what they are given."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fuzzytrack.trackers.catalog import make_tracker

#: What is recorded of a run; `lanes` are all numbers of its last state.
OUTPUTS = (
    "predicted", "innovation", "alpha", "beta", "gamma", "filtered", "velocity", "acceleration"
)  # fmt: skip
LANES = "lanes"
GAINS = ("alpha", "beta", "gamma")

# ------------------------------------------------------------------ rule bases

# Two centers an output, and ends and widths of sets, are powers of two: sums and products over sets
# are then exact, and tables are the same whatever library adds them up.
CENTERS = {
    "stiffness": (0.25, 0.5), "damping": (0.5, 1.0),
    "alpha": (0.25, 0.5), "beta": (0.125, 0.25), "gamma": (0.015625, 0.0625),
}  # fmt: skip

FIRST = {
    "n": "trapmf: [-3.125, -3.125, -1, 0]", "z": "trimf: [-1, 0, 0.5]",
    "p": "trimf: [0, 0.5, 2.5]", "g": "trapmf: [0.5, 2.5, 3.125, 3.125]",
}  # fmt: skip

SECOND = {
    "l": "trapmf: [-3.125, -3.125, -0.25, 0.25]", "m": "trimf: [-0.25, 0.25, 1.25]",
    "h": "trapmf: [0.25, 1.25, 3.125, 3.125]",
}  # fmt: skip

# What the rules say of up to three outputs, for the sets n, z, p and g.
CELLS = {"l": "SLL LSS SSL LLS", "m": "SSS SLL LSL LSS", "h": "LSL LLS SLS LLL"}

SMOOTH = {"n": "zmf: [-1, 0]", "z": "pimf: [-1, 0, 0.25, 0.5]", "p": "smf: [0, 0.5]",
          "g": "trimf: [0.5, 2.5, 3.125]"}  # fmt: skip

CURVED = {"n": "sigmf: [-0.5, -4]", "z": "gaussmf: [0, 0.5]", "p": "gauss2mf: [0.5, 0.25, 1, 0.75]",
          "g": "gbellmf: [1, 4, 2.5]"}  # fmt: skip


def lopsided(
    normalization, outputs="stiffness damping", more="", first=FIRST,
    operators="and: product, or: sum, defuzzification: weighted-centers", doubt="",
):  # fmt: skip
    """Text of a rule base without any symmetry."""
    names = outputs.split()
    gains = {"stiffness damping": "w-domain", "stiffness": "kalata"}.get(outputs, "direct")

    def sets(shapes):
        return "{" + ", ".join(f"{name}: {{{shape}}}" for name, shape in shapes.items()) + "}"

    lines = ["rulebase: 1", "name: lopsided", "source: test", "inputs:"]
    for name, shapes in (("error", first), ("rate", SECOND)):
        lines += [f"  {name}:", "    universe: [-3.125, 3.125, 51]", f"    sets: {sets(shapes)}"]
    lines += ["outputs:"]
    for name in names:
        low, high = CENTERS[name]
        shapes = {"S": f"trimf: [{low}, {low}, {high}]", "L": f"trimf: [{low}, {high}, {high}]"}
        lines += [f"  {name}:", f"    universe: [{low}, {high}, 9]", f"    sets: {sets(shapes)}"]
    lines += [f"operators: {{{operators}}}", "rules:", "  columns: error", "  rows: rate"]
    lines += [f"  cells: [{', '.join(names)}]", "  table:"]
    for row, words in CELLS.items():
        cells = ["-".join(word[: len(names)]) for word in words.split()]
        cells[1] += doubt
        lines += [f"    {row}: [{', '.join(cells)}]"]
    lines += [f"scheduler: {{normalization: {normalization}, gains: {gains}{more}}}"]
    return "\n".join(lines) + "\n"


# ------------------------------------------------------------------ cases


@dataclass(frozen=True)
class Case:
    """A tracker whose results are recorded.

    Attributes
    ----------
    name : str
    spec : str
        What `make_tracker` takes; with `rules` only what stands after the file.
    rules : str
        Text of a rule base of its own.
    noise : bool
        Whether the tracker needs the standard deviation of the plots.
    compiled : bool
        Whether it is compiled in double precision, too. All that can are compiled in single
        precision; to compile takes seconds where no other process has left its code on disk, so one
        or two cases of a kind have to do.
    single : bool
        Whether it runs in single precision.
    streams : bool
        Whether it takes plots one by one.
    tolerant : bool
        Whether another machine may give other last bits: where numbers come from `exp` and `pow` of
        the C library, or from matrix products of BLAS. + - * / and square roots are rounded the
        same everywhere.
    """

    name: str
    spec: str
    rules: str = ""
    noise: bool = False
    compiled: bool = False
    single: bool = True
    streams: bool = True
    tolerant: bool = False


FIXED = (
    Case("fixed", "fixed:alpha=0.55:beta=0.21", compiled=True),
    Case("fixed, one-point", "fixed:alpha=0.55:beta=0.21:start=one-point", compiled=True),
    Case("fixed, gamma", "fixed:alpha=0.6:beta=0.3:gamma=0.07", compiled=True),
    Case("fixed, gamma, one-point", "fixed:alpha=0.6:beta=0.3:gamma=0.07:start=one-point"),
    Case("benedict-bordner", "benedict-bordner:alpha=0.45"),
    # Powers of 1 - ξ that need few bits, so that no rounding of `pow` shows.
    Case("fading-memory", "fading-memory:xi=0.625"),
    Case("fading-memory, njonjo", "fading-memory:xi=0.625:convention=njonjo:start=one-point"),
    Case("fading-memory, order 2", "fading-memory:xi=0.75:order=2"),
)

# Standard deviations are given in few bits for the same reason: they are squared with `pow`.
MEMORY = (
    Case("growing-memory", "growing-memory", compiled=True),
    Case("growing-memory, one-point", "growing-memory:limit=5:start=one-point"),
    Case("linear-combination", "linear-combination"),
    Case(
        "linear-combination, one-point",
        "linear-combination:alpha=0.3:weight=0.25:limit=6:start=one-point",
    ),
    Case("track-quality", "alpha-beta:scheduler=track-quality", compiled=True),
    Case("track-quality, one-point", "track-quality:cap=3:drop=1.5:start=one-point"),
    Case("innovation", "innovation:sigma_d=0.5:window=3", noise=True, compiled=True),
    Case(
        "innovation, one-point",
        "innovation:sigma_d=2:window=4:partial=false:start=one-point",
        noise=True,
    ),
    Case(
        "innovation, as published",
        "innovation:sigma_d=5:q_scale=5:window=3:extra_term=true:partial=false:floor=negative",
        noise=True,
    ),
    Case("kalman-cv", "kalman-cv:sigma_v=1.5", noise=True, compiled=True),
    Case(
        "kalman-cv, one-point",
        "kalman-cv:sigma_v=1.5:velocity_sigma=32:start=one-point",
        noise=True,
    ),
    Case("kalman-cv, one sigma", "kalman-cv:sigma_v=0.5:sigma_w=8:start=one-point"),
    Case("kalman-ca", "kalman-ca:sigma_v=0.5:acceleration_sigma=4", noise=True, compiled=True),
    Case(
        "kalman-ca, one-point",
        "kalman-ca:sigma_v=0.5:acceleration_sigma=4:sigma_w=8:velocity_sigma=32:start=one-point",
    ),
)

SHIPPED = (
    Case("stiffness-damping", "stiffness-damping", compiled=True),
    Case("stiffness-damping, one-point", "stiffness-damping:start=one-point"),
    Case("stiffness-damping by table", "stiffness-damping:method=table", tolerant=True),
    Case("stiffness-damping by relation", "stiffness-damping:method=relation", tolerant=True),
    Case("stiffness-damping-wide", "stiffness-damping-wide"),
    # Its output sets differ in area, which is summed up by BLAS.
    Case("stiffness-damping-cog", "stiffness-damping-cog", tolerant=True),
    Case("stiffness-damping-cog by table", "stiffness-damping-cog:method=table", tolerant=True),
    Case(
        "stiffness-damping-cog by relation", "stiffness-damping-cog:method=relation", tolerant=True
    ),
    Case("chan-style", "chan-style", compiled=True),
    Case("chan-style, one-point", "chan-style:start=one-point"),
    Case("chan-style by table", "chan-style:method=table", tolerant=True),
    Case("chan-style by relation", "chan-style:method=relation", tolerant=True),
    Case("omega-schedule", "omega-schedule", noise=True, compiled=True),
    Case(
        "omega-schedule, by the name fuzzy", "fuzzy:rules=omega-schedule:start=one-point",
        noise=True,
    ),
    Case("omega-schedule by table", "omega-schedule:method=table", noise=True, tolerant=True),
    Case("omega-schedule by relation", "omega-schedule:method=relation", noise=True, tolerant=True),
    Case("maneuver", "maneuver:level=3", noise=True, compiled=True),
    Case("maneuver, own axes", "maneuver:level=3:axes=own", noise=True, compiled=True),
    Case(
        "maneuver, from one plot", "maneuver:level=3:velocity_sigma=32:start=one-point", noise=True
    ),
    Case("maneuver-two-rules, no level", "maneuver-two-rules", noise=True, compiled=True),
)  # fmt: skip

OPENING = ", opening: growing-memory"
GAMMA = "alpha beta gamma"
MINIMUM = "and: min, or: max, defuzzification: "

RULES = (
    Case("chan", "", lopsided("chan")),
    Case("chan, gamma", "", lopsided("chan", GAMMA), compiled=True),
    Case("chan, gamma, one-point", ":start=one-point", lopsided("chan", GAMMA)),
    Case("chan-signed", "", lopsided("chan-signed", "alpha beta")),
    Case("chan-magnitude, gamma", "", lopsided("chan-magnitude", GAMMA), compiled=True),
    Case(
        "chan-magnitude, opening, one-point", ":start=one-point",
        lopsided("chan-magnitude", more=OPENING),
    ),
    Case("scale", "", lopsided("scale"), noise=True),
    Case("scale, opening", "", lopsided("scale", GAMMA, OPENING), noise=True),
    Case(
        "smoothed, one-point", ":start=one-point",
        lopsided("smoothed", "stiffness", ", rho: 0.625"), noise=True,
    ),
    Case(
        "smoothed-magnitude, gamma", "", lopsided("smoothed-magnitude", GAMMA, ", rho: 0.5"),
        noise=True, compiled=True,
    ),
    Case(
        "smoothed-magnitude, opening", "",
        lopsided("smoothed-magnitude", "stiffness", f", rho: 0.5{OPENING}"), noise=True,
    ),
    Case("predicted", "", lopsided("predicted"), noise=True),
    Case(
        "predicted, gamma, opening", "", lopsided("predicted", GAMMA, OPENING), noise=True,
        compiled=True,
    ),
    Case(
        "predicted, one-point", ":start=one-point", lopsided("predicted", "alpha beta"), noise=True
    ),
    Case("by table", ":method=table", lopsided("scale"), noise=True, compiled=True),
    Case("by relation", ":method=relation", lopsided("scale", GAMMA), noise=True, compiled=True),
    Case(
        "by relation, coupled", ":method=relation:start=one-point", lopsided("chan-magnitude"),
    ),
    Case("doubtful rules", "", lopsided("scale", doubt="@0.75"), noise=True),
    Case("sets that overlap", "", lopsided("scale", first=SMOOTH), noise=True, compiled=True),
    Case(
        "minimum over centers", "",
        lopsided("scale", operators=MINIMUM + "weighted-centers", doubt="@0.75"), noise=True,
    ),
    Case(
        "minimum over the grid", "", lopsided("scale", operators=MINIMUM + "centroid"), noise=True,
        compiled=True,
    ),
    Case(
        "sets with exp and pow", "", lopsided("scale", first=CURVED), noise=True, compiled=True,
        tolerant=True,
    ),
)  # fmt: skip

BANK = "bank:lowest=0.25:highest=0.75:members=3"
IMM = "imm:quiet_sigma=0.25:maneuver_sigma=3"

OTHERS = (
    # The weights of its members are exponentials.
    Case("bank", BANK, noise=True, compiled=True, single=False, tolerant=True),
    Case("bank, best", f"{BANK}:selection=best:forget=0.625", compiled=True, single=False),
    Case("bank, last", f"{BANK}:selection=last", compiled=True, single=False),
    Case("bank, hindsight", f"{BANK}:selection=hindsight", compiled=True, single=False,
         streams=False),
    Case("window-search", "window-search:window=3:alpha=0.5:grid_step=0.125", compiled=True),
    Case("window-search, longer", "window-search:window=5:alpha=0.3"),
    Case("imm", IMM, noise=True, compiled=True, single=False),
    Case("imm, single axes", f"{IMM}:joint=false", noise=True, compiled=True, single=False),
    Case("imm, cv", f"{IMM}:maneuver=cv", noise=True, single=False),
    Case("imm, cv, single axes", f"{IMM}:maneuver=cv:joint=false", noise=True, compiled=True,
         single=False),
    Case("imm, from one plot", f"{IMM}:sigma_w=8:velocity_sigma=32:acceleration_sigma=2",
         single=False),
    Case("imm, cv, from one plot",
         f"{IMM}:maneuver=cv:joint=false:velocity_sigma=32:maneuver_start=0.25", noise=True,
         single=False),
    Case("imm-two", "imm-two", noise=True, compiled=True),
    Case("imm-three", "imm-three:level=4:sigma_w=8", compiled=True),
)  # fmt: skip

CASES = (*FIXED, *MEMORY, *SHIPPED, *RULES, *OTHERS)


def tracker_of(case, options=""):
    """Tracker of a case, made anew.

    Parameters
    ----------
    case : Case
    options : str
        Further parameters, ``:name=value``, that every tracker is to be made with.
    """
    if not case.rules:
        made = make_tracker(case.spec + options)
    else:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "rules.yaml")
            path.write_text(case.rules, encoding="utf-8")
            made = make_tracker(f"{path}{case.spec}{options}")
    # Equal trackers share their compiled code, also with other tests of this process. Trackers of
    # different classes are not equal: this one begins in plain Python.
    kind = type(made)
    own_kind = type(kind.__name__, (kind,), {"__slots__": ()})
    object.__setattr__(made, "__class__", own_kind)
    return made


# ------------------------------------------------------------------ inputs


@dataclass(frozen=True)
class Inputs:
    """What a tracker is given: times (s), plots (m) and their standard deviation (m).

    All numbers are multiples of 1/64 below 16,000, so that none is rounded in single precision.
    """

    times: np.ndarray
    plots: np.ndarray
    sigma: object

    def part(self, steps):
        """Some time steps."""
        sigma = self.sigma if np.ndim(self.sigma) == 0 else self.sigma[steps]
        return Inputs(self.times[steps], self.plots[steps], sigma)

    def track(self, number, axis=slice(None)):
        """One track alone, or one of its axes."""
        times = self.times if self.times.ndim == 1 else self.times[:, number]
        sigma = self.sigma if np.ndim(self.sigma) == 0 else self.sigma[:, number, axis]
        return Inputs(times, self.plots[:, number, axis], sigma)

    def repeated(self, count):
        """Every track so many times, one after another."""
        times, plots, sigma = (
            np.repeat(values, count, axis=1) if np.ndim(values) > 1 else values
            for values in (self.times, self.plots, self.sigma)
        )
        return Inputs(times, plots, sigma)


def whole_numbers(seed, shape, below):
    """Random whole numbers, from raw words of the generator, which no release of NumPy changes."""
    words = np.random.PCG64(seed).random_raw(int(np.prod(shape)))
    return (words >> np.uint64(32)).astype(np.int64).reshape(shape) % below


def noisy_turns(seed, times, tracks):
    """Plots of tracks that fly straight and then accelerate, each axis in its own way."""
    shape = (len(times), tracks, 2)
    position, velocity, push, when = (
        whole_numbers(seed + k, shape[1:], 64) - middle for k, middle in enumerate((0, 32, 32, -64))
    )
    t = np.broadcast_to(times.reshape(len(times), -1), shape[:2])[..., None]
    late = np.maximum(t - t[:1] - when / 16, 0.0)
    truth = 16.0 * position + velocity * t + push / 8 * late**2
    noise = sum(whole_numbers(seed + 4 + k, shape, 64) - 31.5 for k in range(4)) / 8
    return np.round(64 * (truth + noise)) / 64


def plain_plots():
    """Common times, all time steps of one length, one standard deviation."""
    times = 10.0 + 0.75 * np.arange(10)
    return Inputs(times, noisy_turns(100, times, 3), 8.0)


def plots_with_gaps():
    """Common times, irregular, missed plots of all kinds, a standard deviation for each plot."""
    times = 5.0 + np.cumsum(32 + whole_numbers(200, 18, 97)) / 64
    plots = noisy_turns(201, times, 5)
    missed = (
        ((3, 8), 0, 0), ((9, 17), 0, 1),  # single coordinates, also at the end
        ((0, 1, 2, 9, 10, 11, 12), 1, None),  # at the start, and several in a row
        ((1, 2, 7, 9, 11, 15, 16, 17), 2, None),  # after the first, every other one, at the end
        ((0,), 3, 0), ((6,), 3, None),  # one axis starts late, and one alone in the middle
        (range(18), 4, None),  # never seen
    )  # fmt: skip
    for steps, track, axis in missed:
        plots[list(steps), track, slice(None) if axis is None else axis] = np.nan
    return Inputs(times, plots, (16 + whole_numbers(300, plots.shape, 97)) / 4)


def plots_at_own_times():
    """Each track has times of its own, and misses some plots."""
    times = 1.0 + np.cumsum(32 + whole_numbers(400, (10, 3), 97), axis=0) / 64
    plots = noisy_turns(401, times, 3)
    plots[4, 0], plots[6:8, 1], plots[7, 2, 0] = np.nan, np.nan, np.nan
    return Inputs(times, plots, (16 + whole_numbers(500, plots.shape, 97)) / 4)


INPUTS = {
    "plain": plain_plots(), "gaps": plots_with_gaps(), "own times": plots_at_own_times()
}  # fmt: skip
