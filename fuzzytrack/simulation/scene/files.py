"""Scenes of many targets from files and texts, with settings changed on the way."""

from __future__ import annotations

import copy
import os
from collections.abc import Mapping as AnyMapping
from pathlib import Path

from fuzzytrack import specs
from fuzzytrack.errors import FileError, ScenarioError
from fuzzytrack.shipped import Shipped
from fuzzytrack.simulation.scene.reader import SceneReader, is_scene
from fuzzytrack.simulation.scene.scene import Scene
from fuzzytrack.yamltree import Document, Mapping, Node, Scalar, suggestion

__all__ = [
    "as_scene",
    "load_scene",
    "loads_scene",
    "names_scene",
    "scene_path",
    "scene_source",
    "shipped_scenes",
]

_SHIPPED = Shipped("scene", "scenarios/traffic", "harbor.yaml", ScenarioError)


def loads_scene(
    text: str | bytes, file: str = "<text>", changed: AnyMapping[str, str] | None = None
) -> Scene:
    """Read a scene from YAML text.

    Parameters
    ----------
    text : str or bytes
        At most 128 KiB; bytes are UTF-8.
    file : str
        Name for messages.
    changed : mapping of str to str, optional
        Settings to change, by their path, as ``{"radar.detection": "0.8"}``.

    Returns
    -------
    Scene

    Raises
    ------
    ScenarioError
        If the text is not a complete and consistent scene; names file, line, column, the
        offending word and the allowed words.

    Examples
    --------
    >>> from fuzzytrack.simulation.scene import loads_scene
    >>> scene = loads_scene('''
    ... scenario: 1
    ... name: bay
    ... scans: {count: 20, period: 2.5}
    ... radar: {reach: [50, 5000], sigma_range: 5, sigma_bearing: 0.2, detection: 0.9}
    ... traffic: {boats: {count: 10, speed: [2, 8]}}
    ... clutter: {sea: {kind: uniform, count: 15}}
    ... ''', changed={"traffic.boats.count": "12"})
    >>> scene.traffic["boats"].count
    12
    """
    return _read(Document(text, file, failure=ScenarioError), changed or {})


def load_scene(name_or_path: str | os.PathLike[str]) -> Scene:
    """Read a shipped scene, or a file.

    Parameters
    ----------
    name_or_path : str or path
        A name out of `shipped_scenes`, or a path: anything that ends in ``.yaml`` or ``.yml``,
        holds a separator or is a path object. Settings may follow, as in
        ``dense-traffic:traffic.ships.count=10000:radar.detection=0.8``.

    Returns
    -------
    Scene

    Raises
    ------
    ScenarioError
        If there is no such name, or the file cannot be read, or is no scene.
    """
    name, changed = _split(name_or_path)
    return _read(_SHIPPED.document(name), changed)


def as_scene(scene: Scene | str | os.PathLike[str]) -> Scene:
    """The scene itself, or the one of a name or path; see `load_scene`.

    Raises
    ------
    ScenarioError
        As for `load_scene`.
    TypeError
        If it is something else.
    """
    if isinstance(scene, str | os.PathLike):
        return load_scene(scene)
    if not isinstance(scene, Scene):
        raise TypeError(
            "scene must be a Scene, the name of a shipped one or the path of a file, "
            f"got {type(scene).__name__}"
        )
    return scene


def names_scene(name_or_path: str | os.PathLike[str]) -> bool:
    """Whether it is the name or the path of a scene, with or without settings after it."""
    try:
        name, _ = _split(name_or_path)
        return name in shipped_scenes() or is_scene(_SHIPPED.document(name))
    except FileError:
        return False


def scene_source(name_or_path: str | os.PathLike[str]) -> str:
    """Paper or other source of a scene; see `load_scene`."""
    return SceneReader(_SHIPPED.document(_split(name_or_path)[0])).source()


def shipped_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with fuzzytrack, in alphabetical order."""
    return _SHIPPED.names()


def scene_path(name_or_path: str | os.PathLike[str]) -> Path:
    """Path of a shipped scene by name, or the path that was given, without settings.

    Raises
    ------
    ScenarioError
        If it is the name of no shipped scene.
    """
    return _SHIPPED.path(_split(name_or_path)[0])


def _split(name_or_path: str | os.PathLike[str]) -> tuple[str | os.PathLike[str], dict[str, str]]:
    """Name or path, and the settings after it."""
    if not isinstance(name_or_path, str):
        return name_or_path, {}
    try:
        return specs.split(name_or_path, "scene")
    except ValueError as error:
        raise ScenarioError(str(error)) from None


def _read(document: Document, changed: AnyMapping[str, str]) -> Scene:
    """Read a document, and again with settings changed: a mistake in these has no place in it."""
    scene = SceneReader(document).scene()
    if not changed:
        return scene
    for path, text in changed.items():
        try:
            _change(document, path.split("."), text)
            scene = SceneReader(document).scene()
        except FileError as error:
            raise ScenarioError(f"{path}={text}: {error.message}") from None
    return scene


def _change(document: Document, path: list[str], text: str) -> None:
    """Put a value in its place in a document that was read without complaint."""
    node = document.root
    for depth, word in enumerate(path):
        if not word:
            raise ScenarioError("a name is missing between two points")
        if not isinstance(node, Mapping):
            raise ScenarioError(f"{'.'.join(path[:depth])} has no settings of its own")
        if word not in node.entries or depth == len(path) - 1:
            if depth == 0 and word not in ("region", "own", "clutter"):
                allowed = tuple(key for key in node.entries if key not in ("scenario", "name"))
                raise ScenarioError(f"unknown setting {word!r}{suggestion(word, allowed)}")
            node.entries[word] = _entry(path[depth:], text)
            return
        # A copy, since an alias may have the same node elsewhere.
        key, found = node.entries[word]
        found = copy.copy(found)
        if isinstance(found, Mapping):
            found.entries = dict(found.entries)
        node.entries[word] = (key, found)
        node = found


def _entry(path: list[str], text: str) -> tuple[Scalar, Node]:
    """Entry of a mapping with a value at the end of a path."""
    opened = "".join(f"{{{word}: " for word in path)
    made = Document(f"{opened}{text}{'}' * len(path)}", "", failure=ScenarioError).root
    if not isinstance(made, Mapping) or list(made.entries) != path[:1]:
        raise ScenarioError("must be one value")
    return made.entries[path[0]]
