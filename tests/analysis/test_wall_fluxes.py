"""Heat and shear stress on walls: free flight, a fluid, between them, and balances that are exact."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.expected.flows import plates_of
from gaspart.analysis.run import open_run
from gaspart.errors import SceneError
from gaspart.theory.heat import INTERPOLATED, dilute_fourier_flux

A = gp.analysis
GAP, SIDE = 10.0, 4.0
ENGINES = {"event": gp.EventDriven(), "dsmc": gp.DSMC(0.05, (20, 1, 1), "boltzmann")}


def plates(count, knudsen, hot=1.0, slide=0.0, drift=0.0, **rest):
    """Between x_low, at `hot`, and x_high, at 1, which slides along y."""
    density = count / (GAP * SIDE**2)
    diameter = (math.sqrt(2.0) * math.pi * density * knudsen * GAP) ** -0.5
    faces = {
        "x_low": gp.Thermal(hot, velocity=(0.0, drift, 0.0)),
        "x_high": gp.Thermal(1.0, velocity=(0.0, drift + slide, 0.0)),
    }
    container = gp.Container((GAP, SIDE, SIDE), ("wall", "periodic", "periodic"))
    species = gp.Species(count, diameter / 2, temperature=1.2)
    return gp.Scene(container, [species], faces=faces, **rest)


def made(scene, duration, engine="dsmc", seed=1):
    simulation = gp.Simulation(scene, ENGINES[engine], seed=seed)
    simulation.advance(duration=duration)
    return simulation


def off(found):
    """Deviations in standard deviations, of values with an error."""
    return np.abs(found.deviation.values[np.isfinite(found.deviation.values)])


def test_heat_between_free_flight_and_a_fluid():
    """A fluid whose flux differs by more than 8 % from either limit."""
    scene = plates(1000, 1.0, hot=2.0, drift=1e-9)  # the kernels of plates that slide
    found = A.heat_flux(made(scene, 400.0))
    free = float(gp.theory.free_molecular_flux(6.25, 2.0, 1.0, 3))
    flux = float(found.theory[1])
    assert "Sherman" in found.attrs["source"] and 0.7 * free < flux < 0.85 * free
    unsure = math.hypot(INTERPOLATED, ENGINES["dsmc"].bias(scene, "fluxes"))
    assert float(found["heat_flux_theory_error"][1]) == pytest.approx(unsure * flux)
    assert (off(found) < 3.0).all() and (found.error < 0.03 * flux).all()


@pytest.mark.thorough
def test_heat_of_a_fluid():
    """Knudsen number 0.05: Fourier's flux would be 25 % more without temperature jumps."""
    scene = plates(2000, 0.05, hot=2.0)
    found = A.heat_flux(made(scene, 1200.0))  # 7 times of the conduction of heat
    assert "jumps" in found.attrs["source"] and (off(found) < 3.0).all()
    diameter = 2.0 * scene.largest_radius
    without = dilute_fourier_flux(GAP, 2.0, 1.0, diameter)
    assert float(found.theory[1]) < 0.85 * without
    assert float(found.error[1]) < 0.05 * without


def test_stress_and_heat_of_sliding_plates_in_free_flight():
    """n U sqrt(T / 2 pi) = 6.25 / sqrt(2 pi) = 2.493 drags both plates, and half its work warms each."""
    simulation = made(plates(1000, 1e6, slide=1.0), 800.0)
    shear, heat = A.wall_shear(simulation), A.heat_flux(simulation)
    assert shear.theory.sel(component="y").values == pytest.approx([2.4934, -2.4934], rel=2e-3)
    assert shear.theory.sel(component="z").values == pytest.approx([0.0, 0.0])
    assert heat.theory.values == pytest.approx([1.2467, 1.2467], rel=2e-3)
    assert (off(shear) < 3.0).all() and (off(heat) < 3.0).all()
    assert (shear.error.sel(component="y") < 0.05).all()
    work = float(-shear.estimate.sel(face="x high", component="y"))
    assert float(heat.estimate.sum()) == pytest.approx(work, abs=3.0 * float(heat.error.sum()))


@pytest.mark.interpreted
def test_the_equations_of_points_do_not_depend_on_density():
    """The path of particles that touch is shorter than that of points by the contact value."""
    scene = plates(50, 0.2)
    paths = {}
    for engine in ENGINES:
        with open_run(made(scene, 0.5, engine), 0.0) as run:
            paths[engine] = plates_of(run)
    found = paths["event"]
    assert found.filled > 0.03 and found.length == pytest.approx(GAP - 2.0 * scene.largest_radius)
    contact = float(gp.theory.contact_value(found.filled, 3))
    assert paths["dsmc"].knudsen == pytest.approx(0.2, rel=1e-3)
    assert found.knudsen == pytest.approx(0.2 / contact, rel=1e-6) and contact > 1.08


@pytest.mark.interpreted
def test_plates_that_nothing_hits_are_refused():
    slow = plates(2, 1.0)
    slow = replace(slow, species=[replace(slow.species[0], temperature=1e-9)])
    with pytest.raises(SceneError, match="nothing hit"):
        A.heat_flux(made(slow, 2.0))


@pytest.mark.parametrize("dimension", [pytest.param(2, marks=pytest.mark.thorough), 3])
def test_heat_of_free_flight_beside_an_open_face(dimension):
    """Points come from a reservoir at 2 and go back at the wall's 1: each leaves (d + 1) / 2 of heat."""
    density, radius = 300.0 / 10.0**dimension, 1e-4
    reservoir = gp.Open(density * {2: math.pi, 3: 4.0 / 3.0 * math.pi}[dimension] * radius**dimension, 2.0)
    container = gp.Container((10.0,) * dimension, ("wall", *["periodic"] * (dimension - 1)))
    species = [gp.Species(300, radius, temperature=1.0)]
    faces = {"x_low": reservoir, "x_high": gp.Thermal(1.0)}
    scene = gp.Scene(container, species, faces=faces, centres_to_walls=True)
    found = A.heat_flux(made(scene, 200.0, "event"))
    expected = 0.5 * (dimension + 1.0) * density * math.sqrt(2.0 / (2.0 * math.pi))
    assert found.estimate["face"].values.tolist() == ["x high"] and found.theory is None
    assert abs(float(found.estimate[0]) - expected) < 3.0 * float(found.error[0]) < 0.3 * expected
