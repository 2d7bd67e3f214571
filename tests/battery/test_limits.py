"""Symmetries beside the table: the number of particles, turns of discs, walls of no effect, and nearly equal
species."""

import math
from dataclasses import replace

import numpy as np
import pytest
from battery.observed import outcome
from battery.symmetries import divided
from exact import closed, runs
from exact.kinds import kinds

import gaspart as gp
from gaspart.errors import SceneError
from gaspart.trajectory.reading import open_trajectory
from gaspart.yaml_text import dump_yaml, parse_yaml

pytestmark = pytest.mark.thorough

COUNTS = (2, 5, 20, 100, 500)
FRACTION, COLLISIONS = 1e-3, 4000
"""Packing fraction and collisions of a dilute gas: 5/2 of the fraction is what the theory omits."""


@pytest.mark.parametrize("count", COUNTS)
def test_a_dilute_gas_depends_on_its_number_as_the_pairs_and_the_fixed_energy_say(count, tmp_path):
    """Z - 1 = 4 eta (N - 1) / N and Gamma = 4 n sigma^2 sqrt(pi) (N - 1) / N times the factor of speeds."""
    side = (count * math.pi / 6.0 / FRACTION) ** (1.0 / 3.0)
    species = [gp.Species(count, 0.5, temperature=1.0, exact_temperature=True)]
    scene = gp.Scene(gp.Container((side,) * 3, "periodic"), species)
    share = (count - 1.0) / count
    rate = 4.0 * count / side**3 * math.sqrt(math.pi) * share * closed.speed_factor(3 * (count - 1))
    duration = 2.0 * COLLISIONS / (count * rate) / 0.75
    path = gp.run(scene, gp.EventDriven(), 3, duration, duration / 256, tmp_path / "run.nc", pairs=True)
    expected = {
        "Z": 1.0 + 4.0 * FRACTION * share,
        "collision_rate": rate,
        "pair_rates": rate,
        "contact_values": 1.0,
    }
    for name, value in expected.items():
        found = gp.measure(path, name)
        error = float(np.squeeze(found.error))
        less = 1.0 if name == "Z" else 0.0
        assert error < 0.05 * (value - less)
        allowed = 4.0 * error + 2.5 * FRACTION * (value - less)
        assert float(np.squeeze(found.estimate)) == pytest.approx(value, abs=allowed), name


TURNS = {
    "mirror image": lambda x, side: np.stack([side - x[..., 0], x[..., 1]], axis=-1),
    "quarter turn": lambda x, side: np.stack([side - x[..., 1], x[..., 0]], axis=-1),
}


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("name", ["structure_factor", "partial_structure_factors", "order", "rdf"])
def test_discs_have_the_same_structure_in_a_mirror_and_turned(name, turn):
    data = runs.recorded("periodic")
    side = kinds()["periodic"].case.box.lengths[0]
    turned = data.copy(deep=True)
    plane = data["coordinates"].values[..., :2].astype(float)
    turned["coordinates"].values[..., :2] = TURNS[turn](plane, side)
    one, other = (gp.measure(each, name) for each in (data, turned))
    # A pair may be in the next bin, and some wave vectors of a shell are chosen.
    apart = np.abs(np.asarray(one.estimate) - np.asarray(other.estimate))
    allowed = {"order": 1e-4 * float(np.max(one.estimate)), "rdf": 0.02 * float(np.max(one.estimate))}
    error = np.nan_to_num(np.asarray(one.error))
    assert (apart <= allowed.get(name, 1e-6 * np.asarray(one.estimate) + 4.0 * error)).all()


STATIC = ("pressure", "force", "density", "temperature", "collision_rate", "speeds", "heat_flux", "velocity")
"""Observables that walls of no effect leave as they are."""


@pytest.mark.parametrize("name", STATIC)
def test_a_wall_that_no_particle_reaches_has_no_effect(name, tmp_path):
    """A segment in a corner, nearer to the faces than the radius: centres never touch it."""
    scene = gp.Scene(
        gp.Container((6.0, 5.0)),
        [gp.Species(16, 0.3, temperature=1.0)],
        faces={"x_low": gp.Thermal(1.0)},
    )
    path = gp.run(scene, gp.EventDriven(), 4, 64.0, 0.5, tmp_path / "run.nc")
    cut = replace(scene, walls=[gp.Wall((0.02, 0.02), (0.05, 0.03))])
    with open_trajectory(path) as data:
        plain = data.load()
    one, other = (
        outcome(name, each, (1, (0, 1)))
        for each in (plain, plain.assign_attrs(scene=dump_yaml(cut.to_dict())))
    )
    assert not isinstance(one, SceneError) and not isinstance(other, SceneError)
    np.testing.assert_allclose(np.asarray(other.estimate), np.asarray(one.estimate), rtol=2e-3)


@pytest.mark.parametrize(
    "name", [*STATIC, "msd", "vacf", "order", "structure_factor", "rdf", "Z", "chemical_potential"]
)
def test_two_species_whose_radii_hardly_differ_are_as_one(name):
    kind = (
        "periodic"
        if name in ("order", "structure_factor", "rdf", "Z", "chemical_potential")
        else "points_walls"
    )
    data = runs.recorded(kind)
    halves = divided(data)
    scene = gp.Scene.from_dict(parse_yaml(halves.attrs["scene"]))
    first, second = scene.species
    nearly = replace(scene, species=(first, replace(second, radius=second.radius * (1.0 - 1e-12))))
    one = outcome(name, data, (1, (0, 1)))
    other = outcome(name, halves.assign_attrs(scene=dump_yaml(nearly.to_dict())), (1, (0, 1)))
    if isinstance(one, SceneError):
        assert isinstance(other, SceneError)
        return
    if isinstance(other, SceneError):  # what faces are given is tallied per area of each size
        assert name in ("pressure", "heat_flux") and "area" in other.rule
        return
    value = np.asarray(other.estimate, float)
    if name == "chemical_potential":
        value = value[0]
    scale = np.nanmax(np.abs(np.asarray(one.estimate, float)))
    tolerance = (
        4.0 * float(one.error)
        if name == "chemical_potential"
        else 1e-2 * scale
        if name == "rdf"
        else 1e-6 * scale
    )
    np.testing.assert_allclose(value, np.asarray(one.estimate, float), rtol=0.0, atol=tolerance)
