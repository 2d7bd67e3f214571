"""Observables beside fixed particles and interior walls: rates of those that move, and what is refused."""

import math

import pytest

import gaspart as gp

STILL = (0.0, 0.0)


def posts(radius, period, number=2):
    """Fixed discs on a square lattice."""
    places = [(period * (i + 0.5), period * (k + 0.5)) for i in range(number) for k in range(number)]
    return [gp.Particle(place, STILL, radius, fixed=True) for place in places]


def agrees(found, exact, uncertainty=0.0):
    error = math.hypot(float(found.error), uncertainty)
    assert error < 0.05 * exact
    assert abs(float(found.estimate) - exact) < 4.0 * error


@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.TimeStepped(0.03125)])
def test_a_particle_among_fixed_ones_has_the_rate_of_santalo(engine, tmp_path):
    """v S / (pi A), with the perimeter S and the area A outside of the posts, which its radius widens."""
    scene = gp.Scene(
        gp.Container((10.0, 10.0), "periodic"), [gp.Species(1, 0.1, speed=1.0)], particles=posts(1.5, 5.0)
    )
    path = gp.run(scene, engine, 1, 9000.0, 6.0, tmp_path / "a.nc")
    exact = 8.0 * 1.6 / (100.0 - 4.0 * math.pi * 1.6**2)
    agrees(gp.analysis.collision_rate(path), exact)


@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.TimeStepped(0.004, threads=2)])
def test_collisions_with_fixed_particles_count_once(engine, tmp_path):
    """20 discs around 4 posts: 1.2435(12) by a Metropolis sampler, from the densities of pairs at contact."""
    gas = gp.Species(20, 0.15, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((6.0, 6.0), "periodic"), [gas], particles=posts(0.8, 3.0))
    path = gp.run(scene, engine, 1, 400.0, 1.0, tmp_path / "a.nc")
    agrees(gp.analysis.collision_rate(path), 1.2435, 0.0012)
    with gp.open_trajectory(path) as data:
        lacking = data.drop_vars("fixed_collisions").load()
    with pytest.raises(gp.SceneError, match="are not counted apart; make the run again"):
        gp.analysis.collision_rate(lacking)


PERIODIC = gp.Container((6.0, 6.0), "periodic")
GAS = gp.Species(20, 0.15, temperature=1.0)
WALLS = [gp.Wall((1.0, 1.0), (1.0, 5.0))]


@pytest.mark.parametrize("keys", [{"particles": posts(0.8, 3.0)}, {"walls": WALLS}], ids=["fixed", "walls"])
@pytest.mark.parametrize("name", ["Z", "rdf", "structure_factor", "order", "chemical_potential"])
def test_what_a_homogeneous_gas_has_is_refused_beside_obstacles(name, keys):
    scene = gp.Scene(PERIODIC, [GAS], **keys)
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    sim.advance(duration=2.0)
    with pytest.raises(gp.SceneError, match="pressure|homogeneous|smooth and elastic particles alone"):
        gp.measure(sim, name)


def test_contact_values_are_refused_beside_interior_walls(tmp_path):
    scene = gp.Scene(PERIODIC, [GAS], walls=WALLS)
    path = gp.run(scene, gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "a.nc", pairs=True)
    with pytest.raises(gp.SceneError, match="walls = 1: make places unlike"):
        gp.analysis.contact_values(path)
    assert (gp.analysis.pair_collision_rates(path).estimate > 0.0).all()
