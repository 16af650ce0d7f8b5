"""Python functions as C99 functions: kernels of schedulers, and rule bases as scalar functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fuzzytrack.interop.c99.function_writer import written_function
from fuzzytrack.interop.c99.program import Program, Written
from fuzzytrack.interop.c99.python_source import definition_of, plain_function
from fuzzytrack.interop.c99.values import NUMBER, Form, leaves
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.schedulers.form import checked_kernel, checked_memory

__all__ = ["INCLUDES", "Translation", "translated", "translated_kernel"]

#: Headers that the text needs; of <math.h> it uses the macros NAN and INFINITY, and no function
#: unless it was allowed.
INCLUDES = ("math.h", "stdbool.h", "stdint.h", "string.h")


@dataclass(frozen=True, eq=False)
class Translation:
    """Functions in C99.

    Attributes
    ----------
    name : str
        Name of the function that is called; all other names begin with it.
    number : {"double", "float"}
    definitions : str
        Text in C without ``#include`` lines. All functions are ``FUZZYTRACK_INLINE``, which is
        ``static inline`` unless it is defined before.
    prototype : str
        Head of the function.
    takes : tuple of int
        For each argument, 0 for a number, and for an array how many there are.
    gives : int
        Numbers in the result; 0 if it is returned.
    includes : tuple of str
        Headers that the text needs.
    needs : frozenset of str
        Functions of C's mathematical library that it calls.
    operations : mapping of str to int
        Operations of one call, at most: additions (and subtractions), multiplications, divisions,
        comparisons, choices, conversions to integers, calls; functions of `math` by their names.
    constants_bytes : int
        Size of its constants.
    """

    name: str
    number: str
    definitions: str
    prototype: str
    takes: tuple[int, ...]
    gives: int
    includes: tuple[str, ...]
    needs: frozenset[str]
    operations: Mapping[str, int]
    constants_bytes: int

    def __repr__(self) -> str:
        return summary(self, "name", "number", "operations", "constants_bytes")


def translated(
    function: Any,
    *,
    name: str,
    number: str = "double",
    arguments: Sequence[Form] | None = None,
    libm: Sequence[str] = (),
) -> Translation:
    """A Python function as a C function.

    Parameters
    ----------
    function : function
        In the restricted Python of kernels: numbers, tuples, `math`, and plain functions of these;
        loops with a constant number of turns; no recursion. Numbers and functions of the enclosing
        scope and of its module become constants and functions in C.
    name : str
        Name of the function in C, with which all others of the program begin.
    number : {"double", "float"}
        Type of floating-point numbers.
    arguments : sequence, optional
        For each argument ``"number"``, or for a tuple a tuple of these; numbers unless given.
    libm : collection of str
        Functions of C's mathematical library that may be called, such as ``("sin",)``; the program
        must then be linked with it. Square roots, exponentials, logarithms, powers, sines and
        cosines do not need it.

    Returns
    -------
    Translation
        Its function takes numbers, and for each tuple a constant array of them (none for an empty
        one). It returns the number that the Python function returns; a tuple is written into an
        array, the last argument, number by number. That array may be one of those that are given.

    Raises
    ------
    TranslationError
        If the function, or one that it calls, uses what is not written in C; names the function
        and the place in its file.
    ValueError
        If `name`, `number` or `libm` is wrong.

    Notes
    -----
    Operations are those of Python, in the same order; results in double precision differ from
    Python's in the last bits only where `math.exp`, `math.log`, `math.cos`, `math.sin` or a power
    is used. Sine and cosine of angles beyond 1.6e6 are NaN, unless those of C are allowed. Where a
    value may be an integer or a floating-point number, it is a floating-point number. Where Python
    raises an error about numbers, C code goes on as compiled trackers do: a division by 0 gives
    infinity or NaN, the square root of a negative number NaN, an exponential that is too large
    infinity. Integers have 64 bits, and take the nearest value that there is where a result is too
    large; the integer of NaN is 0. A place outside of a tuple is the nearest place inside.
    """
    plain = plain_function(function)
    if plain is None:
        raise TypeError(f"function must be a plain function, got {type(function).__name__}")
    definition = definition_of(plain)
    names = [each.arg for each in definition.parameters]
    given_otherwise = definition.node.args
    if given_otherwise.vararg or given_otherwise.kwonlyargs or given_otherwise.kwarg:
        definition.refuse(definition.node, "takes other arguments than those by position")
    forms = tuple(arguments) if arguments is not None else (NUMBER,) * len(names)
    if len(forms) != len(names):
        raise ValueError(f"arguments: {len(forms)} for a function that takes {len(names)}")
    program = Program(name, number, libm)
    written = written_function(program, plain, forms)
    entry = _entry(program, written, dict(zip(names, forms, strict=True)))
    return Translation(
        name, number, program.definitions(), *entry, INCLUDES, frozenset(program.needs),
        dict(sorted(written.costs.items())), program.constants_bytes,
    )  # fmt: skip


def _entry(
    program: Program, written: Written, arguments: Mapping[str, Form]
) -> tuple[str, tuple[int, ...], int]:
    """Add the function that users call, which takes arrays in place of structs.

    Returns
    -------
    prototype, takes, gives
        As in a `Translation`.
    """
    heads, lines, given, takes = [], [], [], []
    for k, (argument, form) in enumerate(arguments.items()):
        count = len(list(leaves(form)))
        if not count:
            continue
        # A name of its own, since that in Python may be a word of C.
        name = f"{argument}_in" if argument.isascii() else f"argument_{k}"
        takes.append(0 if form == NUMBER else count)
        if form == NUMBER:
            heads.append(f"{program.number} {name}")
        else:
            heads.append(f"const {program.number} {name}[{count}]")
        if not written.used[len(heads) - 1]:
            lines.append(f"(void){name};")
        elif form == NUMBER:
            given.append(name)
        else:
            places = ", ".join(f"{name}[{j}]" for j in range(count))
            given.append(f"({program.struct(form)}){{{{{places}}}}}")
    call = f"{written.name}({', '.join(given)})"
    kind, gives, results = _results(program, written, call)
    if gives:
        heads.append(f"{program.number} result[{gives}]")
    prototype = f"{kind} {program.name}({', '.join(heads) or 'void'})"
    body = (f"    {line}" for line in (*lines, *results))
    program.functions.append("\n".join([f"FUZZYTRACK_INLINE {prototype}", "{", *body, "}"]))
    return prototype, tuple(takes), gives


def _results(program: Program, written: Written, call: str) -> tuple[str, int, list[str]]:
    """Type of the result, how many numbers are written into an array, and how."""
    kinds = list(leaves(written.result))
    casts = ["" if kind == NUMBER else f"({program.number})" for kind in kinds]
    if not kinds:
        return "void", 0, [f"{call};"]
    if not isinstance(written.result, tuple):
        return program.number, 0, [f"return {casts[0]}{call};"]
    array = program.struct_is_array(written.result)
    members = (f"v[{j}]" if array else f"f{j}" for j in range(len(kinds)))
    return "void", len(kinds), [
        f"const {program.struct(written.result)} found = {call};",
        *(
            f"result[{j}] = {cast}found.{member};"
            for j, (cast, member) in enumerate(zip(casts, members, strict=True))
        ),
    ]  # fmt: skip


def translated_kernel(
    scheduler: GainScheduler,
    *,
    name: str,
    n_axes: int = 1,
    number: str = "double",
    libm: Sequence[str] = (),
) -> Translation:
    """The kernel of a scheduler as a C function.

    Parameters
    ----------
    scheduler : GainScheduler
    name, number, libm
        As for `translated`.
    n_axes : int
        Axes that the kernel gets at once: 1 unless the scheduler is coupled.

    Returns
    -------
    Translation
        Its function takes innovation, change, time step, standard deviation and memory, as
        `fuzzytrack.schedulers.base.GainScheduler.kernel` does; the result is α, β, γ (of each axis,
        if the scheduler has `own_gains`), the retention time and the new memory.

    Raises
    ------
    PluginError
        If the kernel lacks the form.
    TranslationError
        As `translated` does.
    """
    kernel = checked_kernel(scheduler, n_axes)
    axes: Form = (NUMBER,) * n_axes if scheduler.coupled else NUMBER
    memory = (NUMBER,) * len(checked_memory(scheduler, n_axes))
    return translated(
        kernel, name=name, number=number, arguments=(axes, axes, NUMBER, axes, memory), libm=libm
    )
