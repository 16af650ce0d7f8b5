"""Which module of a package imports which, read from its source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

Graph = dict[str, set[str]]


def import_graph(package: Path) -> Graph:
    """Modules of a package, and for each the modules that it imports, anywhere in its source.

    Imports inside functions and below ``if TYPE_CHECKING`` count. So does ``import_module`` of a
    text; of an f-string with constant beginning, all modules that begin so. An import of
    ``package.module`` runs ``package/__init__.py`` first, so that counts as imported too, but not
    by the modules of the package itself: they are always imported by way of it.

    One import does not count: that of ``package.plotting`` in a method ``plot``, which draws.
    """
    files = modules_of(package)
    return {
        name: {found for found in _imports(name, path, set(files)) if found != name}
        for name, path in files.items()
    }


def modules_of(package: Path) -> dict[str, Path]:
    """Names of the modules of a package, and their files."""
    return {_name(path, package): path for path in sorted(package.rglob("*.py"))}


def circles(graph: Graph) -> list[str]:
    """One circle, written ``a -> b -> a``, for each group of modules that import one another."""
    below = {name: _reached(name, graph) for name in graph}
    groups = {
        min(other for other in below[name] if name in below[other])
        for name in graph
        if name in below[name]
    }
    return [" -> ".join(_way_back(name, graph)) for name in sorted(groups)]


def _reached(start: str, graph: Graph) -> set[str]:
    found: set[str] = set()
    stack = [start]
    while stack:
        new = graph[stack.pop()] - found
        found |= new
        stack.extend(new)
    return found


def _way_back(start: str, graph: Graph) -> list[str]:
    """A shortest way from a module of a circle to itself, with both ends."""
    before: dict[str, str] = {}
    queue = [start]
    for name in queue:
        for other in sorted(graph[name]):
            if other not in before:
                before[other] = name
                queue.append(other)
    way = [start]
    while len(way) == 1 or way[-1] != start:
        way.append(before[way[-1]])
    return way[::-1]


def _name(path: Path, package: Path) -> str:
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(name: str, path: Path, modules: set[str]) -> Iterator[str]:
    """Modules that `name` imports, and the packages that this runs."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    nodes = list(ast.walk(tree))
    drawing = {id(node) for node in _drawing(nodes, f"{name.partition('.')[0]}.plotting")}
    for node in nodes:
        if id(node) in drawing:
            continue
        for target in _targets(node, modules):
            yield target
            parts = target.split(".")
            for depth in range(1, len(parts)):
                package = ".".join(parts[:depth])
                if package in modules and not f"{name}.".startswith(f"{package}."):
                    yield package


def _drawing(nodes: list[ast.AST], pictures: str) -> Iterator[ast.ImportFrom]:
    """Imports of the room of pictures in methods that are called ``plot``."""
    for kind in nodes:
        for method in kind.body if isinstance(kind, ast.ClassDef) else ():
            if isinstance(method, ast.FunctionDef) and method.name == "plot":
                for node in ast.walk(method):
                    if isinstance(node, ast.ImportFrom) and node.module == pictures:
                        yield node


def _targets(node: ast.AST, modules: set[str]) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names if alias.name in modules)
    elif isinstance(node, ast.ImportFrom):
        if node.level:
            raise ValueError(f"line {node.lineno}: write the import with the name of the package")
        for alias in node.names:
            submodule = f"{node.module}.{alias.name}"
            yield from {submodule if submodule in modules else str(node.module)} & modules
    elif isinstance(node, ast.Call) and node.args and "import_module" in ast.unparse(node.func):
        match node.args[0]:
            case ast.Constant(value=str(text)):
                yield from {text} & modules
            case ast.JoinedStr(values=[ast.Constant(value=str(start)), *_]):
                yield from (module for module in modules if module.startswith(start))
