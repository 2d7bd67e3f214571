"""Compilation, cache and loading of kernels, and all code that depends on the internals of numba."""
