"""The kinds of jobs of a point, a module for each, with its keys, its parameters and its work.

`RESULT` states what a job makes, `KEYS` declares the keys that only such jobs have, `engines(point)` lists
the engines whose kernels it compiles, `parameters(point)` makes plain values of a point's settings, and
`run(parameters)` does the work. `reproduction.points.jobs` lists the modules.
"""
