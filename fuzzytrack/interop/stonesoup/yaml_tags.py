"""Reading this package's components from the YAML of Stone Soup.

It writes them by itself, but reads only tags of its own packages unless a plug-in adds others; the
entry point ``stonesoup.serialise.yaml`` names `add_to_yaml`.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ruamel.yaml.constructor import ConstructorError
from stonesoup.base import Base

__all__ = ["add_to_yaml"]

_TAG = "!fuzzytrack.interop.stonesoup."


def add_to_yaml(yaml: Any) -> None:
    """Make a YAML reader know the components of this package.

    Parameters
    ----------
    yaml : ruamel.yaml.YAML
    """
    yaml.constructor.add_multi_constructor(_TAG, _component)


def _component(constructor: Any, suffix: str, node: Any) -> Any:
    """Component of the mapping that was written for it."""
    module, _, name = f"{_TAG[1:]}{suffix}".rpartition(".")
    try:
        made: Any = getattr(import_module(module), name)
    except (ImportError, AttributeError):
        made = None
    if not (isinstance(made, type) and issubclass(made, Base)):
        raise ConstructorError(
            "while constructing a Stone Soup component", node.start_mark,
            f"there is no component {module}.{name}", node.start_mark,
        )  # fmt: skip
    # Objects within it must be whole before it is made.
    constructor.deep_construct = True
    (properties,) = constructor.construct_yaml_omap(node)
    try:
        return made(**properties)
    except (TypeError, ValueError) as error:
        raise ConstructorError(
            "while constructing a Stone Soup component", node.start_mark, str(error),
            node.start_mark,
        ) from error  # fmt: skip
