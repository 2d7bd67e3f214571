"""Sheared faces: contacts worked out by hand, conservation laws, bits of all searches, and theory."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.scene.boundaries import flow

SEARCHES = {
    "direct": gp.EventDriven(search="direct"),
    "boxes": gp.EventDriven(search="boxes"),
    "columns": gp.EventDriven(search="boxes", boxes_per_side=(5, 1)),
    "rows": gp.EventDriven(search="boxes", boxes_per_side=(2, 5)),
    "pairs": gp.EventDriven(search="pairs"),
}


def sheared(rate, count=60, packing=0.3, dimension=2, species=None, **rest):
    """A periodic gas of diameter 1 that is sheared at a rate; None: one at rest."""
    lengths = (0.25 * count * math.pi / packing) if dimension == 2 else count * math.pi / 6.0 / packing
    container = gp.Container((lengths ** (1.0 / dimension),) * dimension, "periodic")
    faces = {} if rate is None else {"y_high": gp.LeesEdwards(rate)}
    return gp.Scene(container, species or [gp.Species(count, 0.5, temperature=1.0)], faces=faces, **rest)


def peculiar(scene, state):
    """(N, d) velocities about the flow."""
    return state.velocities - flow(scene, state.positions)


def thermal_energy(scene, state):
    return 0.5 * float((state.masses[:, None] * peculiar(scene, state) ** 2).sum()) + state.rotational_energy


def square(positions, velocities, rate):
    """Discs of diameter 1 in a square of side 10."""
    discs = [gp.Particle(x, v, 0.5) for x, v in zip(positions, velocities, strict=True)]
    container = gp.Container((10.0, 10.0), "periodic")
    return gp.Scene(container, particles=discs, faces={"y_high": gp.LeesEdwards(rate)})


@pytest.mark.interpreted
@pytest.mark.parametrize("search", ["direct", "boxes", "pairs"])
def test_a_crossing_displaces_a_particle_and_changes_its_velocity(search):
    scene = square([(3.0, 9.0), (8.0, 5.0)], [(1.0, 0.5), (0.0, 0.0)], 0.1)
    sim = gp.Simulation(scene, SEARCHES[search], 1)
    sim.advance(until=4.0)  # crosses at 2, with images above displaced by 2 and faster by 1
    state = sim.state
    assert state.velocities[0] == pytest.approx((0.0, 0.5))
    assert state.positions[0] == pytest.approx((3.0 + 2.0 - 2.0, 1.0))
    assert state.displaced == pytest.approx(4.0)
    assert state.unwrapped[0] == pytest.approx((3.0 + 4.0, 11.0))
    assert sim.tally.wall_energy[3] == pytest.approx(0.5)
    sim.advance(until=46.0)  # three crossings in all, the last two at v = 0 and -1
    assert sim.state.velocities[0] == pytest.approx((-2.0, 0.5))
    assert sim.state.unwrapped[0] == pytest.approx((3.0 + 46.0, 9.0 + 23.0))
    sim.check_invariants()


@pytest.mark.interpreted
@pytest.mark.parametrize("search", ["direct", "boxes", "pairs"])
@pytest.mark.parametrize("swapped", [False, True])
def test_a_contact_across_the_faces_is_as_worked_out_by_hand(search, swapped):
    """The image of the lower disc, at (2, 10) at time 0, moves at 1 in x with the images above, and meets the
    upper one at (4.5, 9.4), at rest, where they are 0.6 apart in y and 0.8 in x: at time 1.7."""
    discs = [((4.5, 9.4), (0.0, 0.0)), ((2.0, 0.0), (0.0, 0.0))]
    places, velocities = zip(*discs[:: -1 if swapped else 1], strict=True)
    sim = gp.Simulation(square(places, velocities, 0.1), SEARCHES[search], 1)
    sim.record_events = True
    sim.advance(until=1.7 - 1e-9)
    assert sim.tally.collisions == 0
    sim.advance(until=1.7 + 1e-9)
    assert sim.tally.collisions == 1 and sim.events["time"][0] == pytest.approx(1.7, abs=1e-12)
    upper, lower = sim.state.velocities[:: -1 if swapped else 1]
    # the normal from the image to the upper disc is (0.8, -0.6): 0.8 of the approach, along it, is exchanged
    assert upper == pytest.approx((0.64, -0.48))
    assert lower == pytest.approx((-0.64, 0.48))
    assert sim.state.kinetic_energy == pytest.approx(0.64)
    assert sim.tally.wall_energy.sum() == pytest.approx(-0.64)


@pytest.mark.interpreted
def test_a_particle_meets_an_image_that_comes_only_after_whole_lengths():
    """Slow across the flow: the discs come near in y when images have slid by some lengths."""
    scene = square([(5.0, 8.0), (5.0, 0.5)], [(0.0, 0.05), (0.0, 0.0)], 0.5)
    times = []
    for engine in SEARCHES.values():
        sim = gp.Simulation(scene, engine, 1)
        sim.record_events = True
        sim.advance(until=40.0)
        times.append(sim.events["time"][0])
        assert sim.tally.worst_contact < 1e-12
    assert 30.0 < times[0] < 40.0 and len(set(times)) == 1  # 1.5 / 0.05 until they are near in y


@pytest.mark.thorough
def test_neighbour_lists_and_oversized_particles_are_not_used():
    with pytest.raises(gp.SceneError, match="neighbour lists do not support sheared faces"):
        gp.Simulation(sheared(0.5), gp.EventDriven(search="lists"), 1)
    large = [gp.Species(200, 0.1, temperature=1.0), gp.Species(1, 2.0, temperature=1.0)]
    found = []
    for engine in (gp.EventDriven(), gp.EventDriven(search="direct")):
        sim = gp.Simulation(sheared(0.5, species=large), engine, seed=1)
        sim.advance(until=10.0)
        found.append(sim.state)
    assert (found[0].positions == found[1].positions).all()
    with pytest.raises(gp.SceneError, match="must not be narrower than the largest diameter"):
        gp.Simulation(sheared(0.5, species=large), gp.EventDriven(boxes_per_side=8), 1)


MIXED = [gp.Species(40, 0.5, mass=1.0, temperature=1.0), gp.Species(20, 0.25, mass=0.2, temperature=1.0)]
SIZES = [gp.Species(60, 0.5, polydispersity=0.3, temperature=1.0)]
LAWS = {"elastic": None, "inelastic": gp.Restitution(0.95), "rough": gp.Restitution(tangential=0.5)}


@pytest.mark.thorough
@pytest.mark.parametrize("rate", [0.6, -0.6])
@pytest.mark.parametrize("species", [None, MIXED, SIZES], ids=["alike", "mixture", "sizes"])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_energy_gained_is_the_work_of_the_stress(rate, species, law):
    """d(thermal energy) / dt = -shear rate V P_yx - losses, exactly; the faces' work, of all energy."""
    scene = sheared(rate, species=species, restitution=law)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=2, stress=True)
    before, whole = thermal_energy(scene, sim.state), sim.state.kinetic_energy
    sim.advance(until=6.0)
    tally, state = sim.tally, sim.state
    work = -rate * tally.stress_sum[1, 0]
    gained = thermal_energy(scene, state) - before
    assert abs(work) > 20.0
    assert gained == pytest.approx(work - tally.dissipated_energy, abs=1e-11 * state.kinetic_energy)
    taken = tally.wall_energy.sum() + tally.dissipated_energy
    assert state.kinetic_energy - whole == pytest.approx(-taken, abs=1e-11 * state.kinetic_energy)
    sim.check_invariants()


