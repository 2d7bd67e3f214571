"""The tally of the stress tensor and the heat flux: its definition, the virial and energy; its bits."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.analysis import transport
from gaspart.state.tally import StressTally
from gaspart.trajectory.recipe import Recipe, read_recipe
from gaspart.trajectory.run import simulation_of

CUBE, FLAT = gp.Container((4.0,) * 3, "periodic"), gp.Container((9.0, 7.0), "periodic")
PAIR = [gp.Species(20, 0.3, temperature=1.0), gp.Species(10, 0.2, mass=3.0, temperature=1.0)]
UNEQUAL = [replace(kind, polydispersity=0.3) for kind in PAIR]
SCENES = {
    "spheres": gp.Scene(CUBE, [PAIR[0]]),
    "mixture": gp.Scene(CUBE, PAIR),
    "discs": gp.Scene(FLAT, PAIR),
    "rough": gp.Scene(FLAT, PAIR, restitution=gp.Restitution(0.9, 0.5, contact_duration=0.0)),
    "sizes": gp.Scene(CUBE, [replace(PAIR[0], polydispersity=0.4)]),
    "inelastic sizes": gp.Scene(FLAT, UNEQUAL, restitution=gp.Restitution(0.8)),
}
ENGINES = {"event": gp.EventDriven(), "enskog": gp.DSMC(0.02, 1, "enskog")}


def drift_of(state):
    """(d,) the velocity of the centre of mass."""
    return state.momentum / state.masses.sum()


def energies(state):
    """(N,) kinetic energy of each particle about the centre of mass, that of rotation included."""
    spins = state.spins.reshape(state.count, -1)
    turning = np.where(spins != 0.0, state.moments_of_inertia[:, None] * spins**2, 0.0)
    relative = state.velocities - drift_of(state)
    return 0.5 * state.masses * (relative**2).sum(axis=1) + 0.5 * turning.sum(axis=1)


def integrals(simulation):
    """The two sums of a simulation from its start on, by their definition, from all states after events."""
    states = list(simulation.replay(by="event"))
    lengths = np.array(simulation.scene.container.lengths)
    d = len(lengths)
    stress, heat = np.zeros((d, d)), np.zeros(d)
    for before, after in itertools.pairwise(states):
        dt = after.time - before.time
        v, energy = before.velocities - drift_of(before), energies(before)
        stress += dt * np.einsum("n,na,nb->ab", before.masses, v, v)
        heat += dt * (energy @ v)
        changed = np.flatnonzero((after.velocities != before.velocities).any(axis=1))
        if len(changed) == 2:
            i, j = changed
            apart = after.positions[i] - after.positions[j]
            apart -= lengths * np.round(apart / lengths)
            gained = after.masses[i] * (after.velocities[i] - before.velocities[i])
            passed = energies(after)[changed] - energy[changed]
            stress += np.outer(apart, gained)
            heat += apart * 0.5 * (passed[0] - passed[1])
    return stress, heat


@pytest.mark.interpreted
@pytest.mark.parametrize("name", SCENES)
def test_event_driven_sums_are_those_of_their_definition(name):
    sim = gp.Simulation(SCENES[name], gp.EventDriven(), seed=2, stress=True)
    sim.advance(duration=3.0)
    assert sim.tally.collisions > 15
    stress, heat = integrals(sim)
    scale = abs(stress).max()
    assert np.allclose(sim.tally.stress_sum, stress, rtol=0.0, atol=1e-11 * scale)
    assert np.allclose(sim.tally.heat_sum, heat, rtol=0.0, atol=1e-11 * scale)


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_a_gas_that_moves_as_a_whole_has_the_fluxes_of_one_at_rest(name):
    """To rounding that collisions have let grow."""
    drift = np.array([5.0, -3.0, 0.7])[: SCENES[name].dimension]
    still = gp.Simulation(SCENES[name], gp.EventDriven(), seed=2, stress=True)
    state = still.initial_state.copy()
    state.velocities += drift
    other = gp.Simulation(SCENES[name], gp.EventDriven(), seed=2, stress=True, initial=state)
    for sim in (still, other):
        sim.advance(duration=3.0)
    assert still.tally.collisions == other.tally.collisions > 15
    mean = drift_of(still.initial_state)
    assert still.tally.flux_velocity == pytest.approx(mean, rel=1e-9)
    assert other.tally.flux_velocity == pytest.approx(mean + drift, rel=1e-9)
    for field in ("stress_sum", "collisional_stress_sum", "heat_sum"):
        one, two = getattr(still.tally, field), getattr(other.tally, field)
        assert np.allclose(one, two, rtol=0.0, atol=1e-8 * abs(one).max()), field
        assert abs(one).max() > 0.1


@pytest.mark.interpreted
@pytest.mark.parametrize("engine", ["event", "enskog"])
def test_the_trace_is_that_of_energy_and_virial(engine):
    """Of smooth elastic particles: twice the energy about the centre of mass by the time, and the virial."""
    sim = gp.Simulation(SCENES["mixture"], ENGINES[engine], seed=2, stress=True)
    sim.advance(duration=1.0)
    sim.reset_tally()
    sim.advance(duration=2.0)
    tally = sim.tally
    expected = 2.0 * energies(sim.state).sum() * tally.time + tally.virial_sum
    assert np.trace(tally.stress_sum) == pytest.approx(expected, rel=1e-12)
    assert tally.collisions > 10


@pytest.mark.thorough
def test_many_epochs_of_the_clocks_lose_nothing():
    """Until the clocks have started again a hundred times: the trace is exact to rounding."""
    sim = gp.Simulation(SCENES["discs"], gp.EventDriven(), seed=1, stress=True)
    sim.advance(duration=3000.0)
    tally = sim.tally
    expected = 2.0 * energies(sim.state).sum() * tally.time + tally.virial_sum
    assert np.trace(tally.stress_sum) == pytest.approx(expected, rel=1e-12)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("scene", "engine", "rule"),
    [
        (gas(2, 20, 0.1), gp.TimeStepped(time_step=0.01), "stress = True: .*engine"),
        (gas(2, 20, 0.1, "wall"), gp.EventDriven(), "boundary = .*periodic"),
        (
            replace(gas(2, 20, 0.1), thermostat=gp.Thermostat(1.0, 0.03)),
            gp.EventDriven(),
            "stress = True: .*kicks",
        ),
    ],
)
def test_what_cannot_be_tallied_is_refused(scene, engine, rule):
    with pytest.raises(gp.SceneError, match=rule):
        gp.Simulation(scene, engine, stress=True)


def run(path, scene, engine, interval, lags, frames, per_frame, follow=1):
    """A trajectory with correlations of the stress."""
    asked, sample = gp.Correlations(interval, lags, stress=True), interval * per_frame
    return gp.run(scene, engine, 3, sample * frames, sample, path, follow=follow, correlations=asked)


@pytest.mark.thorough
def test_viscosity_and_conductivity_of_a_dilute_gas_are_those_of_chapman_and_enskog(tmp_path):
    """By DSMC, with the error of its cells: 3 sigma, of 2.5 %."""
    count, width, step = 216, 0.5, 0.125
    length = 2.0 * width
    sigma = math.sqrt(length**3 / (count * math.sqrt(2.0) * math.pi))  # the mean free path is 1
    kind = gp.Species(count, 0.5 * sigma, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((length,) * 3, "periodic"), [kind])
    path = run(tmp_path / "run.nc", scene, gp.DSMC(step, 2), 4.0 * step, 20, 30, 600)
    coarse = 1.0 + 16.0 / (45.0 * math.pi) * width**2 + 16.0 / (75.0 * math.pi) * 2.0 * step**2
    viscosity = gp.analysis.shear_viscosity(path, start=0.0)
    expected = coarse * float(theory.enskog_viscosity(1e-12, 3, sigma))
    assert float(viscosity.error) < 0.03 * expected
    assert abs(float(viscosity.estimate) - expected) < 3.0 * float(viscosity.error)
    conductivity = gp.analysis.thermal_conductivity(path, start=0.0)
    expected = float(theory.enskog_conductivity(1e-12, 3, sigma)) * (
        1.0 + 32.0 / (225.0 * math.pi) * width**2
    )
    assert float(conductivity.error) < 0.04 * expected
    assert abs(float(conductivity.estimate) - expected) < 3.0 * float(conductivity.error)


@pytest.mark.interpreted
def test_a_file_has_the_optional_tallies_that_its_recipe_lists(tmp_path):
    """And no header of a run that lists none tells of them."""
    recipe = Recipe(gas(3, 20, 0.2), gp.EventDriven(), 1, 1.0, 0.5)
    assert "tallies" not in recipe.attributes() and "heat_sum" not in recipe.layout.variables
    asked = replace(recipe, tallies=(StressTally(),))
    (tmp_path / "run.nc").write_bytes(asked.header(""))
    assert read_recipe(tmp_path / "run.nc") == asked
    assert asked.layout.shape("stress_sum") == (3, 3)
    sim = simulation_of(asked)
    sim.advance(until=1.0)
    assert np.array_equal(sim.sums_of("stress")[-3:], sim.tally.heat_sum)
    with pytest.raises(gp.SceneError, match="stress = False: was not requested"):
        gp.Simulation(asked.scene, asked.engine, 1).sums_of("stress")


@pytest.mark.thorough
def test_green_and_kubo_agree_with_helfand(tmp_path):
    """The derivative of the squared change of G is the integral of the correlation, to the pairs at the ends;
    the pressure tensor is isotropic, with the trace of the virial."""
    path = run(tmp_path / "run.nc", gas(3, 64, 0.3), gp.EventDriven(), 0.05, 20, 20, 200, None)
    viscosity = gp.analysis.shear_viscosity(path, start=0.0)
    time = viscosity["lag"].values
    slope = np.diff(viscosity["helfand"].values[1:] * time[1:]) / np.diff(time[1:])
    assert slope == pytest.approx(viscosity["green_kubo"].values[1:-1], rel=0.02)
    tensor = gp.analysis.pressure_tensor(path, start=0.0)
    across = ~np.eye(3, dtype=bool).ravel()
    assert abs(tensor.estimate.values / tensor.error.values)[across].max() < 4.5
    z = float(gp.analysis.compressibility_factor(path, start=0.0).estimate)
    mean = float(tensor.estimate.values.reshape(3, 3).trace() / 3.0)
    with gp.open_trajectory(path) as data:
        ideal = 2.0 * float(data["kinetic_energy"][0]) / 3.0 / math.prod(gas(3, 64, 0.3).container.lengths)
    assert mean == pytest.approx(z * ideal, rel=0.02)


@pytest.mark.thorough
def test_older_files_are_measured_rightly_or_refused(tmp_path):
    """Without a mean velocity their fluxes are the same; with one, they are refused."""
    for exact in (True, False):
        scene = gas(3, 40, 0.2, exact_temperature=exact)
        path = run(tmp_path / f"{exact}.nc", scene, gp.EventDriven(), 0.05, 4, 20, 5)
        with gp.open_trajectory(path) as data:
            older = data.load().drop_vars("flux_velocity")
        if exact:
            new, old = (gp.analysis.thermal_conductivity(each, start=0.0) for each in (path, older))
            assert float(old.estimate) == float(new.estimate)
            continue
        for name in ("thermal_conductivity", "shear_viscosity", "pressure_tensor"):
            with pytest.raises(gp.SceneError, match="correlations = .*absolute velocities.*: run it again"):
                getattr(gp.analysis, name)(older, start=0.0)


@pytest.mark.thorough
def test_the_conductivity_of_a_gas_with_drawn_velocities_is_that_of_enskog(tmp_path):
    """Whose small mean velocity carried ten times as much heat: 3 sigma, of 10 %."""
    path = run(tmp_path / "run.nc", gas(3, 100, 0.15), gp.EventDriven(), 0.05, 40, 25, 600)
    found = gp.analysis.thermal_conductivity(path, start=0.0)
    assert float(found.error) < 0.12 * float(found.theory)
    assert abs(float(found.estimate) - float(found.theory)) < 3.0 * float(found.error)


@pytest.mark.parametrize("lasts", [2.0, 8.0, 30.0])
def test_correlations_that_last_longer_than_their_lags_are_warned_of(lasts, recwarn):
    """The integral of exp(-t / lasts) until 10 leaves out .7, 40 and 250 % of itself."""
    lags = np.linspace(0.0, 10.0, 11)
    noise = 0.001 * np.random.default_rng(3).standard_normal((16, 11)).cumsum(axis=1)
    transport._warn_of_rest("shear_viscosity", 1.0 - np.exp(-lags / lasts) + noise, 10.0)
    found = [float(re.search(r"some (\d+)% more", str(one.message))[1]) for one in recwarn]
    rest = 100.0 / np.expm1(10.0 / lasts)
    assert found == ([pytest.approx(rest, rel=0.1)] if rest > 3.0 else [])
