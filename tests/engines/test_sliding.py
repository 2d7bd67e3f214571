"""Thermal faces that slide: the momentum, the work and the velocity that they give, by both engines."""

import pytest

import gaspart as gp

ENGINES = {
    "event": gp.EventDriven(),
    "dsmc": gp.DSMC(time_step=0.25, cells_per_side=1),
}


def between(speed, radius=1e-3, count=400, **rest):
    """A gas between two walls across x that slide along y."""
    faces = {
        "x_low": gp.Thermal(1.0, velocity=(0.0, -0.5 * speed, 0.0)),
        "x_high": gp.Thermal(1.0, velocity=(0.0, 0.5 * speed, 0.0)),
    }
    container = gp.Container((5.0, 10.0, 10.0), ("wall", "periodic", "periodic"))
    return gp.Scene(container, [gp.Species(count, radius, temperature=1.0)], faces=faces, **rest)


def momentum(state):
    """(d,) of all particles."""
    return state.masses @ state.velocities


@pytest.mark.thorough
@pytest.mark.parametrize("engine", ENGINES)
def test_momentum_is_conserved_with_that_of_the_walls(engine):
    sim = gp.Simulation(between(1.0, radius=0.2), ENGINES[engine], seed=4)
    before, energy = momentum(sim.state), sim.state.kinetic_energy
    sim.advance(duration=5.0)
    assert sim.tally.collisions > 100
    lost = before - momentum(sim.state)
    assert sim.tally.wall_shear.sum(axis=0)[1:] == pytest.approx(lost[1:], abs=1e-7)
    assert sim.tally.wall_energy.sum() == pytest.approx(energy - sim.state.kinetic_energy, abs=1e-6)


@pytest.mark.interpreted
def test_a_velocity_of_zero_changes_nothing():
    still, free = (between(0.0, radius=0.2) for _ in range(2))
    free = gp.Scene(free.container, free.species, faces=dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0)))
    states = []
    for scene in (still, free):
        sim = gp.Simulation(scene, ENGINES["dsmc"], seed=2)
        sim.advance(duration=1.0)
        assert sim.tally.wall_shear is None
        states.append(sim.state)
    assert (states[0].velocities == states[1].velocities).all()


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("velocity", "rule"),
    [((1.0, 0.0, 0.0), "no component across"), ((0.0, 1.0), "3 finite numbers"), ("fast", "finite numbers")],
)
def test_a_velocity_lies_along_the_face(velocity, rule):
    scene = between(1.0)
    with pytest.raises(gp.SceneError, match=f"velocity = .*{rule}"):
        gp.Scene(scene.container, scene.species, faces={"x_low": gp.Thermal(1.0, velocity=velocity)})


@pytest.mark.interpreted
def test_what_cannot_slide_is_refused():
    with pytest.raises(gp.SceneError, match='velocity = .*components "all"'):
        gp.Thermal(1.0, "normal", (0.0, 1.0, 0.0))
