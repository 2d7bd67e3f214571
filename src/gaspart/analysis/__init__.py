"""Observables with uncertainties. The functions below are public (`gp.analysis`).

Each takes a trajectory, by its path or open, or a `Simulation`, and returns an `Observable`: an
xarray.Dataset with uncertainties, units and theory, which plots itself. A function is loaded when it is first
used. `lyapunov_exponent` takes a simulation that has recorded its events.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__, for_users=True)
