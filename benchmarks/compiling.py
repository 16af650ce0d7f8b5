"""How the loops that are written by hand are compiled."""

from __future__ import annotations

import numba
from numba.extending import intrinsic

__all__ = ["inline", "loop", "wide"]

#: Compiles a function that is part of its callers.
inline = numba.njit(error_model="numpy", forceinline=True)
#: Compiles a loop.
loop = numba.njit(error_model="numpy", nogil=True, cache=True)


@intrinsic
def wide(typing_context):
    """Ask for vectors of 512 bits in the function that calls this."""

    def generate(context, builder, signature, arguments):
        # llvmlite knows no such attribute, LLVM does.
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return numba.types.void(), generate
