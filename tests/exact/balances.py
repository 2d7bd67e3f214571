"""Balances of each run, whatever its gas does: what counters of faces say of momentum, energy and bodies.

A balance is (difference of both sides, error of rounding), or a text: why it does not hold.
"""

import numpy as np

from gaspart.analysis import wall_force
from gaspart.errors import SceneError

SINGLE = 1e-6
"""Relative error of sums of numbers in single precision."""
WEIGHTS = 0.1
"""Effect of blocks that differ in length by one interval, in errors of the mean."""
DOUBLE = 1e-8
"""Relative error of sums over a run in double precision."""


def momentum(kind, data):
    """Return by what the momentum has changed, beyond gravity and what faces have been given."""
    if kind.opened or kind.sheared or kind.moving_face or not kind.case.empty:
        return "bodies, or walls inside, take momentum that is not tallied"
    momenta, sizes = _momenta(data)
    time = data["time"].values
    impulse, shear = data["wall_impulse"].values, data.get("wall_shear")
    apart, errors = [], []
    for k in range(kind.dimension):
        if shear is None and any(name[0] != "xyz"[k] for name in kind.dragging):
            continue  # faces take momentum along themselves, which is not tallied
        weight = _masses(data).sum() * kind.case.box.gravity[k] * (time - time[0])
        given = impulse[:, 2 * k + 1] - impulse[:, 2 * k]
        if shear is not None:
            others = [face for face in range(2 * kind.dimension) if face // 2 != k]
            given = given + shear.values[:, others, k].sum(axis=1)
        apart.append(momenta[:, k] - momenta[0, k] - weight + given)
        scale = np.abs(impulse[-1]).sum() + abs(weight[-1])
        errors.append(SINGLE * sizes.max() + DOUBLE * scale)
    if not apart:
        return "faces take momentum along themselves, which is not tallied"
    return np.array(apart), np.array(errors)[:, None]


def energy(kind, data):
    """Return by what the energy has changed, beyond what faces, contacts and kicks have taken."""
    if kind.sheared or kind.moving_face or kind.case.box.wells.any() or "vibrat" in str(kind.faces):
        return "a face works on the gas, or a potential steps"
    taken = data["wall_energy"].values.sum(axis=1) + data["dissipated_energy"].values
    taken = taken - data["thermostat_energy"].values
    kinetic = data["kinetic_energy"].values
    potential = 0.0 * kinetic
    if any(kind.case.box.gravity):
        potential = -(data["displacements"].values @ kind.case.box.gravity) @ _masses(data)
    total = kinetic + potential + taken
    if "vibrations" in data:
        total = total + data["vibrations"].values.sum(axis=1)
    gross = np.abs(data["wall_energy"].values).max() + np.abs(data["dissipated_energy"].values).max()
    error = DOUBLE * (kinetic.max() + gross + np.abs(potential).max())
    return total - total[0], np.array(error)


def impulses(kind, data):
    """Return by what the force on each face differs from its impulses over the time."""
    if kind.sheared or kind.case.periodic.all() or "sticky" in str(kind.faces):
        return "faces that no impulse describes"
    try:
        found = wall_force(data)
    except SceneError as error:
        return error.rule
    if found.attrs.get("estimator", "wall impulses") != "wall impulses":
        return "known fluctuations are subtracted"
    time, impulse = data["time"].values, data["wall_impulse"].values
    start = np.searchsorted(time, time[0] + 0.25 * (time[-1] - time[0]) * (1.0 - DOUBLE))
    mean = (impulse[-1] - impulse[start]) / (time[-1] - time[start])
    faces = [int(np.flatnonzero(data["face"].values == face)[0]) for face in found["face"].values]
    stated = found["wall_force_error"].values
    scatter = np.where(np.isfinite(stated), stated, np.abs(mean[faces]))  # without an error: a few hits
    error = SINGLE * np.abs(mean).max() + WEIGHTS * scatter
    return np.nan_to_num(found["wall_force"].values, nan=np.inf) - mean[faces], error


def bodies(kind, data):
    """Return by what the number of bodies has changed, beyond entries and exits."""
    if not kind.opened:
        return "the number of bodies is constant"
    number = np.isfinite(data["coordinates"].values[:, :, 0]).sum(axis=1)
    opened = [
        n for n, face in enumerate(data["face"].values) if str(face).replace(" ", "_") in kind.open_faces
    ]
    moved = (data["entries"].values - data["wall_hits"].values)[:, opened].sum(axis=1)
    return (number - number[0] - moved).astype(float), np.array(0.5)


def _masses(data):
    """Return the masses, 0 of fixed bodies."""
    return np.where(np.isfinite(data["mass"].values), data["mass"].values, 0.0)


def _momenta(data):
    """Return the momentum of all bodies in each frame, and the sum of their sizes."""
    each = data["velocities"].values.astype(float) * _masses(data)[:, None]
    each = np.nan_to_num(each)  # places without a body
    return each.sum(axis=1), np.abs(each).sum(axis=(1, 2))


BALANCES = {"momentum": momentum, "energy": energy, "impulses": impulses, "bodies": bodies}
"""Name of a balance -> rule."""
