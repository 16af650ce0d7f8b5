"""The values of a scan as the arrays that its stages take, and what is wrong with them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.stages.plots import BAD_COVARIANCE, BAD_POSITION, BAD_TIME, LARGEST, NO_NOISE

__all__ = ["ScanArrays", "complaint", "scan_arrays"]


class ScanArrays(NamedTuple):
    """Arrays of a scan; what is not given is empty. See `fuzzytrack.scan.scan.Scan`."""

    positions: Array
    covariances: Array
    times: Array
    may_start: Mask
    rows: NDArray[np.int64]


_NO_COVARIANCES, _NO_TIMES = np.empty((0, 3)), np.empty(0)
_NO_STARTS, _NO_ROWS = np.empty(0, np.bool_), np.empty(0, np.int64)


def scan_arrays(
    scan: Scan,
    last: float,
    begins: bool,
    may_start: ArrayLike | None = None,
    needing_own: tuple[str, ...] = (),
) -> ScanArrays:
    """Arrays of a scan, of which everything is checked but single plots.

    Parameters
    ----------
    scan : Scan
    last : float
        Time of the call before (s).
    begins : bool
        Whether the scan must be later than that, not only not earlier.
    may_start : array_like of bool, optional
        Which plots may start a track.
    needing_own : tuple of str
        Roles whose part needs the position of the radar.

    Raises
    ------
    DataError
        If the time does not follow, a shape does not fit, or the position of the radar is needed
        and not known.
    """
    time = scan.time
    if not ((time > last if begins else time >= last) and -LARGEST <= time <= LARGEST):
        raise DataError(f"time: {time!r} s does not follow {last!r} s; scans need times that grow")
    own_x, own_y = scan.own
    if own_x != own_x and own_y != own_y:
        if needing_own:
            raise DataError(
                f"own: the position of the radar is not known, and {' and '.join(needing_own)} of "
                "this configuration need it"
            )
    elif not (-LARGEST <= own_x <= LARGEST and -LARGEST <= own_y <= LARGEST):
        raise DataError(f"own: {scan.own!r} is no position in meters")
    positions: Any = np.ascontiguousarray(scan.positions, np.float64)
    n = len(positions)
    _check("positions", positions, (n, 2))
    covariances, times, starts, rows = _NO_COVARIANCES, _NO_TIMES, _NO_STARTS, _NO_ROWS
    if scan.covariances is not None:
        covariances = np.ascontiguousarray(scan.covariances, np.float64)
        _check("covariances", covariances, (n, 3))
    if scan.times is not None:
        times = np.ascontiguousarray(scan.times, np.float64)
        _check("times", times, (n,))
    if may_start is not None:
        starts = np.ascontiguousarray(may_start, np.bool_)
        _check("may_start", starts, (n,))
    if scan.rows is not None:
        rows = np.ascontiguousarray(scan.rows, np.int64)
        _check("rows", rows, (n,))
    return ScanArrays(positions, covariances, times, starts, rows)


def _check(name: str, array: NDArray[Any], shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise DataError(f"{name}: shape {array.shape}; expected {shape}")


def complaint(answer: int, scan: Scan, j: int) -> DataError:
    """What is wrong with plot `j`, by the answer of the stage that looked at it."""
    row = j if scan.rows is None else int(scan.rows[j])
    plot = f"plot {row} of the scan at {scan.time:g} s"
    if answer == BAD_POSITION:
        x, y = scan.positions[j]
        return DataError(f"{plot}: position ({x:g}, {y:g}) m; needs numbers below {LARGEST:g}")
    if answer == BAD_TIME and scan.times is not None:
        return DataError(f"{plot}: time {scan.times[j]:g} s; none may be later than the scan")
    if answer == NO_NOISE:
        distance = float(np.hypot(*(scan.positions[j] - np.asarray(scan.own))))
        return DataError(
            f"{plot}: {distance:g} m from the radar, where its noise across the line of sight is "
            "too large for the numbers here; are the positions in meters?"
        )
    assert answer == BAD_COVARIANCE
    assert scan.covariances is not None
    values = ", ".join(f"{value:g}" for value in scan.covariances[j])
    return DataError(
        f"{plot}: covariance ({values}) m²; needs xx and yy > 0 and at most {LARGEST:g}, "
        "xy² < xx·yy"
    )