@pytest.mark.interpreted
@pytest.mark.parametrize("drift", [(0.7, 0.0), (0.0, -0.9), (0.5, 1.1)])
def test_a_sheared_gas_that_moves_as_a_whole_has_the_stress_of_one_at_rest(drift):
    """A drift across the flow carries the gas to where the flow is faster."""
    rate, sums = 0.4, []
    rng = np.random.default_rng(1)
    places = [(1.5 + 2.5 * (n % 4), 1.0 + 2.0 * (n // 4)) for n in range(16)]
    velocities = rng.normal(size=(16, 2))
    velocities -= velocities.mean(axis=0)
    along = np.array([(rate * (y - 5.0), 0.0) for _, y in places])
    for more in ((0.0, 0.0), drift):
        moved = map(tuple, velocities + more + along)
        sim = gp.Simulation(square(places, moved, rate), gp.EventDriven(), stress=True)
        sim.advance(until=0.7)
        sim.reset_tally()
        sim.advance(until=4.0)
        assert sim.tally.collisions > 15
        assert sim.tally.flux_velocity == pytest.approx(more, abs=1e-12)
        sums.append(sim.tally)
    for name in ("stress_sum", "collisional_stress_sum", "heat_sum"):
        one, two = (getattr(tally, name) for tally in sums)
        assert one == pytest.approx(two, abs=1e-8 * abs(one).max())


@pytest.mark.thorough
def test_momentum_about_the_flow_is_conserved():
    scene = sheared(1.0, species=MIXED)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=3)
    for _ in range(4):
        sim.advance(duration=3.0)
        momentum = sim.state.masses @ peculiar(scene, sim.state)
        assert momentum == pytest.approx(np.zeros(2), abs=1e-11)
    assert sim.tally.collisions > 500


@pytest.mark.interpreted
def test_without_shear_the_faces_are_periodic():
    """The same contacts, until rounding, which differs, has grown."""
    species = [gp.Species(60, 0.5, temperature=1.0, exact_temperature=True)]  # without a mean velocity
    scenes = [sheared(rate, species=species) for rate in (0.0, None)]
    gases = [gp.Simulation(scene, gp.EventDriven(), seed=5, stress=True) for scene in scenes]
    for sim in gases:
        sim.advance(max_events=60)
    one, other = gases
    assert one.time == pytest.approx(other.time, rel=1e-9)
    assert one.state.positions == pytest.approx(other.state.positions, abs=1e-7)
    assert one.state.unwrapped == pytest.approx(other.state.unwrapped, abs=1e-7)
    assert one.tally.stress_sum == pytest.approx(other.tally.stress_sum, abs=1e-6)
    assert one.tally.heat_sum == pytest.approx(other.tally.heat_sum, abs=1e-6)
    assert one.tally.wall_energy.sum() == 0.0


@pytest.mark.thorough
def test_the_profile_of_the_flow_is_linear():
    scene = sheared(0.3, 400, 0.2, restitution=gp.Restitution(normal=0.8))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=7)
    sim.advance(until=150.0)
    profile = gp.analysis.field(sim, of="velocity", axes="y", cells=5)
    y, u = profile["y"].values, profile["velocity"].values[0]
    errors = profile["velocity_error"].values[0]
    expected = 0.3 * (y - 0.5 * scene.container.lengths[1])
    assert abs(expected).max() > 3.0
    assert (np.abs(u - expected) < 5.0 * errors + 0.02).all()


@pytest.mark.thorough
@pytest.mark.parametrize(("packing", "rate", "duration"), [(0.05, 0.04, 400.0), (0.2, 0.15, 60.0)])
def test_the_response_is_the_viscosity_of_enskog(packing, rate, duration):
    """Spheres at a dilute and a moderate density; noise is 2 %. Each interval over sqrt(T), by which the gas
    and its viscosity scale while it heats."""
    scene = sheared(rate, 4000, packing, 3)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=8, stress=True)
    sim.advance(until=0.1 * duration)
    ratios = []
    for _ in range(20):
        sim.reset_tally()
        begin = thermal_energy(scene, sim.state)
        sim.advance(duration=0.045 * duration)
        temperature = (begin + thermal_energy(scene, sim.state)) / (3.0 * scene.count)
        found = -sim.tally.stress_sum[1, 0] / (rate * scene.container.volume * sim.tally.time)
        expected = gp.theory.enskog_viscosity(packing, 3, temperature=temperature, mass=1.0, diameter=1.0)
        ratios.append(found / expected)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.05)


