"""Rule bases and trackers written as C99: a header, and a program that checks it."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fuzzytrack.fuzzy.as_json import rulebase_as_json
from fuzzytrack.fuzzy.loading import as_rulebase, rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.c_program import CProgram
from fuzzytrack.interop.c99.error_bound import RANDOM_INPUTS, ErrorBound, error_bound
from fuzzytrack.interop.c99.filter_export import FilterExport, filter_export
from fuzzytrack.interop.c99.formulas import Formulas, formulas
from fuzzytrack.interop.c99.grid_table import breakpoint_table
from fuzzytrack.interop.c99.header import (
    about_bound,
    about_file,
    about_number,
    about_operations,
    about_rules,
    about_variables,
    header_text,
)
from fuzzytrack.interop.c99.identifiers import SYSTEM_HEADERS, c_identifier, is_free_name
from fuzzytrack.interop.c99.number_types import NumberType, number_type
from fuzzytrack.interop.c99.selftest import Check, infer_check, selftest_text
from fuzzytrack.interop.c99.signature import signature
from fuzzytrack.interop.c99.tabulated import Tabulated, tabulated
from fuzzytrack.interop.c99.vectors import vectors
from fuzzytrack.json_types import plain
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["CExport", "export_c"]


@dataclass(frozen=True, eq=False)
class CExport:
    """C source of a rule base.

    Attributes
    ----------
    name : str
        Name of the rule base; the files are named after it.
    prefix : str
        With which all names of the header begin.
    number : str
        Type of its numbers.
    files : dict of str
        Text of each file by its name: the header, and the program that checks it.
    figures : dict
        Method, errors, bytes and operations, as JSON.
    """

    name: str
    prefix: str
    number: str
    files: Mapping[str, str]
    figures: Mapping[str, Any]

    def __repr__(self) -> str:
        return summary(self, "name", "number", files=", ".join(self.files))

    @property
    def header(self) -> str:
        """Text of the header."""
        return self.files[f"{self.name}.h"]

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Write the files into a folder that exists; both appear, or neither.

        Raises
        ------
        OSError
            If they cannot be written.
        """
        from contextlib import ExitStack

        from fuzzytrack.io.files import whole_file

        with ExitStack() as all_of_them:
            for name, text in self.files.items():
                draft = all_of_them.enter_context(whole_file(Path(folder) / name))
                draft.write_bytes(text.encode("ascii"))


def export_c(
    subject: RuleBase | GainScheduler | LaneTracker | str | os.PathLike[str],
    *,
    number: str = "double",
    filter: bool = False,
    axes: int = 2,
    table: bool = False,
    nodes: int | None = None,
    name: str | None = None,
    random: int = RANDOM_INPUTS,
    progress: Progress | None = None,
) -> CExport:
    """Write a rule base, a scheduler or a tracker as C99.

    Parameters
    ----------
    subject : RuleBase, GainScheduler, LaneTracker, str or path
        A rule base; or the name of a shipped one or the path of a file; or a scheduler, which
        stands for a `fuzzytrack.AlphaBetaTracker` with its gains, or a tracker. Of these two the
        whole filter is written.
    number : {"double", "float", "q15"}
        Type of inputs and outputs; ``q15`` are integers of 16 bits over the universes, for rule
        bases without a filter.
    filter : bool
        Whether the whole tracker of a rule base is written beside it.
    axes : int
        Axes of space of a filter, 12 at most.
    table : bool
        Whether a rule base that no table at its break points fits is tabulated on a finer grid,
        with an error that is measured, rather than written as formulas. Integers always are.
    nodes : int, optional
        Nodes on each input of such a table; about 4,300 in all unless given.
    name : str, optional
        Name of the files and beginning of all names in C; that of the file or rule base unless
        given, or of the class of a scheduler or tracker.
    random : int
        Random inputs at which the error of a rule base is measured.
    progress : callable, optional
        Called with the share of that which is done.

    Returns
    -------
    CExport
        The same for the same rule base and version, byte for byte.

    Raises
    ------
    RuleBaseError
        If there is no such rule base; or with integers no rule fires somewhere and an output has no
        default; or it has no settings for a filter.
    TranslationError
        If a scheduler or tracker uses what cannot be written in C; says where.
    ValueError
        If a parameter is out of range, or these numbers cannot be used.

    Notes
    -----
    Where a table at the break points is exact (`fuzzytrack.interop.c99.grid_table`), it is used.

    Examples
    --------
    >>> from fuzzytrack.interop.c99 import export_c
    >>> made = export_c("valve", number="q15")
    >>> list(made.files), made.figures["rom_bytes"]
    (['valve.h', 'valve_selftest.c'], 44)
    """
    kind = number_type(number)
    if random < 1:
        raise ValueError(f"random: at least 1 input is needed, got {random}")
    if isinstance(subject, GainScheduler | LaneTracker):
        return _tracker_export(subject, kind, axes, name)
    source, rules, own = _source(subject)
    called, prefix = _names(own if name is None else name)
    moving = None
    if filter:
        if kind.whole:
            raise ValueError("filter: there is none in integers; use the number double or float")
        tracker = AlphaBetaTracker(FuzzyScheduler(rules))
        moving = filter_export(tracker, kind, name=f"{prefix}_filter", axes=axes)
    system = FuzzySystem(rules)
    names = signature(rules, prefix, kind.c_type)
    made = _method(system, kind, table, nodes)
    program = made.program(names)
    checked = vectors(system, kind, made.nodes)
    tried = min(random, made.most_random)
    bound = error_bound(system, kind, made.evaluate, checked, random=tried, progress=progress)
    silent = made.silent
    about = [
        *about_rules(rules, source, kind),
        *about_variables(rules, names, kind, silent),
        ("Method", made.words),
        *about_bound(names, kind, bound, len(checked.inputs), bool(silent)),
        *about_operations(program),
    ]
    figures = {
        "rule_base": source,
        "method": made.method,
        "nodes": [len(n) for n in made.nodes],
        "errors": _errors(rules, bound),
        "random_inputs": bound.random or "all",
        "vectors": len(checked.inputs),
        "rom_bytes": program.constants_bytes,
        "ram_bytes": program.state_bytes,
        "operations": dict(program.operations),
    }
    checks = [infer_check(names, kind, checked, bound)]
    return _whole(called, prefix, kind, about, [program], checks, figures, moving)


