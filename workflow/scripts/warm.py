"""Compile the kernels that the task on the command line needs."""

import sys

from _job import function, job_time

function("gaspart.reproduction.points.point", "compile_kernels")(sys.argv[1])
print(job_time.describe())
