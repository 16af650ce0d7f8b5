"""How two axes of position lie on a map: which one is horizontal, and what they are called."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzytrack.io.column_names import plain_name

__all__ = ["map_axes"]


def map_axes(names: Sequence[str]) -> tuple[tuple[str, str], tuple[int, int]]:
    """Names of the horizontal and the vertical axis of a map, and which axes of space they are.

    Parameters
    ----------
    names : sequence of str
        Two names of axes in meters, as columns have them: ``("north_m", "east_m")``.

    Returns
    -------
    names : tuple of str
        Without a unit: ``("east", "north")``.
    order : tuple of int
        ``(1, 0)`` if the first axis is north, which is drawn upwards; else ``(0, 1)``.

    Raises
    ------
    ValueError
        If there are not two names.
    """
    if len(names) != 2:
        raise ValueError(f"axes_names: needs 2 names, got {len(names)}: {', '.join(names)}")
    plain = [found if unit == "m" else each for each, (found, unit) in _split(names)]
    order = (1, 0) if plain[0].lower().startswith("north") else (0, 1)
    return (plain[order[0]], plain[order[1]]), order


def _split(names: Sequence[str]) -> list[tuple[str, tuple[str, str]]]:
    return [(name, plain_name(name)) for name in names]
