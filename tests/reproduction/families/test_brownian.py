"""The large particle's numbers, from made-up paths whose friction and diffusion are known."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, column, draw, follows, lines, shows, varied

import gaspart as gp
from gaspart import theory
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.brownian import claims as claims_of_brownian
from gaspart.reproduction.families.brownian import figure, measure
from gaspart.reproduction.points.point import Point

RATE, MASS, COUNT = 0.5, 100.0, 900


def point(replicas=300, boundary="periodic", **more):
    """A point whose scene file is replaced by `motion`'s scene in these tests."""
    settings = {
        "scene": "config/scenes/brownian_heavy.yaml",
        "scene.container.boundary": boundary,
        "scene.species.0.count": COUNT,
        "displacements": True,
        "duration": 60.0,
        "samples": 300,
        "replicas": replicas,
    }
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
        monkeypatch.setattr(measure, "_read_paths", lambda given: found)
        return chosen

    return use


def test_friction_diffusion_and_equipartition_of_known_paths(made_up):
    """With the recoil that a finite gas gives back, and its drift, taken out."""
    chosen = point()
    motion = measure.motion_of(chosen)
    assert motion.share == pytest.approx(0.1)
    ds = measure.brownian_msd([made_up(chosen, paths(motion, 300, drift=1.0))], {}).isel(point=0)
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


def test_a_light_particle_is_expected_to_move_as_the_linear_boltzmann_equation_states(made_up):
    """In Maxwell's gas near Langevin's equation; with less energy, and less far, in one of equal speeds."""
    equal_speeds = {"scene.species.0.temperature": None, "scene.species.0.speed": 3**0.5}
    found = {}
    for name, gas in (("maxwell", {}), ("equal", equal_speeds)):
        light = {"replicas": 40, "boundary": "wall", "scene.particles.0.mass": 1.0, **gas}
        motion = measure.motion_of(point(**light))
        unit = 1.0 / motion.friction
        chosen = point(**light, duration=24.0 * unit, equilibration=6.0 * unit, samples=240)
        assert motion.is_light
        made_up(chosen, paths(motion, 40))
        found[name] = measure.brownian_msd([chosen], {}).isel(point=0)
        assert 0.001 < float(found[name]["expected_friction_error"] / motion.friction) < 0.02
    maxwell, equal = found["maxwell"], found["equal"]
    assert float(maxwell["expected_equipartition"]) == pytest.approx(1.0, abs=0.012)
    assert float(maxwell["expected_friction"] / maxwell["friction"]) == pytest.approx(0.9935, abs=0.015)
    assert float(equal["expected_equipartition"]) == pytest.approx(0.925, abs=0.015)
    assert float(equal["expected_friction"] / equal["friction"]) == pytest.approx(0.963, abs=0.015)
    assert float(equal["expected_vacf"][0]) == pytest.approx(float(equal["expected_equipartition"]), rel=1e-6)


def test_between_walls_nothing_is_given_back():
    motion = measure.motion_of(point(boundary="wall"))
    assert motion.share == 0.0
    assert motion.diffusion * motion.friction * motion.mass == pytest.approx(motion.temperature)
    light = measure.motion_of(point(boundary="wall", **{"scene.particles.0.mass": 1.0}))
    assert light.diffusion * light.friction == pytest.approx(1.01895)


def test_ends_of_paths(made_up):
    chosen = point(boundary="wall")
    motion = measure.motion_of(chosen)
    found = [(t, x, v) for t, x, v in paths(motion, 200)]
    ds = measure.brownian_paths([made_up(chosen, found)], {"paths": 3}).isel(point=0)
    assert ds["way"].shape == (3, 301, 3) and int(ds["end_freedom"]) == 600
    # these start in equilibrium, not at rest: farther by (30 - 1) / (30 - 1.5)
    ratio = float(ds["end_chi_square"] / ds["end_freedom"])
    assert ratio == pytest.approx(29.0 / 28.5, abs=4 * np.sqrt(2 / 600))


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
        measure.brownian_msd([point(displacements=False)], {})
    short = point()
    motion = measure.motion_of(short)
    found = [(t[:60], x[:60], v[:60]) for t, x, v in paths(motion, 2)]
    with pytest.raises(gp.SceneError, match="must be .* or more"):
        measure.brownian_msd([made_up(short, found)], {})
    with pytest.raises(gp.SceneError, match="one entry of particles and one species"):
        measure.motion_of(point(scene="config/scenes/brownian.yaml", **{"scene.particles": []}))


def measured(**changes):
    """What `measure.brownian` gives of a heavy particle, if theory is right."""
    values = {
        "equal_speeds": False,
        "is_light": False,
        "stepped": False,
        "mass": 100.0,
        "gas_mass": 1.0,
        "replicas": 200,
        "share": 0.02,
        "radius": 10.0,
        "contact": 10.5,
        "mean_free_path": 700.0,
        "friction": 0.05,
        "diffusion": 0.2,
        "expected_equipartition": 1.0,
        "expected_equipartition_error": 0.0,
        "expected_friction": 0.05,
        "expected_friction_error": 0.0,
        "expected_diffusion": 0.2,
        "expected_diffusion_error": 0.0,
        "equipartition": 1.01,
        "equipartition_error": 0.01,
        "measured_friction": 0.0505,
        "measured_friction_error": 0.0007,
        "measured_diffusion": 0.199,
        "measured_diffusion_error": 0.006,
        "end_freedom": 600,
        "end_chi_square": 620.0,
    }
    return xr.Dataset({name: ("point", [value]) for name, value in (values | changes).items()})


