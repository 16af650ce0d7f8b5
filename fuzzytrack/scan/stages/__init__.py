"""Stages of a scan: each a function of the arrays of a session, made of the kernels of parts."""
