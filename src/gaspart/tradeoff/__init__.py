"""What accuracy costs, as a model: errors of time steps, noise of run lengths, and the price of both.

`data/tradeoff.csv` holds what was measured (`gaspart.tradeoff.fit` makes it); `table` reads it, `speed`
carries its times over to this machine, `advice` chooses engine and settings, `grids` for whole configs.
"""
