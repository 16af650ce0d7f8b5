"""Numbers of compiled code that it reads from memory, where others are constants.

Importing this needs Numba.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.imputils import lower_constant
from numba.core.typeconv.castgraph import Conversion
from numba.extending import lower_cast, models, register_model, typeof_impl

__all__ = ["Slot"]


@dataclass(frozen=True)
class Slot:
    """A number in memory that stands for a constant of a function that is compiled.

    Attributes
    ----------
    address : int
        Where it is; it must stay there as long as the code is used, and must not change while the
        code runs.
    """

    address: int


class _SlotType(types.Type):
    """Type of a `Slot`: in arithmetic it is a float64."""

    def __init__(self) -> None:
        super().__init__(name="Slot")

    def can_convert_to(self, typing_context: Any, other: Any) -> Any:
        """Say that it can stand where a float64 is expected."""
        return Conversion.safe if other == types.float64 else None

    def unify(self, typing_context: Any, other: Any) -> Any:
        """Type of a variable that is either a slot or a float64."""
        return types.float64 if other in (self, types.float64) else None


_SLOT = _SlotType()


def _type_of(value: Slot, context: Any) -> Any:
    return _SLOT


class _SlotModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.DoubleType())


def _read(context: Any, builder: Any, kind: Any, value: Slot) -> Any:
    address = ir.Constant(ir.IntType(64), value.address)
    number = builder.load(address.inttoptr(ir.DoubleType().as_pointer()))
    # Without it, the compiler would read it again after every write of a result.
    number.set_metadata("invariant.load", builder.module.add_metadata([]))
    return number


def _as_float(context: Any, builder: Any, kind: Any, wanted: Any, value: Any) -> Any:
    return value


typeof_impl.register(Slot)(_type_of)
register_model(_SlotType)(_SlotModel)
lower_constant(_SlotType)(_read)
lower_cast(_SlotType, types.float64)(_as_float)
