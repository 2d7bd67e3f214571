"""All code compiled by numba, and nothing else: compile policy and cache digest follow from this folder."""