def equal_speeds(**changes):
    """The same of a light particle in a gas of equal speeds, for which the linear Boltzmann equation is
    solved."""
    expected = {"expected_equipartition": 0.93, "expected_friction": 0.0475, "expected_diffusion": 0.186}
    errors = {f"{name}_error": 0.001 * value for name, value in expected.items()}
    found = {"equipartition": 0.925, "measured_friction": 0.0478, "measured_diffusion": 0.184}
    others = {"equal_speeds": True, "is_light": True, "mass": 1.0, "share": 0.0}
    return measured(**others | expected | errors | found | changes)


def verdicts(ds):
    return judged([*claims_of_brownian.brownian_paths(ds), *claims_of_brownian.brownian_msd(ds)])


def test_theory_agrees_with_itself():
    found = verdicts(measured())
    assert len(found) == 5 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("equipartition", 1.06, "equipartition"),
        ("measured_friction", 0.055, "friction"),
        ("measured_diffusion", 0.23, "diffusion"),
        ("end_chi_square", 800.0, "ends of"),
        ("mean_free_path", 90.0, "mean free path"),
    ],
)
def test_each_claim_can_fail(name, value, text):
    found = verdicts(measured(**{name: value}))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


def test_the_sources_gas_is_not_in_equilibrium():
    """Theory of its own gas is expected, and that of one in equilibrium is excluded, or else undecided."""
    claims = claims_of_brownian.brownian_msd(equal_speeds())
    assert all("equal speeds" in claim.claim and "Boltzmann" in claim.source for claim in claims[:3])
    assert judge(claims) == ["agrees"] * 4
    assert [claim.alternative for claim in claims[:3]] == [1.0, 0.05, 0.2]
    assert [claim.is_scattered for claim in claims[:3]] == [True, True, False]  # D follows from both
    maxwell = {"equipartition": 1.0, "measured_friction": 0.0505, "measured_diffusion": 0.206}
    assert judge(claims_of_brownian.brownian_msd(equal_speeds(**maxwell)))[:3] == ["disagrees"] * 3
    assert (
        judge(claims_of_brownian.brownian_msd(equal_speeds(measured_friction_error=0.0014)))[1]
        == "inconclusive"
    )


def test_both_engines_are_compared_where_both_have_run_a_scene():
    events = equal_speeds()
    heavy = measured(stepped=False)
    steps = events.assign(stepped=("point", [True]))
    claims = claims_of_brownian.brownian_msd(xr.concat([heavy, events, steps], "point"))
    both = [claim for claim in claims if "by time steps" in claim.claim]
    assert len(both) == 3 and judge(both) == ["agrees"] * 3
    assert all(claim.measured.value == 1.0 and "equal speeds" in claim.claim for claim in both)
    for name in ("equipartition", "measured_friction", "measured_diffusion"):
        wrong = steps.assign({name: 1.2 * steps[name]})
        found = judged(claims_of_brownian.brownian_msd(xr.concat([heavy, events, wrong], "point")))
        assert [one for text, one in found.items() if "by time steps" in text].count("disagrees") == 1


def test_a_friction_that_does_not_exclude_the_bare_radius_is_inconclusive():
    found = verdicts(measured(contact=10.1))
    assert {verdict for claim, verdict in found.items() if "friction" in claim} == {"inconclusive"}


def rows(**values):
    light = {name: [False, True] for name in ("equal_speeds", "stepped", "is_light")}
    gases = {"mass": [100.0, 1.0], "gas_mass": [1.0, 1.0], "radius": [10.0, 10.0]}
    runs = {"duration": [580.0, 300.0], "friction": [0.05, 0.1]}
    columns = {name: ("point", column) for name, column in {**light, **gases, **runs}.items()}
    return xr.Dataset(values | columns)


def test_displacements_and_velocities_are_drawn_with_their_deviations():
    time = np.linspace(0.0, 8.0, 81) * np.array([[1.0], [0.9]])
    msd, vacf, error = theory.langevin_msd(time, 1 / 6, 1.0), np.exp(-time), np.full(time.shape, 0.01)
    curves = {"time": time, "msd": msd, "msd_error": error, "vacf": vacf, "vacf_error": error}
    curves |= {"expected_msd": 0.93 * msd, "expected_vacf": 0.93 * vacf}
    ds = rows(**{name: (("point", "lag"), values) for name, values in curves.items()})
    ds = varied(ds, "time", "mass", "gas_mass")
    for name in curves:
        ds[name][1, 70:] = np.nan  # a shorter run has fewer lags
    msd, ratio, vacf, difference = draw(figure.brownian_msd, ds).axes
    first, second = ds.isel(point=0), ds.isel(point=1, lag=slice(70))
    shows(msd, column(first, "time", "msd", some=True), column(second, "time", "msd", some=True))
    shows(vacf, column(first, "time", "vacf", some=True), column(second, "time", "vacf", some=True))
    relative, absolute = [], []
    for row in (first, second):
        curve = np.maximum(theory.langevin_msd(row["time"], 1 / 6, 1.0), 1e-300)
        relative.append(Points(row["time"], row["msd"] / curve - 1.0, row["msd_error"] / curve, some=True))
        absolute.append(Points(row["time"], row["vacf"] - np.exp(-row["time"]), row["vacf_error"], some=True))
    shows(ratio, *relative)
    shows(difference, *absolute)


def test_paths_are_drawn_from_above_and_start_in_the_middle():
    way = np.cumsum(np.random.default_rng(1).standard_normal((2, 4, 50, 3)), axis=2)
    way -= way[:, :, :1]
    way[1, :, 40:] = np.nan
    ds = rows(way=(("point", "path", "frame", "axis"), way))
    for index, axis in enumerate(draw(figure.brownian_paths, ds).axes):
        paths = [one for one in lines(axis) if len(one.get_xdata()) > 1]
        for path, one in zip(way[index], paths, strict=True):
            follows(one, path[:, 0], path[:, 1])
