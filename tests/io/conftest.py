"""Tests that need packages which the suite with the lowest versions does not install."""

from importlib.util import find_spec

# Independent readers of what is written, and pandas.
NEEDED = {
    "test_czml.py": ["czml3"],
    "test_geojson.py": ["pyogrio", "geojson_pydantic"],
    "test_gpx_writing.py": ["gpxpy", "pyogrio"],
    "test_kml.py": ["pyogrio", "geojson_pydantic"],
    "test_times.py": ["pandas"],
}

collect_ignore = [file for file, names in NEEDED.items() if not all(map(find_spec, names))]
