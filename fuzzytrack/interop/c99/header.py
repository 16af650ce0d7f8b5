"""The header of a rule base in C: a comment that says what it is, and its definitions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.interop.c99.c_program import CProgram, operations_in_words
from fuzzytrack.interop.c99.c_text import comment_lines
from fuzzytrack.interop.c99.error_bound import ErrorBound
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.signature import Signature
from fuzzytrack.version import __version__

__all__ = [
    "about_bound",
    "about_file",
    "about_number",
    "about_operations",
    "about_rules",
    "about_variables",
    "header_text",
]


def header_text(prefix: str, about: Sequence[tuple[str, str]], programs: Sequence[CProgram]) -> str:
    """Source of a header.

    Parameters
    ----------
    prefix : str
        With which the names of the header begin.
    about : sequence of (str, str)
        The comment at its beginning, in two columns.
    programs : sequence of CProgram
        Its definitions, in order.
    """
    guard = f"FUZZYTRACK_{prefix.upper()}_H"
    includes = sorted({name for each in programs for name in each.includes})
    lines = [
        *comment_lines(about),
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        *(f"#include <{name}>" for name in includes),
        "",
        "#if defined(__clang__)",
        "#pragma STDC FP_CONTRACT OFF",
        "#endif",
        "",
    ]
    if not any("double" in p.definitions or "float" in p.definitions for p in programs):
        del lines[-4:]
    definitions = "\n".join(p.definitions.strip("\n") + "\n" for p in programs)
    return "\n".join(lines) + "\n" + definitions + f"\n#endif /* {guard} */\n"


def about_file(name: str, description: str) -> Iterator[tuple[str, str]]:
    """What it is, and what wrote it."""
    yield "", f"{name}: {description}" if description else name
    yield "", ""
    yield "", "Change what it was made of and export it again, not this file."
    yield "Written by", f"fuzzytrack {__version__}"


def about_number(number: NumberType) -> tuple[str, str]:
    """Its numbers."""
    kinds = {
        "double": "double (64 bits)",
        "float": "float (32 bits)",
        "q15": "q15 (integers of 16 bits)",
    }
    return "Numbers", kinds[number.name]


def about_rules(rules: RuleBase, source: str, number: NumberType) -> Iterator[tuple[str, str]]:
    """What a rule base is, and where it comes from."""
    yield from about_file(rules.name, rules.description)
    yield "Rule base", source
    if rules.source:
        yield "After", rules.source
    yield about_number(number)
    yield "", ""


def about_variables(
    rules: RuleBase, names: Signature, number: NumberType, silent: Mapping[str, str]
) -> Iterator[tuple[str, str]]:
    """Ranges, units and scales of inputs and outputs, and what else may be given.

    Parameters
    ----------
    rules : RuleBase
    names : Signature
    number : NumberType
    silent : dict of str
        For some outputs what they are where no rule fires.
    """
    for word, variable in zip(names.inputs, rules.inputs, strict=True):
        yield "Input", f"{word}: {_range(variable)}{_scale(word, variable, number)}"
    for word, variable in zip(names.outputs, rules.outputs, strict=True):
        says = silent.get(variable.name)
        more = f"; {says} where no rule fires" if says else ""
        yield "Output", f"{word}: {_range(variable)}{_scale(word, variable, number)}{more}"
    if number.whole:
        yield (
            "Beyond",
            "every integer of 16 bits is an input. Saturate what lies beyond a range to -32768 or "
            "32767; an output at the high end of its range is 32767, one step below it.",
        )
    else:
        yield (
            "Beyond",
            "an input beyond its range counts as the nearest end, infinities too; a NaN makes "
            "every output NaN, which -ffast-math would break.",
        )
    yield "", ""


def _range(variable: Variable) -> str:
    unit = f" {variable.unit}" if variable.unit and variable.unit != "1" else ""
    label = f"{variable.label}, " if variable.label else ""
    return f"{label}{variable.universe.low:.15g} to {variable.universe.high:.15g}{unit}"


def _scale(word: str, variable: Variable, number: NumberType) -> str:
    if not number.whole:
        return ""
    low, high = variable.universe.low, variable.universe.high
    return f"; value = {(low + high) / 2:.15g} + {word} * {(high - low) / 65_536:.15g}"


def about_bound(
    names: Signature, number: NumberType, bound: ErrorBound, checked: int, silent: bool
) -> Iterator[tuple[str, str]]:
    """Errors, and how they were measured; `silent` if in places no rule fires."""
    unit = " steps" if number.whole else ""
    each = ", ".join(
        f"{name} {value:.3g}{unit}" for name, value in zip(names.outputs, bound.bounds, strict=True)
    )
    met = ", ".join(f"{value:.3g}" for value in bound.largest)
    if bound.ulps is not None:
        met += f"; in units in the last place {', '.join(f'{u:.0f}' for u in bound.ulps)}"
    if bound.random:
        how = (
            f"twice the largest difference from fuzzytrack in double precision ({met}) met at "
            f"{bound.random:,} random inputs and {checked:,} break points, middles and ends"
        )
    else:
        how = "the largest difference from fuzzytrack in double precision over all inputs"
    if silent and number.whole:
        how += (
            "; where rules fire at some corners of a cell of the table only, and an output jumps, "
            "it may err by more, but is never beyond its values at these corners"
        )
    yield "Error bound", f"{each}: {how}"


def about_operations(program: CProgram) -> Iterator[tuple[str, str]]:
    """Bytes and operations."""
    yield "ROM", f"{program.constants_bytes} bytes of constants, and the code"
    stack = "" if program.state_bytes is None else f": {program.state_bytes} bytes of variables"
    yield "RAM", f"none but the stack{stack}"
    yield "Operations", f"at most {operations_in_words(program.operations)} for a call"
