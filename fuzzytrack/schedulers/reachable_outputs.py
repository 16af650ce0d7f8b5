"""Values that the outputs of a rule base can have."""

from __future__ import annotations

from itertools import product

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import RuleBase

__all__ = ["REACHES", "output_values"]

REACHES = ("universe", "rules")
#: Values of each output of which counter-examples are made; the limits are two of them.
_TRIED = 5


def output_values(rules: RuleBase, names: tuple[str, ...], reach: str) -> tuple[Array, Array]:
    """Values that enclose those some outputs of a rule base can have, and some that they do have.

    Parameters
    ----------
    rules : RuleBase
    names : tuple of str
        The outputs.
    reach : {"universe", "rules"}
        ``universe``: anything in the universes of the outputs. ``rules``: what the single rules
        conclude, and the defaults if there are inputs at which no rule fires.

    Returns
    -------
    around : ndarray, shape (n, k)
        All values are in their convex hull; columns in the order of `names`.
    reached : ndarray, shape (m, k)

    Raises
    ------
    RuleBaseError
        If ``rules`` is not valid for the algebra.
    ValueError
        If `reach` is unknown.
    """
    if reach not in REACHES:
        raise ValueError(f"reach: unknown {reach!r}; one of {', '.join(REACHES)}")
    if reach == "rules":
        concluded = _rule_conclusions(rules, names)
        return concluded, concluded
    values = [_values(rules, name) for name in names]
    around = np.array(list(product(*((min(v), max(v)) for v in values))))
    return around, np.array(list(product(*values)))


def _values(rules: RuleBase, name: str) -> tuple[float, ...]:
    """Values of an output: a few in its universe, its limits among them; its default if used."""
    output = rules.output(name)
    if output.is_linear:
        raise RuleBaseError(
            f"{rules.name}: {name} has linear sets, whose values have no bounds; what its rules "
            "reach cannot be certified"
        )
    inside = tuple(np.linspace(output.universe.low, output.universe.high, _TRIED).tolist())
    if output.default is None or find_hole(rules, name) is None:
        return inside
    return (*inside, output.default)


def _rule_conclusions(rules: RuleBase, names: tuple[str, ...]) -> Array:
    """What each rule concludes about the outputs, shape (n_rules, n_outputs)."""
    algebras = {rules.operators_of(rules.output(name)) for name in names}
    if algebras != {Operators("product", "sum", "weighted-centers")}:
        algebra = dict.fromkeys(word for o in algebras for word in o.words().values())
        raise RuleBaseError(
            "reach 'rules' needs product, sum and weighted-centers, where every output is a mean "
            f"of what the rules conclude; {rules.name} has {', '.join(algebra)}: "
            "use reach 'universe'"
        )
    linear = [name for name in names if rules.output(name).is_linear]
    if linear:
        raise RuleBaseError(f"reach 'rules' needs sets with centers; {linear[0]} has linear ones")
    rows = []
    for rule in rules.rules:
        totals, row = [], []
        for name in names:
            output = rules.output(name)
            centers = dict(zip(output.set_names, output.centers().tolist(), strict=True))
            shares = [
                (c.confidence, centers[c.set_name]) for c in rule.consequents if c.output == name
            ]
            total = sum(share for share, _ in shares)
            totals.append(total)
            row.append(sum(share * center for share, center in shares) / total if total else 0.0)
        if abs(totals[0] - totals[-1]) > 1e-12:
            raise RuleBaseError(
                f"reach 'rules' needs rules with the same confidence for {names[0]} and "
                f"{names[-1]}, got: {rule}"
            )
        if totals[0] > 0:
            rows.append(row)
    # Each rule concludes about all of the outputs or none: they are silent at the same inputs.
    defaults = [rules.output(name).default for name in names]
    if None not in defaults and find_hole(rules, names[0]) is not None:
        rows.append([float(d) for d in defaults if d is not None])
    return np.array(rows)
