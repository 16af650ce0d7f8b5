"""How well tracks fit true ones: metrics of tracking several targets."""

from fuzzytrack.scoring.metrics import METRICS, Metric, Settings
from fuzzytrack.scoring.positions import KINDS, Positions
from fuzzytrack.scoring.score_tracks import score
from fuzzytrack.scoring.scores import GroupScores, Scores

__all__ = ["KINDS", "METRICS", "GroupScores", "Metric", "Positions", "Scores", "Settings", "score"]
