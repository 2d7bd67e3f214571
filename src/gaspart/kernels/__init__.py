"""Functions compiled by numba, and no other code.

The compile policy and the digest of the cache apply to this folder.
"""
