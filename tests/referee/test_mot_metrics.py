"""py-motmetrics and TrackEval as referees of CLEAR MOT, IDF1 and HOTA.

Both are optional: ``pip install --no-deps motmetrics trackeval``.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from fuzzytrack.scoring.clear_mot import clear_mot
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.hota import hota
from fuzzytrack.scoring.idf1 import idf1

sys.path.insert(0, str(Path(__file__).parents[1] / "scoring"))
from scored_scenes import pairs, random_scene

SEEDS = range(8)


def by_instant(scene):
    """Identities and distances, instant by instant."""
    for k in range(len(scene.time)):
        there, here = (rows.where(rows.instant == k) for rows in (scene.truth, scene.tracks))
        apart = there.position[:, None] - here.position
        yield there.id, here.id, np.sqrt((apart**2).sum(axis=2))


@pytest.mark.parametrize("seed", SEEDS)
def test_clear_mot_and_identities(seed):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motmetrics = pytest.importorskip("motmetrics", reason="py-motmetrics is not installed")
    scene = random_scene(seed, objects=6, tracks=9, instants=30)
    referee = motmetrics.MOTAccumulator(auto_id=True)
    for objects, tracks, distance in by_instant(scene):
        referee.update(objects, tracks, np.where(distance <= 8.0, distance, np.nan))
    names = {
        "mota": "mota",
        "motp": "motp",
        "num_misses": "misses",
        "num_false_positives": "false_positives",
        "num_switches": "switches",
        "num_fragmentations": "fragmentations",
        "idf1": "idf1",
        "idp": "idp",
        "idr": "idr",
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = motmetrics.metrics.create().compute(referee, metrics=list(names)).iloc[0]
    ours = vars(clear_mot(scene, Correspondences.of(scene, pairs(scene), 8.0)))
    ours |= vars(idf1(scene, pairs(scene), 8.0))
    for name, mine in names.items():
        assert ours[mine] == pytest.approx(theirs[name], rel=1e-9), name


@pytest.mark.parametrize("seed", SEEDS)
def test_hota(seed):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        module = pytest.importorskip(
            "trackeval.metrics.hota", reason="TrackEval is not installed", exc_type=ImportError
        )
    scene = random_scene(seed, objects=6, tracks=9, instants=30)
    rows = list(by_instant(scene))
    data = {
        "num_gt_dets": len(scene.truth),
        "num_tracker_dets": len(scene.tracks),
        "num_gt_ids": len(scene.truth.names),
        "num_tracker_ids": len(scene.tracks.names),
        "gt_ids": [row[0] for row in rows],
        "tracker_ids": [row[1] for row in rows],
        "similarity_scores": [np.maximum(0, 1 - row[2] / 15.0) for row in rows],
    }
    theirs = module.HOTA().eval_sequence(data)
    ours = hota(scene, pairs(scene), 15.0)
    for curve, name in zip(ours.curves, ("HOTA", "DetA", "AssA", "LocA"), strict=True):
        assert curve == pytest.approx(theirs[name], rel=1e-9), name
    assert ours.hota == pytest.approx(np.mean(theirs["HOTA"]), rel=1e-9)
