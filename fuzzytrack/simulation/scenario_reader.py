"""Scenario read from a YAML tree; every error names the place in the file and the word."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import FileError
from fuzzytrack.io.recording import read_tracks
from fuzzytrack.simulation.noise import Noise, streams
from fuzzytrack.simulation.published import (
    ALL_SETS,
    MANEUVERS,
    kim_lee,
    llinas_maneuver,
    s3,
    track_set,
    warship,
)
from fuzzytrack.simulation.sampling import PATTERNS, REGULAR, Sampling
from fuzzytrack.simulation.scenario import FieldSensors, PlotNoise, Scenario, Sensors
from fuzzytrack.simulation.sensor_field import SPACINGS, SensorField, sensor_grid
from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
    waypoints,
)
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.yamltree import Document, Node, Sequence, quoted

__all__ = ["FORMAT_VERSION", "ScenarioReader"]

#: Times, positions, and the first scan, from 0, that counts unless the file says otherwise.
Target = tuple[Array, Array, int]
#: Times and positions: at the target's own times, or at those of the argument `at`.
Path = Callable[..., tuple[Array, Array]]

FORMAT_VERSION = "1"

# Limits, so that a text cannot ask for more memory than a computer has.
MAX_SCANS = 100_000
MAX_TRACKS = 10_000
MAX_SENSORS = 10_000
MAX_SIGHTS = 10_000_000

# Times that are drawn for a single target that is sampled irregularly: run k has number k modulo
# this many.
_DRAWS = 100

_REQUIRED = ("scenario", "name", "target", "sensors")
_OPTIONAL = ("source", "sampling", "start", "score", "process_sigma", "trackers")
_STARTS = ("as-seen", "interpolate")
_SIGMA_FROM = ("truth", "plot")
_PATTERNS = tuple(pattern for pattern in PATTERNS if pattern != "regular")
_TRUTH = {"yes": True, "true": True, "no": False, "false": False}

_MOTION_KEYS = ("heading", "start", "steps", "period")
#: Motion to its function, and the keys that it needs.
_MOTIONS: dict[str, tuple[Path, tuple[str, ...]]] = {
    "constant-velocity": (constant_velocity, ("speed",)),
    "constant-acceleration": (constant_acceleration, ("speed", "acceleration")),
    "turn": (turn, ("speed", "radius")),
    "turn-with-angular-acceleration": (
        turn_with_angular_acceleration,
        ("speed", "acceleration", "radius"),
    ),
}
_PAPERS: dict[str, Path] = {
    "kim-lee": kim_lee,
    "s3": s3,
    "warship": warship,
}

_NOISE_KEYS = ("correlation", "freedom")
_FIELD_NUMBERS = ("reach", "range_sigma", "bearing_sigma")
_FIELD_KEYS = ("detection", *_NOISE_KEYS, "linear", "sigma_from")

# Keys that may stand beside the key that names the kind of target, or of sensors.
_TARGET_KEYS = (
    "speed",
    "acceleration",
    "radius",
    *_MOTION_KEYS,
    *("leg", "times", "rate", "tracks", "seed", "time", "axes"),
)
_PLOT_KEYS = ("clean", "factors", "spread", "outliers", "told")
_SENSOR_KEYS = (*_PLOT_KEYS, "spacing", "centre", *_FIELD_NUMBERS, *_FIELD_KEYS)


class ScenarioReader:
    """Reader of the scenario in a YAML document.

    Parameters
    ----------
    document : Document
        The document; it gives errors their place in the file.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.sampling: Node | None = None

    def scenario(self) -> Scenario:
        """Read the whole document.

        Raises
        ------
        ScenarioError
            At the first error in the document.
        """
        document = self.document
        self._check_version()
        top = document.fields(document.root, "the scenario", _REQUIRED, _OPTIONAL)
        self.sampling = top.get("sampling")
        time, position, first_scored = self._target(top["target"], self._when())
        if len(time) <= first_scored:
            raise document.error(
                self.sampling or top["target"],
                f"the target has {len(time)} scans; at least {first_scored + 1}",
            )
        start = document.choice(top["start"], "start", _STARTS) if "start" in top else "as-seen"
        if start == "interpolate" and time.ndim == 2:
            raise document.error(
                top["start"], "start 'interpolate' needs times that are the same in all runs"
            )
        if "score" in top:
            first_scored = self._first_scored(top["score"], len(time))
        process = top.get("process_sigma")
        with self._errors_at(top, top["target"]):
            return Scenario(
                name=document.text(top["name"], "name"),
                source=document.text(top["source"], "source") if "source" in top else "",
                time=time,
                position=position,
                sensors=self._sensors(top["sensors"], position),
                first_scored=first_scored,
                prepare_start=start == "interpolate",
                process_sigma=None
                if process is None
                else document.number(process, "process_sigma"),
                trackers=self._trackers(top["trackers"]) if "trackers" in top else (),
            )

    def source(self) -> str:
        """Read the source of the scenario only; empty if the file names none."""
        entries = self.document.entries(self.document.root, "the scenario")
        return self.document.text(entries["source"][1], "source") if "source" in entries else ""

    def _check_version(self) -> None:
        entries = self.document.entries(self.document.root, "the scenario")
        if "scenario" not in entries:
            raise self.document.error(
                self.document.root,
                f"the scenario lacks its format version, 'scenario: {FORMAT_VERSION}'",
            )
        self.document.choice(entries["scenario"][1], "format version", (FORMAT_VERSION,))

    def _first_scored(self, node: Node, scans: int) -> int:
        value = self.document.fields(node, "score", ("from",))["from"]
        return self._whole(value, "from", 1, scans) - 1

    def _trackers(self, node: Node) -> tuple[str, ...]:
        specs: list[str] = []
        for item in self.document.items(node, "trackers"):
            spec = self.document.text(item, "tracker").strip()
            if ".yaml" in spec.lower() or ".yml" in spec.lower():
                spec = self._beside(spec)
            try:
                make_tracker(spec)
            except ValueError as error:
                raise self.document.error(item, str(error)) from None
            if spec in specs:
                raise self.document.error(item, f"tracker {quoted(spec)} is given twice")
            specs.append(spec)
        return tuple(specs)

    def _beside(self, name: str) -> str:
        """Path of a file that the scenario names, relative to the folder of the scenario."""
        return str(FilePath(self.document.file).parent / name)

    # ---------------------------------------------------------------- target

    def _when(self) -> Sampling:
        document, node = self.document, self.sampling
        if node is None:
            return REGULAR
        fields = document.fields(node, "sampling", (), (*_PATTERNS, "period"))
        found = [word for word in fields if word in _PATTERNS]
        if len(found) > 1:
            raise document.error(
                document.entries(node, "sampling")[found[1]][0],
                f"sampling has {found[0]!r} already; it takes one of {', '.join(_PATTERNS)}",
            )
        period = document.number(fields["period"], "period") if "period" in fields else None
        with self._errors_at(fields, node):
            if not found:
                return Sampling(period=period)
            return Sampling(found[0], self._each(fields[found[0]], found[0]), period)

    def _target(self, node: Node, sampling: Sampling) -> Target:
        kinds: dict[str, Callable[[Node, Sampling], Target]] = {
            "motion": self._motion,
            "waypoints": self._waypoints,
            "maneuver": self._maneuver,
            "set": self._set,
            "file": self._file,
        }
        return kinds[self._kind(node, "target", kinds, _TARGET_KEYS)](node, sampling)

    def _sampled(self, path: Path, sampling: Sampling) -> Target:
        """A single target at its own times, or at those of the sampling."""
        time, position = path()
        first = 2
        if sampling != REGULAR:
            with self._errors_of_sampling():
                first = sampling.scan(first, time)
                time = sampling.times(time, streams(0, _DRAWS))
            _, position = path(at=time)
        return time, position, first

    def _motion(self, node: Node, sampling: Sampling) -> Target:
        document = self.document
        word = document.choice(document.entries(node, "target")["motion"][1], "motion", _MOTIONS)
        make, needed = _MOTIONS[word]
        fields = document.fields(node, f"a target in {word}", ("motion", *needed), _MOTION_KEYS)
        given: dict[str, Any] = {}
        for key, value in fields.items():
            if key == "steps":
                given[key] = self._whole(value, key, 3, MAX_SCANS)
            elif key == "start":
                given[key] = self._numbers(value, key)
            elif key == "heading":
                given[key] = math.radians(document.number(value, key))
            elif key != "motion":
                given[key] = document.number(value, key)
        with self._errors_at(fields, node):
            return self._sampled(partial(make, **given), sampling)

    def _waypoints(self, node: Node, sampling: Sampling) -> Target:
        document = self.document
        fields = document.fields(node, "target", ("waypoints",), ("leg", "times", "period"))
        if "leg" in fields and "times" in fields:
            raise document.error(
                fields["leg"], "leg and times both set the times of the points; give one"
            )
        points = self._points(fields["waypoints"], "waypoints")
        leg = document.number(fields["leg"], "leg") if "leg" in fields else 60.0
        times = self._numbers(fields["times"], "times") if "times" in fields else None
        period = document.number(fields["period"], "period") if "period" in fields else 60.0
        last = leg * (len(points) - 1) if times is None else times[-1] - times[0]
        if period > 0 and last / period > MAX_SCANS:
            raise document.error(node, f"more than {MAX_SCANS} scans; make the period longer")
        with self._errors_at({"points": fields["waypoints"], **fields}, node):
            path = partial(waypoints, points, times=times, leg=leg, period=period)
            return self._sampled(path, sampling)

    def _maneuver(self, node: Node, sampling: Sampling) -> Target:
        document = self.document
        allowed = (*MANEUVERS, *_PAPERS)
        entry = document.entries(node, "target")["maneuver"][1]
        word = document.choice(entry, "maneuver", allowed)
        optional = ("rate",) if word == "warship" else ()
        fields = document.fields(node, f"a target in maneuver {word}", ("maneuver",), optional)
        if word in MANEUVERS:
            return self._sampled(partial(llinas_maneuver, word), sampling)
        given = {"rate": document.number(fields["rate"], "rate")} if "rate" in fields else {}
        with self._errors_at(fields, node):
            return self._sampled(partial(_PAPERS[word], **given), sampling)

    def _set(self, node: Node, sampling: Sampling) -> Target:
        fields = self.document.fields(node, "a set of targets", ("set", "tracks"), ("seed",))
        word = self.document.choice(fields["set"], "set", ALL_SETS)
        tracks = self._whole(fields["tracks"], "tracks", 1, MAX_TRACKS)
        seed = self._whole(fields["seed"], "seed", 0, 2**53) if "seed" in fields else 0
        with self._errors_of_sampling():
            found = track_set(word, tracks, seed, sampling)
        return found.time, found.position, found.first_scored

    def _file(self, node: Node, sampling: Sampling) -> Target:
        document = self.document
        if sampling != REGULAR:
            raise document.error(
                self.sampling or node,
                "sampling needs a target that is known at all times; a recorded one has the times "
                "of its file",
            )
        fields = document.fields(node, "a target from a file", ("file",), ("time", "axes"))
        name = self._beside(document.text(fields["file"], "file"))
        time = document.text(fields["time"], "time") if "time" in fields else None
        axes = None
        if "axes" in fields:
            axes = [document.text(item, "axis") for item in document.items(fields["axes"], "axes")]
        try:
            (track,) = read_tracks(name, time=time, axes=axes).tracks
        except OSError as error:
            raise document.error(fields["file"], f"cannot read {name}: {error.strerror}") from None
        except ValueError as error:
            raise document.error(node, str(error)) from None
        if len(track.time) > MAX_SCANS:
            raise document.error(fields["file"], f"{name} has more than {MAX_SCANS} scans")
        return track.time, track.plots, 2

    # ---------------------------------------------------------------- sensors

    def _sensors(self, node: Node, position: Array) -> Sensors:
        kinds = {"sigma": self._noise, "grid": self._grid, "positions": self._scattered}
        kind = self._kind(node, "sensors", kinds, _SENSOR_KEYS)
        n_axes = position.shape[-1]
        if kind != "sigma" and n_axes != 2:
            raise self.document.error(
                node, f"a field of sensors is for targets with two axes, this one has {n_axes}"
            )
        return kinds[kind](node, position)

    def _noise(self, node: Node, position: Array) -> Sensors:
        document = self.document
        optional = ("detection", *_PLOT_KEYS, *_NOISE_KEYS)
        fields = document.fields(node, "sensors", ("sigma",), optional)
        sigma = self._each(fields["sigma"], "sigma")
        if isinstance(sigma, list) and len(sigma) != position.shape[-1]:
            raise document.error(
                fields["sigma"],
                f"sigma has {len(sigma)} numbers, the target {position.shape[-1]} axes",
            )
        given: dict[str, Any] = {
            key: document.number(fields[key], key)
            for key in ("detection", "spread", "told")
            if key in fields
        }
        if "clean" in fields:
            given["clean"] = self._whole(fields["clean"], "clean", 0, MAX_SCANS)
        if "factors" in fields:
            given["factors"] = self._numbers(fields["factors"], "factors")
        if "outliers" in fields:
            names = ("share", "factor")
            parts = document.fields(fields["outliers"], "outliers", names)
            given["outliers"] = tuple(document.number(parts[name], name) for name in names)
        with self._errors_at(fields, node):
            return PlotNoise(sigma, self._kind_of_noise(fields), **given)  # type: ignore[arg-type]

    def _grid(self, node: Node, position: Array) -> Sensors:
        document = self.document
        required = ("grid", "spacing", *_FIELD_NUMBERS)
        fields = document.fields(node, "a grid of sensors", required, ("centre", *_FIELD_KEYS))
        n = self._whole(fields["grid"], "grid", 1, math.isqrt(MAX_SENSORS))
        spacing = self._spacing(fields["spacing"])
        given = self._field_numbers(fields)
        if "centre" in fields:
            given["centre"] = self._numbers(fields["centre"], "centre")
        with self._errors_at(fields, node):
            return self._field(fields, node, sensor_grid(n, spacing, **given), position)

    def _scattered(self, node: Node, position: Array) -> Sensors:
        required = ("positions", *_FIELD_NUMBERS)
        fields = self.document.fields(node, "sensors", required, _FIELD_KEYS)
        places = self._points(fields["positions"], "positions")
        with self._errors_at({"position": fields["positions"], **fields}, node):
            field = SensorField(places, **self._field_numbers(fields))
            return self._field(fields, node, field, position)

    def _field(
        self, fields: Mapping[str, Node], node: Node, field: SensorField, position: Array
    ) -> Sensors:
        document = self.document
        places = position.reshape(-1, 2)
        if len(places) * len(field.position) > MAX_SIGHTS:
            raise document.error(
                node,
                f"{len(field.position)} sensors and {len(places)} positions of targets are too "
                f"many: {MAX_SIGHTS} pairs at most",
            )
        if not field.sees(places).any():
            raise document.error(node, "no sensor has the target within its reach in any scan")
        given: dict[str, Any] = {}
        if "linear" in fields:
            given["linear"] = _TRUTH[document.choice(fields["linear"], "linear", _TRUTH)]
        if "sigma_from" in fields:
            given["sigma_from"] = document.choice(fields["sigma_from"], "sigma_from", _SIGMA_FROM)
        return FieldSensors(field, self._kind_of_noise(fields), **given)

    def _field_numbers(self, fields: Mapping[str, Node]) -> dict[str, Any]:
        given: dict[str, Any] = {key: self._each(fields[key], key) for key in _FIELD_NUMBERS}
        bearing = np.asarray(given["bearing_sigma"])
        # Checked here, since the file is in degrees.
        if not (bearing > 0).all():
            worst = f"{bearing.min():g}"
            raise self.document.error(
                fields["bearing_sigma"], f"bearing_sigma must be > 0, got {worst}"
            )
        given["bearing_sigma"] = np.radians(bearing)
        if "detection" in fields:
            given["detection"] = self.document.number(fields["detection"], "detection")
        return given

    def _spacing(self, node: Node) -> float:
        word = self.document.text(node, "spacing")
        if word[0].isalpha():
            return SPACINGS[self.document.choice(node, "spacing", SPACINGS)]
        return self.document.number(node, "spacing")

    def _kind_of_noise(self, fields: Mapping[str, Node]) -> Noise:
        given = {
            key: self.document.number(fields[key], key) for key in _NOISE_KEYS if key in fields
        }
        return Noise(**given)

    # ---------------------------------------------------------------- parts

    def _kind(self, node: Node, role: str, kinds: Collection[str], known: Collection[str]) -> str:
        """The single key of a mapping that names its kind."""
        entries = self.document.entries(node, role)
        found = [word for word in entries if word in kinds]
        if len(found) > 1:
            raise self.document.error(
                entries[found[1]][0],
                f"{role} has {found[0]!r} already; it takes one of {', '.join(kinds)}",
            )
        if not found:
            for word, (key, _) in entries.items():
                if word not in known:
                    raise self.document.unknown(key, word, f"key in {role}:", tuple(kinds))
            raise self.document.error(node, f"{role} needs one of {', '.join(kinds)}")
        return found[0]

    def _errors_of_sampling(self) -> AbstractContextManager[None]:
        """Give an error of the times the place of the period, else of the sampling."""
        node = self.sampling
        if node is None:
            return nullcontext()
        fields = self.document.entries(node, "sampling")
        return self._errors_at({word: value for word, (_, value) in fields.items()}, node)

    @contextmanager
    def _errors_at(self, fields: Mapping[str, Node], node: Node) -> Iterator[None]:
        """Give an error of the model the place of the key that it names, else of `node`."""
        try:
            # An overflow is reported as an infinite number.
            with np.errstate(all="ignore"):
                yield
        except FileError:
            raise
        except ValueError as error:
            named = str(error).partition(" ")[0].rstrip(":")
            raise self.document.error(fields.get(named, node), str(error)) from None

    def _whole(self, node: Node, role: str, low: int, high: int) -> int:
        value = self.document.whole(node, role)
        if not low <= value <= high:
            raise self.document.error(
                node, f"{role} must be a whole number from {low} to {high}, got {value}"
            )
        return value

    def _numbers(self, node: Node, role: str) -> list[float]:
        return [self.document.number(item, role) for item in self.document.items(node, role)]

    def _each(self, node: Node, role: str) -> float | list[float]:
        """A number, or one for each axis or sensor."""
        if isinstance(node, Sequence):
            return self._numbers(node, role)
        return self.document.number(node, role)

    def _points(self, node: Node, role: str) -> list[list[float]]:
        """Points, all with as many coordinates as the first."""
        items = self.document.items(node, role)
        points = [self._numbers(item, f"each of the {role}") for item in items]
        for item, point in zip(items, points, strict=True):
            if len(point) != len(points[0]):
                raise self.document.error(
                    item, f"has {len(point)} coordinates, the first of the {role} {len(points[0])}"
                )
        return points
