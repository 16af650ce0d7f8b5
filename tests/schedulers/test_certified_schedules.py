"""Verdicts on random rule bases, against their gains in the worst order, at the worst times.

`check_random_rule_bases(300)` is the long form of the test.
"""

from dataclasses import dataclass

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.gains.certificate import error_matrix
from fuzzytrack.gains.period import resampled_gains
from fuzzytrack.schedulers.gain_outputs import find_gain_outputs
from fuzzytrack.schedulers.reachable_gains import certify

# One input, outputs in any of the three forms. Without the set p, the default holds from 0 to 1.
RULES = """\
rulebase: 1
name: random
inputs:
  x: {{universe: [-1, 1, 21], sets: {{n: {{trimf: [-1, -1, 0]}}, z: {{trimf: [-1, 0, 1]}}{p}}}}}
outputs:
{outputs}
operators: {{and: product, or: sum, defuzzification: {defuzzification}}}
rules:
{rules}
"""


def random_rule_base(rng):
    kind = [("stiffness", "damping"), ("stiffness",), ("alpha", "beta")][rng.integers(3)]
    limits = {
        "stiffness": (0.05, 0.8),
        "damping": (0.4, 1.2),
        "alpha": (0.1, 0.9),
        "beta": (0.02, 0.5),
    }
    with_default = rng.random() < 0.4
    outputs, words = "", []
    for name in kind:
        low, high = np.sort(rng.uniform(*limits[name], 2))
        middle = rng.uniform(low, high)
        outputs += f"  {name}: {{universe: [{low}, {high}, 21], sets: {{" + ", ".join(
            f"{word}: {{trimf: [{a}, {b}, {c}]}}"
            for word, (a, b, c) in {
                "S": (low, low, middle),
                "M": (low, middle, high),
                "L": (middle, high, high),
            }.items()
        )
        outputs += f"}}, default: {rng.uniform(low, high)}}}\n" if with_default else "}}\n"
    for x in ("n", "z") if with_default else ("n", "z", "p"):
        then = ", ".join(f"{name}: {rng.choice(['S', 'M', 'L'])}" for name in kind)
        words.append(f"  - {{if: {{x: {x}}}, then: {{{then}}}}}")
    return loads_rulebase(
        RULES.format(
            outputs=outputs.rstrip(),
            rules="\n".join(words),
            p="" if with_default else ", p: {trimf: [0, 1, 1]}",
            defuzzification=rng.choice(["centroid", "weighted-centers"]),
        )
    )


def random_period(rules, steps, rng):
    """A period for a third of the rule bases, where their gains can have one."""
    if rng.random() < 2 / 3:
        return None
    period = float(steps[0] * rng.uniform(0.5, 2))
    try:
        certify(rules, period=period, max_length=1)
    except ft.RuleBaseError:
        return None
    return period


def gains_in_use(rules):
    """Gains that the rule base schedules, over its input and beyond, shape (n, 2)."""
    outputs = ft.FuzzySystem(rules)(x=np.linspace(-1, 1, 101))
    gains = find_gain_outputs(rules.output_names).gains(outputs)
    return np.stack([gains["alpha"], gains["beta"]], axis=1)


def check_bound(found, gains, rng, sequences=1000, plots=40, tried=24):
    """The norm shrinks as certified at every plot, in random sequences and in greedy ones."""
    e = rng.normal(size=(sequences, 2))
    size = found.norm(e)
    greedy = np.arange(sequences) % 2 == 0
    for _ in range(plots):
        alpha, beta = np.moveaxis(gains[rng.integers(len(gains), size=(sequences, tried))], -1, 0)
        low, high, missed = found.times.low, found.times.high, found.times.missed
        steps = rng.choice([low, high, rng.uniform(low, high)], (missed + 1, sequences, tried))
        skipped = np.arange(missed + 1)[:, None, None] > rng.integers(0, missed + 1, alpha.shape)
        elapsed = np.where(skipped, 0.0, steps).sum(axis=0)
        if found.period:
            alpha, beta, _ = resampled_gains(alpha, beta, period=found.period, dt=elapsed)
        after = error_matrix(alpha, beta, elapsed / low) @ e[:, None, :, None]
        sizes = found.norm(after[..., 0])
        chosen = np.where(greedy, sizes.argmax(axis=1), 0)
        e = after[np.arange(sequences), chosen, :, 0]
        assert (sizes.max(axis=1) <= found.rate * size * (1 + 1e-9)).all()
        size = found.norm(e)
        # Norms are compared at every plot, so the size of the error may start again.
        e, size = e / size[:, None], np.ones(sequences)


