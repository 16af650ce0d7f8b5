import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains.singer import fade
from fuzzytrack.normalizations import Surprise

FULL = Surprise(time=5.0, clip=3.0, agreement_time=8.0)


def follow(normalization, innovations, steps, variances):
    """Signals of each update."""
    n_axes = len(innovations[0])
    kernel, memory = normalization.kernel(n_axes), normalization.initial_memory(n_axes)
    found = []
    for e, dt, s in zip(innovations, steps, variances, strict=True):
        # The change of observation is of no account.
        signals, memory = kernel(tuple(e), (math.nan,) * n_axes, dt, tuple(s), memory)
        found.append(signals)
    return np.array(found), memory


updates = st.integers(1, 3).flatmap(
    lambda n: st.lists(
        st.tuples(
            st.lists(st.floats(-50, 50), min_size=n, max_size=n),
            st.floats(1e-3, 100.0),
            st.lists(st.floats(0.01, 100.0), min_size=n, max_size=n),
        ),
        min_size=1,
        max_size=20,
    )
)


@given(updates)
def test_signals_are_sums_over_all_updates(given_updates):
    innovations, steps, variances = zip(*given_updates, strict=True)
    found, memory = follow(FULL, innovations, steps, variances)
    nu = np.array(innovations) / np.sqrt(np.array(variances))
    length = np.linalg.norm(nu, axis=1, keepdims=True)
    nu = nu * np.minimum(1.0, 3.0 / np.maximum(length, 1e-300))
    product = np.append(0.0, (nu[1:] * nu[:-1]).sum(axis=1))
    for k in range(len(steps)):
        # What is left at update k of what came in at update j.
        left, left_of_product = (
            [
                math.prod(fade(dt / time) for dt in steps[j + 1 : k + 1])
                * math.sqrt(1 - fade(steps[j] / time) ** 2)
                for j in range(k + 1)
            ]
            for time in (5.0, 8.0)
        )
        surprise = np.linalg.norm(np.array(left) @ nu[: k + 1])
        assert found[k, 0] == pytest.approx(surprise, rel=1e-9, abs=1e-9)
        agreement = np.array(left_of_product) @ product[: k + 1]
        assert found[k, 1] == pytest.approx(agreement, rel=1e-9, abs=1e-9)
    n_axes = nu.shape[1]
    assert memory[n_axes : 2 * n_axes] == pytest.approx(nu[-1], rel=1e-9, abs=1e-12)
    assert len(memory) == len(FULL.initial_memory(n_axes)) == 2 * n_axes + 1


def test_without_an_agreement_time_there_is_only_surprise():
    alone = Surprise(time=5.0, clip=3.0)
    assert alone.signals == ("surprise",)
    assert FULL.signals == ("surprise", "agreement of successive innovations")
    innovations = np.random.default_rng(2).normal(0, 3, (9, 2))
    steps, variances = np.linspace(0.1, 4.0, 9), np.full((9, 2), 2.0)
    found, memory = follow(alone, innovations, steps, variances)
    both, _ = follow(FULL, innovations, steps, variances)
    np.testing.assert_array_equal(found[:, 0], both[:, 0])
    assert len(memory) == 2


@pytest.mark.parametrize("steps", [[0.2], [8.0], [0.01, 1.0, 20.0]])
def test_white_innovations_look_alike_at_any_sampling(steps):
    random = np.random.default_rng(7)
    n = 20_000
    variances = random.uniform(0.5, 9.0, (n, 2))
    innovations = random.normal(size=(n, 2)) * np.sqrt(variances)
    found, _ = follow(Surprise(6.5, 1e9, 16.0), innovations, np.resize(steps, n), variances)
    late = found[2000:]
    # Sums of 18,000 that are correlated over up to 60 updates: about 5 % off.
    assert (late[:, 0] ** 2).mean() == pytest.approx(2.0, rel=0.2)
    assert (late[:, 1] ** 2).mean() == pytest.approx(2.0, rel=0.3)


def test_where_nothing_is_expected_nothing_surprises():
    (surprise, agreement), memory = FULL.kernel(2)(
        (1e6, -2.0), (0.0, 0.0), 1.0, (math.inf, math.inf), FULL.initial_memory(2)
    )
    assert (surprise, agreement) == (0.0, 0.0)
    assert memory == (0.0,) * 5


@pytest.mark.parametrize("name", ["time", "clip", "agreement_time"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan])
def test_numbers_are_checked(name, value):
    with pytest.raises(ValueError, match=f"{name} must be finite and > 0, got"):
        Surprise(**{name: value})
