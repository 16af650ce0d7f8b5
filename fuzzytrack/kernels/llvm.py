"""What Numba's public interface does not offer: code kept by content, and words to LLVM.

Importing this needs Numba. See `fuzzytrack.kernels` for what breaks when Numba changes.
"""

from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.caching import NullCache
from numba.core.ccallback import CFunc
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.extending import intrinsic

from fuzzytrack.kernels import language
from fuzzytrack.kernels.cache import KernelFolder

__all__ = ["c_function", "call", "inlined", "keep_on_disk", "pointer", "word_for_compiler"]

#: Part of what code is kept by. Raise it when this room compiles the same function differently.
_SCHEME = 7
_MADE_BY = (_SCHEME, sys.implementation.cache_tag, numba.__version__, llvmlite.__version__)

#: Vectors that the compiler works on in each iteration of a loop.
_VECTORS = 2


# ---------------------------------------------------------------- code kept on disk


class _ByContent(NullCache):
    """Numba's cache of one function, with its files named by the content of the function.

    Numba's own cache recognizes a closure by its pickled variables. Those of compiled helpers
    differ from process to process, so it would find nothing again.
    """

    def __init__(self, digest: str) -> None:
        self._digest = digest

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        """Compiled code for a signature, or None."""
        target_context.refresh()
        name = self._name(signature, target_context.codegen())
        content = KernelFolder.of_user().read(name)
        # A damaged file is replaced by what is compiled now: its code could end the process.
        if content is None or content[:_CHECKED] != _checksum(name, content[_CHECKED:]):
            return None
        try:
            return CompileResult._rebuild(target_context, *pickle.loads(content[_CHECKED:]))
        # Another version of something that the code needs.
        except Exception:
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep compiled code for a signature."""
        if not result.lifted and not result.library.has_dynamic_globals:
            name = self._name(signature, result.codegen)
            code = dumps(result._reduce())
            KernelFolder.of_user().write(name, _checksum(name, code) + code)

    def _name(self, signature: Any, codegen: Any) -> str:
        # The last part is the processor with its features.
        key = (_MADE_BY, self._digest, str(signature), codegen.magic_tuple())
        return hashlib.sha256(repr(key).encode()).hexdigest()[:32]


#: Bytes of the checksum before the code in a file.
_CHECKED = 32


def _checksum(name: str, code: bytes) -> bytes:
    return hashlib.sha256(name.encode() + code).digest()


def keep_on_disk(compiled: Any, digest: str | None) -> None:
    """Keep the code of a Numba dispatcher or C function on disk, under the digest of its source.

    Without a digest it is compiled anew in every process.
    """
    if digest is not None:
        compiled._cache = _ByContent(digest)


def c_function(
    function: Callable[..., Any], arguments: str, dtype: type, digest: str | None
) -> Any:
    """Compile a function for calls by its address.

    Parameters
    ----------
    function : callable
    arguments, dtype
        See `fuzzytrack.kernels.compile.entry_point`.
    digest : str or None
        See `keep_on_disk`.
    """
    number = numba.from_dtype(np.dtype(dtype))
    kinds = {"v": types.void, "i": types.intp, "x": number, "p": types.CPointer(number)}
    result, *given = (kinds[letter] for letter in arguments)
    made: Any = CFunc(function, (tuple(given), result), {}, {"error_model": "numpy"})
    keep_on_disk(made, digest)
    made.compile()
    return made


#: The annotations of Numba leave some of its options out.
_INLINED: Any = {
    "error_model": "numpy", "forceinline": True, "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip


def inlined(helper: Callable[..., Any], allocates: bool = True) -> Any:
    """Numba dispatcher of a function that only compiled code calls.

    It is inlined whatever its size: a call keeps a loop from being vectorized. Code by which Python
    or C could call it is left out, which would take a quarter of the time to compile.
    """
    options = _INLINED if allocates else {**_INLINED, "_nrt": False}
    return numba.njit(helper, **options)


# ---------------------------------------------------------------- words of the language


def word_for_compiler(function: Callable[..., Any], dtype: type) -> Any:
    """What compiled code has in place of a word of `fuzzytrack.kernels.language`.

    Parameters
    ----------
    function : callable
    dtype : type
        Type of number that is compiled for.

    Returns
    -------
    Numba intrinsic or None
        None for any other function.
    """
    if function is language.own_numbers:
        return _own_numbers(dtype)
    return _WORDS.get(function)


def _use_wide_vectors(typing_context: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        # LLVM has this attribute as text only, and the list of llvmlite refuses texts.
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), generate


@cache
def _own_numbers(dtype: type) -> Any:
    number = numba.from_dtype(np.dtype(dtype))

    def declare(typing_context: Any, count: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            numbers = context.get_data_type(number)
            return cgutils.alloca_once(builder, numbers, size=count.literal_value)

        return types.CPointer(number)(count), generate

    return intrinsic(prefer_literal=True)(declare)


def _promise_independent_turns(typing_context: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function, module = builder.function, builder.module
        group = _Distinct(module)
        for block in function.blocks:
            for instruction in block.instructions:
                # What is inlined takes over the group of its call.
                if isinstance(instruction, _TOUCHING):
                    instruction.set_metadata("llvm.access.group", group)
        independent = _entry(module, "llvm.loop.parallel_accesses", group)
        count = ir.Constant(ir.IntType(32), _VECTORS)
        interleaved = _entry(module, "llvm.loop.interleave.count", count)
        for branch in _branches_back(function.blocks):
            loop = _Distinct(module)
            loop.operands = (loop, independent, interleaved)
            branch.set_metadata("llvm.loop", loop)
        return context.get_dummy_value()

    return types.void(), generate


def _read_soon(typing_context: Any, table: Any, row: Any, column: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(table)(context, builder, arguments[0])
        strides = cgutils.unpack_tuple(builder, array.strides)
        offset = builder.add(
            builder.mul(arguments[1], strides[0]), builder.mul(arguments[2], strides[1])
        )
        byte, whole = ir.IntType(8).as_pointer(), ir.IntType(32)
        place = builder.gep(builder.bitcast(array.data, byte), [offset])
        fetch = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(ir.VoidType(), [byte, whole, whole, whole]),
            "llvm.prefetch.p0",
        )
        # To be read, kept in all caches, data.
        builder.call(fetch, [place, whole(0), whole(3), whole(1)])
        return context.get_dummy_value()

    return types.void(table, types.intp, types.intp), generate


#: Instructions that may read or write memory.
_TOUCHING = (ir.LoadInstr, ir.StoreInstr, ir.CallInstr)


class _Distinct(ir.MDValue):  # type: ignore[misc]
    """Metadata that equals no other: LLVM names groups of accesses and loops so; llvmlite has none.

    The first operand of the name of a loop is that name itself.
    """

    def __init__(self, module: Any) -> None:
        super().__init__(module, (), name=str(len(module.metadata)))

    def descr(self, buf: list[str]) -> None:
        inside = ", ".join(operand.get_reference() for operand in self.operands)
        buf += (f"distinct !{{ {inside} }}", "\n")

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


def _entry(module: Any, name: str, value: Any) -> Any:
    return module.add_metadata([ir.MetaDataString(module, name), value])


def _branches_back(blocks: Sequence[Any]) -> Iterator[Any]:
    """Ends of blocks that lead back to a block on the way to them, so that they close a loop."""
    done: set[Any] = set()
    # From every block: the first one does not yet lead to those that were written before it ended.
    for start in blocks:
        way = [] if start in done else [(start, iter(_next_blocks(start)))]
        while way:
            block, others = way[-1]
            other = next(others, None)
            if other is None:
                done.add(block)
                way.pop()
            elif any(other is passed for passed, _ in way):
                yield block.terminator
            elif other not in done:
                way.append((other, iter(_next_blocks(other))))


def _next_blocks(block: Any) -> list[Any]:
    # Blocks that are still being written have no end.
    operands = () if block.terminator is None else block.terminator.operands
    return [operand for operand in operands if isinstance(operand, ir.Block)]


# Numba adds the context to the arguments by itself.
_WORDS: dict[Callable[..., Any], Any] = {
    language.use_wide_vectors: intrinsic(_use_wide_vectors),
    language.promise_independent_turns: intrinsic(_promise_independent_turns),
    language.read_soon: intrinsic(_read_soon),
}


# ---------------------------------------------------------------- calls by address

# So code that is compiled once can call what was compiled later.


def _pointer(typing_context: Any, array: Any, index: Any) -> Any:
    """Pointer to the number at an index of an array, to be given to `call`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.gep(data, [arguments[1]])

    return types.CPointer(array.dtype)(array, types.intp), generate


def _call(typing_context: Any, address: Any, given: Any) -> Any:
    """Call the function at an address, see `entry_point`, with a tuple of pointers and numbers."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values = cgutils.unpack_tuple(builder, arguments[1])
        function = ir.FunctionType(ir.VoidType(), [value.type for value in values])
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), values)
        return context.get_dummy_value()

    return types.void(types.intp, given), generate


pointer: Any = intrinsic(_pointer)
call: Any = intrinsic(_call)
