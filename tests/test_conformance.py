"""Every scheduler and every tracker keeps its contract: each check is a test."""

import itertools

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.fuzzy.saving import dumps_rulebase
from fuzzytrack.kernels.rebuild import fingerprint
from fuzzytrack.normalizations import normalizations
from fuzzytrack.schedulers import (
    BenedictBordner,
    FadingMemory,
    GrowingMemory,
    InnovationScheduler,
    KalmanCA,
    KalmanCV,
    LinearCombination,
    QualityGains,
    schedulers,
)
from fuzzytrack.testing import parametrize_with_checks
from fuzzytrack.trackers import (
    InteractingPair,
    ParallelBank,
    WindowSearch,
    three_model_imm,
    trackers,
    two_model_imm,
)

pytestmark = pytest.mark.untraced


def fuzzy(name, method="exact", **settings):
    """A shipped rule base, maybe with other settings of its scheduler."""
    text = dumps_rulebase(ft.load_rulebase(name))
    lines = [line for line in text.splitlines() if not line.startswith("scheduler")]
    known = {**dict(ft.load_rulebase(name).scheduler), **settings}
    written = ", ".join(f"{key}: {value}" for key, value in known.items() if value is not None)
    rules = ft.loads_rulebase("\n".join([*lines, f"scheduler: {{{written}}}"]))
    return ft.FuzzyScheduler(rules, method)


SCHEDULERS = {
    "benedict-bordner": BenedictBordner(0.4),
    "chan-style": fuzzy("chan-style"),
    "fading-memory": FadingMemory(0.6),
    "fixed": ft.FixedGains(0.5, 0.2, 0.05),
    "fixed, with a period": ft.FixedGains(0.5, 0.2, 0.05, period=1.5),
    "growing-memory": GrowingMemory(limit=6),
    "innovation": InnovationScheduler(window=3),
    "innovation, as published": InnovationScheduler.as_published(window=2),
    "kalman-ca": KalmanCA(0.5, 1.0, 10.0),
    "kalman-cv": KalmanCV(0.5),
    "linear-combination": LinearCombination(limit=20),
    "maneuver": fuzzy("maneuver"),
    "maneuver, level": ft.FuzzyScheduler("maneuver", level=5.0),
    "maneuver, own axes": ft.FuzzyScheduler("maneuver", level=5.0, axes="own"),
    "maneuver-two-rules": ft.FuzzyScheduler("maneuver-two-rules", level=2.0, velocity_sigma=10.0),
    "omega-schedule": fuzzy("omega-schedule"),
    "omega-schedule on magnitude": fuzzy("omega-schedule", normalization="smoothed-magnitude"),
    "omega-schedule on predicted": fuzzy("omega-schedule", normalization="predicted", rho=None),
    "omega-schedule on scale": fuzzy(
        "omega-schedule", normalization="scale", rho=None, opening=None
    ),
    "stiffness-damping": fuzzy("stiffness-damping"),
    "stiffness-damping by table": fuzzy("stiffness-damping", "table"),
    "stiffness-damping, with a period": fuzzy("stiffness-damping", period=1.5),
    "stiffness-damping, signed": fuzzy("stiffness-damping", normalization="chan-signed"),
    "stiffness-damping-cog by relation": fuzzy("stiffness-damping-cog", "relation"),
    "stiffness-damping-wide": fuzzy("stiffness-damping-wide"),
    "track-quality": QualityGains(),
}

TRACKERS = {
    "alpha-beta, one-point": ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2), "one-point"),
    "bank": ParallelBank(),
    "bank, best": ParallelBank(selection="best"),
    "imm": InteractingPair(0.2, 3.0),
    "imm of single axes": InteractingPair(0.2, 3.0, maneuver="cv", joint=False),
    "imm-three": three_model_imm(level=5.0),
    "imm-two": two_model_imm(),
    "window-search": WindowSearch(window=4),
}


@parametrize_with_checks({**SCHEDULERS, **TRACKERS})
def test_contract(check):
    check()


@pytest.mark.parametrize("name", [*SCHEDULERS, *TRACKERS])
def test_compiled_code_can_be_kept_on_disk(name):
    program = (TRACKERS.get(name) or ft.AlphaBetaTracker(SCHEDULERS[name])).program(2)
    functions = [program.step(8)]
    if program.steady is not None:
        kinds = itertools.product((True, False), repeat=2)
        functions += [program.steady(8, *kind) for kind in kinds]
    assert None not in map(fingerprint, functions)


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@pytest.mark.parametrize("name", [*SCHEDULERS, *TRACKERS])
def test_missed_plots_swing_no_track_up(name):
    """A coasted turn goes wrong by 100 m/s, and a start from noise as much; nothing may add up."""
    random = np.random.default_rng(3)
    times = np.cumsum(random.uniform(0.5, 2.0, 100))
    angle = np.outer(times, random.uniform(-0.1, 0.1, 30))
    truth = 1e3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    plots = truth + random.normal(0.0, 10.0, truth.shape)
    plots[random.random((100, 30)) < 0.3] = np.nan
    tracker = TRACKERS.get(name) or ft.AlphaBetaTracker(SCHEDULERS[name])
    errors = np.abs(tracker.run(times, plots, 10.0).filtered - truth)[20:]
    # Gains of wide limits are for one time step; here it varies tenfold.
    assert errors.max() < (5e3 if name == "stiffness-damping-wide" else 3e3)
    # Gains that fall for ever lose a turn.
    assert np.median(errors) < (400.0 if name == "linear-combination" else 60.0)


def test_nothing_is_left_out():
    assert {type(s) for s in SCHEDULERS.values()} == {p.factory for p in schedulers}
    classes = {p.factory for p in trackers if isinstance(p.factory, type)}
    assert {type(tracker) for tracker in TRACKERS.values()} >= classes
    # The others make trackers with other numbers.
    assert {p.name for p in trackers if p.factory not in classes} <= set(TRACKERS)
    rules = [s.rules for s in SCHEDULERS.values() if isinstance(s, ft.FuzzyScheduler)]
    scheduling = {n for n in shipped_rulebases() if ft.load_rulebase(n).scheduler}
    assert {base.name for base in rules} >= scheduling - {"stiffness-damping-cog"}
    assert {dict(base.scheduler)["normalization"] for base in rules} == set(normalizations.names())
