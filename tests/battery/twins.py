"""Runs that start from the same state seen otherwise, or in other units: each variable of their files, for as
long as chaos has not made rounding large."""

from dataclasses import dataclass, replace

import numpy as np
from battery.isometries import View, data_seen, seen, state_seen
from battery.kinds_of_runs import FEW, KINDS, start_of
from battery.scaling import UNITS, data_in_units, engine_in_units, scene_in_units, state_in_units
from battery.symmetries import views

import gaspart as gp
from gaspart.errors import SceneError

ALIKE = 2e-5
"""Relative difference of variables, some of which are in single precision, after `FEW` intervals."""
COSTS = {"pair_tests", "box_visits", "crossings", "rebuilds", "worst_contact", "deepest_overlap"}
"""What depends on how particles are found."""
CELL = {"cell_lengths", "cell_origin"}
"""The container of the moment: it follows from the scene and from `piston`, which is compared."""
DRAWN = ("thermal", "thermal_walls", "sliding", "thermostat")
"""Features that draw random numbers, for each particle and face by their numbers."""


@dataclass(frozen=True)
class Twin:
    """What was found of a pair of runs; as `symmetries.Cell`."""

    symmetry: str
    engine: str
    scene: str
    state: str
    text: str = ""
    deviation: float = 0.0


def base(engine, name):
    """What both runs start from: the state is given, where it can be."""
    start = start_of(engine, name)
    initial = start.initial or gp.Simulation(start.scene, start.engine, start.seed).initial_state
    return replace(start, initial=initial)


def refusal(engine, name, symmetry, view):
    """Why the pair of runs does not exist; "" if it does."""
    if not isinstance(view, View):
        return view
    start = base(engine, name)
    present = start.scene.features
    if "open" in present:
        return "what enters is drawn by the numbers of faces and the places on them"
    if engine.startswith("dsmc") and symmetry != "moving":
        return "partners are drawn by the numbers of cells and particles"
    if present & set(DRAWN) and symmetry not in ("shifted", "moving"):
        return "random numbers belong to the numbers of particles and faces"
    if engine == "dsmc enskog" and not all(start.scene.container.periodic):
        return "what is tried depends on the largest speed along the walls"
    if engine.startswith("dsmc") and "sliding" in present:
        return "faces draw velocities at the places of a step"
    return ""


def of_views(engine, name):
    """The twins of a run that are views of it."""
    start = base(engine, name)
    for symmetry, view in views(KINDS[name]).items():
        if why := refusal(engine, name, symmetry, view):
            yield Twin(symmetry, engine, name, "not defined", why)
            continue
        if engine.startswith("dsmc"):  # which has no cells of its own in a frame that moves on by all of them
            side = start.scene.container.lengths[KINDS[name].moving]
            view = replace(view, velocity=tuple(np.sign(view.velocity) * side / start.engine.time_step))
        other = replace(
            start,
            scene=seen(start.scene, view),
            initial=state_seen(start.scene, view, start.initial),
            along=None if start.along is None else view.axis(start.along),
        )
        try:
            yield from _compared(
                symmetry, engine, name, start, other, lambda data, view=view: data_seen(data, view)
            )
        except SceneError as error:
            yield Twin(symmetry, engine, name, "not defined", error.rule)


def in_units(engine, name):
    """The twin in other units, which has the same bits."""
    start = start_of(engine, name)
    other = replace(
        start,
        scene=scene_in_units(start.scene),
        engine=engine_in_units(start.engine),
        interval=start.interval * UNITS["time"],
        initial=start.initial and state_in_units(start.initial),
    )
    yield from _compared("units", engine, name, start, other, data_in_units, 0.0, set())


def _compared(symmetry, engine, name, start, other, change, limit=ALIKE, left_out=frozenset(COSTS)):
    """The twin, by its variable that differs most."""
    worst, which = 0.0, ""
    for form in start.forms:
        expected, found = change(start.record(form, FEW)), other.record(form, FEW)
        assert set(expected.variables) == set(found.variables)
        lengths = np.array(other.scene.container.lengths)
        for key in sorted(set(expected.data_vars) - set(left_out) - CELL):
            old, new = (_without_constant(one, other) if key == "momentum_flux_sum" else one[key]
                        for one in (expected, found))  # fmt: skip
            apart = _apart(old.values, new, _size(key, found), lengths)
            if apart > worst:
                worst, which = apart, f"{form}: {key}"
    state = "tested" if worst <= limit else "broken"
    yield Twin(symmetry, engine, name, state, which, worst)


def _without_constant(data, start):
    """The momentum that has flown through planes, along a periodic axis less its mean, which is not known."""
    flown = data["momentum_flux_sum"]
    return flown - flown.mean("bin") if start.scene.container.periodic[start.along] else flown


def _size(key, data):
    """The largest value of a variable; of what may vanish but for rounding, such as the flux of heat of two
    particles and the stress that turns, that of the stress that shears, times the largest speed."""
    kind = key.partition("_")[2]
    speed = float(np.abs(data["velocities"].values).max()) if key.startswith("heat") else 1.0
    if key == "heat_sum":
        return speed * float(np.abs(data["stress_sum"].values).max())
    if key.startswith(("rotational", "heat")):
        return speed**2 * float(np.abs(data[f"shear_{kind}"].values).max())
    return float(np.nanmax(np.abs(data[key].values), initial=0.0))


def _apart(old, new, size, lengths):
    """The largest difference, of positions the nearest images', over the size of the values."""
    difference = new.values - old
    if new.name == "coordinates":
        difference -= lengths * np.round(difference / lengths)
    if not np.array_equal(np.isnan(old), np.isnan(new.values)):  # of other particles
        return np.inf
    largest = float(np.nanmax(np.abs(difference), initial=0.0))
    return largest / size if size else largest
