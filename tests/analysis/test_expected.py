"""Theory of a run by the equation that its engine solves, and of its number of particles."""

import math

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.analysis.expected.equilibrium import compressibility_factor
from gaspart.analysis.expected.transport import diffusion_in_cube
from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import OBSERVABLES
from gaspart.analysis.run import open_run
from gaspart.inspection.checks import judge
from gaspart.inspection.readers import read_frames
from gaspart.scene.facts import Gas
from gaspart.theory import bulk
from gaspart.theory.modes import diffusion_by_modes
from gaspart.trajectory.correlator import Correlations

DENSE = gas(3, 278, 0.2, exact_temperature=True)
NUMBERS = ("Z", "collision_rate", "D")
OF_PLACES = ("rdf", "structure_factor", "chemical_potential")


@pytest.fixture(scope="module", params=["boltzmann", "enskog"])
def made(request, tmp_path_factory):
    """(model, path) of a run of the DSMC engine at a packing fraction of 0.2."""
    path = tmp_path_factory.mktemp(request.param) / "run.nc"
    engine = gp.DSMC(model=request.param)
    return request.param, gp.run(DENSE, engine, 3, 40.0, 0.125, path, displacements=True)


def test_a_run_of_a_kinetic_equation_is_compared_with_that_equation(made):
    """Of spheres that touch Z is 2.41, the rate 4.77 and D 0.40, not 1, 2.70 and 0.64."""
    model, path = made
    for name in NUMBERS:
        found = measure(path, name)
        scale = math.hypot(float(found.error), float(found[f"{found.attrs['quantity']}_theory_error"]))
        assert abs(float(found.estimate - found.theory)) <= 3.0 * scale, name
        assert model in found.attrs["source"].lower()
    of_spheres = float(gp.theory.compressibility_factor(DENSE.packing_fraction, 3))
    assert abs(float(measure(path, "Z").theory) - of_spheres) > (1.4 if model == "boltzmann" else 0.005)


def test_places_of_points_are_independent(made):
    """Nearer than a diameter there are 220 pairs in a frame, where spheres have none. Their number varies
    by 2 % from run to run, that of the 700 waves by 0.6 %: three seeds."""
    model, path = made
    if model == "enskog":
        assert all(measure(path, name).theory is None for name in OF_PLACES)
        return
    pairs, waves, inserted = (measure(path, name) for name in OF_PLACES)
    assert (pairs.theory == 1.0).all() and (waves.theory == 1.0).all()
    near = pairs.estimate.sel(distance=slice(0.0, 1.0))
    assert float(near.weighted(near["distance"] ** 2).mean()) == pytest.approx(1.0, abs=0.06)
    assert float(waves.estimate.mean()) == pytest.approx(1.0, abs=0.018)
    lattice = -278.0 * math.log(1.0 - 8.0 * DENSE.packing_fraction / 278.0)
    assert float(inserted.theory) == pytest.approx(lattice)
    assert float(inserted.estimate) == pytest.approx(lattice, abs=0.05)  # seeds scatter by 0.017


def test_the_check_of_a_healthy_run_of_dsmc_is_passed(made):
    _, path = made
    checks = {one.name: one for one in judge(read_frames(path))}
    assert checks["diffusion coefficient D"].passed
    assert not [one for one in checks.values() if one.passed is False]


def test_the_flow_that_cells_resolve_adds_to_diffusion():
    """By hand: 26 wave vectors of three cells a side; none with one cell, or with long free paths."""
    side, count, spreading = 9.0, 278, 1.035
    shortest = (2.0 * math.pi / side) ** 2
    expected = 2.0 / (3.0 * count * spreading * shortest) * (6.0 + 12.0 / 2.0 + 8.0 / 3.0)
    assert diffusion_by_modes(side, count, 3, 3, 0.6, spreading) == pytest.approx(expected)
    assert diffusion_by_modes(side, count, 3, 1, 0.6, spreading) == 0.0
    assert diffusion_by_modes(side, count, 3, 9, 9.0, spreading) == 0.0


