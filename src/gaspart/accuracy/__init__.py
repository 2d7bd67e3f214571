"""Accuracy and cost of runs, and the choice of the cheapest run for an accuracy.

`plan` returns an `Option` for each engine and the best of these options. Measurements of some observables are
in the table `data/accuracy.csv` (`tools/accuracy_table.py` writes it, `table` reads it). `plan_from_table`
makes the plan for these observables, and `plan_from_pilots` for all others, from short pilot runs.
`gaspart.runs` continues a run until its observables are accurate; the stopping rule is in `reached`.
"""

PILOT_SECONDS = 20.0
"""Default CPU time of all pilot runs of a plan in seconds."""
