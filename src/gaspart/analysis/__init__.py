"""Observables with uncertainties. The functions below are public (`gp.analysis`).

Each function takes a trajectory (a path or an open trajectory) or a `Simulation`. It returns an `Observable`:
an xarray.Dataset with uncertainties, units, theory and a `plot` method. Python imports each function when it
is first used. `lyapunov_exponent` needs a simulation that recorded its events.

These arguments mean the same in all functions, which describe only others:

- `source`: a trajectory (a path or an open trajectory), or a simulation.
- `start`: frames before this time are discarded. Default: a quarter of the run.
- `species`: measure only this species, by its number in the scene; single particles follow the last species.
- `particles`, `about`: see `mean_squared_displacement`. `bins`: number of bins.

>>> import gaspart as gp
>>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
>>> simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
>>> simulation.advance(duration=20.0)
>>> gp.analysis.wall_pressure(simulation).face.values.tolist()
['x low', 'x high', 'y low', 'y high']
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
