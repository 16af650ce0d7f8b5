"""The stages of a scan put together from the kernels of parts, compiled where they can be."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import lru_cache
from types import FunctionType
from typing import Any, NamedTuple

from fuzzytrack.errors import PluginError, in_one_sentence
from fuzzytrack.kernels.compile import compiled
from fuzzytrack.kernels.shared_code import SharedCode
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.scan_parts import ScanParts
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.stages.pairs import assignment_stage, pairs_stage
from fuzzytrack.scan.stages.plots import DONE, density_stage, plots_stage
from fuzzytrack.scan.stages.reports import report_stage
from fuzzytrack.scan.stages.tracks import follow_stage, start_stage
from fuzzytrack.scan.update.companion import Companion

__all__ = ["PAIRS", "ScanPass", "compiling_by_stage", "learn_code", "scan_pass", "sharing_code"]

#: Number of the stage that finds pairs; it is repeated when there was no room for them.
PAIRS = 2

Stage = Callable[..., int]
#: What makes compiled code of a function.
Compile = Callable[[Callable[..., Any]], Callable[..., Any]]


class Stages(NamedTuple):
    """The stages of a scan, in their order."""

    plots: Stage
    density: Stage
    pairs: Stage
    assignment: Stage
    follow: Stage
    start: Stage
    report: Stage


@dataclass(frozen=True, eq=False)
class ScanPass:
    """All stages of a scan.

    Attributes
    ----------
    run : callable
        ``run(work, positions, covariances, times, may_start, rows, begin) -> answer``: the stages
        from number `begin` on, until one is not `DONE`.
    report : callable
        The last stage alone.
    density : callable
        Kernel of the clutter model for any place, in plain Python.
    compiled : bool
        Whether all stages are one compiled function.
    """

    run: Callable[..., int]
    report: Callable[..., int]
    density: Callable[..., float]
    compiled: bool


def scan_pass(tracker: ScanParts, plain: bool = False) -> ScanPass:
    """Stages of a tracker; `plain` runs all of them in plain Python."""
    code = _sharing.get()
    if code is None or plain:
        return _own_pass(tracker, plain, _by_stage.get())
    return _made(tracker, code.compiled)


def learn_code(tracker: ScanParts, code: SharedCode) -> None:
    """Note the numbers of a tracker, before `sharing_code` compiles."""
    stages, _, in_python = _stages(tracker)
    if not any(in_python):
        code.learn(_one_function(stages))
        return
    for stage, slow in zip(stages, in_python, strict=True):
        if not slow:
            code.learn(stage)


@contextmanager
def sharing_code(code: SharedCode) -> Iterator[None]:
    """Let sessions that begin inside share compiled code with those that differ in numbers only.

    Each session must have ended before the next one begins: they read their numbers from the same
    memory.
    """
    before = _sharing.set(code)
    try:
        yield
    finally:
        _sharing.reset(before)


@contextmanager
def compiling_by_stage() -> Iterator[None]:
    """Let sessions that begin inside compile each stage by itself.

    Trackers that differ in one part then compile only the stages that call it.
    """
    before = _by_stage.set(True)
    try:
        yield
    finally:
        _by_stage.reset(before)


_sharing: ContextVar[SharedCode | None] = ContextVar("sharing", default=None)
_by_stage: ContextVar[bool] = ContextVar("by_stage", default=False)


@lru_cache(maxsize=64)
def _own_pass(tracker: ScanParts, plain: bool, by_stage: bool) -> ScanPass:
    if plain:
        stages, density, _ = _stages(tracker)
        return ScanPass(_in_turn(stages), stages.report, density, False)
    return _made(tracker, _alone, by_stage)


def _alone(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compiled code that is shared with no other tracker."""
    return compiled(function, allocates=False)


def _made(tracker: ScanParts, compile: Compile, by_stage: bool = False) -> ScanPass:
    """Stages of a tracker, compiled as far as they can be."""
    stages, density, in_python = _stages(tracker)
    apart = by_stage or tracker.companion() is not None
    if not (apart or any(in_python)):
        whole = _compiled(tracker, _one_function(stages), compile)
        return ScanPass(whole, _compiled(tracker, stages.report, compile), density, True)
    mixed = Stages(
        *(
            stage if slow else _compiled(tracker, stage, compile)
            for stage, slow in zip(stages, in_python, strict=True)
        )
    )
    return ScanPass(_in_turn(mixed), mixed.report, density, False)


