"""Particles that pass a plane, or an opening, and the area that walls leave."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.expected.flows import opening
from gaspart.analysis.measuring import measure
from gaspart.errors import SceneError


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
