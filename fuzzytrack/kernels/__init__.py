"""Scalar functions in plain Python, and their compilation by Numba.

The only package that imports Numba. It knows nothing of tracks.
"""
