"""What every part of a scan tracker promises, whatever its role."""

from __future__ import annotations

import pickle
import typing
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from types import FunctionType
from typing import Any

import numpy as np

from fuzzytrack.scan.part import Parameter, Part, declared
from fuzzytrack.scan.scan_pass import compiling_by_stage
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.scanners.catalog import configuration_of
from fuzzytrack.scan.scanners.loading import loads_configuration
from fuzzytrack.scan.scanners.reader import PART
from fuzzytrack.scan.scanners.roles import ROLES
from fuzzytrack.scan.scanners.writer import dumps_configuration
from fuzzytrack.scan.sensor import Sensor
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import FIXED
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.testing.kernel_words import foreign_word
from fuzzytrack.testing.part_samples import sample_scans
from fuzzytrack.testing.plot_part_checks import PLOT_PART_CHECKS
from fuzzytrack.testing.samples import expect
from fuzzytrack.testing.track_part_checks import TRACK_PART_CHECKS
from fuzzytrack.testing.tracker_checks import equals_pickled_copy, hashable

__all__ = ["part_checks", "role_of"]

_ROLE_CHECKS = {**PLOT_PART_CHECKS, **TRACK_PART_CHECKS}


def role_of(part: Part) -> str | None:
    """Role whose base class a part is derived from; None if there is no such role."""
    return next((role for role, each in ROLES.items() if isinstance(part, each.base)), None)


def part_checks(part: Part) -> dict[str, Callable[[Any, int], None]]:
    """Checks of a part, by name: those of all parts, and those of its role."""
    own = next(checks for base, checks in _ROLE_CHECKS.items() if isinstance(part, base))
    return {
        "numbers-are-declared": numbers_are_declared,
        "limits-are-kept": limits_are_kept,
        "hashable": hashable,
        "equals-pickled-copy": equals_pickled_copy,
        "kernels-in-form": kernels_in_form,
        "kernels-use-numbers-only": kernels_use_numbers_only,
        "file-gives-equal-part": file_gives_equal_part,
        **own,
        "same-scans-same-tracks": same_scans_give_the_same_tracks,
        "resumed-equals-uninterrupted": resumed_equals_uninterrupted,
        **({} if part.plain else {"compiled-equals-plain": compiled_equals_plain}),
    }


def numbers_are_declared(part: Part, seed: int) -> None:
    """Every field is made by `parameter` or `word`, and says what it means."""
    known = declared(type(part))
    for each in fields(part):
        expect(
            each.name in known,
            f"the field {each.name} must be declared: {each.name}: float = parameter(...)",
        )
    for name, meant in known.items():
        expect(name != PART, f"a number cannot be called {PART!r}, which files use for the part")
        expect(bool(meant.meaning), f"{name} must say what it means")
    kind = type(part).__name__
    expect(bool(type(part).__doc__), f"{kind} must have a docstring, which lists show")
    try:
        kind_without_numbers = type(part)()
    except (TypeError, ValueError) as error:
        raise AssertionError(f"{kind}() must work: every number needs a default; {error}") from None
    expect(isinstance(kind_without_numbers, type(part)), f"{kind}() must make a {kind}")


def limits_are_kept(part: Part, seed: int) -> None:
    """Numbers out of their limits are refused, with the name of the number."""
    for name, meant in declared(type(part)).items():
        for wrong in _wrong_values(meant):
            try:
                replace(part, **{name: wrong})
            except ValueError as error:
                expect(name in str(error), f"the error about {name} must name it, got: {error}")
                continue
            raise AssertionError(
                f"{name} = {wrong!r} must raise ValueError; allowed is {meant.allowed}; a "
                "__post_init__ of your own has to call super().__post_init__() first"
            )


def _wrong_values(meant: Any) -> Iterator[Any]:
    yield float("nan")
    yield float("inf")
    if isinstance(meant, Parameter):
        yield "1"
        if meant.least > -np.inf:
            yield meant.least if meant.above else meant.least - 1.0
        if meant.most < np.inf:
            yield meant.most if meant.below else meant.most + 1.0
        if meant.whole:
            yield 2.5
    elif meant.choices:
        yield "no word of these"


