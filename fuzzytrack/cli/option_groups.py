"""Options that belong together, which a command takes as one argument."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from copy import copy
from functools import wraps
from typing import Annotated, Any, get_args

__all__ = ["changed", "grouped"]

_Command = Callable[..., None]


def grouped(**groups: Callable[..., Any]) -> Callable[[_Command], _Command]:
    """Give a command the parameters of functions, in place of the arguments named so.

    Parameters
    ----------
    **groups : callable
        By the name of an argument the function that makes it of options; its parameters become
        options of the command, where the argument stood.
    """
    added = {name: inspect.signature(make, eval_str=True) for name, make in groups.items()}

    def decorated(command: _Command) -> _Command:
        own = inspect.signature(command, eval_str=True).parameters

        @wraps(command)
        def with_options(**given: Any) -> None:
            made = {
                name: make(**{each: given.pop(each) for each in added[name].parameters})
                for name, make in groups.items()
            }
            command(**made, **given)

        parameters: list[inspect.Parameter] = []
        for name, parameter in own.items():
            parameters += added[name].parameters.values() if name in added else [parameter]
        ordered = sorted(parameters, key=lambda each: each.default is not inspect.Parameter.empty)
        with_options.__signature__ = inspect.Signature(ordered)  # type: ignore[attr-defined]
        with_options.__annotations__ = {each.name: each.annotation for each in ordered}
        del with_options.__wrapped__  # its signature is another one
        return with_options

    return decorated


def changed(make: Callable[..., Any], options: dict[str, dict[str, Any]]) -> Callable[..., Any]:
    """The same function with other attributes of some of its options, for `grouped`.

    Parameters
    ----------
    make : callable
    options : dict
        By the name of a parameter attributes of its option.
    """

    @wraps(make)
    def same(**given: Any) -> Any:
        return make(**given)

    signature = inspect.signature(make, eval_str=True)
    parameters = [
        _with(each, options[name]) if name in options else each
        for name, each in signature.parameters.items()
    ]
    same.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return same


def _with(parameter: inspect.Parameter, attributes: dict[str, Any]) -> inspect.Parameter:
    kind, option = get_args(parameter.annotation)
    option = copy(option)
    for name, value in attributes.items():
        setattr(option, name, value)
    return parameter.replace(annotation=Annotated[kind, option])