def _tracker_export(
    subject: GainScheduler | LaneTracker, kind: NumberType, axes: int, name: str | None
) -> CExport:
    """A scheduler or tracker, of which there is the filter only."""
    tracker = AlphaBetaTracker(subject) if isinstance(subject, GainScheduler) else subject
    called, prefix = _names(type(subject).__name__ if name is None else name)
    moving = filter_export(tracker, kind, name=f"{prefix}_filter", axes=axes)
    digest = hashlib.sha256(moving.translation.definitions.encode()).hexdigest()
    # The default repr of a class ends with a place in memory.
    words = re.sub(r" object at 0x[0-9a-f]+", "", repr(tracker))
    about = [
        *about_file(called, words),
        ("Written from", f"its step; SHA-256 of the definitions below {digest}"),
        about_number(kind),
    ]
    return _whole(called, prefix, kind, about, [], [], {"tracker": words}, moving)


def _whole(
    called: str,
    prefix: str,
    kind: NumberType,
    about: list[tuple[str, str]],
    programs: list[CProgram],
    checks: list[Check],
    figures: dict[str, Any],
    moving: FilterExport | None,
) -> CExport:
    """The files, with those parts of them that are about a filter."""
    header = f"{called}.h"
    figures = {"name": called, "prefix": prefix, "number": kind.name, **figures}
    if moving is not None:
        about = [*about, *moving.about(f"{prefix}_infer" if programs else "")]
        programs = [*programs, moving.program()]
        checks = [*checks, moving.check()]
        figures["filter"] = moving.figures()
    files = {
        header: header_text(prefix, about, programs),
        f"{called}_selftest.c": selftest_text(called, header, kind, checks),
    }
    return CExport(called, prefix, kind.name, files, {**figures, "files": list(files)})


def _names(given: str) -> tuple[str, str]:
    """Name of the files, and beginning of the names in C."""
    plain_name = re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", given) is not None
    called = given if plain_name else c_identifier(given, "rules")
    if called.lower() in SYSTEM_HEADERS:
        called = f"{called}_rules"
    # Names begin with the prefix and go on with _, so it may be a reserved word itself.
    prefix = c_identifier(called, "rules").rstrip("_")
    return called, prefix if is_free_name(f"{prefix}_filter") else f"rules_{prefix}"


def _method(
    system: FuzzySystem, kind: NumberType, table: bool, nodes: int | None
) -> Tabulated | Formulas:
    """How a rule base is written: at its break points if that is exact."""
    name = system.rules.name
    exact = breakpoint_table(system.rules)
    if exact is not None:
        if nodes is not None:
            raise ValueError(
                f"nodes: {name} is tabulated at the break points of its sets, which is exact"
            )
        return tabulated(system, kind, exact, None)
    if kind.whole or table:
        return tabulated(system, kind, None, nodes)
    if nodes is not None:
        raise ValueError(f"nodes: {name} is written as formulas; `table` writes a table")
    return formulas(system, kind)


def _source(rules: RuleBase | str | os.PathLike[str]) -> tuple[str, RuleBase, str]:
    """Name and hash of the text of a rule base, the rule base, and its name."""
    if isinstance(rules, RuleBase):
        text = json.dumps(plain(rulebase_as_json(rules)), sort_keys=True).encode()
        digest = hashlib.sha256(text).hexdigest()
        return f"{rules.name} as JSON, SHA-256 {digest}", rules, rules.name
    loaded = as_rulebase(rules)
    path = rulebase_path(rules) if rules in shipped_rulebases() else Path(rules)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return f"{path.name}, SHA-256 {digest}", loaded, path.stem


def _errors(rules: RuleBase, bound: ErrorBound) -> dict[str, dict[str, float]]:
    """Errors of each output; in steps for integers."""
    found = {}
    for k, name in enumerate(rules.output_names):
        found[name] = {"largest": float(bound.largest[k]), "bound": float(bound.bounds[k])}
        if bound.ulps is not None:
            found[name]["ulps"] = float(bound.ulps[k])
    return found