def kernels_in_form(part: Any, seed: int) -> None:
    """The kernels are plain functions, as many as the role has, with as many arguments."""
    expect(
        isinstance(part.memory, int) and part.memory >= 0,
        f"memory must be a whole number >= 0, got {part.memory!r}",
    )
    found = _kernels(part)
    base: Any = ROLES[str(role_of(part))].base
    wanted = typing.get_type_hints(base.kernels)["return"]
    expect(
        isinstance(found, wanted),
        f"kernels must return {wanted.__name__}, got {type(found).__name__}",
    )
    for name, hint in typing.get_type_hints(wanted).items():
        kernel, arguments = getattr(found, name), typing.get_args(hint)[0]
        expect(
            isinstance(kernel, FunctionType),
            f"{name} must be a plain function, got {type(kernel).__name__}",
        )
        count = kernel.__code__.co_argcount
        expect(
            count == len(arguments),
            f"{name} must take {len(arguments)} arguments, it takes {count}",
        )


def kernels_use_numbers_only(part: Part, seed: int) -> None:
    """The kernels, and what they call, refer to nothing that cannot be compiled."""
    if part.plain:
        return
    for kernel in _kernels(part):
        found = foreign_word(kernel)
        expect(found is None, f"{found}; or set plain = True in the class")


def file_gives_equal_part(part: Part, seed: int) -> None:
    """Written to a file and read again, it is equal."""
    role = role_of(part)
    if not any(ROLES[str(role)].get(name) is type(part) for name in ROLES[str(role)].names()):
        return  # without a name, no file can hold it
    configuration = configuration_of(_tracker(part))
    text = dumps_configuration(configuration, ROLES)
    expect(
        loads_configuration(text) == configuration, f"a file must give an equal part, got\n{text}"
    )


def same_scans_give_the_same_tracks(part: Part, seed: int) -> None:
    """Two sessions give the same, with finite numbers and identities that are used once."""
    tracker, scans = _tracker(part), sample_scans(seed)
    before = [scan.positions.copy() for scan in scans]
    found = _plain_reports(tracker, scans)
    _expect_same(found, _plain_reports(tracker, scans), "the same scans must give the same")
    expect(
        all(map(np.array_equal, before, (scan.positions for scan in scans))),
        "the plots of a scan must not be changed",
    )
    for name in ("time", "position", "velocity", "deviation", "since_last"):
        expect(bool(np.isfinite(getattr(found, name)).all()), f"{name} of tracks must be finite")
    pairs = set(zip(found.scan.tolist(), found.track_id.tolist(), strict=True))
    expect(len(pairs) == len(found), "an identity must be reported once in a scan")
    known = found.existence[~np.isnan(found.existence)]
    expect(bool(((known >= 0) & (known <= 1)).all()), "existence must be a probability, or NaN")


def resumed_equals_uninterrupted(part: Part, seed: int) -> None:
    """A session that is pickled half way goes on with the same tracks."""
    tracker, scans = _tracker(part), sample_scans(seed)
    session = ScanSession(tracker, plain=True)
    first = _all_reports(session, scans[:11])
    session = pickle.loads(pickle.dumps(session))
    found = TrackReports.joined([first, _all_reports(session, scans[11:])])
    whole = _plain_reports(tracker, scans)
    _expect_same(found, whole, "a session that is resumed must give the same")


def compiled_equals_plain(part: Part, seed: int) -> None:
    """Compiled code gives the tracks of plain Python, to the last bit."""
    tracker, scans = _tracker(part), sample_scans(seed)
    with compiling_by_stage():
        found = _all_reports(tracker.start(), scans)
    plain = _plain_reports(tracker, scans)
    _expect_same(found, plain, "compiled code must give what plain Python does")


def _kernels(part: Any) -> Any:
    setting = Setting(Sensor())
    arguments = part.kernels.__code__.co_argcount
    return part.kernels(setting, FIXED) if arguments == 3 else part.kernels(setting)


def _tracker(part: Part) -> ScanTracker:
    """The default tracker with this part."""
    changed: dict[str, Any] = {str(role_of(part)): part}
    return replace(ScanTracker(), **changed)


def _plain_reports(tracker: ScanTracker, scans: list[Any]) -> TrackReports:
    return _all_reports(ScanSession(tracker, plain=True), scans)


def _all_reports(session: ScanSession, scans: list[Any]) -> TrackReports:
    return TrackReports.joined([session.step(scan, tentative=True) for scan in scans])


def _expect_same(one: TrackReports, other: TrackReports, promise: str) -> None:
    for each in fields(TrackReports):
        same = np.array_equal(getattr(one, each.name), getattr(other, each.name), equal_nan=True)
        expect(same, f"{promise} tracks: {each.name} differs")
