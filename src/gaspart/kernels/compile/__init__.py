"""Compilation, cache and loading of kernels; all code that depends on the internals of numba."""
