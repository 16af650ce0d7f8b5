import math

import pytest

from fuzzytrack.tuning import rank

NONE = {"fixed α-β, published": {}}
FIXED = dict.fromkeys(("report", "mixed", "strong", "all"), (0.5, 0.4))


def test_ranks_put_the_best_first():
    shares = []
    found = rank({**NONE, "fixed α-β": FIXED}, tracks=4, seed=1, progress=shares.append)
    assert [each.name for each in found] == ["fixed α-β", "fixed α-β, published"]
    assert shares == [0.5, 1.0]
    tuned, published = found
    assert (tuned.own_change, tuned.single_change, tuned.single_error) == (0.0, 0.0, 0.0)
    ratios = [published.single[name] / tuned.single[name] for name in ("report", "mixed", "strong")]
    assert published.single_change == pytest.approx(math.prod(ratios) ** (1 / 3) - 1)
    assert published.own == published.single
    assert published.single_error > 0


@pytest.mark.parametrize("tuned", [{**NONE, "fixd": FIXED}, NONE])
def test_unknown_families_are_named(tuned):
    with pytest.raises(ValueError, match=r"tuned: needs families out of .*; got 'fix"):
        rank(tuned, tracks=2, seed=1)
