"""Initial velocities of exactly the temperature that a scene states."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.state.initial import initial_state


def scene(boundary="periodic", exact=True, count=50, **more):
    gas = gp.Species(count, 0.3, mass=2.0, temperature=1.7, exact_temperature=exact)
    return gp.Scene(gp.Container((12.0, 9.0, 15.0), boundary), [gas], **more)


@pytest.mark.parametrize(
    ("boundary", "axes"),
    [("periodic", 3), (("periodic", "wall", "periodic"), 2), ("wall", 0)],
)
def test_the_temperature_about_the_conserved_momentum_is_exact(boundary, axes):
    for seed in range(3):
        state = initial_state(scene(boundary), seed)
        assert 2.0 * state.kinetic_energy / (3 * 50 - axes) == pytest.approx(1.7, rel=1e-14)
        still = np.array(scene(boundary).container.periodic)
        assert np.abs(state.momentum[still]).max(initial=0.0) < 1e-12
        assert (np.abs(state.momentum[~still]) > 1e-3).all()


def test_without_the_key_velocities_are_as_drawn():
    drawn, exact = (initial_state(scene("wall", exact), 3).velocities for exact in (False, True))
    assert np.ptp(exact / drawn) < 1e-12 and abs((exact / drawn).mean() - 1.0) > 1e-4
    assert "exact_temperature" not in scene(exact=False).to_dict()["species"][0]
    assert gp.Scene.from_dict(scene().to_dict()) == scene()


def test_obstacles_and_friction_take_up_momentum():
    post = gp.Particle((6.0, 4.5, 7.0), (0.0, 0.0, 0.0), 0.5, fixed=True)
    plate = gp.Plate((1.0, 1.0, 1.0), ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0)))
    rough, slit = gp.Restitution(tangential=1.0), ("periodic", "periodic", "wall")
    hot = {"z_low": gp.Thermal(1.0)}
    for boundary, more in (
        ("periodic", {"particles": [post]}),
        ("periodic", {"walls": [plate]}),
        (slit, {"restitution": rough}),
        (slit, {"faces": hot}),
    ):
        assert not any(scene(boundary, **more).conserved_axes)
        state = initial_state(scene(boundary, **more), 1)
        assert 2.0 * state.kinetic_energy == pytest.approx(1.7 * 150.0, rel=1e-14)
    assert all(scene(restitution=rough).conserved_axes)
    assert scene(slit, faces={"z_low": gp.Thermal(1.0, "normal")}).conserved_axes == (True, True, False)


def test_species_that_have_it_are_scaled_together():
    kinds = [
        gp.Species(20, 0.3, temperature=1.5, exact_temperature=True),
        gp.Species(10, 0.3, temperature=1.5),
        gp.Species(20, 0.3, mass=5.0, temperature=1.5, exact_temperature=True),
    ]
    drawn = [gp.Species(it.count, it.radius, mass=it.mass, temperature=1.5) for it in kinds]
    container = gp.Container((20.0, 20.0), "periodic")
    state, plain = (initial_state(gp.Scene(container, it), 1) for it in (kinds, drawn))
    chosen = np.r_[0:20, 30:50]
    energy = 0.5 * (state.masses[chosen, None] * state.velocities[chosen] ** 2).sum()
    assert 2.0 * energy / (2 * 40 - 2) == pytest.approx(1.5, rel=1e-14)
    assert (state.velocities[20:30] == plain.velocities[20:30]).all()


def test_what_has_no_temperature_is_refused():
    with pytest.raises(gp.SceneError, match="exact_temperature = True: needs the temperature of a species"):
        gp.Species(5, 0.5, speed=1.0, exact_temperature=True)
    with pytest.raises(gp.SceneError, match="exact_temperature = True: needs two particles or more"):
        initial_state(scene(count=1), 1)
    assert math.isfinite(initial_state(scene("wall", count=1), 1).kinetic_energy)
    resting = gp.Species(5, 0.5, temperature=0.0, exact_temperature=True)
    assert initial_state(gp.Scene(gp.Container((9.0, 9.0)), [resting]), 1).kinetic_energy == 0.0
