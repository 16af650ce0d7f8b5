"""Rule bases with some of their numbers free: levels of outputs, sets, scheduler settings."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.numbers import NumberPlaces, Place, Span, replaced
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.schedulers.settings import KEYS
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import tracker_of_rules
from fuzzytrack.tuning.candidates import Candidates, Choice, chosen
from fuzzytrack.tuning.parameters import Numbers, Parameter, Space

__all__ = ["RuleBaseNumbers", "rulebase_numbers"]

# Parameters of shapes that are places on the axis; in shapes that are not listed, all are.
_PLACES = {
    "gaussmf": (0,), "gauss2mf": (0, 2), "gbellmf": (2,), "sigmf": (0,), "dsigmf": (0, 2),
    "psigmf": (0, 2), "cosine": (0,), "spike": (0,),
}  # fmt: skip
# Shapes of any number of parameters, which stay as they are.
_FIXED = ("discrete", LINEAR)
# Scheduler settings that are shares, from 0 to 1; others are positive.
_SHARES = frozenset({"rho"})
# A positive number may become so many times smaller or larger.
_FACTOR = 30.0
# A corner keeps this part of the universe's width away from its ends.
_MARGIN = 1e-4


@dataclass(frozen=True)
class RuleBaseNumbers(Candidates):
    """Trackers with a rule base, some of whose numbers are free.

    Attributes
    ----------
    rules_text : str
        The rule base in YAML; only its numbers are changed.
    options : tuple of (str, str)
        Parameters of scheduler and tracker, as in a specification.
    places : tuple
        For each free number the characters where it is in the text, with its sign there.
    """

    rules_text: str
    options: tuple[tuple[str, str], ...]
    places: tuple[tuple[tuple[Span, float], ...], ...]

    def text(self, numbers: Numbers) -> str:
        """See `Candidates.text`."""
        changes = {
            span: sign * number
            for number, places in zip(numbers, self.places, strict=True)
            for span, sign in places
        }
        return replaced(self.rules_text, changes)

    def tracker(self, numbers: Numbers) -> Tracker:
        """See `Candidates.tracker`."""
        return tracker_of_rules(loads_rulebase(self.text(numbers), self.title), dict(self.options))

    def restricted(self, kept: Sequence[int]) -> RuleBaseNumbers:
        """See `Candidates.restricted`."""
        places = tuple(self.places[k] for k in kept)
        return replace(self, space=self.space.restricted(kept), places=places)


def rulebase_numbers(
    text: str, title: str, options: dict[str, str], free: Collection[str] | None
) -> RuleBaseNumbers:
    """Trackers with a rule base, some of whose numbers are free.

    Parameters
    ----------
    text : str
        The rule base in YAML.
    title : str
        Its name or file.
    options : dict of str to str
        Parameters of scheduler and tracker, as in a specification.
    free : collection of str or None
        Which numbers are free, see the notes; all unless given.

    Raises
    ------
    RuleBaseError
        If the text is no rule base that schedules gains.
    ValueError
        If there is no such number, or nothing is free; lists what is allowed.

    Notes
    -----
    ``outputs`` are the levels of all outputs, ``sets`` the corners of all sets of inputs,
    ``normalization`` the numbers of the scheduler settings; ``stiffness`` or ``lag`` is one
    variable, ``lag.ps`` one of its sets, and ``rho`` one setting.

    Sets that share a corner go on sharing it, and corners keep their order. Sets that lie
    symmetrically about 0 stay so. An end of a universe moves if a set has its peak there.
    """
    rules = loads_rulebase(text, title)
    numbers = NumberPlaces.of(text, title)
    found: list[_Found] = []
    rising: list[list[int]] = []
    for group in _by_sets(rules, numbers):
        corners = list(_corners(group, numbers))
        rising.append([*range(len(found), len(found) + len(corners))])
        found += corners
        found += _widths(group, numbers)
    found += _settings(numbers)
    picked = chosen([each.choice for each in found], free, f"rule base {title!r}")
    every = Space(
        tuple(each.choice.parameter for each in found),
        tuple(tuple(group) for group in rising),
    )
    places = tuple(
        tuple((numbers.spans[place], sign) for place, sign in each.places) for each in found
    )
    whole = RuleBaseNumbers(title, every, text, tuple(options.items()), places)
    return whole.restricted(picked)


@dataclass(frozen=True)
class _Found:
    """A number that can be free, with its places in the text."""

    choice: Choice
    places: tuple[tuple[Place, float], ...]


@dataclass(frozen=True)
class _Group:
    """Variables that share their sets: one, unless an alias repeats them."""

    part: str
    variables: tuple[Variable, ...]

    @property
    def word(self) -> str:
        return "outputs" if self.part == "outputs" else "sets"

    def words(self, sets: Collection[str]) -> frozenset[str]:
        """Words that choose a number of some sets."""
        names = [v.name for v in self.variables]
        return frozenset({self.word, *names, *(f"{n}.{s}" for n in names for s in sets)})

    def place(self, fuzzy_set: FuzzySet, index: int) -> Place:
        return (self.part, self.variables[0].name, "sets", fuzzy_set.name, fuzzy_set.shape, index)


def _by_sets(rules: RuleBase, numbers: NumberPlaces) -> Iterator[_Group]:
    for part, variables in (("outputs", rules.outputs), ("inputs", rules.inputs)):
        by_span: dict[tuple[int, int], list[Variable]] = {}
        for variable in variables:
            first = variable.sets[0]
            place = (part, variable.name, "sets", first.name, first.shape, 0)
            by_span.setdefault(numbers.spans[place], []).append(variable)
        for same in by_span.values():
            yield _Group(part, tuple(same))


def _corners(group: _Group, numbers: NumberPlaces) -> Iterator[_Found]:
    """Places on the axis where sets have a corner, each once, in rising order."""
    low = min(v.universe.low for v in group.variables)
    high = max(v.universe.high for v in group.variables)
    sets = [s for s in group.variables[0].sets if s.base not in _FIXED]
    at: dict[float, list[tuple[FuzzySet, int]]] = {}
    for fuzzy_set in sets:
        for index in _PLACES.get(fuzzy_set.base, range(len(fuzzy_set.parameters))):
            at.setdefault(fuzzy_set.parameters[index], []).append((fuzzy_set, index))
    # A universe of magnitudes goes on beginning at 0.
    ends = {end for end in (low, high) if end != 0.0}
    moving = {end for end in ends if any(s.core(low, high) == (end, end) for s in sets)}
    free = [x for x in sorted(at) if low < x < high or x in moving]
    # Symmetric sets stay symmetric: the corners on the right decide.
    mirrored = len(free) > 1 and all(
        abs(a + b) < 1e-12 for a, b in zip(free, free[::-1], strict=True)
    )
    values = [x for x in free if x > 0] if mirrored else free
    positive = bool(values) and values[0] > 0 and (mirrored or low >= 0)
    for value in values:
        members = [(s, index, 1.0) for s, index in at[value]]
        if mirrored:
            twin = min(at, key=lambda x: abs(x + value))
            members += [(s, index, -1.0) for s, index in at[twin]]
        places = [(group.place(s, index), sign) for s, index, sign in members]
        places += _ends(group, value, 1.0, numbers)
        places += _ends(group, -value, -1.0, numbers) if mirrored else []
        name = _corner_name(group, value, at[value], free)
        words = group.words({s.name for s, _, _ in members})
        margin = _MARGIN * (high - low)
        least, most = (low + margin, high - margin)
        if moving:
            least, most = low - (high - low), high + (high - low)
        if positive:
            least = max(value / _FACTOR, least)
            most = value * _FACTOR if moving else min(value * _FACTOR, most)
        scale = "log" if positive else "linear"
        parameter = Parameter(name, value, min(least, value), max(most, value), scale)
        yield _Found(Choice(parameter, words), tuple(places))


def _ends(
    group: _Group, value: float, sign: float, numbers: NumberPlaces
) -> list[tuple[Place, float]]:
    """Ends of universes that move with a corner."""
    found: list[tuple[Place, float]] = []
    for variable in group.variables:
        base = (group.part, variable.name, "universe")
        for end, keys in (
            (variable.universe.low, (0, "low")),
            (variable.universe.high, (1, "high")),
        ):
            if end == value:
                found += [((*base, key), sign) for key in keys if (*base, key) in numbers.spans]
    return found


def _corner_name(
    group: _Group, value: float, members: list[tuple[FuzzySet, int]], free: list[float]
) -> str:
    """``lag.ps`` for the only corner of the core of a set; else with the name of the parameter."""
    variable = group.variables[0].name
    for fuzzy_set, _ in members:
        core = SHAPES[fuzzy_set.shape].core(fuzzy_set.parameters)
        if value in core and len({x for x in core if x in free}) == 1:
            return f"{variable}.{fuzzy_set.name}"
    fuzzy_set, index = members[0]
    return f"{variable}.{fuzzy_set.name}.{SHAPES[fuzzy_set.shape].parameters[index]}"


def _widths(group: _Group, numbers: NumberPlaces) -> Iterator[_Found]:
    """Widths and slopes of sets, which have no place on the axis."""
    for fuzzy_set in group.variables[0].sets:
        if fuzzy_set.base in _FIXED:
            continue
        names = SHAPES[fuzzy_set.shape].parameters
        for index in range(len(names)):
            if index in _PLACES.get(fuzzy_set.base, range(len(names))):
                continue
            value = fuzzy_set.parameters[index]
            name = f"{group.variables[0].name}.{fuzzy_set.name}.{names[index]}"
            size = abs(value)
            parameter = Parameter(name, size, size / _FACTOR, size * _FACTOR)
            places = ((group.place(fuzzy_set, index), 1.0 if value > 0 else -1.0),)
            yield _Found(Choice(parameter, group.words({fuzzy_set.name})), places)


def _settings(numbers: NumberPlaces) -> Iterator[_Found]:
    """Numbers of the scheduler settings."""
    for place, value in numbers.values.items():
        name = str(place[-1])
        # Words, and the period to which gains belong, are no numbers of the normalization.
        if place[0] != "scheduler" or name in KEYS or not value > 0:
            continue
        if name in _SHARES:
            parameter = Parameter(name, value, 0.0, 1.0, "probability")
        else:
            parameter = Parameter(name, value, value / _FACTOR, value * _FACTOR)
        yield _Found(Choice(parameter, frozenset({"normalization"})), ((place, 1.0),))
