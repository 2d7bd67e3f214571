"""Declarations of all named observables.

All parts of the program that use observables read these declarations.
These parts are `gaspart measure`, `sweep`, `advise`, `--until`, `check`, `info` and `theory`, figures of
users, the reference page and shell completion (`tests/workflow/test_observables.py`). The module
`declaration` defines the form of a declaration.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from gaspart.analysis import conditions as where
from gaspart.analysis.declaration import Named, units_in
from gaspart.errors import SceneError, unknown_word
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.faces import Open
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.state.tally import StressTally, WallShearTally

if TYPE_CHECKING:
    from gaspart.engines import Engine

KEPT: dict[str, tuple[str, Any, str]] = {
    "fluxes": (
        "correlations",
        None,
        "needs correlations of the stress: gaspart run --correlations T,L --stress",
    ),
    "pairs": ("pairs", False, "the run must count collisions by pairs: run with --pairs"),
}
"""Data that a run stores only on request. The entry of each is the key, the value and the rule of the error
message if the run lacks the data.
"""
_SAMPLED = "is of the positions of pairs, which DSMC does not have"
_OF_PAIRS: dict[str, Any] = {
    "samples": "structure",
    "nothing": dict.fromkeys(("boltzmann", "enskog"), _SAMPLED),
}
"""Common properties of the observables that are computed from the relative positions of particles."""
_FLUX: dict[str, Any] = {"needs": "fluxes", "lags": 100}
"""Common properties of the observables that are computed from correlations of the stress and the heat
flux.
"""

OBSERVABLES: dict[str, Named] = {
    "Z": Named(
        title="compressibility factor", symbol="Z",
        definition="compressibility factor PV/(N k_B T), periodic", units="1",
        function="compressibility_factor", needs_all_particles="unless fluxes",
        conditions=(
            where.refuse_shear, where.periodic_virial, where.elastic, where.without_obstacles, where.thermal,
        ),
        nothing={"boltzmann": "is 1 of particles without extent, whatever happens"},
        theory="equilibrium.compressibility_factor", discretised="rates", bulk="compressibility_factor",
        source="{state}", mixture="mixture_compressibility_factor", ends_runs=True, tabulated=True,
    ),
    "pressure": Named(
        title="pressure", definition="pressure on each wall", units="energy / length^d",
        function="wall_pressure", of_impulses=True, varying=True, needs_all_particles="never",
        along=("face",), conditions=(where.require_walls, where.refuse_shear),
        theory="equilibrium.wall_pressure", discretised="walls", power=1.0, by_impulses=True, ends_runs=True,
    ),
    "force": Named(
        title="force", definition="force on each wall", units="energy / length", function="wall_force",
        of_impulses=True, varying=True, needs_all_particles="never", along=("face",),
        conditions=(where.require_walls, where.refuse_shear), theory="equilibrium.wall_force",
        discretised="walls", power=1.0, ends_runs=True,
    ),
    "heat_flux": Named(
        title="heat flux", symbol="q",
        definition="heat given to each face at a temperature, per area, in a steady state",
        units="energy / (length^(d-1) time)", function="heat_flux", varying=True, needs_all_particles="never",
        along=("face",), conditions=(where.refuse_shear, where.thermal_walls), theory="flows.heat_flux",
        discretised="fluxes", power=1.5, ends_runs=True, drives=(where.heat_flows,), relative_to="norm",
    ),
    "wall_shear": Named(
        title="shear stress", symbol="τ",
        definition="shear stress on each face that is dragged along itself, in a steady state",
        units="energy / length^d", function="wall_shear", needs_all_particles="never",
        along=("face", "component"), needs="shear", conditions=(where.refuse_shear, where.dragged_walls),
        theory="flows.wall_shear", discretised="fluxes", power=1.0, ends_runs=True,
        drives=(where.velocity_flows,), relative_to="norm",
    ),
    "collision_rate": Named(
        title="collisions of a particle per time", definition="collisions of a particle per time",
        units="1 / time", function="collision_rate", conditions=(where.some_move,),
        theory="equilibrium.collision_rate", discretised="rates", bulk="collision_rate",
        source="exact in equilibrium, with g(sigma) from: {state}", mixture="mixture_collision_rates",
        power=0.5, ends_runs=True, tabulated=True,
    ),
    "pair_rates": Named(
        title="collisions of a particle per time", definition="collision rate of each pair of species",
        units="1 / time", function="pair_collision_rates", needs_all_particles="never", along=("pair",),
        needs="pairs", conditions=(where.refuse_shear, where.of_species), theory="equilibrium.pair_rates",
        discretised="rates", merged="split", power=0.5,
    ),
    "contact_values": Named(
        title="pair distribution at contact",
        definition="pair distribution at contact of each pair of species", units="1",
        function="contact_values", along=("pair",), needs="pairs",
        conditions=(
            where.refuse_shear, where.of_species, where.homogeneous, where.elastic, where.one_size_each,
            where.thermal,
        ),
        theory="equilibrium.contact_values", discretised="rates", merged="split",
    ),
    "msd": Named(
        title="mean-squared displacement", definition="mean-squared displacement", units="length^2",
        function="mean_squared_displacement", along=("lag",),
        selections=("species", "particles", "per_axis", "about"), needs="paths",
        conditions=(where.refuse_shear, where.require_particles, where.steady_flow),
        theory="transport.mean_squared_displacement", discretised="paths", scatter="particles", power=0.5,
        memory=True, lags=40,
    ),
    "D": Named(
        title="diffusion coefficient", symbol="D", definition="diffusion coefficient",
        units="length^2 / time", function="diffusion_coefficient",
        selections=("species", "particles", "per_axis", "lag", "about"), needs="paths",
        conditions=(
            where.refuse_shear, where.free_axis, where.no_lasting_discs, where.require_particles,
            where.steady_flow,
        ),
        theory="transport.diffusion", discretised="paths", bulk="diffusion",
        source="Enskog's theory times the ratio of Erpenbeck and Wood 1991; discs have none",
        scatter="particles", power=0.5, memory=True, samples="paths", ends_runs=True, tabulated=True,
    ),
    "mutual_diffusion": Named(
        title="mutual diffusion coefficient", definition="mutual diffusion of two species, periodic",
        units="length^2 / time", function="mutual_diffusion", needs="paths",
        conditions=(
            where.refuse_shear, where.two_species, where.periodic, where.elastic, where.no_lasting_discs,
        ),
        theory="transport.mutual_diffusion", discretised="paths", merged="lost", power=0.5, memory=True,
        samples="paths",
    ),
    "vacf": Named(
        title="velocity autocorrelation", definition="velocity autocorrelation", units="length^2 / time^2",
        function="velocity_autocorrelation", along=("lag",), selections=("species", "particles", "about"),
        conditions=(where.refuse_shear, where.require_particles, where.steady_flow),
        theory="transport.velocity_autocorrelation", discretised="paths", scatter="particles", power=1.0,
        memory=True, lags=40,
    ),
    "speeds": Named(
        title="density of speeds", definition="distribution of speeds", units="time / length",
        function="speed_distribution", along=("speed",), selections=("about",), ends="fastest",
        conditions=(where.require_particles,), theory="equilibrium.speeds", scatter="particles", power=0.5,
    ),
    "rdf": Named(
        title="radial distribution", symbol="g(r)", definition="radial distribution function, periodic",
        units="1", function="rdf", needs_all_particles="never", along=("distance",),
        conditions=(where.refuse_shear, where.homogeneous, where.a_pair), theory="places.radial_distribution",
        discretised="rates", **_OF_PAIRS,
    ),
    "structure_factor": Named(
        title="structure factor", symbol="S(k)", definition="static structure factor, periodic", units="1",
        function="structure_factor", along=("wave_number",),
        conditions=(where.refuse_shear, where.homogeneous), theory="places.structure_factor", **_OF_PAIRS,
    ),
    "partial_structure_factors": Named(
        title="partial structure factor", symbol="S(k)",
        definition="static structure factor of each pair of species, periodic", units="1",
        function="partial_structure_factors", along=("pair", "wave_number"),
        conditions=(where.refuse_shear, where.homogeneous, where.of_species),
        theory="places.partial_structure_factors", merged="split", relative_to="norm", **_OF_PAIRS,
    ),
    "chemical_potential": Named(
        title="excess chemical potential over k_B T",
        definition="chemical potential beyond an ideal gas's over k_B T, by insertion, periodic", units="1",
        function="chemical_potential", conditions=(where.refuse_shear, where.periodic, where.smooth_sizes),
        theory="places.chemical_potential", discretised="rates", bulk="chemical_potential", source="{state}",
        **_OF_PAIRS,
    ),
    "density": Named(
        title="number density", definition="density along an axis, by default the last", units="1 / length^d",
        function="profile", needs_all_particles="mixed", arguments={"of": "density"}, varying=True,
        along=("position",), selections=("axis", "species"), conditions=(where.has_axis, where.has_species),
        theory="places.density", by_impulses=True, ends_runs=True,
    ),
    "velocity": Named(
        title="mean velocity",
        definition="mean velocity along an axis, by default the last along which the flow varies",
        units="length / time", function="velocity_profile", varying=True, along=("component", "position"),
        selections=("axis", "species"), conditions=(where.has_axis, where.has_species),
        theory="flows.velocity", discretised="fluxes", moving=False, power=0.5, ends_runs=True,
        drives=(where.velocity_flows,), relative_to="norm",
    ),
    "flux": Named(
        title="net flux of particles",
        definition="particles that pass a plane or an opening across an axis per time, net", units="1 / time",
        function="particle_flux", varying=True, along=("component",), selections=("axis", "at", "species"),
        conditions=(where.refuse_shear, where.walled_axis, where.open_across, where.has_species),
        theory="flows.flux", power=0.5, ends_runs=True, drives=(where.streams,), relative_to="norm",
    ),
    "number": Named(
        title="number of particles", symbol="N",
        definition="mean number of particles inside, between open faces", units="1",
        function="particle_number", needs_all_particles="never", varying=True,
        conditions=(where.refuse_shear, where.require_open_faces), ends_runs=True,
    ),
    "temperature": Named(
        title="temperature", definition="temperature along an axis, by default the last", units="energy",
        function="profile", arguments={"of": "temperature"}, varying=True, along=("position",),
        selections=("axis", "species", "about"),
        conditions=(where.has_axis, where.has_species, where.thermal), theory="places.temperature", power=1.0,
    ),
    "shear_viscosity": Named(
        title="shear viscosity", symbol="η", definition="shear viscosity", units="mass length^(2-d) / time",
        function="shear_viscosity", selections=("lag",), needs_all_particles="never",
        conditions=(where.shears, where.fluctuates_or_shears, where.require_stress, where.thermal),
        theory="transport.shear_viscosity", discretised="fluxes", bulk="shear_viscosity",
        source="Enskog's theory, of dense spheres times a measured ratio, with g(sigma) from: {state}",
        power=0.5, memory=True, ends_runs=True, **_FLUX,
    ),
    "bulk_viscosity": Named(
        title="bulk viscosity", symbol="ζ", definition="bulk viscosity", units="mass length^(2-d) / time",
        function="bulk_viscosity", selections=("lag",), needs_all_particles="never",
        conditions=(where.refuse_shear, where.elastic, where.require_stress, where.thermal),
        nothing={"boltzmann": "is 0 of particles without extent; a run shows that of its cells"},
        theory="transport.bulk_viscosity", discretised="fluxes", bulk="bulk_viscosity",
        source="Enskog's theory, with g(sigma) from: {state}", power=0.5, memory=True, **_FLUX,
    ),
    "thermal_conductivity": Named(
        title="thermal conductivity", symbol="κ",
        definition="conductivity of heat, of a mixture without diffusion", units="1 / (length^(d-2) time)",
        function="thermal_conductivity", selections=("lag",), needs_all_particles="mixed",
        conditions=(where.refuse_shear, where.in_species, where.elastic, where.require_stress, where.thermal),
        theory="transport.thermal_conductivity", discretised="fluxes", bulk="thermal_conductivity",
        source="Enskog's theory, with g(sigma) from: {state}", power=0.5, memory=True, **_FLUX,
    ),
    "pressure_tensor": Named(
        title="pressure tensor", definition="components of the pressure tensor",
        units="mass / (length^(d-2) time^2)", function="pressure_tensor", needs_all_particles="never",
        along=("component",), conditions=(where.require_stress,), theory="equilibrium.pressure_tensor",
        discretised="rates", power=1.0, relative_to="norm", **_FLUX,
    ),
    "order": Named(
        title="bond order", definition="global bond order, periodic", units="1", function="order_parameter",
        conditions=(where.refuse_shear, where.homogeneous, where.a_neighbourhood), **_OF_PAIRS,
    ),
}  # fmt: skip
"""Observables by the name that the command line, a sweep and a config use."""


TOO_SHORT = ("frames", "duration", "collisions", "wall_hits", "start", "D", "mutual_diffusion")
"""Keys of the error messages that may not occur in a longer run."""


ALIASES: dict[str, str] = {
    "P": "pressure",
    "g(r)": "rdf",
    "S(k)": "structure_factor",
    "viscosity": "shear_viscosity",
    "conductivity": "thermal_conductivity",
    **{
        declared.function: name
        for name, declared in OBSERVABLES.items()
        if declared.function != name and not declared.arguments
    },
}
"""Other names of observables, including the names of their functions in `gaspart.analysis`."""


def observable_name(name: object) -> str:
    """Return the standard name of an observable, from its name or an alias; SceneError if unknown."""
    if isinstance(name, str):
        if name in OBSERVABLES:
            return name
        if name in ALIASES:
            return ALIASES[name]
    words = (*OBSERVABLES, *get_close_matches(str(name), ALIASES, n=1))
    raise SceneError("observable", name, unknown_word(name, words, "observable"))


def observables_with(**traits: Any) -> tuple[str, ...]:
    """Return the names of the observables whose declarations have these property values."""
    return tuple(
        name
        for name, declared in OBSERVABLES.items()
        if all(getattr(declared, trait) == value for trait, value in traits.items())
    )


def selecting(key: str) -> tuple[str, ...]:
    """Return the names of the observables that accept the selection `key`."""
    return tuple(name for name, declared in OBSERVABLES.items() if key in declared.selections)


def selections() -> tuple[str, ...]:
    """Return the keys of all selections that some observable accepts."""
    return tuple(dict.fromkeys(key for declared in OBSERVABLES.values() for key in declared.selections))


def about(name: str, dimension: int) -> dict[str, str]:
    """Return the units and the label of an observable, as attributes of its variable."""
    declared = OBSERVABLES[name]
    return {"units": units_in(declared.units, dimension), "long_name": declared.label}


def name_of(function: str) -> str:
    """Return the name of the observable that a function measures, or of the function."""
    return next((name for name, declared in OBSERVABLES.items() if declared.function == function), function)


def require_selection(name: str, selection: Mapping[str, Any]) -> None:
    """Raise SceneError for a selection that an observable does not accept."""
    for key, value in selection.items():
        if value is not None and key not in OBSERVABLES[name].selections:
            able = selecting(key)
            rule = f"cannot be chosen for {name}, only for {', '.join(able)}" if able else "is no selection"
            raise SceneError(key, value, rule)


def require_defined(name: str, scene: Scene, **selection: Any) -> None:
    """Raise SceneError, with the reason, if an observable or a selection is undefined for a scene."""
    declared = OBSERVABLES[observable_name(name)]
    require_selection(name, selection)
    if not declared.varying:
        refuse_open(scene, where.VARYING)
    for condition in declared.conditions:
        condition(scene, selection)


def require_run(name: str, scene: Scene, kept: Collection[str] = (), follow: int | None = None) -> None:
    """Raise SceneError if no run of a scene, of any length, can measure an observable. `kept`: names of the
    stored data, see `require_kept`. `follow`: number of particles in the file, the argument of `gaspart.run`;
    None for all.
    """
    require_defined(name, scene)
    required = {"mixed": len(scene.kinds) > 1, "unless fluxes": "fluxes" not in kept, "never": False}
    if (
        follow is not None
        and follow < scene.count
        and required.get(OBSERVABLES[name].needs_all_particles, True)
    ):
        raise SceneError("follow", follow, f"needs all {scene.count} particles in the file")
    require_kept(name, kept)


def walls_of(name: str, scene: Scene) -> tuple[str, ...]:
    """Return the walls that may have a value: all for pressure or force, else faces with a temperature."""
    if "face" not in OBSERVABLES[name].along:
        return ()
    if OBSERVABLES[name].of_impulses:
        return scene.container.walls
    return tuple(FACES[number].replace("_", " ") for number in scene.thermal_numbers)


def require_steady_value(name: str, scene: Scene) -> None:
    """Raise SceneError, with the reason, if an observable is 0 on average in the steady state. In a container
    whose open faces all lead to a vacuum, all observables are 0 in the steady state.
    """
    if scene.is_open and not any(face.temperatures for _, face in scene.faces_of(Open)):
        refuse_open(scene, "has no reservoir: all particles leave, and nothing is steady; give a duration")
    for condition in OBSERVABLES[observable_name(name)].drives:
        condition(scene, {})


def require_modelled(name: str, scene: Scene, engine: Engine) -> None:
    """Raise SceneError, with the reason, if runs of an engine do not determine an observable or its data."""
    declared = OBSERVABLES[observable_name(name)]
    if engine.equation in declared.nothing:
        raise SceneError("observable", name, declared.nothing[engine.equation])
    if declared.needs == "fluxes":
        engine.check_tally(StressTally(), scene)
    if declared.needs == "shear" and WallShearTally.name not in engine.tallies:
        raise SceneError("observable", name, "needs an engine that tallies momentum along faces")
    if declared.needs == "pairs" and not engine.records_events:
        raise SceneError("observable", name, "needs an engine that records events")


def require_kept(name: str, kept: Collection[str]) -> None:
    """Raise SceneError if a run lacks the data that an observable needs. The message names the option to set.
    `kept` contains the names of the data that the run has stored, such as "fluxes" or "pairs". Paths need not
    be stored, because they can be reconstructed from frames that are close enough in time.
    """
    needs = OBSERVABLES[observable_name(name)].needs
    if needs in KEPT and needs not in kept:
        raise SceneError(*KEPT[needs])
