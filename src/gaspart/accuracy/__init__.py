"""Accuracy and its cost: errors of engines, noise of runs, CPU time, and the cheapest run.

`plan` chooses among an `Option` for each engine. Where `data/accuracy.csv` holds measurements (written by
`gaspart.accuracy.fit`, read by `table`), `plan_from_table` makes them, scaled to this machine by `speed`; of
everything else `plan_from_pilots` makes them from pilot runs. `gaspart.runs` runs until observables are
accurate, by the rule in `reached`.
"""

PILOT_SECONDS = 20.0
"""Processor time of all pilot runs of an advice, by default."""
