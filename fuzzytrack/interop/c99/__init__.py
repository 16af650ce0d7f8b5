"""Schedulers, rule bases and trackers as C99 source code.

`fuzzytrack.interop.c99.export.export_c` writes a header, and a program that checks it.
"""
