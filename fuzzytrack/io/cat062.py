"""Tracks as ASTERIX of category 062, system track data.

Source: EUROCONTROL Specification for Surveillance Data Exchange, ASTERIX Part 9, Category 062, SDPS
Track Messages, edition 1.18 (EUROCONTROL-SPEC-0149-9): items, their places in the user application
profile, units and sizes. A data block is its category, its length in two bytes, and records; a
record begins with its field specification, seven items in each byte and a bit that says whether
there is one more byte.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.reprs import summary

__all__ = ["SUFFIXES", "SystemTracks", "is_cat062", "write_blocks"]

#: Suffixes of files that are written as category 062.
SUFFIXES = (".ast", ".cat062")

_CATEGORY = 62
_DAY = 86_400
# Records of a block: far below 65,535 bytes, and small enough for one datagram.
_RECORDS = 20
# Least significant bits: of times, positions, velocities, ages, and angles of places.
_TIME, _METER, _SPEED, _AGE, _ANGLE = 1 / 128, 0.5, 0.25, 0.25, 180 / 2**25
_SIGNED_24 = 2**23 - 1
#: Items by their place in the profile. Those that a record has are written in this order.
_010, _070, _105, _100, _185, _040, _080, _290, _500 = 1, 4, 5, 6, 7, 12, 13, 14, 27


@dataclass(frozen=True, eq=False)
class SystemTracks:
    """Tracks at some times, one row for each.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Seconds after midnight, UTC; days are taken off.
    number : ndarray of int, shape (n,)
        Track numbers, from 0 to 65,535.
    position, velocity : ndarray, shape (n, 2)
        To the east and north (m, m/s).
    deviation : ndarray, shape (n, 4)
        Standard deviations of both; NaN where unknown.
    tentative, coasting, first : ndarray of bool, shape (n,)
        Whether a track is not confirmed, has no plot in this scan, and was not written before.
    age, since_last : ndarray, shape (n,)
        Time since the track was first written, and since its last plot (s).
    place : ndarray, shape (n, 2), or None
        Latitude and longitude (deg), WGS 84.
    """

    time: Array
    number: NDArray[np.int64]
    position: Array
    velocity: Array
    deviation: Array
    tentative: Mask
    coasting: Mask
    first: Mask
    age: Array
    since_last: Array
    place: Array | None = None

    def __repr__(self) -> str:
        return summary(self, rows=len(self))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)


def is_cat062(path: object) -> bool:
    """Whether a file, by its suffix, is written as category 062."""
    return str(path).lower().endswith(SUFFIXES)


def write_blocks(stream: BinaryIO, tracks: SystemTracks, source: tuple[int, int] = (0, 0)) -> None:
    """Write tracks as data blocks, in their order.

    Parameters
    ----------
    stream : binary file
        Open for writing.
    tracks : SystemTracks
    source : (int, int)
        System area code and system identification code (SAC, SIC).

    Notes
    -----
    Items: 010 data source, 070 time, 105 place (WGS 84) if it is known, 100 position, 185 velocity,
    040 number, 080 status (one sensor; tentative; first message; coasting, with the age of the last
    primary update above its limit), 290 ages of the track and of its last primary plot, 500
    standard deviations of position and velocity. A value beyond the range of its item becomes the
    limit of the range; a position that is not known is left out.
    """
    records = _records(tracks, source)
    for first in range(0, len(records), _RECORDS):
        body = b"".join(records[first : first + _RECORDS])
        stream.write(struct.pack(">BH", _CATEGORY, len(body) + 3) + body)


def _records(tracks: SystemTracks, source: tuple[int, int]) -> list[bytes]:
    clock = np.round(np.mod(tracks.time, _DAY) / _TIME).astype(np.int64) % round(_DAY / _TIME)
    position = _whole(tracks.position, _METER, -_SIGNED_24 - 1, _SIGNED_24)
    velocity = _whole(tracks.velocity, _SPEED, -(2**15), 2**15 - 1)
    spread = _whole(tracks.deviation[:, :2], _METER, 0, 2**16 - 1)
    spread_of_velocity = _whole(tracks.deviation[:, 2:], _SPEED, 0, 255)
    age = _whole(tracks.age, _AGE, 0, 255)
    since = _whole(tracks.since_last, _AGE, 0, 255)
    place = None
    if tracks.place is not None:
        place = _whole(tracks.place, _ANGLE, -(2**31), 2**31 - 1)
    known = np.isfinite(tracks.position.sum(axis=1))
    precise = np.isfinite(tracks.deviation.sum(axis=1))
    found = []
    for k in range(len(tracks)):
        items = {
            _010: bytes(source),
            _070: _three(int(clock[k])),
            _185: struct.pack(">hh", *velocity[k].tolist()),
            _040: struct.pack(">H", int(tracks.number[k])),
            _080: _status(tracks, k),
            _290: bytes([0b11000000, int(age[k]), int(since[k])]),
        }
        if known[k]:
            items[_100] = b"".join(_three(value) for value in position[k].tolist())
        if place is not None and tracks.place is not None and np.isfinite(tracks.place[k]).all():
            items[_105] = struct.pack(">ii", *place[k].tolist())
        if precise[k]:
            items[_500] = bytes([0b10000100]) + struct.pack(
                ">HHBB", *spread[k].tolist(), *spread_of_velocity[k].tolist()
            )
        found.append(_record(items))
    return found


def _record(items: dict[int, bytes]) -> bytes:
    """Field specification and items in the order of the profile."""
    specification = bytearray((max(items) - 1) // 7 + 1)
    for number in items:
        specification[(number - 1) // 7] |= 0x80 >> (number - 1) % 7
    for place in range(len(specification) - 1):
        specification[place] |= 1
    return bytes(specification) + b"".join(items[number] for number in sorted(items))


def _status(tracks: SystemTracks, row: int) -> bytes:
    """Item 080: one sensor and confirmed or not; first message; nothing; coasting."""
    old = 0b11000000 if tracks.coasting[row] else 0
    return bytes(
        [
            0b10000001 | (0b10 if tracks.tentative[row] else 0),
            0b00000001 | (0b100000 if tracks.first[row] else 0),
            0b00000001,
            old,
        ]
    )


def _whole(values: Array, unit: float, least: int, most: int) -> NDArray[np.int64]:
    """Values in whole units, within the range of their item; 0 where unknown."""
    scaled = np.nan_to_num(np.asarray(values) / unit, nan=0.0, posinf=most, neginf=least)
    return np.clip(np.round(scaled), least, most).astype(np.int64)


def _three(value: int) -> bytes:
    """Three bytes, two's complement."""
    return (value & 0xFFFFFF).to_bytes(3, "big")