@pytest.mark.thorough
def test_a_granular_gas_has_the_temperature_and_stress_of_grads_method():
    """A dilute gas in which shear heats as fast as contacts cool (Grad's method; Santos, Garzo & Dufty, Phys.
    Rev. E 69, 061303 (2004)): with b = (1 + e)(3 - e)/4 - z, z = 5 (1 - e^2)/12, P_yy/p = b/(b + z), P_xx/p =
    (b + 3 z)/(b + z), and the shear rate over p/eta is sqrt(3 z / 2 b) (b + z)."""
    e, packing, rate = 0.95, 0.005, 0.02  # terms of second order in 1 - e^2 are missing in the formulae
    scene = sheared(rate, 1000, packing, 3, restitution=gp.Restitution(normal=e))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=9, stress=True)
    sim.advance(until=2500.0)
    sim.reset_tally()
    temperatures = []
    for _ in range(40):
        sim.advance(duration=100.0)
        temperatures.append(2.0 * thermal_energy(scene, sim.state) / (3.0 * scene.count))
    temperature, tally = float(np.mean(temperatures)), sim.tally
    pressures = tally.stress_sum / np.trace(tally.stress_sum) * 3.0
    lost = 5.0 * (1.0 - e * e) / 12.0
    total = (1.0 + e) * (3.0 - e) / 4.0
    rest, reduced = total - lost, math.sqrt(1.5 * lost / (total - lost)) * total
    assert pressures[0, 0] == pytest.approx((rest + 3.0 * lost) / total, abs=0.02)
    assert pressures[1, 1] == pytest.approx(rest / total, abs=0.015)
    assert pressures[2, 2] == pytest.approx(rest / total, abs=0.02)
    assert pressures[1, 0] == pytest.approx(-1.5 * lost / reduced, abs=0.01)
    # p / eta of the dilute gas, times g(sigma) for the collisions
    density = scene.count / scene.container.volume
    eta = gp.theory.enskog_viscosity(1e-9, 3) * math.sqrt(temperature)
    frequency = density * temperature / eta * gp.theory.contact_value(packing, 3)
    assert rate / frequency == pytest.approx(reduced, rel=0.03)
    assert rate * tally.stress_sum[1, 0] == pytest.approx(-tally.dissipated_energy, rel=0.01)
