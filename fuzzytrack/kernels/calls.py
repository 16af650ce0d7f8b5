"""Calls from compiled code to compiled code that is known by its address only.

So the passage through a job is compiled once, for all trackers, and each tracker brings nothing but
its own arithmetic. Importing this needs Numba.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

__all__ = ["call_steady", "call_step"]


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Where a number of an array lies."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.gep(data, [index])


def _call(builder: Any, address: Any, arguments: list[Any]) -> None:
    function = ir.FunctionType(ir.VoidType(), [argument.type for argument in arguments])
    builder.call(builder.inttoptr(address, function.as_pointer()), arguments)


def _call_step(typing_context: Any, step: Any, buffer: Any, count: Any) -> Any:
    """Call a step function, see `fuzzytrack.lanes.program.LaneProgram`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        step, buffer, count = arguments
        start = ir.Constant(count.type, 0)
        place = _address(context, builder, signature.args[1], buffer, start)
        _call(builder, step, [place, count])
        return context.get_dummy_value()

    return types.void(types.intp, buffer, types.intp), generate


def _call_steady(
    typing_context: Any, steady: Any, buffer: Any, count: Any, dt: Any,
    plots: Any, plots_at: Any, predicted: Any, predicted_at: Any,
) -> Any:  # fmt: skip
    """Call a steady function, likewise, with plots and predictions from places on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        steady, buffer, count, dt, plots, plots_at, predicted, predicted_at = arguments
        start = ir.Constant(count.type, 0)
        kinds = signature.args
        given = [
            _address(context, builder, kinds[1], buffer, start), count, dt,
            _address(context, builder, kinds[4], plots, plots_at),
            _address(context, builder, kinds[6], predicted, predicted_at),
        ]  # fmt: skip
        _call(builder, steady, given)
        return context.get_dummy_value()

    whole = types.intp
    arguments = (whole, buffer, whole, buffer.dtype, plots, whole, predicted, whole)
    return types.void(*arguments), generate


# Numba gives the context by itself.
call_step: Any = intrinsic(_call_step)
call_steady: Any = intrinsic(_call_steady)