@dataclass(frozen=True)
class Sequence(ft.GainScheduler):
    """Plays a sequence of gains over and over."""

    uses_acceleration = False

    gains: tuple

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        gains, count = self.gains, len(self.gains)

        def play(innovation, change, dt, sigma, memory):
            alpha, beta = gains[int(memory[0])]
            return alpha, beta, 0.0, 1.0, ((memory[0] + 1.0) % count,)

        return play


def replay(found, cycles, missed_rows):
    """Growth of the error of a tracker that is at rest at 0, for wrong starts of size 1.

    The starts are two errors at right angles, so one of them grows as the product of the matrices.
    Missed plots are rows that are empty, or that are left out.
    """
    unit = found.times.low
    tracker = ft.AlphaBetaTracker(Sequence(tuple(map(tuple, found.sequence.tolist()))))
    # x + U v and U v of the two tracks are (1, 0) and (0, 1) after the second plot.
    t, plots = [0.0, unit], [[1.0, -2.0], [1.0, -1.0]]
    for elapsed in np.tile(found.elapsed, cycles):
        steps = found.times.missed_within(elapsed) + 1 if missed_rows else 1
        t += [t[-1] + elapsed * (k + 1) / steps for k in range(steps)]
        plots += [[np.nan, np.nan]] * (steps - 1) + [[0.0, 0.0]]
    state = tracker.run(np.array(t), np.array(plots)[:, :, None]).state
    velocity = unit * state.velocity[:, 0]
    return np.hypot(state.position[:, 0] + velocity, velocity).max()


def check_replay(found):
    """The error of a tracker grows at the rate that a refutation claims."""
    per_cycle = found.growth ** len(found.sequence)
    product = np.eye(2)
    for matrix in error_matrix(*found.sequence.T, found.elapsed / found.times.low):
        product = matrix @ product
    assert np.abs(np.linalg.eigvals(product)).max() == pytest.approx(per_cycle, rel=1e-6)
    cycles = int(np.ceil(np.log(1e6) / np.log(per_cycle)))
    claimed = per_cycle**cycles
    for missed_rows in (False, True):
        assert replay(found, cycles, missed_rows) >= claimed / np.sqrt(2) * (1 - 1e-6)


def check_random_rule_bases(count, seed=11):
    """No certified one exceeds its bound, and every refutation diverges; counts the verdicts."""
    rng = np.random.default_rng(seed)
    verdicts = []
    for _ in range(count):
        rules = random_rule_base(rng)
        steps = 1.0, float(rng.choice([1.0, np.exp(rng.uniform(0, 1.5))]))
        scale = float(rng.choice([1.0, 0.1, 7.0]))
        missed = int(rng.integers(0, 4))
        reach = "universe" if rules.operators.defuzzification == "centroid" else "rules"
        limits = scale, scale * steps[1]
        period = random_period(rules, limits, rng)
        found = certify(rules, reach=reach, steps=limits, missed=missed, period=period)
        verdicts.append(found.verdict)
        if found.verdict == "certified":
            check_bound(found, gains_in_use(rules), rng)
        elif found.verdict == "refuted":
            check_replay(found)
    return {verdict: verdicts.count(verdict) for verdict in sorted(set(verdicts))}


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@pytest.mark.untraced
def test_verdicts_on_random_rule_bases():
    verdicts = check_random_rule_bases(16)
    assert verdicts["certified"] >= 4
    assert verdicts["refuted"] >= 4
    assert verdicts.get("not decided", 0) <= 1
