"""The observables that have a name: on the command line, in a sweep and in a config."""

from __future__ import annotations

from typing import Any

from gaspart.errors import SceneError, unknown_word

OBSERVABLES: dict[str, tuple[str, dict[str, Any], str]] = {
    "Z": ("compressibility_factor", {}, "compressibility factor PV/(N k_B T), periodic"),
    "pressure": ("wall_pressure", {}, "pressure on each wall"),
    "collision_rate": ("collision_rate", {}, "collisions of a particle per time"),
    "pair_rates": (
        "pair_collision_rates",
        {},
        "collision rate of each pair of species, of a run with --pairs",
    ),
    "contact_values": (
        "contact_values",
        {},
        "pair distribution at contact of each pair of species, likewise",
    ),
    "msd": ("mean_squared_displacement", {}, "mean-squared displacement"),
    "D": ("diffusion_coefficient", {}, "diffusion coefficient"),
    "mutual_diffusion": ("mutual_diffusion", {}, "mutual diffusion of two species, periodic"),
    "vacf": ("velocity_autocorrelation", {}, "velocity autocorrelation"),
    "speeds": ("speed_distribution", {}, "distribution of speeds"),
    "rdf": ("rdf", {}, "radial distribution function, periodic"),
    "structure_factor": ("structure_factor", {}, "static structure factor, periodic"),
    "chemical_potential": ("chemical_potential", {}, "beyond the ideal gas's, by insertion, periodic"),
    "density": ("profile", {"of": "density"}, "density along the last axis"),
    "temperature": ("profile", {"of": "temperature"}, "temperature along the last axis"),
    "shear_viscosity": ("shear_viscosity", {}, "shear viscosity, of a run with --stress"),
    "bulk_viscosity": ("bulk_viscosity", {}, "bulk viscosity, likewise"),
    "thermal_conductivity": ("thermal_conductivity", {}, "conductivity of heat, likewise"),
    "pressure_tensor": ("pressure_tensor", {}, "components of the pressure tensor, likewise"),
    "order": ("order_parameter", {}, "global bond order, periodic"),
}
"""Name -> function of `gaspart.analysis`, its arguments, meaning."""
PAIRS = ("pair_rates", "contact_values")
"""Those that need a run which counts the collisions of each pair of species."""
FLUXES = ("shear_viscosity", "bulk_viscosity", "thermal_conductivity", "pressure_tensor")
"""Those that need a run which correlates the stress tensor and the heat flux."""
PATHS = ("msd", "D", "mutual_diffusion")
"""Those of paths, which need displacements in the file if frames are far apart."""
MOTION = ("msd", "vacf")
"""Those of lags, which are those of a run's correlations or else of its frames."""
CURVES = ("msd", "vacf", "speeds", "rdf", "structure_factor", "density", "temperature")
"""Those that are a curve; others are a number, or one for each face, pair or component."""
SELECTIONS = {
    "species": ("msd", "vacf", "D"),
    "particles": ("msd", "vacf"),
    "per_axis": ("msd", "D"),
    "axis": ("density", "temperature"),
}
"""Those that can be of one species, of some particles, along each axis, or along one of them."""
TOO_SHORT = ("frames", "duration", "collisions", "start", "D")
"""Keys of the errors of an analysis that a longer run may not have."""


def known(name: object) -> str:
    """The name of an observable. Raises SceneError for any other value."""
    if not isinstance(name, str) or name not in OBSERVABLES:
        raise SceneError("observable", name, unknown_word(name, OBSERVABLES, "observable"))
    return name
