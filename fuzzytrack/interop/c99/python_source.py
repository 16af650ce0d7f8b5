"""The syntax tree of a function that exists, with the place of every word in its file."""

from __future__ import annotations

import ast
import builtins
import linecache
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType, FunctionType
from typing import Any, NoReturn

from fuzzytrack.errors import FileError, Location

__all__ = ["Definition", "TranslationError", "definition_of", "plain_function"]

_UNDEFINED = object()


class TranslationError(FileError):
    """A function that cannot be written in C; names the function and the place in its file."""


class FloatRangeError(TranslationError):
    """A function works with a number that is too large or too small for 32 bits."""


@dataclass(frozen=True, eq=False)
class Definition:
    """A function and its syntax tree.

    Attributes
    ----------
    function : function
    node : ast.FunctionDef or ast.Lambda
    file : str
        As Python names it.
    """

    function: FunctionType
    node: ast.FunctionDef | ast.Lambda
    file: str

    @property
    def name(self) -> str:
        """Name of the function; of a lambda that of the function around it."""
        return readable_name(self.function)

    @property
    def parameters(self) -> list[ast.arg]:
        """Parameters that are given by position."""
        return [*self.node.args.posonlyargs, *self.node.args.args]

    @property
    def body(self) -> list[ast.stmt]:
        """Statements, without the docstring; of a lambda one that returns."""
        if isinstance(self.node, ast.Lambda):
            return [ast.copy_location(ast.Return(self.node.body), self.node.body)]
        has_text = ast.get_docstring(self.node, clean=False) is not None
        return self.node.body[1:] if has_text else self.node.body

    def outer(self, name: str) -> Any:
        """Value of a name that is not local.

        Raises
        ------
        KeyError
            If there is none.
        """
        free = self.function.__code__.co_freevars
        if name in free and self.function.__closure__ is not None:
            try:
                return self.function.__closure__[free.index(name)].cell_contents
            except ValueError:
                raise KeyError(name) from None
        found = self.function.__globals__.get(name, getattr(builtins, name, _UNDEFINED))
        if found is _UNDEFINED:
            raise KeyError(name)
        return found

    def refuse(
        self, node: ast.AST, what: str, error: type[TranslationError] = TranslationError
    ) -> NoReturn:
        """Raise an error about a part of the function."""
        line = getattr(node, "lineno", self.function.__code__.co_firstlineno)
        column = getattr(node, "col_offset", 0) + 1
        raise error(f"the function {self.name} {what}", Location(self.file, line, column))


def readable_name(function: FunctionType) -> str:
    """Name of a function; of a lambda that of the function around it."""
    parts = [part for part in function.__qualname__.split(".") if not part.startswith("<")]
    return parts[-1] if parts else "lambda"


def plain_function(value: Any) -> FunctionType | None:
    """The function itself, or the one that Numba has compiled; None for anything else."""
    value = getattr(value, "py_func", value)
    return value if isinstance(value, FunctionType) else None


def definition_of(function: FunctionType) -> Definition:
    """Syntax tree of a function.

    Parameters
    ----------
    function : function
        Its source must be in the file that it was read from, or in its attribute ``source``, as
        that of a rule base is.

    Raises
    ------
    TranslationError
        If the source is not there, or is not that of the function any more.
    """
    code = function.__code__
    text = vars(function).get("source")
    if text is None:
        lines = linecache.getlines(code.co_filename, function.__globals__)
        text = "".join(lines)
    for node, candidate in _functions(text, code.co_filename):
        if _is(candidate, code):
            return Definition(function, node, code.co_filename)
    trouble = "has changed since it was imported" if text else "is not in a file"
    remedy = "C code is written from the source"
    if text and code.co_name == "<lambda>" and not _has_columns(code):
        trouble = "cannot be told from that of the other lambdas on its line"
        remedy = (
            "write each on a line of its own, or start Python without -X no_debug_ranges and "
            "PYTHONNODEBUGRANGES"
        )
    raise TranslationError(
        f"the source of the function {readable_name(function)} {trouble}; {remedy}",
        Location(code.co_filename, code.co_firstlineno, 1),
    )


def _has_columns(code: CodeType) -> bool:
    """Whether the columns of instructions are kept, which an option of Python omits."""
    return any(column is not None for _, _, column, _ in code.co_positions())


def _is(candidate: CodeType, code: CodeType) -> bool:
    """Whether a compiled source is that of a function."""
    return (
        candidate.co_firstlineno == code.co_firstlineno
        and candidate.co_name == code.co_name
        and candidate.co_code == code.co_code
        and candidate.co_varnames == code.co_varnames
        and list(candidate.co_positions()) == list(code.co_positions())
    )


@lru_cache(maxsize=64)
def _functions(text: str, file: str) -> list[tuple[ast.FunctionDef | ast.Lambda, CodeType]]:
    """All functions of a source, each with its compiled code."""
    try:
        tree = ast.parse(text, file)
    except SyntaxError:
        return []
    lambdas = Counter(node.lineno for node in ast.walk(tree) if isinstance(node, ast.Lambda))
    codes: dict[tuple[int, str], list[CodeType]] = {}
    for code in _all_codes(compile(text, file, "exec", dont_inherit=True)):
        codes.setdefault((code.co_firstlineno, code.co_name), []).append(code)
    found: list[tuple[ast.FunctionDef | ast.Lambda, CodeType]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(word.lineno for word in node.decorator_list)])
            found += [(node, code) for code in codes.get((first, node.name), ())]
        elif isinstance(node, ast.Lambda):
            same_line = codes.get((node.lineno, "<lambda>"), ())
            # Without columns, one that is alone on its line.
            alone = lambdas[node.lineno] == len(same_line) == 1
            found += [(node, code) for code in same_line if alone or _inside(node, code)]
    return found


def _inside(node: ast.Lambda, code: CodeType) -> bool:
    """Whether a code is that of a lambda, by the places of its instructions."""
    whole = (node.body.lineno, node.body.col_offset, node.body.end_lineno, node.body.end_col_offset)
    places = [
        (line, column, end_line, end_column)
        for line, end_line, column, end_column in code.co_positions()
        if None not in (line, end_line, column, end_column) and end_column
    ]
    return places[-1:] == [whole]


def _all_codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _all_codes(constant)
