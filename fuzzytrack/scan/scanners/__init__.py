"""Configurations of scan trackers: files that name the parts and their numbers."""
