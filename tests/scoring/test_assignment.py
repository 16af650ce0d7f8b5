"""The best assignment among possible pairs, against every way to choose."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.scoring.assignment import best_assignment


def by_brute_force(left, right, gain):
    best = 0.0
    numbers = range(len(gain))
    for size in range(1, len(gain) + 1):
        for chosen in combinations(numbers, size):
            mine, yours = {left[k] for k in chosen}, {right[k] for k in chosen}
            if len(mine) == len(yours) == size:
                best = max(best, sum(gain[k] for k in chosen))
    return best


@given(
    st.dictionaries(st.tuples(st.integers(0, 3), st.integers(0, 3)), st.integers(-3, 9), max_size=9)
)
def test_greatest_sum(table):
    left = np.array([pair[0] for pair in table], dtype=np.int64)
    right = np.array([pair[1] for pair in table], dtype=np.int64)
    gain = np.array(list(table.values()), dtype=float)
    chosen = best_assignment(left, right, gain)
    assert list(chosen) == sorted(chosen)
    assert len(set(left[chosen])) == len(set(right[chosen])) == len(chosen)
    assert (gain[chosen] > 0).all()
    assert gain[chosen].sum() == pytest.approx(by_brute_force(left, right, gain))


def test_nothing_is_chosen_from_nothing():
    none = np.empty(0, dtype=np.int64)
    assert len(best_assignment(none, none, np.empty(0))) == 0
    assert len(best_assignment(np.array([0]), np.array([0]), np.array([0.0]))) == 0


def test_problems_at_once_are_solved_each():
    rng = np.random.default_rng(3)
    tables = [rng.uniform(0.1, 1, (4, 5)) for _ in range(6)]
    rows, columns = np.indices((4, 5)).reshape(2, -1)
    left = np.concatenate([rows + 4 * k for k in range(6)])
    right = np.concatenate([columns + 5 * k for k in range(6)])
    gain = np.concatenate([table.ravel() for table in tables])
    together = best_assignment(left, right, gain)
    alone = [
        best_assignment(rows, columns, table.ravel()) + 20 * k for k, table in enumerate(tables)
    ]
    assert together.tolist() == np.concatenate(alone).tolist()
