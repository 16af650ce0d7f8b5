"""Numbers in the text of a rule base: where they are, and how they are set in place."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.numerals import is_number
from fuzzytrack.yamltree import Document, Node, Scalar, Sequence, quoted
from fuzzytrack.yamltree import Mapping as MappingNode

__all__ = ["NumberPlaces", "replaced", "with_numbers", "written"]

#: Keys and indices that lead to a number, as ``("inputs", "E", "sets", "ze", "trimf", 1)``.
Place = tuple[str | int, ...]

#: Characters from the first to before the second.
Span = tuple[int, int]


def written(value: float) -> str:
    """A number as rule bases write it: the shortest text that is read as this number."""
    return repr(float(value)).removesuffix(".0")


@dataclass(frozen=True)
class NumberPlaces:
    """Where the numbers of a rule base are in its text.

    Attributes
    ----------
    values : dict of Place to float
        All numbers of universes, sets and scheduler settings.
    spans : dict of Place to Span
        The characters of each. Those in a part that an alias repeats are the same for all places
        where it stands.
    """

    values: dict[Place, float]
    spans: dict[Place, Span]

    @classmethod
    def of(cls, text: str, file: str = "<text>") -> NumberPlaces:
        """Find the numbers of a rule base.

        Raises
        ------
        RuleBaseError
            If the text is no rule base, or a number is itself an alias or carries an anchor, so
            that it cannot be set by itself.
        """
        loads_rulebase(text, file)
        document, found = Document(text, file), cls({}, {})
        # The tree counts characters after a byte order mark.
        mark = len(text) - len(text.removeprefix("\ufeff"))
        top = document.entries(document.root, "the rule base")
        for part in ("inputs", "outputs", "scheduler"):
            nodes = _scalars(top[part][1], (part,)) if part in top else ()
            for place, node in nodes:
                start, end = node.start + mark, node.end + mark
                if not is_number(node.text):
                    continue
                if not is_number(text[start:end].strip("'\"")):
                    raise document.error(
                        node,
                        f"{quoted(text[start:end])}: a number that an anchor shares cannot be set "
                        "by itself; write it out first",
                    )
                found.values[place], found.spans[place] = float(node.text), (start, end)
        return found


def _scalars(node: Node, place: Place) -> Iterator[tuple[Place, Scalar]]:
    """Words below a node, with the keys and indices that lead to them."""
    below: Iterable[tuple[str | int, Node]] = ()
    if isinstance(node, Scalar):
        yield place, node
    elif isinstance(node, MappingNode):
        below = ((word, value) for word, (_, value) in node.entries.items())
    elif isinstance(node, Sequence):
        below = enumerate(node.items)
    for key, value in below:
        yield from _scalars(value, (*place, key))


def with_numbers(text: str, numbers: Mapping[Place, float], file: str = "<text>") -> str:
    """Set numbers in the text of a rule base, and change nothing else in it.

    Parameters
    ----------
    text : str
        A rule base in YAML.
    numbers : mapping of Place to float
        Places out of `NumberPlaces`, with the new numbers. Of places that an alias shares, one is
        enough.
    file : str
        Name for messages.

    Returns
    -------
    str
        The text; comments and layout are those of before.

    Raises
    ------
    KeyError
        If there is no number at such a place.
    RuleBaseError
        If the text, before or after, is no rule base, or a number is itself an alias or carries an
        anchor.

    Examples
    --------
    >>> from fuzzytrack.fuzzy.loading import load_rulebase, loads_rulebase, rulebase_path
    >>> from fuzzytrack.fuzzy.numbers import with_numbers
    >>> text = rulebase_path("omega-schedule").read_text(encoding="utf-8")
    >>> dict(loads_rulebase(with_numbers(text, {("scheduler", "rho"): 0.8})).scheduler)["rho"]
    '0.8'
    """
    spans = NumberPlaces.of(text, file).spans
    changed = replaced(text, {spans[place]: number for place, number in numbers.items()})
    loads_rulebase(changed, file)
    return changed


def replaced(text: str, numbers: Mapping[Span, float]) -> str:
    """Text with numbers in place of some of its characters.

    Parameters
    ----------
    text : str
    numbers : mapping of Span to float
        Spans out of `NumberPlaces`.
    """
    for (start, end), number in sorted(numbers.items(), reverse=True):
        text = text[:start] + written(number) + text[end:]
    return text
