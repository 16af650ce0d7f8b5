"""Rule bases written as C99: a header, and a program that checks it."""

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
from fuzzytrack.fuzzy.loading import as_rulebase, rulebase_path
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.error_bound import RANDOM_INPUTS, ErrorBound, error_bound
from fuzzytrack.interop.c99.formulas import Formulas, formulas
from fuzzytrack.interop.c99.grid_table import breakpoint_table
from fuzzytrack.interop.c99.header import (
    about_bound,
    about_operations,
    about_rules,
    about_variables,
    header_text,
)
from fuzzytrack.interop.c99.identifiers import c_identifier
from fuzzytrack.interop.c99.number_types import NumberType, number_type
from fuzzytrack.interop.c99.selftest import selftest_text
from fuzzytrack.interop.c99.signature import signature
from fuzzytrack.interop.c99.tabulated import Tabulated, tabulated
from fuzzytrack.interop.c99.vectors import vectors
from fuzzytrack.json_types import plain
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

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
    rules: RuleBase | str | os.PathLike[str],
    *,
    number: str = "double",
    table: bool = False,
    nodes: int | None = None,
    name: str | None = None,
    random: int = RANDOM_INPUTS,
    progress: Progress | None = None,
) -> CExport:
    """Write a rule base as C99.

    Parameters
    ----------
    rules : RuleBase, str or path
        A rule base; or the name of a shipped one or the path of a file.
    number : {"double", "float", "q15"}
        Type of inputs and outputs; ``q15`` are integers of 16 bits over the universes.
    table : bool
        Whether a rule base that no table at its break points fits is tabulated on a finer grid,
        with an error that is measured, rather than written as formulas. Integers always are.
    nodes : int, optional
        Nodes on each input of such a table; about 4,300 in all unless given.
    name : str, optional
        Name of the files and beginning of all names in C; that of the file or rule base unless
        given.
    random : int
        Random inputs at which the error is measured.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    CExport
        The same for the same rule base and version, byte for byte.

    Raises
    ------
    RuleBaseError
        If there is no such rule base; or with integers no rule fires somewhere and an output has no
        default.
    ValueError
        If a parameter is out of range, or the rule base cannot be written with these numbers.

    Notes
    -----
    Where a table at the break points is exact (`fuzzytrack.interop.c99.grid_table`), it is used.

    Examples
    --------
    >>> from fuzzytrack.interop.c99.export import export_c
    >>> made = export_c("valve", number="q15")
    >>> list(made.files), made.figures["rom_bytes"]
    (['valve.h', 'valve_selftest.c'], 44)
    """
    kind = number_type(number)
    if random < 1:
        raise ValueError(f"random: at least 1 input is needed, got {random}")
    source, loaded, own = _source(rules)
    called = own if name is None else name
    if re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", called) is None:
        called = c_identifier(called, "rules")
    prefix = c_identifier(called, "rules")
    system = FuzzySystem(loaded)
    names = signature(loaded, prefix, kind.c_type)
    made = _method(system, kind, table, nodes)
    program = made.program(names)
    checked = vectors(system, kind, made.nodes)
    tried = min(random, made.most_random)
    bound = error_bound(system, kind, made.evaluate, checked, random=tried, progress=progress)
    silent = made.silent
    about = [
        *about_rules(loaded, source, kind),
        *about_variables(loaded, names, kind, silent),
        ("Method", made.words),
        *about_bound(names, kind, bound, len(checked.inputs), bool(silent)),
        *about_operations(program),
    ]
    header = f"{called}.h"
    files = {
        header: header_text(prefix, about, [program]),
        f"{called}_selftest.c": selftest_text(loaded.name, header, names, kind, checked, bound),
    }
    figures = {
        "name": called,
        "prefix": prefix,
        "number": number,
        "files": list(files),
        "rule_base": source,
        "method": made.method,
        "nodes": [len(n) for n in made.nodes],
        "errors": _errors(loaded, bound),
        "random_inputs": bound.random or "all",
        "vectors": len(checked.inputs),
        "rom_bytes": program.constants_bytes,
        "ram_bytes": program.state_bytes,
        "operations": dict(program.operations),
    }
    return CExport(called, prefix, number, files, figures)


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
    path = rulebase_path(rules)
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
