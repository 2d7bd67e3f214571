"""A model of the cost of accuracy: errors of time steps, noise of run lengths, and processor time.

`data/tradeoff.csv` holds the measurements (written by `gaspart.tradeoff.fit`); `table` reads it, `speed`
measures this machine against it, `advice` chooses engine and settings. `until` runs until observables are
accurate, by the rule in `reached`.
"""
