"""Tests of what needs an extra are left out where it is not installed."""

from importlib.util import find_spec

collect_ignore_glob = [] if find_spec("stonesoup") else ["test_stonesoup_*.py"]
