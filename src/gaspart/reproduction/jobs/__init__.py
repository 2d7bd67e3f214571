"""Jobs of points, a module for each kind of job, with keys, arguments and work.

`RESULT` describes the result of the job. `KEYS` declares the keys that only such jobs have. `engines(point)`
lists the engines whose kernels the job compiles. `arguments(point)` computes the arguments of the job's
function from a point. This function has the name of the module, and does the work. `reproduction.points.jobs`
lists the modules.
"""
