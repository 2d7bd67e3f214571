"""Functions compiled by numba, without any other code.

The compile policy and the hash of the cache apply to this folder.
"""