def _stages(tracker: ScanParts) -> tuple[Stages, Callable[..., float], tuple[bool, ...]]:
    """Stages, the density of clutter at a place, and which stages can only be plain Python."""
    setting = Setting(tracker.sensor)
    at = tracker.places()

    def kernels(role: str) -> Any:
        part = getattr(tracker, role)
        made = part.kernels(setting, at[role]) if role in at else part.kernels(setting)
        return type(made)(*(_guarded(each, role, part) for each in made)) if part.plain else made

    extraction, candidates, association = map(kernels, ("extraction", "candidates", "association"))
    clutter, gate, update, quality, kind = map(
        kernels, ("clutter", "gate", "update", "quality", "kind")
    )
    initiation, confirmation, identity, report = map(
        kernels, ("initiation", "confirmation", "identity", "report")
    )
    noise = tracker.sensor.noise()
    stages = Stages(
        plots_stage(extraction, noise, candidates),
        density_stage(clutter),
        pairs_stage(update, gate, initiation, candidates, association, noise),
        assignment_stage(association),
        follow_stage(
            update, quality, kind, initiation, confirmation, identity, clutter,
            tracker.sensor.detection,
        ),
        start_stage(update, quality, kind, initiation, confirmation, identity, clutter),
        report_stage(update, quality, kind, report),
    )  # fmt: skip
    plain = {role for role in tracker.roles() if getattr(tracker, role).plain}
    return stages, clutter.density, tuple(bool(plain & used) for used in _USED)


#: Roles of which each stage calls kernels.
_LIFE = {"update", "quality", "kind", "initiation", "confirmation", "identity", "clutter"}
_USED: tuple[set[str], ...] = (
    {"extraction", "candidates"},
    {"clutter"},
    {"update", "gate", "initiation", "candidates", "association"},
    {"association"},
    _LIFE,
    _LIFE,
    {"update", "quality", "kind", "report"},
)


def _guarded(kernel: Callable[..., Any], role: str, part: Part) -> Callable[..., Any]:
    """A kernel whose exceptions name its part."""

    def guarded(*arguments: Any) -> Any:
        try:
            return kernel(*arguments)
        except Exception as error:
            raise PluginError(
                f"{role} {type(part).__name__}: {getattr(kernel, '__name__', 'kernel')} raised "
                f"{in_one_sentence(error)}; the session is as it was before this scan"
            ) from error

    return guarded


def _one_function(stages: Stages) -> FunctionType:
    plots, density, pairs, assignment, follow, start, report = stages

    def run(
        work: Any,
        positions: Any,
        covariances: Any,
        times: Any,
        may_start: Any,
        rows: Any,
        begin: int,
    ) -> int:
        if begin == 0:
            answer = plots(work, positions, covariances, times, may_start, rows)
            if answer != DONE:
                return answer
            density(work)
        answer = pairs(work)
        if answer != DONE:
            return answer
        assignment(work)
        follow(work)
        start(work)
        return report(work)

    return run  # type: ignore[return-value]


def _in_turn(stages: Stages) -> Callable[..., int]:
    """The stages one after the other, called from Python, and a companion between them."""
    number = {name: k for k, name in enumerate(Stages._fields)}

    def run(
        work: Any, positions: Any, covariances: Any, times: Any, may_start: Any, rows: Any,
        begin: int, companion: Companion | None = None,
    ) -> int:  # fmt: skip
        before: dict[int, Callable[[Any], None]] = {}
        if companion is not None:
            before = {
                number["pairs"]: companion.predict,
                number["follow"]: companion.correct,
                number["start"]: companion.end,
                number["report"]: companion.start,
            }
        if begin == 0:
            answer = stages.plots(work, positions, covariances, times, may_start, rows)
            if answer != DONE:
                return answer
        for k in range(max(begin, 1), len(stages)):
            if k in before:
                before[k](work)
            answer = stages[k](work)
            if answer != DONE:
                return answer
        return DONE

    return run


def _compiled(
    tracker: ScanParts, function: Callable[..., Any], compile: Compile
) -> Callable[..., Any]:
    """Compiled code of a function; an error of the compiler names the parts that are not ours."""
    code = compile(function)
    foreign = [
        f"{role} {type(getattr(tracker, role)).__name__}"
        for role in tracker.roles()
        if not type(getattr(tracker, role)).__module__.startswith("fuzzytrack.")
    ]
    if not foreign:
        return code

    def run(*arguments: Any) -> Any:
        try:
            return code(*arguments)
        # Compiled code raises nothing, so it is an error of the compiler.
        except Exception as error:
            raise PluginError(
                f"{', '.join(foreign)}: a kernel cannot be compiled: {in_one_sentence(error)}; "
                "set plain = True in the class to run it in plain Python"
            ) from error

    return run
