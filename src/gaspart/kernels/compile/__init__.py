"""How kernels are compiled, cached and loaded, and all that depends on the internals of numba."""
