"""Scans with which the parts of a scan tracker are checked."""

import numpy as np

from fuzzytrack.testing.part_samples import sample_scans


def test_scans_have_twins():
    scans = [scan for scan in sample_scans(0) if len(scan)]
    nearest = []
    for scan in scans:
        apart = np.linalg.norm(scan.positions[:, None] - scan.positions, axis=2)
        nearest.append(apart[~np.eye(len(scan), dtype=bool)].min())
    assert np.median(nearest) < 3.0
