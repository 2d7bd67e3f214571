"""The large particle's numbers, from made-up paths whose friction and diffusion are known."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.figures import brownian
from gaspart.reproduction.figures.brownian import Sphere, measure_msd
from gaspart.reproduction.points.point import Point


def point(boundary="periodic", **more):
    settings = {
        "scene": "config/scenes/brownian_heavy.yaml", "scene.container.boundary": boundary,
        "scene.species.0.count": 900, "displacements": True, "duration": 60.0, "samples": 300,
        "replicas": 300,
    }  # fmt: skip
    return Point("brownian_heavy", "single", "simulate", settings | more, "results/points", 1)


def paths(motion, replicas):
    """Ornstein-Uhlenbeck paths in 3D of the container's friction and drift, (T,), (T, 1, 3), (T, 1, 3)."""
    rng = np.random.default_rng(5)
    rest = 1.0 - motion.share
    rate, steps = motion.friction / rest, 300
    interval, fine = 0.1 / rate, 20
    width = np.sqrt(rest * motion.temperature / motion.mass)
    keep = np.exp(-rate * interval / fine)
    v = width * rng.standard_normal((replicas, 3))
    x = np.zeros_like(v)
    common = np.sqrt(rest * motion.share * motion.temperature / motion.mass)
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


def test_friction_diffusion_and_equipartition_of_known_paths(monkeypatch):
    """With the recoil that a finite gas gives back, and its drift, taken out."""
    chosen = point()
    motion = Sphere(chosen)
    assert motion.share == pytest.approx(0.1)
    found = paths(motion, 300)
    monkeypatch.setattr(brownian, "measured_paths", lambda _: found)
    ds = measure_msd([chosen], {}).isel(point=0)
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


def test_what_cannot_be_measured_is_refused(monkeypatch):
    with pytest.raises(gp.SceneError, match="displacements"):
        measure_msd([point(displacements=False)], {})
    short = [(np.arange(60.0), np.ones((60, 1, 3)), np.ones((60, 1, 3)))] * 2
    monkeypatch.setattr(brownian, "measured_paths", lambda _: short)
    with pytest.raises(gp.SceneError, match="must be .* or more"):
        measure_msd([point()], {})
    with pytest.raises(gp.SceneError, match="one entry of particles and one species"):
        Sphere(point(scene="config/scenes/brownian.yaml", **{"scene.particles": []}))
