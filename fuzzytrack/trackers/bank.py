"""A bank of fixed α-β filters in parallel, averaged or selected by their innovations."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.gains import design
from fuzzytrack.gains.checks import finite
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.start import single_axis_step
from fuzzytrack.trackers.base import trackers
from fuzzytrack.trackers.lane_tracker import LaneTracker, check_missed
from fuzzytrack.trackers.state import TrackState

__all__ = ["SELECTIONS", "ParallelBank"]

SELECTIONS = ("soft", "best", "last", "hindsight")

#: Bound of the scores, so that the difference of two is never NaN.
_WORST = 1e300


@trackers.register("bank")
@dataclass(frozen=True, repr=False)
class ParallelBank(LaneTracker):
    """Fixed α-β filters in parallel on each axis: method M5 of Al-Wagih & Abdulla, and causal ones.

    The α of the members lie evenly from `lowest` to `highest`, with β = α²/(2 - α). Each member
    keeps a recursion of its own, and is scored by its innovations e; a low score J is good.

    Parameters
    ----------
    lowest, highest : float
        Position gains of the first and the last member, 0 < lowest <= highest < 4 - 2√2 = 1.1716.
    members : int
        Number of filters, at least 1.
    selection : {"soft", "best", "last", "hindsight"}
        ``soft`` averages the members with weights exp(-J/2), J = forget·J + e²/(2σ²); it needs the
        standard deviation of the plots. ``best`` takes the member with the least J = forget·J + e².
        ``last`` takes the one that predicted the last plot best. ``hindsight`` takes, as published,
        the one whose prediction is nearest to the plot that it predicts: so it is not causal, can
        only `run`, and its innovations are no measure of its errors.
    forget : float
        Factor of the old score at each plot, 0 <= forget <= 1; ``last`` and ``hindsight`` do not
        use it.
    missed : {"elapsed", "step"}
        As for `fuzzytrack.AlphaBetaTracker`.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    Al-Wagih & Abdulla, M5, Algorithm 3. The authors give no gains; ten from 0.1 to 0.999 are a
    reading that fits their tables. All members start from the first two plots, with a score of 0;
    of members with equal scores the one with the lowest α is taken. Position, velocity and gains
    come from the scores after the plot, so that the next prediction is x + v·T, as in other
    trackers. A missed plot does not change the scores.

    Examples
    --------
    >>> from fuzzytrack.trackers.bank import ParallelBank
    >>> bank = ParallelBank(0.2, 0.8, members=2, selection="best")
    >>> bank.run([0, 1, 2, 3, 4], [0, 10, 19, 31, 40]).gains.alpha
    array([nan, nan, 0.2, 0.2, 0.2])
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M5, Algorithm 3"

    lowest: float = 0.1
    highest: float = 0.999
    members: int = 10
    selection: str = "soft"
    forget: float = 0.9
    missed: str = "elapsed"

    def __post_init__(self) -> None:
        check_missed(self.missed)
        lowest, highest = (
            float(finite("lowest", self.lowest)),
            float(finite("highest", self.highest)),
        )
        bound = 4 - math.sqrt(8)
        if not 0 < lowest < bound:
            raise ValueError(f"lowest must be > 0 and < 4 - 2 sqrt(2) = 1.17157, got {lowest:g}")
        if not lowest <= highest < bound:
            raise ValueError(
                f"highest must be >= lowest = {lowest:g} and < 4 - 2 sqrt(2) = 1.17157, "
                f"got {highest:g}"
            )
        members = operator.index(self.members)
        if members < 1:
            raise ValueError(f"members must be at least 1, got {members}")
        if self.selection not in SELECTIONS:
            raise ValueError(
                f"selection: unknown {self.selection!r}; one of {', '.join(SELECTIONS)}"
            )
        forget = float(finite("forget", self.forget))
        if not 0 <= forget <= 1:
            raise ValueError(f"forget must be from 0 to 1, got {forget:g}")
        object.__setattr__(self, "lowest", lowest)
        object.__setattr__(self, "highest", highest)
        object.__setattr__(self, "members", members)
        object.__setattr__(self, "forget", forget)

    @property
    def causal(self) -> bool:
        """Whether a prediction is made without the plot that it predicts."""
        return self.selection != "hindsight"

    uses_acceleration = False

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: only where members are averaged."""
        return self.selection == "soft"

    @property
    def gains(self) -> tuple[tuple[float, float], ...]:
        """α and β of the members."""
        alphas = np.linspace(self.lowest, self.highest, self.members)
        return tuple(zip(alphas.tolist(), design.benedict_bordner(alphas).tolist(), strict=True))

    def program(self, n_axes: int) -> LaneProgram:
        """The members' recursions and their selection; see `LaneTracker.program`."""
        rows = Rows(n_axes, 3 * self.members)
        return LaneProgram(rows, (0.0,) * rows.n_memory, lambda stride: _step(self, rows, stride))

    def start(self, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None) -> TrackState:
        """State of a new track; see `LaneTracker.start`.

        Raises
        ------
        ValueError
            If the selection is not causal.
        """
        self._check_causal()
        return super().start(z, t, sigma)

    def step(
        self, state: TrackState, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> TrackState:
        """State after one more plot; see `LaneTracker.step`.

        Raises
        ------
        DataError, ValueError
            As there, and if the selection is not causal.
        """
        self._check_causal()
        return super().step(state, z, t, sigma)

    def _check_causal(self) -> None:
        if not self.causal:
            raise ValueError(
                "selection: 'hindsight' chooses its prediction by the plot that it predicts, so it "
                "cannot track plot by plot; use run, or another selection"
            )


def _step(bank: ParallelBank, rows: Rows, stride: int) -> Callable[[Any, int], None]:
    """Function that does one time step of the first lanes, single axes, of a buffer, in place.

    The memory holds position, velocity and score of the members, one after another.
    """
    advance = _members(bank, rows, stride)
    choose = (_mixture if bank.selection == "soft" else _best)(bank, rows, stride)
    hindsight = not bank.causal

    def correct(
        b: Any, i: int, z: float, prediction: float, v: float, dt: float, gap: float, sigma: float,
        update: bool, starts: bool,
    ) -> tuple[float, float, float, float, float]:  # fmt: skip
        least, nearest = advance(b, i, z, v, dt, sigma, update, starts)
        x_chosen, v_chosen, alpha, beta = choose(b, i, least)
        prediction = nearest if update & hindsight else prediction
        return prediction, x_chosen, v_chosen if update else v, alpha, beta

    return single_axis_step(rows, stride, correct)


def _members(bank: ParallelBank, rows: Rows, stride: int) -> Callable[..., tuple[float, float]]:
    """Function that takes the members a step on; the least score, and its member's prediction."""
    gains, count = bank.gains, bank.members
    alphas, betas = tuple(alpha for alpha, _ in gains), tuple(beta for _, beta in gains)
    scaled = bank.needs_sigma
    forget = bank.forget if bank.selection in ("soft", "best") else 0.0
    x_row, v_row, score_row = rows.memory, rows.memory + count, rows.memory + 2 * count
    worst, infinity = _WORST, math.inf

    def members(
        b: Any, i: int, z: float, v_first: float, dt: float, sigma: float, update: bool,
        starts: bool,
    ) -> tuple[float, float]:  # fmt: skip
        least, nearest, rate = infinity, 0.0, 1.0 / dt
        for m in range(count):
            v = b[(v_row + m) * stride + i]
            score = b[(score_row + m) * stride + i]
            prediction = b[(x_row + m) * stride + i] + v * dt
            e = z - prediction if update else 0.0
            added = 0.5 * (e / sigma) * (e / sigma) if scaled else e * e
            score = forget * score + added if update else score
            score = score if score < worst else worst
            x = prediction + alphas[m] * e
            b[(x_row + m) * stride + i] = z if starts else x
            b[(v_row + m) * stride + i] = v_first if starts else v + (betas[m] * rate) * e
            b[(score_row + m) * stride + i] = score
            nearest = prediction if score < least else nearest
            least = score if score < least else least
        return least, nearest

    return members


def _mixture(bank: ParallelBank, rows: Rows, stride: int) -> Callable[..., Any]:
    """Function that averages position, velocity, α and β of the members by their scores."""
    gains, count = bank.gains, bank.members
    alphas, betas = tuple(alpha for alpha, _ in gains), tuple(beta for _, beta in gains)
    x_row, v_row, score_row = rows.memory, rows.memory + count, rows.memory + 2 * count

    def mixture(b: Any, i: int, least: float) -> tuple[float, float, float, float]:
        total, x, v, alpha, beta = 0.0, 0.0, 0.0, 0.0, 0.0
        for m in range(count):
            weight = math.exp(0.5 * (least - b[(score_row + m) * stride + i]))
            total = total + weight
            x = x + weight * b[(x_row + m) * stride + i]
            v = v + weight * b[(v_row + m) * stride + i]
            alpha = alpha + weight * alphas[m]
            beta = beta + weight * betas[m]
        return x / total, v / total, alpha / total, beta / total

    return mixture


def _best(bank: ParallelBank, rows: Rows, stride: int) -> Callable[..., Any]:
    """Function that takes position, velocity, α and β of the first member with the least score."""
    gains, count = bank.gains, bank.members
    alphas, betas = tuple(alpha for alpha, _ in gains), tuple(beta for _, beta in gains)
    x_row, v_row, score_row = rows.memory, rows.memory + count, rows.memory + 2 * count

    def best(b: Any, i: int, least: float) -> tuple[float, float, float, float]:
        x, v, alpha, beta = 0.0, 0.0, 0.0, 0.0
        # Backwards, so that the first of equal ones is left.
        for m in range(count - 1, -1, -1):
            chosen = b[(score_row + m) * stride + i] == least
            x = b[(x_row + m) * stride + i] if chosen else x
            v = b[(v_row + m) * stride + i] if chosen else v
            alpha = alphas[m] if chosen else alpha
            beta = betas[m] if chosen else beta
        return x, v, alpha, beta

    return best
