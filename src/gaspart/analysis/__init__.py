"""Observables with uncertainties. The functions below are the public ones, `gp.analysis`.

Each takes a trajectory, by its path or open, or a `Simulation`, and returns an `Observable`: an
xarray.Dataset with uncertainties, units and theory, which plots itself. They are loaded when first
used. `lyapunov_exponent` takes a simulation that has recorded its events.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_HOMES = {
    "Observable": "observable",
    "bulk_viscosity": "transport",
    "collision_rate": "pressure",
    "compressibility_factor": "pressure",
    "diffusion_coefficient": "motion",
    "lyapunov_exponent": "lyapunov",
    "mean_squared_displacement": "motion",
    "order_parameter": "structure",
    "pressure_tensor": "transport",
    "profile": "structure",
    "rdf": "structure",
    "shear_viscosity": "transport",
    "speed_distribution": "structure",
    "thermal_conductivity": "transport",
    "velocity_autocorrelation": "motion",
    "wall_pressure": "pressure",
}

__all__ = [*_HOMES]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"gaspart.analysis.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'gaspart.analysis' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
