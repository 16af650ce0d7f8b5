"""Schedulers, rule bases and trackers as C99 source code.

`export_c` writes a header, and a program that checks it; `compiled_c` compiles a tracker with the
compiler of this computer and calls it.
"""

from fuzzytrack.interop.c99.compiled_filter import CompiledFilter, compiled_c
from fuzzytrack.interop.c99.export import CExport, export_c

__all__ = ["CExport", "CompiledFilter", "compiled_c", "export_c"]
