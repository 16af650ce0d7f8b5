"""Many tracks side by side: the arithmetic of a tracker, run over blocks of lanes."""
