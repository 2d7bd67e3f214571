"""Kinds of jobs of a point, a module for each, with keys, arguments and work.

`RESULT` states what a job makes, `KEYS` declares the keys that only such jobs have, `engines(point)` lists
the engines whose kernels it compiles, `arguments(point)` makes the arguments of a point for the function with
the name of the module, which does the work. `reproduction.points.jobs` lists the modules.
"""
