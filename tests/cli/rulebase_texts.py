"""Texts of rule bases on which commands are tried."""

LIST = """\
rulebase: 1
name: three
inputs:
  a: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
  b: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
  c: {universe: [0, 1, 11], sets: {lo: {trimf: [0, 0, 1]}, hi: {trimf: [0, 1, 1]}}}
outputs:
  out: {universe: {low: 0, high: 2, points: 21, grid: midpoints}, unit: m, default: 0.5,
        sets: {small: {trimf: [0, 0, 1]}, large: {trimf: [1, 2, 2]}}}
operators: {and: product, or: sum, defuzzification: centroid}
rules:
  - {if: {a: lo}, then: {out: small}}
  - {if: {a: hi, b: hi}, then: {out: [small@0.3, large@0.7]}}
"""


ODD = """\
rulebase: 1
name: odd
inputs:
  x: {universe: [-1, 1, 21], sets: {n: {trimf: [-1, -1, 1]}, p: {trimf: [-1, 1, 1]}}}
outputs:
  u: {universe: [-1, 1, 21], sets: {n: {trimf: [-1, -1, 1]}, p: {trimf: [-1, 1, 1]}}}
  w: {universe: [-1, 1, 21], sets: {n: {trimf: [-1, -1, 1]}, p: {trimf: [-1, 1, 1]}}}
operators: {and: product, or: sum, defuzzification: weighted-centers}
rules:
  - {if: {x: n}, then: {u: n, w: n}}
  - {if: {x: p}, then: {u: p, w: n}}
"""
