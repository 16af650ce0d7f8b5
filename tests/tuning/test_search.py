import math

import numpy as np

from fuzzytrack.tuning.parameters import Parameter, Space
from fuzzytrack.tuning.search import Search

SPACE = Space(
    (
        Parameter("size", 1.0, 1e-3, 1e3),
        Parameter("share", 0.5, 0.0, 1.0, "probability"),
        Parameter("place", 0.0, -4.0, 6.0, "linear"),
    )
)
BEST = (20.0, 0.9, 3.0)


def loss(numbers):
    size, share, place = numbers
    # A valley that is not along the axes.
    bent = math.log(size / 20) + 0.5 * (place - 3)
    return bent**2 + 4 * (share - 0.9) ** 2 + 0.3 * (place - 3) ** 2


def run(search, least=math.inf):
    while not search.finished and len(search.losses) < least:
        search.tell([loss(numbers) for numbers in search.ask()])
    return search


def test_the_optimum_is_found():
    search = run(Search(SPACE, seed=3, trials=600))
    np.testing.assert_allclose(search.best, BEST, rtol=0.02)
    assert search.best_loss == loss(search.best) < 1e-3
    assert len(search.losses) <= 600 + 20


def test_it_begins_at_the_start_and_is_never_worse():
    search = Search(SPACE, seed=0, trials=8)
    assert search.ask()[0] == SPACE.start == (1.0, 0.5, 0.0)
    search.tell([0.0, *(1.0 for _ in search.ask()[1:])])
    assert search.best == SPACE.start
    assert search.finished


def test_what_is_told_again_continues_where_it_was():
    whole = run(Search(SPACE, seed=5, trials=60))
    begun = run(Search(SPACE, seed=5, trials=60), least=30)
    continued = Search(SPACE, seed=5, trials=60)
    # The last generation was interrupted: it is tried again.
    continued.replay([*begun.losses, *whole.losses[len(begun.losses) :][:2]])
    assert continued.losses == begun.losses
    assert continued.ask() == begun.ask()
    assert run(continued).losses == whole.losses
    assert continued.best == whole.best
    assert run(Search(SPACE, seed=6, trials=60)).losses != whole.losses
