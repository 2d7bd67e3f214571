"""The large particle's numbers, from made-up paths whose friction and diffusion are known."""

from __future__ import annotations

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.figures import brownian
from gaspart.reproduction.figures.brownian import Sphere, measure_msd, measure_paths
from gaspart.reproduction.points.point import Point


def point(replicas=300, boundary="periodic", **more):
    """A point whose scene file is replaced by `motion`'s scene in these tests."""
    settings = {
        "scene": "config/scenes/brownian_heavy.yaml", "scene.container.boundary": boundary,
        "scene.species.0.count": 900, "displacements": True, "duration": 60.0, "samples": 300,
        "replicas": replicas,
    }  # fmt: skip
    return Point("brownian_heavy", "single", "simulate", settings | more, "results/points", 1)


def paths(motion, replicas, drift=0.0):
    """Ornstein-Uhlenbeck paths in 3D of the container's friction, (T,), (T, 1, 3), (T, 1, 3) each."""
    rng = np.random.default_rng(5)
    rest = 1.0 - motion.share
    rate, steps = motion.friction / rest, 300
    interval, fine = 0.1 / rate, 20
    width = np.sqrt(rest * motion.temperature / motion.mass)
    keep = np.exp(-rate * interval / fine)
    v = width * rng.standard_normal((replicas, 3))
    x = np.zeros_like(v)
    common = drift * np.sqrt(rest * motion.share * motion.temperature / motion.mass)
    common = common * rng.standard_normal((replicas, 3))
    moved, velocities = [x], [v]
    for _ in range(steps):
        for _ in range(fine):
            new = keep * v + width * np.sqrt(1 - keep**2) * rng.standard_normal(v.shape)
            x = x + 0.5 * (v + new) * interval / fine
            v = new
        moved.append(x)
        velocities.append(v)
    time = interval * np.arange(steps + 1)
    moved = np.array(moved) + common * time[:, None, None]
    velocities = np.array(velocities) + common
    return [(time, moved[:, k, None], velocities[:, k, None]) for k in range(replicas)]


@pytest.fixture
def made_up(monkeypatch):
    """Let the measurement read made-up paths."""

    def use(chosen, found):
        monkeypatch.setattr(brownian, "measured_paths", lambda given: found)
        return chosen

    return use


def test_friction_diffusion_and_equipartition_of_known_paths(made_up):
    """With the recoil that a finite gas gives back, and its drift, taken out."""
    chosen = point()
    motion = Sphere(chosen)
    assert motion.share == pytest.approx(0.1)
    ds = measure_msd([made_up(chosen, paths(motion, 300, drift=1.0))], {}).isel(point=0)
    for name, expected in (
        ("equipartition", 1.0),
        ("measured_friction", motion.friction),
        ("measured_diffusion", motion.diffusion),
    ):
        value, error = float(ds[name]), float(ds[f"{name}_error"])
        assert 0.002 * expected < error < 0.05 * expected, name
        assert abs(value - expected) < 3.5 * error, name
    assert float(ds["vacf"][0]) == pytest.approx(1.0, abs=0.05)
    assert float(ds["time"][-1]) == pytest.approx(8.0)
    late = np.nanargmin(np.abs(ds["time"].values - 5.0))
    assert float(ds["msd"][late]) == pytest.approx(4.0, rel=0.1)


def test_between_walls_nothing_is_given_back():
    motion = Sphere(point(boundary="wall"))
    assert motion.share == 0.0
    assert motion.diffusion * motion.friction * motion.mass == pytest.approx(motion.temperature)
    light = Sphere(point(boundary="wall", **{"scene.particles.0.mass": 1.0}))
    assert light.diffusion * light.friction == pytest.approx(1.01895)


def test_ends_of_paths(made_up):
    chosen = point(boundary="wall")
    motion = Sphere(chosen)
    found = [(t, x, v) for t, x, v in paths(motion, 200)]
    ds = measure_paths([made_up(chosen, found)], {"paths": 3}).isel(point=0)
    assert ds["way"].shape == (3, 301, 3) and int(ds["end_freedom"]) == 600
    # these start in equilibrium, not at rest: farther by (30 - 1) / (30 - 1.5)
    ratio = float(ds["end_chi_square"] / ds["end_freedom"])
    assert ratio == pytest.approx(29.0 / 28.5, abs=4 * np.sqrt(2 / 600))


@pytest.mark.thorough
def test_both_engines_move_the_sources_sphere_along_one_path():
    """From one start the paths differ by rounding only, which grows about fifteenfold in 30 units of time: no
    contact is missed, not even of the huge sphere. Seeds 0 to 5 have 1e-10 to 3e-9 after 60."""
    scene = gp.Scene.from_file("config/scenes/brownian.yaml")
    ends = []
    for engine in (gp.EventDriven(), gp.TimeStepped(time_step=0.05)):
        simulation = gp.Simulation(scene, engine, seed=3)
        simulation.advance(duration=60.0)
        ends.append(simulation.state.positions[0])
    assert np.linalg.norm(ends[0] - 160.0) > 10.0
    assert ends[1] == pytest.approx(ends[0], abs=1e-6)


def test_what_cannot_be_measured_is_refused(made_up):
    with pytest.raises(gp.SceneError, match="displacements"):
        measure_msd([point(displacements=False)], {})
    short = point()
    motion = Sphere(short)
    found = [(t[:60], x[:60], v[:60]) for t, x, v in paths(motion, 2)]
    with pytest.raises(gp.SceneError, match="must be .* or more"):
        measure_msd([made_up(short, found)], {})
    with pytest.raises(gp.SceneError, match="one entry of particles and one species"):
        Sphere(point(scene="config/scenes/brownian.yaml", **{"scene.particles": []}))