def test_a_mixture_by_the_enskog_equation_is_its_contact_values():
    """Two equal halves are the gas of one species, exactly."""
    one = gas(3, 20, 0.2)
    half = gp.Scene(one.container, [gp.Species(10, one.species[0].radius, temperature=1.0)] * 2)
    found = []
    for scene in (one, half):
        simulation = gp.Simulation(scene, gp.DSMC(model="enskog"), seed=1)
        simulation.advance(duration=1.0)
        with open_run(simulation, None) as run:
            found.append(compressibility_factor(run)[0])
    assert found[0] == pytest.approx(found[1], rel=1e-12)
    beyond = float(gp.theory.carnahan_starling(0.2)) - 1.0
    assert found[0] == pytest.approx(1.0 + 0.95 * beyond, rel=1e-9)


@pytest.mark.thorough
def test_fluxes_by_the_boltzmann_equation(tmp_path):
    """The pressure of 64 particles about their centre of mass, and the bulk viscosity of cells."""
    scene = gas(3, 64, 0.01, exact_temperature=True)
    kept = Correlations(2.0, 10, stress=True)
    path = gp.run(scene, gp.DSMC(), 1, 4000.0, 20.0, tmp_path / "run.nc", correlations=kept)
    tensor = measure(path, "pressure_tensor")
    kinetic = 63.0 / scene.container.volume
    known = tensor.theory.sel(component=["xx", "yy", "zz"])
    assert np.allclose(known, kinetic, rtol=0.02)
    assert (abs(tensor.estimate - tensor.theory) < 3.5 * tensor.error).all()
    bulk = measure(path, "bulk_viscosity")  # of the cells alone; 0 without them
    assert float(bulk.theory) == pytest.approx(float(bulk.estimate), abs=3.0 * float(bulk.error))
    assert float(bulk.estimate) > 3.0 * float(bulk.error)


@pytest.mark.parametrize(("name", "least"), [("Z", 1.0), ("collision_rate", 0.0), ("pressure", math.nan)])
def test_a_theory_beside_an_engine_has_the_error_of_the_engine(name, least):
    """Of what collisions contribute: of Z - 1, of the rate, of the pressure beyond that of points."""
    scene = gas(3, 64, 0.2, boundary="wall" if name == "pressure" else "periodic", exact_temperature=True)
    errors, engine = [], gp.TimeStepped(time_step=0.1)
    for each in (gp.EventDriven(), engine):
        simulation = gp.Simulation(scene, each, seed=1)
        simulation.advance(duration=8.0)
        found = measure(simulation, name)
        errors.append(found[f"{found.attrs['quantity']}_theory_error"].values.min())
    if name == "pressure":
        least = 64.0 * np.prod(scene.container.lengths - np.ones(3)) ** -1.0
    kind = OBSERVABLES[name].discretised
    changed = engine.bias(scene, kind) * (found.theory.values.min() - least)
    assert changed > 0.005 * least
    assert errors[1] == pytest.approx(math.hypot(errors[0], changed), rel=0.05)


def test_each_bulk_theory_is_that_of_its_contact_value():
    dilute, dense = Gas(3, 1e-6, 100, 1.0, 1.0), Gas(3, 0.3, 100, 1.0, 1.0)
    for name in {one.bulk for one in OBSERVABLES.values()} - {""}:
        of = getattr(bulk, name)
        exact, points = of(dilute, bulk.EXACT), of(dilute, bulk.BOLTZMANN)
        assert exact == pytest.approx(points, rel=1e-5, abs=1e-5), name
    assert bulk.compressibility_factor(dense, bulk.ENSKOG) == pytest.approx(gp.theory.carnahan_starling(0.3))
    assert bulk.diffusion(dense, bulk.EXACT) / bulk.diffusion(dense, bulk.ENSKOG) == pytest.approx(
        float(gp.theory.erpenbeck_wood_ratio(0.3)), rel=0.01
    )
    assert math.isnan(bulk.diffusion(Gas(2, 0.3, 100, 1.0, 1.0), bulk.EXACT))


def test_d_is_what_its_window_gives():
    """Until 24 collisions of a particle it does not feel that a container is long, while the limit of D still
    grows with it: from 0.1940 to 0.1986."""
    found = []
    for count in (5000, 50000):
        side = (count * math.pi / 6.0 / 0.3) ** (1.0 / 3.0)
        found.append(diffusion_in_cube(Gas(3, 0.3, count, 1.0, 1.0), side, None, None)[0])
    assert found[0] == pytest.approx(found[1], rel=2e-3) and found[0] < 0.19
