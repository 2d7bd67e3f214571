"""Particles that pass a plane, or an opening: effusion, and the area that walls leave."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.expected.flows import opening
from gaspart.analysis.measuring import measure
from gaspart.errors import SceneError

A = gp.analysis


def chamber(count=4000, radius=1e-4, region=((0.0, 0.0), (20.0, 20.0)), **more):
    """Two halves of 20 by 20, with an opening of 2 between them."""
    walls = [gp.Wall((20.0, 0.0), (20.0, 9.0)), gp.Wall((20.0, 11.0), (20.0, 20.0))]
    species = gp.Species(count, radius, temperature=2.0, mass=0.5, region=region)
    return gp.Scene(gp.Container((40.0, 20.0)), [species], walls=walls, **more)


@pytest.fixture(scope="module")
def streamed():
    """Points that are in the left half at first, until the first could return: 10 sqrt(1/8 pi)^-1 later."""
    simulation = gp.Simulation(chamber(), gp.EventDriven(), seed=1)
    simulation.advance(duration=4.0)
    return simulation


@pytest.mark.thorough
def test_effusion(streamed):
    """n sqrt(k_B T / 2 pi m) w = 10 sqrt(2 / pi) 2 = 15.96 per time, of which the net number is exact."""
    found = A.particle_flux(streamed, "x", start=0.0)
    assert found.estimate.dims == ("component",) and found["component"].values.tolist() == ["x"]
    theory = 10.0 * math.sqrt(2.0 / math.pi) * 2.0
    assert float(found.theory[0]) == pytest.approx(theory, rel=0.02)
    assert abs(float(found.deviation[0])) < 3.0
    assert float(found.error[0]) < 0.2 * theory
    last = streamed.state.positions[:, 0] > 20.0
    assert float(found.estimate[0]) == pytest.approx(last.sum() / 4.0)


@pytest.mark.thorough
def test_the_flux_of_a_mirrored_or_turned_gas(streamed):
    """Its sign follows the axis, as its name does."""
    with_x = A.particle_flux(streamed, "x", start=0.0)
    mirrored = chamber(region=((20.0, 0.0), (40.0, 20.0)))
    simulation = gp.Simulation(mirrored, gp.EventDriven(), seed=1)
    simulation.advance(duration=4.0)
    back = A.particle_flux(simulation, "x", start=0.0)
    assert float(back.theory[0]) == pytest.approx(-float(with_x.theory[0]), rel=0.02)
    assert abs(float(back.deviation[0])) < 3.0 and float(back.estimate[0]) < 0.0
    elsewhere = A.particle_flux(streamed, "x", at=10.0, start=0.0)
    assert elsewhere.theory is None or float(elsewhere.theory[0]) != float(with_x.theory[0])


def test_a_piston_that_compresses_moves_particles_through_a_plane_at_rest(tmp_path):
    """At speed u, those that were beyond the plane: no steady state, and no theory of one."""
    kind = gp.Species(1000, 0.05, temperature=0.05)
    scene = gp.Scene(gp.Container((6.0, 6.0, 6.0)), [kind], faces={"z_high": gp.Piston(speed=0.1)})
    path = gp.run(scene, gp.EventDriven(), 1, 20.0, 0.25, tmp_path / "run.nc")
    found = measure(path, "flux", axis="z")
    assert found.theory is None
    assert float(found.estimate[0]) < -3.0 * float(found.error[0])


def test_the_area_that_walls_leave():
    assert opening(chamber(), 0, 20.0, 0.25) == pytest.approx(2.0 - 0.5)
    assert opening(chamber(), 0, 10.0, 0.25) is None
    assert opening(chamber(), 1, 20.0, 0.25) is None
    plates = [
        gp.Plate((5.0, 0.0, 0.0), ((0.0, 10.0, 0.0), (0.0, 0.0, 4.0))),
        gp.Plate((5.0, 0.0, 0.0), ((0.0, 4.0, 0.0), (0.0, 0.0, 10.0))),
    ]
    container = gp.Container((10.0, 10.0, 10.0))
    scene = gp.Scene(container, [gp.Species(10, 0.1, temperature=1.0)], walls=plates)
    assert opening(scene, 0, 5.0, 0.5) == pytest.approx((6.0 - 2 * 0.5) ** 2)
    tilted = [gp.Plate((5.0, 5.0, 2.0), ((0.0, 1.0, 1.0), (0.0, -1.0, 1.0)))]
    assert opening(gp.Scene(container, scene.species, walls=tilted), 0, 5.0, 0.1) is None


def test_refusals(streamed):
    for selection, rule in (
        ({"at": 40.0}, "from 0 to 40"),
        ({"at": -1.0}, "from 0 to"),
        ({"axis": "z"}, "axis"),
        ({"species": 1}, "species"),
    ):
        with pytest.raises(SceneError, match=rule):
            measure(streamed, "flux", **{"axis": "x", **selection})
    gas = gp.Scene(gp.Container((8.0, 8.0), ("wall", "periodic")), [gp.Species(20, 0.5, temperature=1.0)])
    simulation = gp.Simulation(gas, gp.EventDriven(), seed=1)
    simulation.advance(duration=5.0)
    assert np.isfinite(float(measure(simulation, "flux").error[0]))
    with pytest.raises(SceneError, match="images pass"):
        measure(simulation, "flux", axis="y")
