"""A model of the cost of accuracy: errors of time steps, noise of run lengths, and processor time.

`data/accuracy.csv` holds the measurements (written by `gaspart.accuracy.fit`); `table` reads it, `speed`
measures this machine against it, `advice` chooses engine and settings from it. For scenes and observables
that it does not cover `plan` chooses among `candidates` from runs of `pilot`. `gaspart.runs` runs
until observables are accurate, by the rule in `reached`.
"""

PILOT_SECONDS = 20.0
"""Processor time of all pilot runs of an advice, by default."""
