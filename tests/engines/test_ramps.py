"""Thermal faces whose temperature varies along them: a closed vessel without collisions, exactly."""

import math
from functools import cache

import numpy as np
import pytest

import gaspart as gp

LENGTH, WIDTH, COLD, HOT, COUNT = 16.0, 4.0, 1.0, 4.0, 400
ENGINES = {"event": gp.EventDriven(), "dsmc": gp.DSMC(0.5, 1, "boltzmann")}
BLOCKS = 32
RAMP = gp.Thermal({"x_low": COLD, "x_high": HOT})
ENDS = {"x_low": gp.Thermal(COLD), "x_high": gp.Thermal(HOT)}
VESSEL = gp.Scene(
    gp.Container((LENGTH, WIDTH)),
    [gp.Species(COUNT, 2e-5, temperature=2.0)],
    faces=ENDS | {"y_low": RAMP, "y_high": RAMP},
)
"""A slit whose walls are ever hotter from one end to the other."""


@cache
def blocks(engine):
    """(BLOCKS, 4) hits of the faces, and (BLOCKS, 4) the mean number in each quarter."""
    simulation = gp.Simulation(VESSEL, ENGINES[engine], seed=1)
    simulation.advance(duration=60.0)
    hits, numbers = [], []
    for _ in range(BLOCKS):
        simulation.reset_tally()
        seen = []
        for _ in range(8):
            simulation.advance(duration=4.0)
            seen.append(np.histogram(simulation.state.positions[:, 0], 4, (0.0, LENGTH))[0])
        hits.append(simulation.tally.wall_hits.copy())
        numbers.append(np.mean(seen, axis=0))
    simulation.check_invariants()
    return np.array(hits), np.array(numbers)


def from_walls(x, y, angles=720):
    """(...) the mean of T^(-1/2) over the walls that are seen from places (...), by the angle."""
    angle = (np.arange(angles) + 0.5) * 2.0 * math.pi / angles
    u, v = np.cos(angle), np.sin(angle)
    across = np.where(u > 0.0, LENGTH - x[..., None], x[..., None]) / np.abs(u)
    along = np.where(v > 0.0, WIDTH - y[..., None], y[..., None]) / np.abs(v)
    place = x[..., None] + u * np.minimum(across, along)
    return ((COLD + (HOT - COLD) * place / LENGTH) ** -0.5).mean(axis=-1)


@pytest.mark.thorough
@pytest.mark.parametrize("engine", ENGINES)
def test_all_walls_of_a_closed_vessel_are_hit_equally_often(engine):
    """By the cosine law there is one rate of hits per length, whatever the temperatures (Knudsen 1909)."""
    rates = blocks(engine)[0] / np.array([WIDTH, WIDTH, LENGTH, LENGTH])
    error = rates.std(axis=0, ddof=1) / math.sqrt(BLOCKS)
    mean = np.average(rates.mean(axis=0), weights=[WIDTH, WIDTH, LENGTH, LENGTH])
    assert (error < 0.03 * mean).all()
    for face in range(4):
        assert rates[:, face].mean() == pytest.approx(mean, abs=3.0 * math.hypot(error[face], error[2] / 3))


@pytest.mark.thorough
@pytest.mark.parametrize("engine", ENGINES)
def test_thermal_transpiration(engine):
    """In the dark of every direction there is a wall, and the density of those that come from it is J
    (2 pi m / T)^(1/2) per angle: n T^(1/2) of a long slit is the same everywhere, and n exactly the mean of
    T^(-1/2) over the walls that are seen. A uniform gas, or one of uniform pressure, is far off."""
    numbers = blocks(engine)[1]
    x, y = ((np.arange(n) + 0.5) * length / n for n, length in ((64, LENGTH), (16, WIDTH)))
    seen = from_walls(*np.meshgrid(x, y, indexing="ij")).mean(axis=1).reshape(4, 16).mean(axis=1)
    expected = COUNT * seen / seen.sum()
    error = numbers.std(axis=0, ddof=1) / math.sqrt(BLOCKS)
    assert (error < 0.02 * expected).all()
    assert numbers.mean(axis=0) == pytest.approx(expected, abs=3.0 * error.max())
    pressure = 1.0 / (COLD + (HOT - COLD) * (np.arange(4) + 0.5) / 4.0)
    for wrong in (np.ones(4), pressure):
        assert np.abs(numbers.mean(axis=0) - COUNT * wrong / wrong.sum()).max() > 10.0 * error.max()


@pytest.mark.thorough
def test_particles_leave_with_the_temperature_of_the_place():
    """m v_n^2 / T has the mean 2 and m v_t^2 / T the mean 1, at every place of the face."""
    simulation = gp.Simulation(VESSEL, ENGINES["event"], seed=2)
    simulation.record_events = True
    simulation.advance(max_events=30_000)
    hits = np.isin(simulation.events["particles"][:, 1], (-3, -4))
    place = simulation.events["positions"][hits, 0, 0]
    squares = simulation.events["velocities"][hits, 0] ** 2
    squares /= (COLD + (HOT - COLD) * place / LENGTH)[:, None]
    for part in np.array_split(np.argsort(place), 4):
        assert len(part) > 4000
        assert squares[part, 1].mean() == pytest.approx(2.0, abs=3.0 * math.sqrt(4.0 / len(part)))
        assert squares[part, 0].mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(2.0 / len(part)))


@pytest.mark.interpreted
def test_files_and_faces_by_either_name():
    scene = gp.Scene.from_dict(VESSEL.to_dict())
    assert scene == VESSEL and scene.faces["y_low"].temperatures == (COLD, HOT)
    assert gp.Thermal({"x high": HOT, "x low": COLD}) == RAMP
    assert list(gp.Thermal({"x_high": HOT, "x_low": COLD}).temperature) == ["x_low", "x_high"]


@pytest.mark.thorough
def test_no_theory_of_plates_is_stated_of_it():
    simulation = gp.Simulation(VESSEL, ENGINES["dsmc"], seed=1)
    simulation.advance(duration=40.0)
    assert "theory" not in gp.analysis.heat_flux(simulation)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("face", "temperature", "rule"),
    [
        ("x_low", {"x_low": 1.0, "x_high": 2.0}, "must vary along the face, not across it"),
        ("x_low", {"z_low": 1.0, "z_high": 2.0}, "needs walls across z"),
        ("z_low", {"y_low": 1.0, "y_high": 2.0}, "needs walls across y"),
        ("x_low", {"z_low": 1.0, "y_high": 2.0}, "must be of two opposite faces"),
        ("x_low", [1.0, 2.0], "must be a single number"),
    ],
)
def test_what_is_refused(face, temperature, rule):
    container = {"lengths": [9.0, 9.0, 9.0], "boundary": ["wall", "periodic", "wall"]}
    if "across z" in rule:
        container = {"lengths": [9.0, 9.0]}
    faces = {face: {"kind": "thermal", "temperature": temperature}}
    with pytest.raises(gp.SceneError, match=rf"faces.{face}.temperature.*{rule}"):
        gp.Scene.from_dict({"container": container, "faces": faces})
