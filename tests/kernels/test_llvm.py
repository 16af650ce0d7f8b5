"""What LLVM is told of the loops of a compiled function, and calls by address."""

import numpy as np
import pytest
from llvmlite import ir

from fuzzytrack.kernels.compile import compiled, entry_point
from fuzzytrack.kernels.language import promise_independent_turns, read_soon
from fuzzytrack.kernels.llvm import _branches_back, call, pointer


def function(targets):
    """Function of empty blocks that lead to those of the given numbers; () ends it."""
    made = ir.Function(ir.Module(), ir.FunctionType(ir.VoidType(), []), "f")
    blocks = [made.append_basic_block() for _ in targets]
    for block, numbers in zip(blocks, targets, strict=True):
        if numbers is None:
            continue
        builder, others = ir.IRBuilder(block), [blocks[n] for n in numbers]
        if not others:
            builder.ret_void()
        elif len(others) == 1:
            builder.branch(others[0])
        else:
            builder.cbranch(ir.Constant(ir.IntType(1), 1), *others)
    return blocks


@pytest.mark.parametrize(
    ("targets", "back"),
    [
        ([()], []),
        ([(1, 2), (3,), (3,), ()], []),
        # A loop, whose beginning is not written yet, with two ways through an iteration.
        ([None, (2,), (3, 6), (4, 5), (5,), (2,), ()], [5]),
        # A loop within a loop.
        ([(1,), (2, 5), (3, 4), (2,), (1,), ()], [3, 4]),
        # An iteration that begins again at once.
        ([(1,), (1, 2), ()], [1]),
    ],
)
def test_branches_back(targets, back):
    blocks = function(targets)
    found = [blocks.index(branch.parent) for branch in _branches_back(blocks)]
    assert sorted(found) == back


def test_the_promise_reaches_the_compiler(monkeypatch):
    # Code from disk cannot be read.
    monkeypatch.setenv("FUZZYTRACK_CACHE_DIR", "off")

    def doubled(numbers, count):
        for i in range(count):
            numbers[i + 1] = 2.0 * numbers[i]

    def promised(numbers, count):
        for i in range(count):
            numbers[i + 1] = 2.0 * numbers[i]
        promise_independent_turns()

    wide = {}
    for made in (doubled, promised):
        made(np.zeros(20), 5)
        code = entry_point(made, "vpi")._library.get_llvm_str()
        wide[made] = "x double>" in code
    # Each iteration uses what the one before left: only a (false) promise makes vectors of it.
    assert wide == {doubled: False, promised: True}


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_compiled_code_calls_what_was_compiled_later(dtype):
    def caller(address, source, at, factor, target):
        call(address, (pointer(source, at), len(source) - at, factor, pointer(target, 1)))

    def scaled(source, count, factor, target):
        for i in range(count):
            target[i] = factor * source[i]

    source, target = np.array([1.0, 2.0, 3.0], dtype), np.zeros(4, dtype)
    outer = compiled(caller)
    outer(entry_point(scaled, "vpixp", dtype).address, source, 1, dtype(0.5), target)
    assert target.tolist() == [0.0, 1.0, 1.5, 0.0]


def test_rows_ahead_are_fetched(monkeypatch):
    """At the place of their numbers in memory, and without harm beyond the last row."""
    monkeypatch.setenv("FUZZYTRACK_CACHE_DIR", "off")

    def total(table):
        found = 0.0
        for i in range(len(table)):
            read_soon(table, i + 1000, 1)
            found += table[i, 1]
        return found

    code, table = compiled(total), np.arange(12.0).reshape(3, 4)
    for given in (table, np.asfortranarray(table), table[:, ::2], table[:0]):
        assert code(given) == total(given) == given[:, 1].sum()
    assert any("call void @llvm.prefetch" in text for text in code.inspect_llvm().values())
