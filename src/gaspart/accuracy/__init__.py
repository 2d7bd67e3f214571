"""Accuracy and its cost: errors of engines, noise of runs, CPU time, and the cheapest run.

`plan` chooses among an `Option` for each engine. If `data/accuracy.csv` contains measurements of an
observable (written by `gaspart.accuracy.fit`, read by `table`), `plan_from_table` makes the plan and scales
it to this machine by `speed`. In all other cases `plan_from_pilots` makes the plan from pilot runs.
`gaspart.runs` runs until observables are accurate, by the rule in `reached`.
"""

PILOT_SECONDS = 20.0
"""Processor time of all pilot runs of an advice, by default."""
