"""Stone Soup's metrics as a referee: OSPA, GOSPA and SIAP.

Stone Soup is optional: ``pip install stonesoup``. Its associations for SIAP are made from ours,
since its own way to associate is another one.
"""

import sys
import warnings
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.scoring.gospa import gospa
from fuzzytrack.scoring.ospa import SetAssignment, ospa
from fuzzytrack.scoring.siap import nearest_objects, siap

sys.path.insert(0, str(Path(__file__).parents[1] / "scoring"))
from scored_scenes import pairs, random_scene, scene

with warnings.catch_warnings():
    # What it warns of while it is imported is its own affair.
    warnings.simplefilter("ignore")
    pytest.importorskip("stonesoup", reason="Stone Soup is not installed")
    from stonesoup.measures import Euclidean
    from stonesoup.metricgenerator.manager import MultiManager
    from stonesoup.metricgenerator.ospametric import GOSPAMetric, OSPAMetric
    from stonesoup.metricgenerator.tracktotruthmetrics import SIAPMetrics
    from stonesoup.types.association import AssociationSet, TimeRangeAssociation
    from stonesoup.types.groundtruth import GroundTruthPath, GroundTruthState
    from stonesoup.types.state import State
    from stonesoup.types.time import TimeRange
    from stonesoup.types.track import Track

BEGIN = datetime(2000, 1, 1)
SEEDS = range(5)


def at(seconds):
    return BEGIN + timedelta(seconds=float(seconds))


def states(of, rows, kind=State):
    """Rows of a scene as states x, vx, y, vy, by identity."""
    found = {}
    for k, id, place, speed in zip(
        rows.instant, rows.id.tolist(), rows.position, rows.velocity, strict=True
    ):
        vector = np.array([place[0], speed[0], place[1], speed[1]])[:, None]
        found.setdefault(id, []).append(kind(vector, timestamp=at(of.time[k])))
    return found


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("order", [1, 2])
def test_distances_of_sets(seed, order):
    of = random_scene(seed, objects=5, tracks=8, instants=15)
    assigned = SetAssignment.of(of, pairs(of, 10.0), 10.0, order)
    ours, general = ospa(assigned), gospa(assigned)
    measure = Euclidean(mapping=(0, 2))
    for k in range(len(of.time)):
        truth, tracks = (
            [state for each in states(of, rows.where(rows.instant == k)).values() for state in each]
            for rows in (of.truth, of.tracks)
        )
        theirs = OSPAMetric(c=10.0, p=order, measure=measure).compute_OSPA_distance(tracks, truth)
        if order == 1:
            assert ours.distance[k] == pytest.approx(theirs.value, rel=1e-9, abs=1e-9)
        # It minimizes the sum of distances and then takes that of their powers, which is larger.
        assert ours.distance[k] <= theirs.value + 1e-9
        found = GOSPAMetric(c=10.0, p=order, measure=measure).compute_gospa_metric(tracks, truth)
        value = found[0].value
        assert general.distance[k] == pytest.approx(value["distance"], rel=1e-9, abs=1e-9)
        assert general.localization[k] ** order == pytest.approx(
            value["localisation"], rel=1e-9, abs=1e-9
        )
        half = 10.0**order / 2
        assert general.missed[k] * half == pytest.approx(value["missed"])
        assert general.false[k] * half == pytest.approx(value["false"])


@pytest.mark.parametrize("seed", SEEDS)
def test_air_picture(seed):
    of = segments_scene(seed)
    rng = np.random.default_rng(seed)
    of.truth.velocity[:] = rng.normal(0, 2, of.truth.velocity.shape)
    of.tracks.velocity[:] = rng.normal(0, 2, of.tracks.velocity.shape)
    found = nearest_objects(pairs(of), 20.0)
    paths = {
        id: GroundTruthPath(each) for id, each in states(of, of.truth, GroundTruthState).items()
    }
    tracks = {id: Track(each) for id, each in states(of, of.tracks).items()}
    manager = MultiManager()
    manager.add_data({"truths": set(paths.values()), "tracks": set(tracks.values())})
    manager.association_set = associations(of, found, paths, tracks)
    generator = SIAPMetrics(
        position_measure=Euclidean((0, 2)),
        velocity_measure=Euclidean((1, 3)),
        truths_key="truths",
        tracks_key="tracks",
    )
    theirs = {metric.title: metric.value for metric in generator.compute_metric(manager)}
    ours = siap(of, found)
    for title, value in (
        ("SIAP Completeness", ours.completeness),
        ("SIAP Ambiguity", ours.ambiguity),
        ("SIAP Spuriousness", ours.spuriousness),
        ("SIAP Position Accuracy", ours.position_accuracy),
        ("SIAP Velocity Accuracy", ours.velocity_accuracy),
        ("SIAP Rate of Track Number Change", ours.rate_of_number_changes),
        ("SIAP Longest Track Segment", ours.longest_segment),
    ):
        assert value == pytest.approx(theirs[title], rel=1e-9), title


def columns(of, found):
    """Objects, tracks and instants of pairs."""
    objects, tracks = of.truth.id[found.true_row], of.tracks.id[found.track_row]
    return objects.tolist(), tracks.tolist(), found.instant.tolist()


def segments_scene(seed):
    """Objects far apart, each followed by segments that overlap a little, every one another track.

    It merges the segments that a track has with an object, and stops counting at a segment of which
    one instant only is not covered by the one before.
    """
    rng = np.random.default_rng(seed)
    truth, tracks, number = [], [], 0
    for object_ in range(4):
        truth += [(k, object_, 1000.0 * object_, 0.0) for k in range(40)]
        end = int(rng.integers(0, 4))
        while end < 34:
            first = max(0, end + int(rng.integers(-2, 4)))
            end = max(end + 2, first + int(rng.integers(2, 9)))
            for k in range(first, min(end, 39) + 1):
                x, y = rng.normal(0, 2, 2)
                tracks.append((k, number, 1000.0 * object_ + x, y))
            number += 1
    tracks += [(k, number, -500.0, 0.0) for k in range(5, 15)]
    return scene(truth, tracks, 40)


def associations(of, found, paths, tracks):
    """What we found, a segment at a time."""
    segments = {}
    for object_, track, k in zip(*columns(of, found), strict=True):
        parts = segments.setdefault((object_, track), [])
        if parts and parts[-1][1] == k - 1:
            parts[-1][1] = k
        else:
            parts.append([k, k])
    return AssociationSet(
        {
            TimeRangeAssociation(
                {paths[object_], tracks[track]},
                TimeRange(at(of.time[first]), at(of.time[last])),
            )
            for (object_, track), parts in segments.items()
            for first, last in parts
        }
    )
