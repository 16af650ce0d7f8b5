"""The discrete relational matrix and its composition (Llinas et al. 1998, Eqs. 3.3 to 3.9)."""

from __future__ import annotations

from functools import reduce

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.inference import conjoin, disjoin, output_grid
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS
from fuzzytrack.fuzzy.rulebase import Conditions, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Variable

__all__ = ["MAX_ELEMENTS", "compose", "relation"]


MAX_ELEMENTS = 100_000_000


def relation(rulebase: RuleBase, output: Variable) -> Array:
    """Relational matrix of one output, rule by rule as the report defines it.

    Returns
    -------
    ndarray, shape (points of input 1, ..., points of input m, points of the output)
        μ_R(x, y) of Eq. 3.5. With weighted centers the last axis runs over the output's sets.

    Raises
    ------
    ValueError
        If the matrix would hold more than `MAX_ELEMENTS` elements.
    """
    operators = rulebase.operators_of(output)
    y, output_grades = output_grid(operators, output)
    shape = (*(v.universe.points for v in rulebase.inputs), len(y))
    if np.prod([float(n) for n in shape]) > MAX_ELEMENTS:
        raise ValueError(
            f"relation of {output.name}: {' x '.join(map(str, shape))} elements are more than "
            f"{MAX_ELEMENTS}; use coarser universes or method='exact'"
        )
    matrix = np.zeros(shape)
    for rule in rulebase.rules:
        antecedent = _antecedent(rulebase, rule)
        for consequent in rule.consequents:
            if consequent.output != output.name:
                continue
            grades = output_grades[output.index(consequent.set_name)]
            # μ_r(x, y) = μ_A(x) and μ_B(y) and c (Eq. 3.3)
            sure = np.asarray(consequent.confidence)
            level = T_NORMS[operators.weighing].values(antecedent[..., None], sure)
            member = T_NORMS[operators.implying].values(level, grades)
            matrix = S_NORMS[operators.disjunction].values(matrix, member)
    return matrix


def _antecedent(rulebase: RuleBase, rule: Rule) -> Array:
    """μ_A of one rule over the grid of all inputs (Eq. 3.4); inputs not named keep length 1."""
    either = S_NORMS[rulebase.operators.alternatives].values
    return reduce(either, (_joint(rulebase, group) for group in rule.groups))


def _joint(rulebase: RuleBase, conditions: Conditions) -> Array:
    """Grade of conditions that hold together, over the grid of all inputs."""
    terms = dict(conditions)
    rows = []
    for axis, variable in enumerate(rulebase.inputs):
        if variable.name in terms:
            shape = [1] * len(rulebase.inputs)
            shape[axis] = -1
            grades = variable.memberships()[variable.index(terms[variable.name])]
            rows.append(grades.reshape(shape))
    return reduce(T_NORMS[rulebase.operators.conjunction].values, rows)


def compose(rulebase: RuleBase, matrix: Array, fuzzy_inputs: list[Array]) -> Array:
    """Compositional rule of inference (Eq. 3.8): fuzzy inputs through the relation.

    Parameters
    ----------
    rulebase : RuleBase
        Its AND and OR are the composition's: sum-product or max-min, or a mixture.
    matrix : ndarray
        From `relation`.
    fuzzy_inputs : list of ndarray
        For each input its membership on the grid, shape (points,).

    Returns
    -------
    ndarray, shape (points of the output,)
    """
    joint: Array = np.ones((1,) * len(fuzzy_inputs))
    for axis, grades in enumerate(fuzzy_inputs):
        shape = [1] * len(fuzzy_inputs)
        shape[axis] = -1
        joint = conjoin(rulebase.operators, joint, grades.reshape(shape))
    member = conjoin(rulebase.operators, matrix, joint[..., None])
    return disjoin(rulebase.operators, member, tuple(range(len(fuzzy_inputs))))
