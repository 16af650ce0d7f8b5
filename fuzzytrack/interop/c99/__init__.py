"""Schedulers, rule bases and trackers as C99 source code."""
