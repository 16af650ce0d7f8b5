"""The base class of gain schedulers, and their registry."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

from fuzzytrack.kernels.language import Memory
from fuzzytrack.plugins import Registry
from fuzzytrack.reprs import constructor_code

__all__ = ["GainScheduler", "Kernel", "Memory", "schedulers"]

#: ``kernel(innovation, change, dt, sigma, memory) -> (alpha, beta, gamma, retention, memory)``; see
#: `GainScheduler.kernel`. Its first, second and fourth arguments are floats, or tuples of floats
#: for a coupled scheduler.
Kernel = Callable[[Any, Any, float, Any, Memory], tuple[float, float, float, float, Memory]]


class GainScheduler(ABC):
    """Chooses the gains of a tracker, update by update.

    A scheduler is immutable and shared between tracks. Its memory of a track is in the track's
    state: a tuple of floats that its kernel takes and returns. It must pickle.

    Attributes
    ----------
    source : str
        Paper, or other origin.
    coupled : bool
        Whether the kernel gets all axes of a track at once and returns one set of gains for them.
    own_gains : bool
        Whether the kernel of a coupled scheduler returns α, β and γ as tuples, with the gains of
        each axis.
    needs_sigma : bool
        Whether the kernel reads the standard deviation of the plot.
    sees_starts : bool
        Whether the kernel also follows the first plots of a track, which need no gains; see
        `kernel`.
    sees_misses : bool
        Whether it also follows steps without a plot, to count them; see `kernel`.
    uses_acceleration : bool
        Whether gamma can be other than 0. Without acceleration a tracker is faster.
    uses_retention : bool
        Whether the fourth number of the kernel's answer is a retention time; see `kernel`. It needs
        `uses_acceleration`.
    may_be_unstable : bool
        Whether the gains for a plot may lie outside of the stability region, on purpose;
        `fuzzytrack.testing.check_scheduler` then does not check it.
    sigma_w : float or None
        Standard deviation of all plots (m), if the scheduler has one.
    variance_start : str or None
        Start of a track, ``two-point`` or ``one-point``, after which `prediction_variance` holds;
        None for both. After another one, predictions have no variance.
    """

    source: ClassVar[str] = ""
    coupled: bool = False
    own_gains: bool = False
    needs_sigma: bool = False
    sees_starts: bool = False
    sees_misses: bool = False
    uses_acceleration: bool = True
    uses_retention: bool = False
    may_be_unstable: bool = False
    sigma_w: float | None = None
    variance_start: str | None = None

    @abstractmethod
    def kernel(self, n_axes: int) -> Kernel:
        """The scheduler's arithmetic, as one scalar function.

        The function is called with

        - ``innovation``: plot minus prediction (m);
        - ``change``: plot minus the previous plot that was seen (m);
        - ``dt``: time since the last plot (s), positive, or with ``missed="step"`` of the tracker
          the time since the last step;
        - ``sigma``: standard deviation of the plot (m); NaN where none was given;
        - ``memory``: tuple of floats, first the one of `initial_memory`;

        and returns ``(alpha, beta, gamma, retention, memory)``: the gains for this plot, the
        retention time, and the new memory, of the same length. The velocity gain is β/dt. Gamma is
        the one whose acceleration gain is γ/(2dt²); unless the scheduler `uses_acceleration`, it
        is 0. Of a coupled scheduler the first, second and fourth arguments are tuples with one
        float for each axis.

        The retention time τ (s) says how fast the acceleration decays after this plot: the next
        prediction starts from φ = fade(dt/τ) times the acceleration, with the dt that then is, see
        `fuzzytrack.gains.singer.fade`. Infinity keeps the acceleration, as every classical filter
        does. Unless the scheduler `uses_retention`, the number is not used.

        Where a plot is missing, or a two-point start still waits for the second one, the function
        is called with zeros (and a sigma of 1) and its result is not used; so an innovation is
        never NaN.

        A scheduler that sets `sees_starts` keeps its memory also at the start of a track, from its
        first plot on; the gains are still dropped. Its kernel gets an innovation and a change of 0
        and the sigma of the plot; at the first plot ``dt`` has no meaning. A scheduler that sets
        `sees_misses` keeps its memory also where a plot is missing; the kernel then gets an
        infinite sigma. Then rows without a plot differ from rows left out. With ``missed="step"``
        of the tracker time goes on at every step, and a scheduler that sees starts sees misses too.

        It runs in plain Python and is compiled by Numba, so it may use numbers,
        tuples, `math`, other such functions, and constants of the enclosing scope; not the
        scheduler itself. It must guard its own divisions.

        Parameters
        ----------
        n_axes : int
            Axes that the kernel gets at once: 1 unless the scheduler is coupled.
        """

    def initial_memory(self, n_axes: int) -> Memory:
        """Memory of a new track; empty unless overridden."""
        return ()

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of the position predicted over a time (m²); NaN unless overridden.

        For schedulers that keep a covariance; `fuzzytrack.Tracker.predict` uses it. It is called
        for many tracks at once, with arrays in place of numbers, so it is written with arithmetic
        and `numpy.where`, without ``if``.

        Parameters
        ----------
        memory : ndarray, shape (n_memory, lanes)
            Memories side by side, each as the kernel returned it after the last plot of a track,
            or of one of its axes.
        dt : float or ndarray, shape (lanes,)
            Time since that plot (s), > 0.

        Returns
        -------
        ndarray or float
            The variance without that of the next plot, shape (lanes,), or for a coupled scheduler
            (n_axes, lanes); NaN where it is not known yet.
        """
        return math.nan

    def __repr__(self) -> str:
        return constructor_code(self)


schedulers: Registry[type[GainScheduler]] = Registry(
    "scheduler", "fuzzytrack.schedulers", GainScheduler
)
