"""Observables with uncertainties. The functions below are public (`gp.analysis`).

Each function takes a trajectory (a path or an open trajectory) or a `Simulation`. It returns an `Observable`:
an xarray.Dataset with uncertainties, units, theory and a `plot` method. Python imports each function when it
is first used. `lyapunov_exponent` needs a simulation that recorded its events.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
