"""physical_validation (Shirts and others): kinetic energies and the volumes under a piston are those of their
ensembles."""

import contextlib
import io
import json
import re

import netCDF4
import numpy as np
import physical_validation as pv
from finding import SIGMA, Finding, of_chance

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
BAR = 16.6054
"""Bar in the package's unit of energy over its unit of volume, kJ/mol/nm^3: it divides pressures by this."""
UNITS = pv.data.UnitData(
    kb=1.0,
    energy_conversion=1.0,
    length_conversion=1.0,
    volume_conversion=1.0,
    temperature_conversion=1.0,
    pressure_conversion=BAR,
    time_conversion=1.0,
)


def read(folder, name, *variables):
    """Variables (T, ...) of a file in double precision, without the first frames; what the scenes state."""
    stated = json.loads((folder / "stated.json").read_text())
    with netCDF4.Dataset(folder / f"{name}.nc") as file:
        return [np.array(file[key][stated["dropped"] :], dtype=float) for key in variables], stated


def canonical(stated, masses, positions, velocities, atoms=1):
    """The package's description of N molecules of some `atoms` (T, N * atoms, 3), rigid if of several."""
    number = len(masses)
    constraints = 3.0 * atoms - 6.0 if atoms > 1 else 0.0
    return pv.data.SimulationData(
        units=UNITS,
        ensemble=pv.data.EnsembleData(
            "NVT", natoms=number, volume=1.0, temperature=stated["temperature"]
        ),  # the volume enters no test
        system=pv.data.SystemData(
            natoms=number,
            nconstraints=constraints * number / atoms,
            ndof_reduction_tra=0,  # thermal faces conserve no momentum
            ndof_reduction_rot=0,
            mass=masses,
            molecule_idx=np.arange(0, number, atoms),
            nconstraints_per_molecule=np.full(number // atoms, constraints),
        ),
        observables=pv.data.ObservableData(
            kinetic_energy=0.5 * np.einsum("tnd,tnd,n->t", velocities, velocities, masses)
        ),
        trajectory=pv.data.TrajectoryData(position=positions, velocity=velocities),
    )


def mixture(folder):
    (positions, velocities), stated = read(folder, "thermal", "coordinates", "velocities")
    return canonical(stated, np.array(stated["masses"]), positions, velocities), stated


def kinetic_energy(folder):
    """The strict test: Kolmogorov and Smirnov's, of the distribution at the temperature of the faces."""
    data, stated = mixture(folder)
    p = pv.kinetic_energy.distribution(data, strict=True, verbosity=0)
    return of_chance(p, f"T = {stated['temperature']:g}")


def species(folder):
    """The same test of each species of the mixture."""
    data, stated = mixture(folder)
    masses = np.array(stated["masses"])
    groups = [np.flatnonzero(masses == mass).tolist() for mass in sorted(set(stated["masses"]))]
    with contextlib.redirect_stdout(io.StringIO()):
        found = pv.kinetic_energy.equipartition(data, strict=True, molec_groups=groups, verbosity=0)
    return of_chance(min(found[2:]), f"T = {stated['temperature']:g}", tests=len(groups))


def rough(folder):
    """Flight and spin of rough spheres: rigid molecules of four atoms with the sphere's moment of inertia."""
    (positions, velocities, spins), stated = read(folder, "rough", "coordinates", "velocities", "spins")
    corners = CORNERS * np.sqrt(1.5 * stated["moment_of_inertia"])  # (2/3) m a^2 of a regular tetrahedron
    of_atoms = (len(positions), -1, 3)
    data = canonical(
        stated,
        np.full(4 * positions.shape[1], 0.25),
        (positions[:, :, None] + corners).reshape(of_atoms),
        (velocities[:, :, None] + np.cross(spins[:, :, None], corners)).reshape(of_atoms),
        atoms=4,
    )
    with contextlib.redirect_stdout(io.StringIO()):
        total, flight, _, spin = pv.kinetic_energy.equipartition(data, strict=True, verbosity=0)
    return of_chance(min(total, flight, spin), f"T = {stated['temperature']:g}", tests=3)


def piston(folder):
    """The logarithm of the ratio of the densities of volumes under two pressures is linear, with the slope
    -(P2 - P1) / k_B T."""
    runs = []
    for name in ("piston_low", "piston_high"):
        (motion,), stated = read(folder, name, "piston")
        ensemble = pv.data.EnsembleData(
            "NPT", natoms=1, pressure=stated["pressures"][name], temperature=stated["temperature"]
        )
        volumes = pv.data.ObservableData(volume=stated["area"] * motion[:, 0])
        runs.append(pv.data.SimulationData(units=UNITS, ensemble=ensemble, observables=volumes))
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        (quantiles,) = pv.ensemble.check(*runs, verbosity=2)
    _, _, likeliest = printed.getvalue().partition("Maximum Likelihood")
    line = re.search(r"Estimated slope.*\n +(\S+) \+/- (\S+) +\| +(\S+)", likeliest)
    slope, error, true = line.groups()
    return Finding(f"slope {true}", f"{slope} ± {error}", abs(float(quantiles)), 3.0, SIGMA)
