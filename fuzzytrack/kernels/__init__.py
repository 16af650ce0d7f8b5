"""Scalar functions in plain Python, and their compilation by Numba.

The only package that imports Numba and llvmlite. It has nothing about tracks in it.

=============  =====================================================================
`language`     words that such a function may use beside plain Python
`rebuild`      copies of functions with other values in place; the content of one
`compile`      a function to compiled code, with all that it calls
`shared_code`  code that functions share which differ only in numbers
`slots`        a number that compiled code reads from memory
`llvm`         what Numba's public interface does not offer
`cache`        the folder in which compiled code is kept
=============  =====================================================================

**Private parts of Numba and llvmlite.** They have no public way for the following, so `llvm` uses
what may change with any release:

- ``Dispatcher._cache``, ``CFunc._cache`` and ``CFunc`` itself, ``NullCache``, the methods
  ``_reduce`` and ``_rebuild`` of ``CompileResult``, and ``numba.core.serialize``: to keep compiled
  code by its content. When they change, compiling fails with an `AttributeError` or `ImportError`,
  or code is compiled anew in every process.
- Function attributes, metadata and blocks of ``llvmlite.ir``, and ``numba.core.cgutils``: to tell
  LLVM that loops may use wide vectors and have independent iterations. When they change, compiling
  fails, or the code becomes several times slower with the same results.
- ``numba.core.typeconv.castgraph.Conversion`` and ``lower_constant``, in `slots`: a type whose
  constants are read from memory. When they change, importing it fails, or compiling with a
  `TypingError`.
- The options ``no_cpython_wrapper`` and ``no_cfunc_wrapper`` of ``njit``, which its documentation
  leaves out: helpers that only compiled code calls are compiled without ways in for others. When
  they change, compiling fails with a `KeyError`.
- ``_Intrinsic._defn``, in `rebuild`: the content of an intrinsic.

So pyproject.toml allows only versions of Numba that were tried. To try another one, install it, run
``python -m pytest tests/kernels tests/lanes tests/trackers``, and change the bounds there.
"""
