"""Marks the loops of a compiled function for LLVM. Importing this needs Numba."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

__all__ = ["mark_loops"]

#: Vectors that go through a turn at a time.
VECTORS = 2

_TOUCHING = (ir.LoadInstr, ir.StoreInstr, ir.CallInstr)


class _Distinct(ir.MDValue):  # type: ignore[misc]
    """A node of metadata that equals no other, as LLVM names groups and loops; llvmlite has none.

    Its first operand is itself, if it is the name of a loop.
    """

    def __init__(self, module: Any, operands: tuple[Any, ...] = ()) -> None:
        super().__init__(module, operands, name=str(len(module.metadata)))

    def descr(self, buf: list[str]) -> None:
        inside = ", ".join(operand.get_reference() for operand in self.operands)
        buf += (f"distinct !{{ {inside} }}", "\n")

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


def _mark_loops(typing_context: Any) -> Any:
    """See `fuzzytrack.kernels.compile.promise_independent_turns`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function, module = builder.function, builder.module
        group = _Distinct(module)
        for block in function.blocks:
            for instruction in block.instructions:
                # What is inlined takes over the group of its call.
                if isinstance(instruction, _TOUCHING):
                    instruction.set_metadata("llvm.access.group", group)
        independent = _entry(module, "llvm.loop.parallel_accesses", group)
        count = ir.Constant(ir.IntType(32), VECTORS)
        interleaved = _entry(module, "llvm.loop.interleave.count", count)
        for branch in _branches_back(function.blocks):
            loop = _Distinct(module)
            loop.operands = (loop, independent, interleaved)
            branch.set_metadata("llvm.loop", loop)
        return context.get_dummy_value()

    return types.void(), generate


def _entry(module: Any, name: str, value: Any) -> Any:
    return module.add_metadata([ir.MetaDataString(module, name), value])


def _branches_back(blocks: Sequence[Any]) -> Iterator[Any]:
    """Ends of blocks that lead to a block on the way to them."""
    done: set[Any] = set()
    # The very first block does not yet lead to the one that was written first.
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
    # Those that are not yet written have no end.
    operands = () if block.terminator is None else block.terminator.operands
    return [operand for operand in operands if isinstance(operand, ir.Block)]


# Numba gives the context by itself.
mark_loops: Any = intrinsic(_mark_loops)
