"""Rule bases as texts, and how they are refused."""

import pytest

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase

TABLE = """\
rulebase: 1
name: small
inputs:
  E:
    label: error
    unit: m
    universe: [0, 1, 11]
    sets:
      lo: {trimf: [0, 0, 1]}
      hi: {trimf: [0, 1, 1]}
  dE:
    universe: {low: -1, high: 1, points: 20, grid: midpoints}
    sets:
      ne: {trapmf: [-1, -1, -0.5, 0]}
      ze: {trimf: [-0.5, 0, 0.5]}
      po: {trapmf: [0, 0.5, 1, 1]}
outputs:
  power: {universe: [0, 2, 21], sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}}
  grip:  {universe: [0, 2, 21], sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}}
operators: {and: product, or: sum, defuzzification: centroid}
rules:
  columns: E
  rows: dE
  cells: [power, grip]
  table:
    #    lo   hi
    ne: [S-S, S-L]
    ze: [S-S, L-L@0.5]
    po: [L-S, [S-L@0.5, L-L@0.5]]
scheduler: {gains: direct}
"""

LIST = """\
rulebase: 1
name: list
inputs:
  E:
    universe: [0, 1, 11]
    sets:
      lo: {trimf: [0, 0, 1]}
      hi: {trimf: [0, 1, 1]}
  d:
    universe: [0, 1, 11]
    sets:
      lo: {trapmf: [0, 0, 0.2, 0.3]}
      hi: {trapmf: [0.7, 0.8, 1, 1]}
outputs:
  u:
    universe: [0, 2, 21]
    sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}
  v:
    universe: [0, 2, 21]
    default: 1.5
    sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}
operators: {and: min, or: max, defuzzification: mom}
rules:
  - {if: {E: lo}, then: {u: S}}
  - {if: {E: hi, d: lo}, then: {u: [S@0.25, L@0.75], v: L@0.5}}
  - {if any: {E: hi, d: hi}, then: {u: L}}
"""


def refusal(text, file="rules.yaml"):
    with pytest.raises(RuleBaseError) as caught:
        loads_rulebase(text, file)
    assert caught.value.location is not None
    assert str(caught.value).startswith(str(caught.value.location))
    return caught.value


def changed(text, old, new):
    assert text.count(old) == 1, old
    return text.replace(old, new)
