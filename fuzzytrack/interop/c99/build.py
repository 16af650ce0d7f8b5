"""C code compiled by the compiler of this computer, and loaded."""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

__all__ = ["CompilerError", "built", "find_compiler"]

#: Options for every build: bits must not depend on what a processor can do at once.
_ALWAYS = ("-std=c99", "-ffp-contract=off", "-fPIC", "-shared")
_COMPILERS = ("cc", "gcc", "clang")


class CompilerError(RuntimeError):
    """There is no C compiler, or it did not compile."""


def find_compiler(compiler: str | None = None) -> list[str]:
    """Command of a C compiler: its path, and the options that are given with it.

    Parameters
    ----------
    compiler : str, optional
        As a shell reads it, such as ``gcc`` or ``ccache gcc -m32``. Unless given, that in the
        environment variable ``CC``, as for make; without it ``cc``, ``gcc`` or ``clang``, the
        first that is installed.

    Raises
    ------
    CompilerError
        If it is not installed, or there is none.
    """
    given = compiler or os.environ.get("CC", "").strip()
    try:
        commands = [shlex.split(command) for command in ([given] if given else _COMPILERS)]
    except ValueError as error:
        raise CompilerError(f"C compiler {given!r}: {error}") from None
    for program, *options in commands:
        found = shutil.which(program)
        if found is not None:
            return [found, *options]
    if given and not compiler:
        raise CompilerError(f"CC: no C compiler {given!r} is installed; unset CC, or install it")
    wanted = repr(given) if given else " or ".join(_COMPILERS)
    raise CompilerError(f"no C compiler {wanted} is installed; install gcc or clang")


def built(
    text: str, *, compiler: str | None = None, flags: Sequence[str] = ("-O2",), link: bool = False
) -> ctypes.CDLL:
    """C code as a library in this process.

    Parameters
    ----------
    text : str
        With its ``#include`` lines.
    compiler : str, optional
        As for `find_compiler`.
    flags : sequence of str
        Options of the compiler.
    link : bool
        Whether to link with C's mathematical library.

    Raises
    ------
    CompilerError
        If there is no compiler, or it does not compile the code; with its first error.
    """
    program = find_compiler(compiler)
    with tempfile.TemporaryDirectory(prefix="fuzzytrack-") as folder:
        source, library = Path(folder, "code.c"), Path(folder, "code.so")
        source.write_text(text, encoding="utf-8")
        command = [*program, *_ALWAYS, *flags, str(source), "-o", str(library)]
        done = subprocess.run(
            [*command, "-lm"] if link else command,
            capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C"},
        )  # fmt: skip
        if done.returncode:
            errors = [line for line in done.stderr.splitlines() if "error" in line]
            first = (errors or done.stderr.splitlines() or ["no message"])[0]
            raise CompilerError(f"{Path(program[0]).name}: {first.replace(folder + os.sep, '')}")
        # It stays loaded when the file is gone.
        return ctypes.CDLL(str(library))
